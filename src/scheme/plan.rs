//! Plans: a preset or a word with its parameters, resolved for one kind of input.

use super::local::{Noise, Sources};
use super::mesh_net::Boundary;
use super::ops::Role;
use super::polygon_net::Ends;
use super::presets::{self, Preset, Refines, Spelling, WORD_PARAMETERS};
use super::step::StepError;
use super::word::{Letter, Word};
use crate::fault::{Fault, under};
use crate::math::expression::{Expression, ExpressionError};
use crate::math::parameter::{Literal, Values, shortened};

/// Most levels of any plan.
pub const MAX_LEVELS: u32 = 64;

/// Compensations beyond this come from a pole of the function, not from a wish.
const MAX_COMPENSATION: f64 = 1e12;

/// What a client writes as a plan.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlanInput {
    /// Name of a preset.
    pub preset: Option<String>,
    /// A word.
    pub word: Option<String>,
    /// Parameters of the preset or the word.
    pub parameters: Vec<(String, Literal)>,
    /// Boundary rule of meshes.
    pub boundary: Boundary,
    /// End rule of open polygons.
    pub ends: Ends,
    /// Seed of random perturbation.
    pub seed: u64,
}

/// What a plan is to be applied to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Subject {
    /// Polygons or a mesh.
    pub is_mesh: bool,
    /// Whether it has ends (an open polygon) or a boundary.
    pub is_open: bool,
    /// What a D could not carry along, if anything.
    pub tags: Option<&'static str>,
}

/// A resolved plan; equal plans are equal values, whether written as preset or word.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The operators.
    pub word: Word,
    /// Parameter spacing that enters the first U, radians.
    pub alpha: f64,
    /// The same for the compensation, where it differs.
    pub compensation_alpha: Option<f64>,
    /// Kernels of the first, second, ... average after a U, in alpha.
    pub kernel: Vec<Expression>,
    /// Compensation function, in alpha.
    pub compensation: Expression,
    /// Push-back factor, in valence.
    pub delta: Expression,
    /// Boundary rule of meshes.
    pub boundary: Boundary,
    /// End rule of open polygons.
    pub ends: Ends,
    /// Decaying perturbation, if any.
    pub perturbation: Option<Perturbation>,
}

/// A random perturbation `c gamma^h xi` of kernel and compensation at the h-th upsampling, `xi` in `[-1, 1)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Perturbation {
    /// Amplitude c.
    pub amplitude: f64,
    /// Decay gamma.
    pub decay: f64,
    /// Seed.
    pub seed: u64,
}

/// One operator with the numbers of its place in the plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Scheduled {
    /// The operator.
    pub letter: Letter,
    /// The level it belongs to: 0 for the prefix, then 1, 2, ...
    pub level: u32,
    /// Parameter spacing that entered the last upsampling, radians.
    pub alpha: f64,
    /// The same for the compensation.
    pub compensation_alpha: f64,
    /// By what the upsamplings before divided alpha: the factor of the alphas that points carry.
    pub scale: f64,
    /// Number of upsamplings before.
    pub upsamplings: u32,
    /// Whether it is the first average since an upsampling.
    pub first: bool,
    /// Value of the kernel.
    pub kernel: f64,
    /// Value of the compensation.
    pub compensation: f64,
}

impl Plan {
    /// The plan that does nothing, for conversions.
    pub fn none(boundary: Boundary, ends: Ends) -> Self {
        let one = Expression::constant(1.0);
        Self {
            word: Word::default(),
            alpha: 0.0,
            compensation_alpha: None,
            kernel: vec![one.clone()],
            compensation: one.clone(),
            delta: one,
            boundary,
            ends,
            perturbation: None,
        }
    }

