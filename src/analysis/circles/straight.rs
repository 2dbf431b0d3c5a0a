//! Straight tubes: all rings are one regular polygon, moved along its axis.
//!
//! An upsampling and k averages, the first with the kernel `cos(theta/2)`, multiply the radius by `g = cos(theta/2)
//! cos(theta/4)^(2 (k - 1))`; a push-back replaces this factor by `g + delta (1 - g)`. With `theta` halved at each
//! level the limit radius is the control radius times the product of `g + delta (1 - g)` over all levels; without a
//! push-back this product is `sin(theta)/theta (2 sin(theta/2)/theta)^(2 k - 2)`.

use super::words;
use crate::math::functions::cos;
use crate::scheme::operator::Role;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::rules::LatitudeRule;

/// Number of levels whose factors are multiplied: the cosine of an angle that is halved so often is 1. Factors are 1
/// from level 27 on. Half as many suffice for most angles; twice as many multiply by 1 more often.
const MULTIPLIED_LEVELS: u32 = 60;
/// Largest deviation of a kernel or compensation from the value that preserves circles, some thousand roundings. Half
/// of it would refuse functions that are written in another way; twice of it would report circles for plans that
/// deviate as much.
const COMPENSATION_ROUNDING: f64 = 1e-12;
/// Number of halvings of the interval in which a push-back factor is searched for, which gives all digits. Half as many
/// give half of the digits; twice as many change nothing.
const PUSH_BACK_HALVINGS: u32 = 60;

/// A straight tube of regular polygons under a plan.
#[derive(Debug, Clone)]
pub struct StraightTube {
    /// The angle between neighbours on a ring, radians.
    pub theta: f64,
    steps: Vec<Scheduled>,
    /// The push-back factor of the plan; 0 if nothing is pushed back.
    pub delta: f64,
    /// Whether the word of the plan pushes anything back.
    pub pushes: bool,
}

impl StraightTube {
    /// Creates the tube whose neighbouring vertices on a ring are the angle `theta` apart.
    ///
    /// # Errors
    /// A sentence if the plan does not preserve circles.
    pub fn of(plan: &Plan, theta: f64) -> Result<Self, String> {
        let latitude = plan.latitude.as_ref().ok_or("the plan does not look at latitude tags")?;
        if !words::keeps_circles(&plan.word, latitude.rule) {
            return Err("only words in which a C follows each U, as U C^k and U C^k P, keep circles".into());
        }
        let plan = Plan { alpha: theta, compensation_alpha: None, ..plan.clone() };
        let steps = plan.schedule(MULTIPLIED_LEVELS).map_err(|fault| fault.detail)?;
        let pushes = words::pushes(&plan.word);
        let delta = if pushes { plan.delta.value(4.0).map_err(|error| error.to_string())? } else { 0.0 };
        let tube = Self { theta, steps, delta, pushes };
        let compensated = pushes && delta != 0.0 || latitude.rule == LatitudeRule::Position;
        if tube.keeps_circles(compensated) {
            return Ok(tube);
        }
        Err(format!(
            "circles need the kernel cos(alpha/2), 1 in later averages, and the compensation 1/cos(alpha/2) with alpha \
             = {theta}; leave kernel, compensation and alpha out, which are these then"
        ))
    }

    fn keeps_circles(&self, compensated: bool) -> bool {
        let mut angle = 2.0 * self.theta;
        self.steps.iter().all(|step| {
            match step.letter.facts().role {
                Role::Upsample => angle /= 2.0,
                Role::Average if step.first => return (step.kernel - cos(angle / 2.0)).abs() <= COMPENSATION_ROUNDING,
                Role::Average => return (step.kernel - 1.0).abs() <= COMPENSATION_ROUNDING,
                Role::PushBack if compensated => {
                    return (step.compensation * cos(angle / 2.0) - 1.0).abs() <= COMPENSATION_ROUNDING;
                }
                Role::PushBack | Role::Smooth => {}
            }
            true
        })
    }

    /// Returns the ratio of the limit radius to the control radius for a push-back factor.
    pub fn factor(&self, delta: f64) -> f64 {
        let (mut angle, mut radius, mut before) = (2.0 * self.theta, 1.0, 1.0);
        for step in &self.steps {
            match step.letter.facts().role {
                Role::Upsample => {
                    angle /= 2.0;
                    before = radius;
                }
                Role::Average if step.first => radius *= cos(angle / 2.0),
                Role::Average => radius *= cos(angle / 4.0) * cos(angle / 4.0),
                Role::PushBack => radius += delta * (before - radius),
                Role::Smooth => {}
            }
        }
        radius
    }

    /// Returns the push-back factor from 0 to 1 for which the limit radius is `wanted` times the control radius, if
    /// there is one.
    pub fn delta_for(&self, wanted: f64) -> Option<f64> {
        let (mut low, mut high) = (0.0, 1.0);
        if !self.pushes || wanted < self.factor(low) || wanted > self.factor(high) {
            return None;
        }
        for _ in 0..PUSH_BACK_HALVINGS {
            let middle = f64::midpoint(low, high);
            if self.factor(middle) < wanted { low = middle } else { high = middle }
        }
        // the bisection never returns 1 itself
        Some(if self.factor(1.0) <= wanted { 1.0 } else { low })
    }
}
