//! Semi-stationary push-back subdivision.

use crate::math::parameter::{Parameter, Values};
use crate::scheme::claim::Claim;
use crate::scheme::letter::Letter;
use crate::scheme::parameters::{
    ALPHA, COMPENSATION, COMPENSATION_ALPHA, DEFAULT_MU, DELTA, KERNEL, KERNEL_LONGITUDE, LATITUDE_RULE, MU,
    PERTURBATION, SPLIT, expression, latitude_rule, perturbation, tile,
};
use crate::scheme::preset::{Preset, Refines, Spelling, letters};

pub(super) const PUSH_BACK: Preset = Preset {
    name: "push-back",
    doc: "Semi-stationary push-back subdivision: the word U C^k P with kernel f(alpha), compensation omega(alpha) and \
          push-back factor delta, from approximating (0) to interpolating (1). Kernel cos(alpha/2) and compensation \
          1/cos(alpha/2) with alpha = 2 pi / K turn regular K-gons into circles for every delta.",
    source: "Zhang and Wang 2002, formulas (1)-(9), theorem 1",
    parameters: &[
        ALPHA,
        KERNEL,
        KERNEL_LONGITUDE,
        COMPENSATION,
        COMPENSATION_ALPHA,
        DELTA,
        LATITUDE_RULE,
        PERTURBATION,
        SPLIT,
        MU,
        Parameter::integer("k", [1, 8], 1.0, "Number of convolution averages a level."),
    ],
    refines: Refines::Both,
    claims: &[
        Claim::new("polygons, all else as it is left out: delta = 1", &[&[("delta", "1")]], ["1", "6", "3"]),
        Claim::new("polygons, 0 < delta < 1", &[&[("delta", "1/10")], &[("delta", "9/10")]], ["2", "6", "1"]),
        Claim::new("polygons, delta = 0", &[&[("delta", "0")]], ["2", "4", "1"]),
        Claim::new(
            "polygons, -2 < delta < 0, delta not -1/2",
            &[&[("delta", "-3/2")], &[("delta", "-1/10")]],
            ["3", "6", "1"],
        ),
        Claim::new("polygons, delta = -1/2", &[&[("delta", "-1/2")]], ["4", "6", "1"]),
        Claim::on_meshes("meshes, delta = 1", &[&[("delta", "1")]], ["1", "6", "3"], Some([3, 12])),
        Claim::on_meshes(
            "meshes, 0 < delta <= 1/4",
            &[&[("delta", "1/10")], &[("delta", "1/4")]],
            ["2", "6", "1"],
            Some([3, 12]),
        ),
        Claim::on_meshes("meshes, delta = 0", &[&[("delta", "0")]], ["2", "4", "1"], Some([3, 12])),
    ],
    spell: |values| {
        let k = values.integer("k").and_then(|k| usize::try_from(k).ok()).unwrap_or(1);
        Ok(with_functions(letters(&format!("U{}P", "C".repeat(k))), values))
    },
};

/// Spells a cycle with the functions of words over U, C and P that are given.
pub(in crate::scheme) fn with_functions(cycle: Vec<Letter>, values: &Values) -> Spelling {
    Spelling {
        alpha: values.number("alpha").unwrap_or(0.0),
        compensation_alpha: values.number("compensation_alpha"),
        kernel: values.expressions("kernel").to_vec(),
        tile: tile(values),
        mu: values.number("mu").unwrap_or(DEFAULT_MU),
        compensation: expression(values, "compensation"),
        delta: expression(values, "delta"),
        perturbation: perturbation(values),
        kernel_longitude: values.expression("kernel_longitude").cloned(),
        latitude_rule: latitude_rule(values),
        ..Spelling::of(cycle)
    }
}
