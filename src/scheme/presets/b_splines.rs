//! Uniform B-splines and C-B-splines: one upsampling and repeated averages.

use super::circles::angle;
use crate::math::expression::Expression;
use crate::math::parameter::{Default, Parameter};
use crate::scheme::claim::Claim;
use crate::scheme::letter::Letter;
use crate::scheme::parameters::ARITY;
use crate::scheme::preset::{Preset, Refines, Spelling, letters};

const LANE_RIESENFELD: &str = "Lane and Riesenfeld, IEEE PAMI 2 (1980), 35-46";

pub(super) const CHAIKIN: Preset = Preset {
    name: "chaikin",
    doc: "Corner cutting at 1/4 and 3/4 of each edge; the limit is the uniform quadratic B-spline, C1. The word UD, \
          mask (1, 3, 3, 1)/4.",
    source: "Chaikin, Computer Graphics and Image Processing 3 (1974), 346-349",
    parameters: &[],
    refines: Refines::Curves,
    claims: &[Claim::new("", &[&[]], ["1", "3", "1"])],
    spell: |_| Ok(Spelling::of(letters("UD"))),
};

pub(super) const CUBIC_B_SPLINE: Preset = Preset {
    name: "cubic-b-spline",
    doc: "The uniform cubic B-spline, C2: vertices (1, 6, 1)/8, edge points (1, 1)/2. The word UC.",
    source: LANE_RIESENFELD,
    parameters: &[],
    refines: Refines::Curves,
    claims: &[Claim::new("", &[&[]], ["2", "4", "1"])],
    spell: |_| Ok(Spelling::of(letters("UC"))),
};

pub(super) const B_SPLINE: Preset = Preset {
    name: "b-spline",
    doc: "The uniform B-spline of degree g, C^(g-1): U, then g - 1 dual averages; symbol (1 + z)^(g+1) / 2^g.",
    source: LANE_RIESENFELD,
    parameters: &[degree(1)],
    refines: Refines::Curves,
    claims: &[Claim::new(
        "",
        &[&[("degree", "1")], &[("degree", "2")], &[("degree", "5")], &[("degree", "12")]],
        ["degree - 1", "degree + 1", "1"],
    )],
    spell: |values| Ok(Spelling::of(averaged(values.integer("degree")))),
};

pub(super) const C_B_SPLINE: Preset = Preset {
    name: "c-b-spline",
    doc: "The uniform C-B-spline of degree g over span{1, t, ..., t^(g-2), cos t, sin t} with knot spacing alpha: the \
          word of the B-spline with kernel cos(alpha/2). With alpha = 2 pi / K a regular K-gon gives a circle.",
    source: "Zhang, CAGD 13 (1996), 217-227; Zhang and Wang 2002, section 1",
    parameters: &[degree(2), angle("Knot spacing; 2 pi / K for a regular K-gon.")],
    refines: Refines::Curves,
    claims: &[Claim::new(
        "",
        &[
            &[("degree", "2"), ("alpha", "1")],
            &[("degree", "3"), ("alpha", "0")],
            &[("degree", "5"), ("alpha", "pi/3")],
        ],
        ["degree - 1", "degree + 1", "1"],
    )],
    spell: |values| {
        let kernel = Expression::parse("cos(alpha/2)", "alpha").expect("a constant text that follows the grammar");
        let alpha = values.number("alpha").unwrap_or(0.0);
        Ok(Spelling { alpha, kernel: vec![kernel], ..Spelling::of(averaged(values.integer("degree"))) })
    },
};

pub(super) const D_ARY_B_SPLINE: Preset = Preset {
    name: "d-ary-b-spline",
    doc: "The uniform B-spline of degree g by refinement of arity d: U of arity d, then g - 1 averages of d points; \
          symbol (1 + z + ... + z^(d-1))^(g+1) / d^g. The word U3 A^3 for d = 3, g = 4.",
    source: "Zhang and Wang 2002, section 4.2; Maillot and Stam, Computer Graphics Forum 20 (2001)",
    parameters: &[Parameter { default: Default::Number(3.0), ..ARITY }, degree(1)],
    refines: Refines::Curves,
    claims: &[Claim::new(
        "",
        &[&[("degree", "1"), ("arity", "3")], &[("degree", "4"), ("arity", "3")], &[("degree", "3"), ("arity", "5")]],
        ["degree - 1", "degree + 1", "1"],
    )],
    spell: |values| {
        let averages = values.integer("degree").and_then(|g| usize::try_from(g - 1).ok()).unwrap_or(0);
        let mut cycle = letters(&format!("U{}", "A".repeat(averages)));
        cycle[0].settings.set(&ARITY, values.get("arity").clone());
        Ok(Spelling::of(cycle))
    },
};

const fn degree(min: i64) -> Parameter {
    Parameter::integer("degree", [min, 12], 3.0, "Polynomial degree of the limit.")
}

fn averaged(degree: Option<i64>) -> Vec<Letter> {
    let averages = degree.and_then(|g| usize::try_from(g - 1).ok()).unwrap_or(0);
    letters(&format!("U{}", "D".repeat(averages)))
}
