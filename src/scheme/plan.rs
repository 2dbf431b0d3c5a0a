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
use super::word::Word;
use crate::math::expression::Expression;
use crate::math::parameter::Literal;
use crate::shape::tile::Tile;

/// Most levels of any plan.
/// Sizes are refused long before for schemes that multiply points; a word without upsampling takes a level as one pass.
/// Half and twice of it halve and double what such a word may cost.
pub const MAX_LEVELS: u32 = 64;
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Subject {
    /// Polygons or a mesh.
    pub is_mesh: bool,
    /// Whether it has ends (an open polygon) or a boundary.
    pub is_open: bool,
    /// What a D could not carry along, if anything.
    pub tags: Option<&'static str>,
    /// What refers to single faces or vertices of the input, which a connectivity of its own could not carry along.
    pub attached: Option<&'static str>,
    /// Whether edges are sharp.
    pub creased: bool,
    /// What a mesh carries that only words over U, C and P look at, if anything.
    pub carried: Option<Carried>,
    /// What has a sharpness between smooth and infinitely sharp, if anything.
    pub semi_sharp: Option<&'static str>,
    /// Whose alpha its points have.
    pub alpha: AlphaOf,
    /// Number and size of the first face that is no triangle, if there is one.
    pub other_face: Option<(usize, usize)>,
}

/// Whose alpha points have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AlphaOf {
    /// That of the plan, or of latitude lines, some of them at least.
    #[default]
    Plan,
    /// All carry their own.
    Points,
}

/// What a mesh carries that only words over U, C and P look at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carried {
    /// Parameters of vertices.
    Parameters,
    /// Tags of longitude lines alone.
    Longitude,
    /// Tags of latitude lines, perhaps of longitude lines, too.
    Latitude,
}

impl Carried {
    /// Its name, for messages.
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
    /// Parameter spacing that enters the first U, radians.
    pub alpha: f64,
    /// Parameter spacing of the compensation, where it differs: then latitude lines have it, too. Points that carry an
    /// alpha of their own have that.
    pub compensation_alpha: Option<f64>,
    /// Kernels of the first, second, ... average after a U, in alpha.
    pub kernel: Vec<Expression>,
    /// Weight of a vertex in averages of triangles.
    pub mu: f64,
    /// Compensation function, in alpha.
    pub compensation: Expression,
    /// Push-back factor, in valence.
    pub delta: Expression,
    /// Boundary rule of meshes.
    pub boundary: Boundary,
    /// Rules of the scheme for meshes.
    pub rules: Rules,
    /// End rule of open polygons.
    pub ends: Ends,
    /// Decaying perturbation, if any.
    pub perturbation: Option<Perturbation>,
    /// What latitude and longitude tags do; `None` where they are not looked at.
    pub latitude: Option<Latitude>,
}

/// What latitude and longitude tags do.
#[derive(Debug, Clone, PartialEq)]
pub struct Latitude {
    /// What odd points of latitude lines follow.
    pub rule: LatitudeRule,
    /// Kernel along longitude lines, where it differs.
    pub kernel_longitude: Option<Expression>,
    /// Whether each closed line of n vertices has the alpha `2 pi / n`, as the plan does not give one.
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

/// One operator with the numbers of its place in the plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Scheduled {
    /// The operator.
    pub letter: Letter,
    /// The level it belongs to: 0 for the prefix, then 1, 2, ...
    pub level: u32,
    /// Parameter spacing that entered the last upsampling, radians.
    pub alpha: f64,
    /// Parameter spacing of the compensation at this step, radians.
    pub compensation_alpha: f64,
    /// By what the upsamplings before divided alpha: the factor of the alphas that points carry.
    pub scale: f64,
    /// Number of upsamplings before.
    pub upsamplings: u32,
    /// Whether it is an upsampling that a push-back follows before the next one.
    pub pushed_back: bool,
    /// Whether it is the first average since an upsampling.
    pub first: bool,
    /// Value of the kernel.
    pub kernel: f64,
    /// Value of the compensation.
    pub compensation: f64,
}

impl Perturbation {
    /// The perturbation at the upsampling after this many.
    pub fn at(&self, upsamplings: u32) -> Noise {
        let amplitude = (0..upsamplings).fold(self.amplitude, |c, _| c * self.decay);
        Noise { amplitude, seed: self.seed, upsamplings }
    }
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

    /// The name of the operator that turns tangents along with points of the plane, if there is one; such a plan is not
    /// linear.
    pub fn turns_tangents(&self) -> Option<&'static str> {
        let mut all = self.word.prefix.iter().chain(&self.word.cycle).map(Letter::facts);
        all.find(|facts| facts.turns_tangents).map(|facts| facts.name)
    }

    /// Whether it makes meshes smooth, applied often enough: with linear interpolation alone it does not.
    pub fn smooths(&self) -> bool {
        self.word.prefix.iter().chain(&self.word.cycle).any(|letter| letter.facts().smooths)
    }

    /// Whether it splits faces into quads and smooths so that regular pieces of its limit surface are bicubic, on each
    /// level alike.
    pub fn is_bicubic(&self) -> bool {
        let Word { prefix, cycle } = &self.word;
        let halves = |letter: &Letter| {
            let settings = &letter.settings;
            letter.facts().role == Role::Upsample && settings.arity() == 2 && settings.tile() == Tile::Quad
        };
        prefix.is_empty() && matches!(&cycle[..], [first, second] if halves(first) && second.facts().bicubic)
    }

    /// The scheme of OpenSubdiv that it is on each level alike, if it is one.
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
        // two upsamplings in a row are no scheme of its own
        let is_one = (standard == Standard::Bilinear) == (cycle.len() == 1);
        (halves && is_one).then_some(standard)
    }

    /// Into what the faces of a mesh are split.
    pub fn tile(&self) -> Tile {
        let triangles = self.word.letters(1).any(|letter| letter.settings.tile() == Tile::Triangle);
        if triangles { Tile::Triangle } else { Tile::Quad }
    }

    /// From what an upsampling computes the values of single points.
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
