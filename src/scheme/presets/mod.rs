//! Presets: named schemes, spelled as words over operators; the registry is the only place that lists them.

mod b_splines;
mod circles;
mod incenter;
mod interpolating;
mod masks;
mod meshes;
mod push_back;
mod quads;
mod ternary;
mod triangles;

use std::sync::Arc;

use crate::fault::Fault;
use crate::math::expression::Expression;
use crate::math::mask::Mask;
use crate::math::parameter::{Default, Kind, Parameter, Values};
use crate::scheme::ops::{self, LatitudeRule, Masked};
use crate::scheme::plan::DEFAULT_MU;
use crate::scheme::rules::Rules;
use crate::scheme::word::Letter;
use crate::shape::tile::Tile;

/// Every preset, in the order of the documentation.
pub const PRESETS: &[&Preset] = &[
    &b_splines::CHAIKIN,
    &b_splines::CUBIC_B_SPLINE,
    &b_splines::B_SPLINE,
    &b_splines::C_B_SPLINE,
    &interpolating::FOUR_POINT,
    &masks::TWO_N_POINT,
    &b_splines::D_ARY_B_SPLINE,
    &circles::D_ARY_CIRCLE,
    &ternary::BLENDING,
    &ternary::C4,
    &ternary::LINEAR,
    &ternary::QUADRATIC,
    &ternary::CUBIC,
    &ternary::QUARTIC,
    &ternary::QUINTIC,
    &ternary::THREE_POINT,
    &ternary::FOUR_POINT,
    &ternary::PAN,
    &ternary::REHAN,
    &ternary::NOVARA,
    &incenter::INCENTER,
    &masks::MASK,
    &push_back::PUSH_BACK,
    &meshes::CATMULL_CLARK,
    &meshes::LOOP,
    &meshes::BILINEAR,
    &quads::DOO_SABIN,
    &quads::REPEATED_AVERAGING,
    &quads::KOBBELT,
    &triangles::BUTTERFLY,
    &triangles::SQRT_3,
];

/// The preset of a name.
pub fn named(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().copied().find(|preset| preset.name == name)
}

/// A named scheme.
#[derive(Debug)]
pub struct Preset {
    /// Name in requests.
    pub name: &'static str,
    /// What it is, with the formula.
    pub doc: &'static str,
    /// Author, year, page.
    pub source: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// Which inputs it refines.
    pub refines: Refines,
    /// How it is spelled.
    pub spell: fn(&Values) -> Result<Spelling, Vec<Fault>>,
}

/// Which inputs a preset refines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refines {
    /// Polygons only.
    Curves,
    /// Meshes only.
    Meshes,
    /// Both.
    Both,
}

/// A scheme spelled out: the cycle and the functions that its operators use.
#[derive(Debug, Clone, PartialEq)]
pub struct Spelling {
    /// The word applied once a level.
    pub cycle: Vec<Letter>,
    /// Parameter spacing that enters the first U.
    pub alpha: f64,
    /// The same for the compensation, where it differs.
    pub compensation_alpha: Option<f64>,
    /// Kernels of the first, second, ... average after a U, in alpha.
    pub kernel: Vec<Expression>,
    /// Into what the faces of a mesh are split.
    pub tile: Tile,
    /// Weight of a vertex in averages of triangles.
    pub mu: f64,
    /// Compensation function, in alpha.
    pub compensation: Expression,
    /// Push-back factor, in valence.
    pub delta: Expression,
    /// Amplitude and decay of the perturbation, if any.
    pub perturbation: Option<[f64; 2]>,
    /// Kernel along longitude lines, where it differs.
    pub kernel_longitude: Option<Expression>,
    /// What latitude tags do.
    pub latitude_rule: LatitudeRule,
    /// Rules of the scheme for meshes.
    pub rules: Rules,
}

impl Spelling {
    /// The cycle with alpha 0, kernel 1, compensation 1, delta 1.
    fn of(cycle: Vec<Letter>) -> Self {
        let one = Expression::constant(1.0);
        Self {
            cycle,
            alpha: 0.0,
            compensation_alpha: None,
            kernel: vec![one.clone()],
            tile: Tile::Quad,
            mu: DEFAULT_MU,
            compensation: one.clone(),
            delta: one,
            perturbation: None,
            kernel_longitude: None,
            latitude_rule: LatitudeRule::default(),
            rules: Rules::default(),
        }
    }
}

/// Letters of operators that have one.
fn letters(word: &str) -> Vec<Letter> {
    let operator = |letter| ops::lettered(letter).expect("presets are spelled in letters of the registry");
    word.chars().map(|letter| Letter::plain(operator(letter))).collect()
}

/// A scheme that is one mask; without entries there is none.
fn masked(arity: u32, mask: Option<Mask>) -> Result<Spelling, Vec<Fault>> {
    let none = || vec![Fault::new("/mask", "every entry of the mask is 0; give the weights of the scheme")];
    let mask = Some(Arc::new(mask.ok_or_else(none)?));
    Ok(Spelling::of(vec![Letter { arity, mask, ..Letter::plain(&Masked) }]))
}

/// The parameters shared by words and push-back.
pub const ALPHA: Parameter = Parameter {
    name: "alpha",
    kind: Kind::Number { min: -1e6, max: 1e6 },
    unit: "radians",
    default: Default::Number(0.0),
    doc: "Parameter spacing that enters the first U; each later U divides it by the arity of the U before it.",
};