    /// Resolves what a client wrote for a subject.
    ///
    /// # Errors
    /// Every fault, with pointers below the plan.
    pub fn resolve(input: &PlanInput, subject: Subject) -> Result<Self, Vec<Fault>> {
        let (spelling, prefix, place) = match (&input.preset, &input.word) {
            (Some(name), None) => (preset(name, &input.parameters, subject)?, Vec::new(), "/preset"),
            (None, Some(text)) => {
                let word = Word::parse(text).map_err(|error| vec![Fault::new("/word", error.to_string())]);
                let functions = word_functions(&input.parameters, subject);
                let (word, functions) = both(word, functions)?;
                (Spelling { cycle: word.cycle, ..functions }, word.prefix, "/word")
            }
            (None, None) => {
                return Err(vec![Fault::new("", "a plan is a \"preset\" or a \"word\"; give one of them")]);
            }
            (Some(_), Some(_)) => {
                return Err(vec![Fault::new("/word", "a plan is a \"preset\" or a \"word\"; leave one of them out")]);
            }
        };
        let mut word = Word { prefix, cycle: spelling.cycle };
        if !subject.is_mesh && spelling.kernel.len() == 1 {
            pair_duals(&mut word.prefix);
            pair_duals(&mut word.cycle);
        }
        let Spelling { alpha, compensation_alpha, kernel, compensation, delta, perturbation, .. } = spelling;
        let perturbation = perturbation.map(|[amplitude, decay]| Perturbation { amplitude, decay, seed: input.seed });
        let compensation_alpha = compensation_alpha.filter(|other| other.to_bits() != alpha.to_bits());
        let plan = Self {
            word,
            alpha,
            compensation_alpha,
            kernel,
            compensation,
            delta,
            boundary: input.boundary,
            ends: input.ends,
            perturbation,
        };
        if subject.is_mesh && plan.perturbation.is_some() {
            let detail = "perturbation acts on polygons; leave it out";
            return Err(vec![Fault::new("/parameters/perturbation", detail)]);
        }
        plan.check_legal(subject).map_err(|error| vec![Fault::new(place, error.to_string())])?;
        plan.check_delta(subject)?;
        Ok(plan)
    }

    /// The operators of `levels` levels with their numbers.
    ///
    /// # Errors
    /// When a function has no value at some level; the fault names level and alpha.
    pub fn schedule(&self, levels: u32) -> Result<Vec<Scheduled>, Fault> {
        let (mut alpha, mut other) = (self.alpha, self.compensation_alpha.unwrap_or(self.alpha));
        let (mut scale, mut upsamplings) = (1.0, 0);
        let mut last_arity = None;
        let mut averages = None;
        let mut steps = Vec::new();
        let prefix = self.word.prefix.len();
        for (i, letter) in self.word.letters(levels).enumerate() {
            let level = if i < prefix { 0 } else { (i - prefix) / self.word.cycle.len() + 1 };
            let level = u32::try_from(level).unwrap_or(u32::MAX);
            let operator = letter.operator;
            let arity = letter.arity;
            let mut step = Scheduled {
                letter,
                level,
                alpha,
                compensation_alpha: other,
                scale,
                upsamplings,
                first: false,
                kernel: 1.0,
                compensation: 1.0,
            };
            match operator.role() {
                Role::Upsample => {
                    let before = f64::from(last_arity.unwrap_or(1));
                    alpha /= before;
                    other /= before;
                    scale /= before;
                    (step.alpha, step.compensation_alpha, step.scale) = (alpha, other, scale);
                    upsamplings += 1;
                    last_arity = Some(arity);
                    averages = Some(0);
                }
                Role::Average => {
                    step.letter.arity = last_arity.unwrap_or(arity);
                    if let Some(place) = averages {
                        step.kernel = self.kernel_at(place, alpha, level)?;
                        step.first = place == 0;
                        averages = Some(place + 1);
                    }
                }
                Role::PushBack => step.compensation = self.compensation_at(other, level)?,
                Role::Smooth => {}
            }
            let at_alpha = step.letter.operator.at_alpha(&mut step.letter, step.alpha);
            at_alpha.map_err(|error| {
                Fault::new("/parameters/alpha", format!("{error} (level {level}); choose another alpha"))
            })?;
            steps.push(step);
        }
        Ok(steps)
    }

