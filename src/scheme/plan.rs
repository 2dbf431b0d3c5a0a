//! Plans: a preset or a word with its parameters, resolved for one kind of input.

mod legal;
mod resolve;
mod schedule;

use super::extent::Ends;
use super::letter::Letter;
use super::local::{Noise, Sources};
use super::operator::{Role, Standard};
use super::parameters::DEFAULT_MU;
use super::rules::{LatitudeRule, Rules};
use super::tags::Boundary;
use super::word::{Word, lettered};
use crate::math::expression::Expression;
use crate::math::parameter::Literal;
use crate::shape::tile::Tile;

/// Maximum number of levels of a plan. Schemes that multiply points reach the size limits long before; for a word
/// without upsampling, a level is one pass, and twice as many levels cost twice as much.
pub const MAX_PLAN_LEVELS: u32 = 64;
/// A plan as a client writes it, unresolved.
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

impl PlanInput {
    /// Returns the plan by which latitude lines are judged where no plan is given.
    pub fn usual_for_latitude_lines() -> Self {
        Self { preset: Some("push-back".to_owned()), ..Self::default() }
    }
}

/// The properties of the input to which a plan is applied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Subject {
    /// Whether it is a mesh rather than polygons.
    pub is_mesh: bool,
    /// Whether it has ends (an open polygon) or a boundary.
    pub is_open: bool,
    /// The tags that D could not carry, if any.
    pub tags: Option<&'static str>,
    /// Data on single faces or vertices of the input that a scheme with its own connectivity could not carry, if any.
    pub attached: Option<&'static str>,
    /// Whether edges are sharp.
    pub creased: bool,
    /// The data on a mesh that only words over U, C and P use, if any.
    pub carried: Option<Carried>,
    /// Items of a sharpness between smooth and infinitely sharp, if any.
    pub semi_sharp: Option<&'static str>,
    /// Where the alpha of points comes from.
    pub alpha: AlphaOf,
    /// Index and size of the first face that is not a triangle, if there is one.
    pub other_face: Option<(usize, usize)>,
}

/// Where the alpha of points comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AlphaOf {
    /// At least some points have the alpha of the plan or of latitude lines.
    #[default]
    Plan,
    /// All points have their own alpha.
    Points,
}

/// Data on a mesh that only words over U, C and P use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carried {
    /// Parameters of vertices.
    Parameters,
    /// Tags of longitude lines only.
    Longitude,
    /// Tags of latitude lines, possibly with longitude lines.
    Latitude,
}

impl Carried {
    /// Returns the name of the data, for messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Parameters => "parameters of vertices",
            Self::Longitude | Self::Latitude => "latitude and longitude tags",
        }
    }
}

/// A resolved plan; equal plans are equal values, whether written as preset or word.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The operators.
    pub word: Word,
    /// The alpha that enters the first U, in radians.
    pub alpha: f64,
    /// The alpha of the compensation in radians, if it differs; it also holds on latitude lines. Points with an alpha
    /// of their own ignore it.
    pub compensation_alpha: Option<f64>,
    /// Kernels of the first, second, ... average after a U, as functions of alpha.
    pub kernel: Vec<Expression>,
    /// Weight of a vertex in averages of triangles.
    pub mu: f64,
    /// Compensation, as a function of alpha.
    pub compensation: Expression,
    /// Push-back factor, as a function of the valence.
    pub delta: Expression,
    /// Boundary rule of meshes.
    pub boundary: Boundary,
    /// Rules of the scheme for meshes.
    pub rules: Rules,
    /// End rule of open polygons.
    pub ends: Ends,
    /// Decaying perturbation, if any.
    pub perturbation: Option<Perturbation>,
    /// The effect of latitude and longitude tags; `None` if they are not used.
    pub latitude: Option<Latitude>,
}

/// The effect of latitude and longitude tags.
#[derive(Debug, Clone, PartialEq)]
pub struct Latitude {
    /// The rule for odd points of latitude lines.
    pub rule: LatitudeRule,
    /// Kernel along longitude lines, if it differs.
    pub kernel_longitude: Option<Expression>,
    /// Whether each closed line of n vertices has the alpha `2 pi / n`, because the plan does not give one.
    pub own_alpha: bool,
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

/// One operator with the values of its place in the plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Scheduled {
    /// The operator.
    pub letter: Letter,
    /// The level it belongs to: 0 for the prefix, then 1, 2, ...
    pub level: u32,
    /// The alpha that entered the last upsampling, in radians.
    pub alpha: f64,
    /// The alpha of the compensation at this step, in radians.
    pub compensation_alpha: f64,
    /// The factor by which preceding upsamplings reduced alpha, applied to the alpha of single points.
    pub scale: f64,
    /// Number of preceding upsamplings.
    pub upsamplings: u32,
    /// Whether this is an upsampling that is followed by a push-back before the next upsampling.
    pub pushed_back: bool,
    /// Whether this is the first average since an upsampling.
    pub first: bool,
    /// Value of the kernel.
    pub kernel: f64,
    /// Value of the compensation.
    pub compensation: f64,
}