/// The kernel f(alpha).
pub const KERNEL: Parameter = Parameter {
    name: "kernel",
    kind: Kind::Expressions { variable: "alpha", most: 8 },
    unit: "",
    default: Default::Number(1.0),
    doc: "Weight of vertices in the first average after a U; a list gives the second, third, ... average theirs.",
};

/// The compensation function omega(alpha).
pub const COMPENSATION: Parameter = Parameter {
    name: "compensation",
    kind: Kind::Expression { variable: "alpha" },
    unit: "",
    default: Default::Number(1.0),
    doc: "How strongly P moves edge points (omega) and face points (omega squared) along with the vertices.",
};

/// The push-back factor delta.
pub const DELTA: Parameter = Parameter {
    name: "delta",
    kind: Kind::Expression { variable: "valence" },
    unit: "",
    default: Default::Number(1.0),
    doc: "Push-back factor: 0 approximates, 1 interpolates; on meshes it may depend on the valence (on boundaries 4, with split triangle 6).",
};

/// The alpha of the compensation, where it differs.
pub const COMPENSATION_ALPHA: Parameter = Parameter {
    name: "compensation_alpha",
    kind: Kind::Number { min: -1e6, max: 1e6 },
    unit: "radians",
    default: Default::Absent,
    doc: "The alpha that the compensation sees at the first U, divided like alpha; when left out alpha itself, which on closed latitude lines is 2 pi / n. An alpha that points carry beats both.",
};

/// Into what the faces of a mesh are split.
pub const SPLIT: Parameter = Parameter {
    name: "split",
    kind: Kind::Choice(&["quad", "triangle"]),
    unit: "",
    default: Default::Text("quad"),
    doc: "Into what U splits the faces of a mesh: quads, or triangles if all faces are triangles. Without effect on polygons.",
};

/// The weight of a vertex in averages of triangles.
pub const MU: Parameter = Parameter {
    name: "mu",
    kind: Kind::Number { min: 0.0, max: 1.0 },
    unit: "",
    default: Default::Number(DEFAULT_MU),
    doc: "Weight of a vertex itself in averages with split triangle; 1/4 makes UC Loop's scheme at regular vertices, 1/3 \
          averages the centroids. Without effect with split quad.",
};

/// The random perturbation.
pub const PERTURBATION: Parameter = Parameter {
    name: "perturbation",
    kind: Kind::Group(&[
        Parameter {
            name: "amplitude",
            kind: Kind::Number { min: 0.0, max: 1e3 },
            unit: "",
            default: Default::Required,
            doc: "Amplitude c at the first U.",
        },
        Parameter {
            name: "decay",
            kind: Kind::Number { min: 0.0, max: 0.999 },
            unit: "",
            default: Default::Number(0.5),
            doc: "Decay gamma: each U multiplies the amplitude by it; below 1/2 the limit stays C1.",
        },
    ]),
    unit: "",
    default: Default::Absent,
    doc: "Random perturbation of kernel and compensation by c gamma^h xi at the h-th U, from the plan's seed; on meshes in \
          words over U, C and P with split quad.",
};

/// Into what the faces of a mesh are split.
pub(super) fn tile(values: &Values) -> Tile {
    if values.choice("split") == Some("triangle") { Tile::Triangle } else { Tile::Quad }
}

/// Amplitude and decay, if a perturbation is given.
pub(super) fn perturbation(values: &Values) -> Option<[f64; 2]> {
    let group = values.group("perturbation")?;
    Some([group.number("amplitude")?, group.number("decay")?])
}

/// Parameters of a plan given as a word.
pub const WORD_PARAMETERS: &[Parameter] =
    &[ALPHA, KERNEL, KERNEL_LONGITUDE, COMPENSATION, COMPENSATION_ALPHA, DELTA, LATITUDE_RULE, PERTURBATION, SPLIT, MU];

/// The kernel along longitude lines.
pub const KERNEL_LONGITUDE: Parameter = Parameter {
    name: "kernel_longitude",
    kind: Kind::Expression { variable: "alpha" },
    unit: "",
    default: Default::Absent,
    doc: "Weight of vertices in the first average after a U along longitude edges; the kernel when left out. Meshes with \
          latitude tags only.",
};

/// What latitude tags do.
pub const LATITUDE_RULE: Parameter = Parameter {
    name: "latitude_rule",
    kind: Kind::Choice(&["difference", "position", "isotropic"]),
    unit: "",
    default: Default::Text("difference"),
    doc: "What P does along latitude lines: odd points follow the displacements of even ones, or their places, or the \
          tags are not looked at. With tags, kernel and compensation default to cos(alpha/2) and 1/cos(alpha/2), and \
          alpha to 2 pi / n on closed lines of n vertices.",
};

/// What latitude tags do, as an operator needs it.
pub(super) fn latitude_rule(values: &Values) -> LatitudeRule {
    match values.choice("latitude_rule") {
        Some("position") => LatitudeRule::Position,
        Some("isotropic") => LatitudeRule::Isotropic,
        _ => LatitudeRule::Difference,
    }
}

fn expression(values: &Values, name: &str) -> Expression {
    values.expression(name).cloned().unwrap_or_else(|| Expression::constant(1.0))
}
