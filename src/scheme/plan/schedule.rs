//! Writes out a plan: every operator of every level with its values.

use super::{Plan, Scheduled};
use crate::fault::Fault;
use crate::math::expression::{Expression, ExpressionError};
use crate::math::parameter::Value;
use crate::scheme::letter::Letter;
use crate::scheme::local::{MAX_COMPENSATION, VANISHING_SUM, has_average};
use crate::scheme::operator::Role;
use crate::scheme::parameters::{ARITY, MU};
use crate::shape::tile::Tile;

impl Plan {
    /// Returns the operators of `levels` levels with their values.
    ///
    /// # Errors
    /// When a function has no value at some level; the fault names level and alpha.
    pub fn schedule(&self, levels: u32) -> Result<Vec<Scheduled>, Fault> {
        let (mut alpha, mut other) = (self.alpha, self.compensation_alpha.unwrap_or(self.alpha));
        let (mut scale, mut upsamplings) = (1.0, 0);
        let mut last_arity = None;
        let mut averages = None;
        let mut upsampled = None;
        let mut steps: Vec<Scheduled> = Vec::new();
        let prefix = self.word.prefix.len();
        for (i, letter) in self.word.letters(levels).enumerate() {
            let level = if i < prefix { 0 } else { (i - prefix) / self.word.cycle.len() + 1 };
            let level = u32::try_from(level).unwrap_or(u32::MAX);
            let operator = letter.operator;
            let arity = letter.settings.arity();
            let mut step = Scheduled {
                letter,
                level,
                alpha,
                compensation_alpha: other,
                scale,
                upsamplings,
                pushed_back: false,
                first: false,
                kernel: 1.0,
                compensation: 1.0,
            };
            match operator.facts().role {
                Role::Upsample => {
                    let before = f64::from(last_arity.unwrap_or(1));
                    alpha /= before;
                    other /= before;
                    scale /= before;
                    (step.alpha, step.compensation_alpha, step.scale) = (alpha, other, scale);
                    upsamplings += 1;
                    last_arity = Some(arity);
                    averages = Some(0);
                    upsampled = Some(i);
                }
                Role::Average => {
                    step.letter.settings.set(&ARITY, Value::Integer(last_arity.unwrap_or(arity).into()));
                    if let Some(place) = averages {
                        step.kernel = self.kernel_at(place, alpha, level, &step.letter)?;
                        step.first = place == 0;
                        averages = Some(place + 1);
                    }
                }
                Role::PushBack => {
                    step.compensation = self.compensation_at(other, level)?;
                    if let Some(upsampling) = upsampled {
                        steps[upsampling].pushed_back = true;
                    }
                }
                Role::Smooth => {}
            }
            let at_alpha = step.letter.operator.at_alpha(&mut step.letter.settings, step.alpha);
            at_alpha.map_err(|error| {
                Fault::new("/parameters/alpha", format!("{error} (level {level}); choose another alpha"))
            })?;
            steps.push(step);
        }
        Ok(steps)
    }

    fn kernel_at(&self, place: usize, alpha: f64, level: u32, letter: &Letter) -> Result<f64, Fault> {
        let Some(kernel) = self.kernel.get(place) else { return Ok(1.0) };
        let average = |kernel: &Expression, name| {
            let value = at(kernel, alpha, level, name)?;
            if has_average(value) { Ok(value) } else { Err(no_average(name, value, alpha, level)) }
        };
        let value = average(kernel, "kernel")?;
        let longitude = self.latitude.as_ref().and_then(|latitude| latitude.kernel_longitude.as_ref());
        if let Some(kernel) = longitude.filter(|kernel| place == 0 && kernel.is_constant()) {
            average(kernel, "kernel_longitude")?;
        }
        if letter.settings.tile() == Tile::Triangle
            && self.triangle_sums(value, letter).iter().any(|sum| sum.abs() < VANISHING_SUM)
        {
            let detail = format!(
                "the kernel is {value} at level {level} (alpha = {alpha}), where the weights of some triangle add up \
                 to 0; choose another kernel or another mu than {}",
                self.mu
            );
            return Err(Fault::new("/parameters/kernel", detail));
        }
        Ok(value)
    }

    /// Returns the sums of triangle weights that may differ from 1: around and next to V in C, next to V in D.
    fn triangle_sums(&self, kernel: f64, letter: &Letter) -> Vec<f64> {
        let mu = self.mu;
        if letter.facts().uses.contains(&MU.name) {
            vec![mu * kernel + 1.0 - mu, mu + 0.5 * (1.0 - mu) * (1.0 + kernel)]
        } else {
            vec![kernel + 2.0]
        }
    }

    fn compensation_at(&self, alpha: f64, level: u32) -> Result<f64, Fault> {
        let value = at(&self.compensation, alpha, level, "compensation")?;
        if value.abs() > MAX_COMPENSATION {
            let detail = if self.compensation.is_constant() {
                format!(
                    "the compensation is {value}; at most {MAX_COMPENSATION} in size is allowed: choose a smaller one"
                )
            } else {
                format!(
                    "the compensation is {value} at level {level} (alpha = {alpha}), a pole of the function; at most \
                     {MAX_COMPENSATION} is allowed: choose another alpha"
                )
            };
            return Err(Fault::new("/parameters/compensation", detail));
        }
        Ok(value)
    }
}

fn no_average(name: &str, value: f64, alpha: f64, level: u32) -> Fault {
    let detail = format!(
        "the {name} is {value} at level {level} (alpha = {alpha}), where no average exists, as its weights add up to \
         0; it is any number but -1"
    );
    Fault::new(format!("/parameters/{name}"), detail)
}

fn at(function: &Expression, alpha: f64, level: u32, name: &str) -> Result<f64, Fault> {
    function.value(alpha).map_err(|error| {
        let value = if let ExpressionError::NotFinite { value, .. } = error { value } else { f64::NAN };
        let detail = if function.is_constant() {
            format!("the {name} is {value}; it must be finite: change the expression")
        } else {
            format!(
                "the {name} is {value} at level {level} (alpha = {alpha}); it must be finite at every level for the \
                 alpha of the plan, even where points or latitude lines have their own: give another \"alpha\" in the \
                 plan, or change the expression"
            )
        };
        Fault::new(format!("/parameters/{name}"), detail)
    })
}