impl Scheduled {
    /// Returns the linear upsampling in place of this step if it is an upsampling, and `None` for all other steps.
    pub fn linear(&self) -> Option<Self> {
        let operator = lettered('U').expect("U is an operator");
        let is_upsampling = self.letter.facts().role == Role::Upsample;
        is_upsampling.then(|| Self { letter: Letter { operator, ..self.letter.clone() }, ..self.clone() })
    }
}

impl Perturbation {
    /// Returns the perturbation at the upsampling after `upsamplings` others.
    pub fn at(&self, upsamplings: u32) -> Noise {
        let amplitude = (0..upsamplings).fold(self.amplitude, |c, _| c * self.decay);
        Noise { amplitude, seed: self.seed, upsamplings }
    }
}

impl Plan {
    /// Returns the plan that does nothing, for conversions.
    pub fn none(boundary: Boundary, ends: Ends) -> Self {
        let one = Expression::constant(1.0);
        Self {
            word: Word::default(),
            alpha: 0.0,
            compensation_alpha: None,
            kernel: vec![one.clone()],
            mu: DEFAULT_MU,
            compensation: one.clone(),
            delta: one,
            boundary,
            rules: Rules::default(),
            ends,
            perturbation: None,
            latitude: None,
        }
    }

    /// Returns the name of the operator that turns tangents along with points of the plane, if there is one; such a
    /// plan is not linear.
    pub fn turns_tangents(&self) -> Option<&'static str> {
        let mut all = self.word.prefix.iter().chain(&self.word.cycle).map(Letter::facts);
        all.find(|facts| facts.turns_tangents).map(|facts| facts.name)
    }

    /// Returns whether the plan smooths meshes; linear interpolation alone does not.
    pub fn smooths(&self) -> bool {
        self.word.prefix.iter().chain(&self.word.cycle).any(|letter| letter.facts().smooths)
    }

    /// Returns whether the plan splits faces into quads and smooths them so that regular pieces of its limit surface
    /// are bicubic, in the same way on each level.
    pub fn is_bicubic(&self) -> bool {
        let Word { prefix, cycle } = &self.word;
        let halves = |letter: &Letter| letter.facts().role == Role::Upsample && letter.settings.halves();
        prefix.is_empty() && matches!(&cycle[..], [first, second] if halves(first) && second.facts().bicubic)
    }

    /// Returns the scheme of OpenSubdiv that the plan equals on each level, if it is one.
    pub fn standard(&self) -> Option<Standard> {
        let Word { prefix, cycle } = &self.word;
        let is_plain = prefix.is_empty() && self.perturbation.is_none() && self.latitude.is_none();
        let (first, smooth) = match &cycle[..] {
            [first] => (first, first),
            [first, second] => (first, second),
            _ => return None,
        };
        let standard = smooth.facts().standard.filter(|_| is_plain)?;
        let tile = if standard == Standard::Loop { Tile::Triangle } else { Tile::Quad };
        let settings = &first.settings;
        let halves = first.facts().role == Role::Upsample && settings.arity() == 2 && settings.tile() == tile;
        // two upsamplings in a row are not a scheme of OpenSubdiv
        let is_one = (standard == Standard::Bilinear) == (cycle.len() == 1);
        (halves && is_one).then_some(standard)
    }

    /// Returns the tile into which the faces of a mesh are split.
    pub fn tile(&self) -> Tile {
        let triangles = self.word.letters(1).any(|letter| letter.settings.tile() == Tile::Triangle);
        if triangles { Tile::Triangle } else { Tile::Quad }
    }

    /// Returns the functions from which an upsampling computes the values of single points.
    pub fn sources(&self, step: &Scheduled) -> Option<Sources<'_>> {
        let kernel = self.kernel.first()?;
        let noise = self.perturbation.map(|perturbation| perturbation.at(step.upsamplings));
        Some(Sources {
            kernel,
            kernel_longitude: self.latitude.as_ref().and_then(|latitude| latitude.kernel_longitude.as_ref()),
            compensation: &self.compensation,
            delta: &self.delta,
            alpha: step.alpha,
            compensation_alpha: step.compensation_alpha,
            compensates_apart: self.compensation_alpha.is_some(),
            scale: step.scale,
            pushes_back: step.pushed_back,
            noise,
        })
    }
}
