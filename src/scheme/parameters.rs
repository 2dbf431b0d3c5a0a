//! The parameters of words, which presets share, and the meaning of their values.

use std::ops::RangeInclusive;

use super::rules::LatitudeRule;
use crate::math::expression::Expression;
use crate::math::parameter::{Default, Parameter, ParameterKind, Values};
use crate::shape::tile::Tile;

/// The weight of a vertex in averages of triangles for which `UC` is Loop's scheme at regular vertices. With any other
/// value the scheme is not a box spline.
pub const DEFAULT_MU: f64 = 0.25;
/// The arities that are offered.
pub const ARITIES: RangeInclusive<i64> = 2..=8;

/// The arity of an upsampling, and of operators that average as many points.
pub const ARITY: Parameter =
    Parameter::integer("arity", [*ARITIES.start(), *ARITIES.end()], 2.0, "New points for each old one.");

/// The number of averages within an operator.
pub const AVERAGES: Parameter = Parameter::integer("averages", [0, 12], 1.0, "Number m of averages of d points.");

/// The entries of a mask.
pub const MASK: Parameter =
    Parameter::new("mask", ParameterKind::Numbers { most: 129 }, Default::Required, "Entries of the mask.");

/// The index of the first entry of a mask.
pub const FIRST: Parameter = Parameter::new(
    "first",
    ParameterKind::Integer { min: -128, max: 128 },
    Default::Required,
    "Index of the first entry.",
);

/// The alpha of the first U, in radians.
pub const ALPHA: Parameter = Parameter {
    name: "alpha",
    kind: ParameterKind::Number { min: -1e6, max: 1e6 },
    unit: "radians",
    default: Default::Number(0.0),
    doc: "Parameter spacing that enters the first U; each later U divides it by the arity of the U before it.",
};

/// The kernel f(alpha).
pub const KERNEL: Parameter = Parameter::new(
    "kernel",
    ParameterKind::Expressions { variable: "alpha", most: 8 },
    Default::Number(1.0),
    "Weight of vertices in the first average after a U; a list gives the second, third, ... average theirs.",
);

/// The compensation function omega(alpha).
pub const COMPENSATION: Parameter = Parameter::new(
    "compensation",
    ParameterKind::Expression { variable: "alpha" },
    Default::Number(1.0),
    "How strongly P moves edge points (omega) and face points (omega squared) along with the vertices.",
);

/// The push-back factor delta.
pub const DELTA: Parameter = Parameter::new(
    "delta",
    ParameterKind::Expression { variable: "valence" },
    Default::Number(1.0),
    "Push-back factor: 0 approximates, 1 interpolates; on meshes it may depend on the valence (on boundaries 4, \
     with split triangle 6).",
);

/// The alpha of the compensation, if it differs.
pub const COMPENSATION_ALPHA: Parameter = Parameter {
    name: "compensation_alpha",
    kind: ParameterKind::Number { min: -1e6, max: 1e6 },
    unit: "radians",
    default: Default::Absent,
    doc: "The alpha that the compensation sees at the first U, divided like alpha; when left out alpha itself, which \
          on closed latitude lines is 2 pi / n. An alpha that points carry beats both.",
};

/// The tile into which the faces of a mesh are split.
pub const SPLIT: Parameter = Parameter::choice(
    "split",
    &["quad", "triangle"],
    "Into what U splits the faces of a mesh: quads, or triangles if all faces are triangles. Without effect on \
     polygons.",
);

/// The weight of a vertex in averages of triangles.
pub const MU: Parameter = Parameter::number(
    "mu",
    [0.0, 1.0],
    Default::Number(DEFAULT_MU),
    "Weight of a vertex itself in averages with split triangle; 1/4 makes UC Loop's scheme at regular vertices, \
     1/3 averages the centroids. Without effect with split quad.",
);

/// The random perturbation.
pub const PERTURBATION: Parameter = Parameter::optional(
    "perturbation",
    ParameterKind::Group(&[
        Parameter::number("amplitude", [0.0, 1e3], Default::Required, "Amplitude c at the first U."),
        Parameter::number(
            "decay",
            [0.0, 0.999],
            Default::Number(0.5),
            "Decay gamma: each U multiplies the amplitude by it; below 1/2 the limit stays C1.",
        ),
    ]),
    "Random perturbation of kernel and compensation by c gamma^h xi at the h-th U, from the plan's seed; on \
     meshes in words over U, C and P with split quad.",
);

/// Returns the tile into which the faces of a mesh are split.
pub(super) fn tile(values: &Values) -> Tile {
    if values.choice("split") == Some("triangle") { Tile::Triangle } else { Tile::Quad }
}

/// Returns amplitude and decay of the perturbation, if one is given.
pub(super) fn perturbation(values: &Values) -> Option<[f64; 2]> {
    let group = values.group("perturbation")?;
    Some([group.number("amplitude")?, group.number("decay")?])
}

/// The parameters of a plan that is given as a word.
pub const WORD_PARAMETERS: &[Parameter] =
    &[ALPHA, KERNEL, KERNEL_LONGITUDE, COMPENSATION, COMPENSATION_ALPHA, DELTA, LATITUDE_RULE, PERTURBATION, SPLIT, MU];

/// The kernel along longitude lines.
pub const KERNEL_LONGITUDE: Parameter = Parameter::optional(
    "kernel_longitude",
    ParameterKind::Expression { variable: "alpha" },
    "Weight of vertices in the first average after a U along longitude edges; the kernel when left out. Meshes \
     with latitude tags only.",
);

/// The effect of latitude tags.
pub const LATITUDE_RULE: Parameter = Parameter::choice(
    "latitude_rule",
    &["difference", "position", "isotropic"],
    "What P does along latitude lines: odd points follow the displacements of even ones, or their places, or the \
     tags are not looked at. With tags, kernel and compensation default to cos(alpha/2) and 1/cos(alpha/2), and \
     alpha to 2 pi / n on closed lines of n vertices.",
);

/// Returns the rule for latitude tags.
pub(super) fn latitude_rule(values: &Values) -> LatitudeRule {
    match values.choice("latitude_rule") {
        Some("position") => LatitudeRule::Position,
        Some("isotropic") => LatitudeRule::Isotropic,
        _ => LatitudeRule::Difference,
    }
}

/// Returns the expression of a parameter, or the constant 1 if it is not given.
pub(super) fn expression(values: &Values, name: &str) -> Expression {
    values.expression(name).cloned().unwrap_or_else(|| Expression::constant(1.0))
}
