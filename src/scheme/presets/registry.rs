//! The list of all presets.

use super::super::preset::Preset;
use super::{b_splines, circles, incenter, interpolating, masks, meshes, push_back, quads, ternary, triangles};

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
    &ternary::TERNARY_FOUR_POINT,
    &ternary::PAN,
    &ternary::REHAN,
    &ternary::NOVARA,
    &incenter::INCENTER,
    &masks::ANY_MASK,
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
