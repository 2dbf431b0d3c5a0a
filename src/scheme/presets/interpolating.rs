//! Interpolating curve schemes.

use super::ternary::real;
use crate::math::number::Number;
use crate::math::parameter::Default;
use crate::math::weight::Weight;
use crate::scheme::claim::Claim;
use crate::scheme::preset::{Preset, Refines, Spelling, constant, letters, weight};

pub(super) const FOUR_POINT: Preset = Preset {
    name: "four-point",
    doc: "The interpolating four-point scheme: odd points (1/2 + w)(p0 + p1) - w (p-1 + p2). C1 for 0 < w < 0.1927, \
          cubic precision at w = 1/16. The word UCP with delta 1 and compensation 16 w.",
    source: "Dyn, Levin and Gregory, CAGD 4 (1987), 257-268; range: Hechler, Moessner and Reif, 2009",
    parameters: &[real("w", Default::Number(1.0 / 16.0), "Tension; half the alpha of the lecture.")],
    refines: Refines::Curves,
    claims: &[
        Claim::new("w = 1/16", &[&[("w", "1/16")]], ["1", "6", "3"]),
        Claim::new(
            "0 < w < 0.1927, w not 1/16",
            &[&[("w", "1/1000")], &[("w", "1/20")], &[("w", "1/8")], &[("w", "0.1925")]],
            ["1", "6", "1"],
        ),
        Claim::new("w = 0", &[&[("w", "0")]], ["0", "2", "1"]),
    ],
    spell: |values| {
        let compensation = constant(&(Weight::whole(16) * weight(values, "w")));
        Ok(Spelling { compensation, ..Spelling::of(letters("UCP")) })
    },
};