    /// From what an upsampling computes the values of single points.
    pub fn sources(&self, step: &Scheduled) -> Option<Sources<'_>> {
        let kernel = self.kernel.first()?;
        let noise = self.perturbation.map(|perturbation| Noise {
            amplitude: (0..step.upsamplings).fold(perturbation.amplitude, |c, _| c * perturbation.decay),
            seed: perturbation.seed,
            upsamplings: step.upsamplings,
        });
        Some(Sources {
            kernel,
            compensation: &self.compensation,
            delta: &self.delta,
            alpha: step.alpha,
            compensation_alpha: step.compensation_alpha,
            scale: step.scale,
            noise,
        })
    }

    fn kernel_at(&self, place: usize, alpha: f64, level: u32) -> Result<f64, Fault> {
        let Some(kernel) = self.kernel.get(place) else { return Ok(1.0) };
        let value = at(kernel, alpha, level, "kernel")?;
        if (1.0 + value).abs() < 1e-9 {
            let detail = format!("the kernel is -1 at level {level} (alpha = {alpha}), where no average exists");
            return Err(Fault::new("/parameters/kernel", detail));
        }
        Ok(value)
    }

    fn compensation_at(&self, alpha: f64, level: u32) -> Result<f64, Fault> {
        let value = at(&self.compensation, alpha, level, "compensation")?;
        if value.abs() > MAX_COMPENSATION {
            let detail = format!(
                "the compensation is {value} at level {level} (alpha = {alpha}), a pole of the function; at most \
                 {MAX_COMPENSATION} is allowed: choose another alpha"
            );
            return Err(Fault::new("/parameters/compensation", detail));
        }
        Ok(value)
    }

    /// Whether every operator can follow those before it, in the prefix and the first two applications of the cycle.
    fn check_legal(&self, subject: Subject) -> Result<(), StepError> {
        let (mut upsampled, mut duals, mut lost) = (false, 0, false);
        let natural = !subject.is_mesh && subject.is_open && self.ends == Ends::Natural;
        let mut arity = 2;
        for mut letter in self.word.letters(2) {
            let role = letter.operator.role();
            if role == Role::Average {
                letter.arity = arity;
            }
            if subject.is_mesh && (role == Role::Upsample && letter.arity != 2 || letter.operator.needs_upsampling()) {
                return Err(StepError::WrongNet("U3 and higher, and A, refine polygons; meshes take U, D, C and P"));
            }
            let dual = letter.operator.shifts(&letter);
            match role {
                Role::Upsample if letter.mask.is_some() || letter.operator.needs_alpha() => {
                    if let Some(tags) = subject.tags {
                        return Err(StepError::MaskTags(tags));
                    }
                    (upsampled, duals, lost, arity) = (true, 0, letter.mask.is_some(), letter.arity);
                }
                Role::Upsample => (upsampled, duals, lost, arity) = (true, 0, false, letter.arity),
                Role::Average => {
                    if letter.operator.needs_upsampling() && !upsampled {
                        return Err(StepError::NoArity);
                    }
                    if let Some(tags) = subject.tags.filter(|_| dual) {
                        return Err(StepError::DualTags(tags));
                    }
                    duals += u32::from(dual);
                    lost |= natural || dual && subject.is_mesh && subject.is_open;
                }
                Role::PushBack if !upsampled => return Err(StepError::NoAnchor),
                Role::PushBack if lost => {
                    return Err(StepError::LostPoints(match (natural, subject.is_mesh) {
                        (true, _) => "natural ends",
                        (false, true) => "the boundary",
                        (false, false) => "a scheme of its own mask",
                    }));
                }
                Role::PushBack if duals % 2 == 1 => return Err(StepError::OddDuals(duals)),
                Role::PushBack | Role::Smooth => {}
            }
        }
        Ok(())
    }

    fn check_delta(&self, subject: Subject) -> Result<(), Vec<Fault>> {
        if subject.is_mesh || self.delta.is_constant() {
            let value = self.delta.value(4.0);
            return value.map(drop).map_err(|error| vec![Fault::new("/parameters/delta", error.to_string())]);
        }
        Err(vec![Fault::new("/parameters/delta", "valence is a property of mesh vertices; give polygons a number")])
    }
}

fn at(function: &Expression, alpha: f64, level: u32, name: &str) -> Result<f64, Fault> {
    function.value(alpha).map_err(|error| {
        let value = if let ExpressionError::NotFinite { value, .. } = error { value } else { f64::NAN };
        let detail =
            format!("the {name} is {value} at level {level} (alpha = {alpha}); it must be finite at every level");
        Fault::new(format!("/parameters/{name}"), detail)
    })
}

fn preset(name: &str, parameters: &[(String, Literal)], subject: Subject) -> Result<Spelling, Vec<Fault>> {
    let Some(preset) = presets::named(name) else {
        let known = presets::PRESETS.iter().map(|p| p.name).collect::<Vec<_>>().join(", ");
        let detail = format!("there is no preset \"{}\"; known are {known}", shortened(name));
        return Err(vec![Fault::new("/preset", detail)]);
    };
    check_subject(preset, subject)?;
    let values = Values::resolve(preset.parameters, parameters).map_err(|faults| under("/parameters", faults))?;
    (preset.spell)(&values).map_err(|faults| under("/parameters", faults))
}

fn check_subject(preset: &Preset, subject: Subject) -> Result<(), Vec<Fault>> {
    let (kind, remedy) = match (preset.refines, subject.is_mesh) {
        (Refines::Curves, true) => ("polygons", "a mesh takes catmull-clark, bilinear, push-back or a word"),
        (Refines::Meshes, false) => ("meshes", "a polygon takes cubic-b-spline, four-point, push-back or a word"),
        _ => return Ok(()),
    };
    Err(vec![Fault::new("/preset", format!("{} refines {kind}; {remedy}", preset.name))])
}

fn word_functions(parameters: &[(String, Literal)], _: Subject) -> Result<Spelling, Vec<Fault>> {
    let values = Values::resolve(WORD_PARAMETERS, parameters).map_err(|faults| under("/parameters", faults))?;
    let one = Expression::constant(1.0);
    Ok(Spelling {
        cycle: Vec::new(),
        alpha: values.number("alpha").unwrap_or(0.0),
        compensation_alpha: values.number("compensation_alpha"),
        kernel: values.expressions("kernel").to_vec(),
        compensation: values.expression("compensation").cloned().unwrap_or_else(|| one.clone()),
        delta: values.expression("delta").cloned().unwrap_or(one),
        perturbation: presets::perturbation(&values),
    })
}

/// Both results, or the faults of both.
fn both<A, B>(a: Result<A, Vec<Fault>>, b: Result<B, Vec<Fault>>) -> Result<(A, B), Vec<Fault>> {
    match (a, b) {
        (Ok(a), Ok(b)) => Ok((a, b)),
        (a, b) => Err(a.err().into_iter().chain(b.err()).flatten().collect()),
    }
}

/// On polygons two D next to each other are a C; one spelling of them makes one key.
fn pair_duals(letters: &mut Vec<Letter>) {
    let average = super::ops::lettered('C').expect("C is an operator");
    let mut paired: Vec<Letter> = Vec::with_capacity(letters.len());
    let is_dual = |letter: &Letter| letter.operator.letter() == Some('D');
    for letter in letters.drain(..) {
        if is_dual(&letter) && paired.last().is_some_and(is_dual) {
            paired.pop();
            paired.push(Letter::plain(average));
        } else {
            paired.push(letter);
        }
    }
    *letters = paired;
}
