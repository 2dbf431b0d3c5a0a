//! Classical schemes on quads besides Catmull-Clark.

use crate::math::parameter::Parameter;
use crate::scheme::claim::Claim;
use crate::scheme::letter::Letter;
use crate::scheme::ops::{DooSabin, KobbeltEdges, KobbeltFaces};
use crate::scheme::preset::{Preset, Refines, Spelling, letters};

pub(super) const DOO_SABIN: Preset = Preset {
    name: "doo-sabin",
    doc: "Doo-Sabin with the original weights (n + 5)/(4n) and (3 + 2 cos(2 pi i/n))/(4n) for faces of any size: \
          biquadratic B-splines in regular regions, C1 everywhere. Boundaries are the quadratic B-splines of their \
          polygons, corners by the plan's `boundary`.",
    source: "Doo and Sabin, CAD 10 (1978), 356-360",
    parameters: &[],
    refines: Refines::Meshes,
    claims: &[Claim::on_meshes("", &[&[]], ["1", "3", "1"], Some([3, 50]))],
    spell: |_| Ok(Spelling::of(vec![Letter::plain(&DooSabin)])),
};

pub(super) const REPEATED_AVERAGING: Preset = Preset {
    name: "repeated-averaging",
    doc: "Repeated averaging: tensor B-splines of the degree in regular regions. Odd degrees are primal, the word \
          U C^((degree-1)/2); even ones dual, U C^((degree-2)/2) D, which draw an open mesh in by half a face a level. \
          Degree 3 is Catmull-Clark with another rule at extraordinary vertices, degree 2 Doo-Sabin.",
    source: "Zorin and Schroeder, CAGD 18 (2001), 429-454; Stam, CAGD 18 (2001), 383-396",
    parameters: &[Parameter::integer(
        "degree",
        [2, 9],
        3.0,
        "Polynomial degree in regular regions: odd for primal schemes, even for dual ones.",
    )],
    refines: Refines::Meshes,
    claims: &[Claim::on_meshes(
        "degree up to 7",
        &[&[("degree", "2")], &[("degree", "3")], &[("degree", "4")], &[("degree", "7")]],
        ["degree - 1", "degree + 1", "1"],
        Some([3, 12]),
    )],
    spell: |values| {
        let averages = values.integer("degree").and_then(|degree| usize::try_from(degree - 1).ok()).unwrap_or(2);
        Ok(Spelling::of(letters(&format!("U{}{}", "C".repeat(averages / 2), "D".repeat(averages % 2)))))
    },
};

pub(super) const KOBBELT: Preset = Preset {
    name: "kobbelt",
    doc: "Kobbelt's interpolating scheme: the tensor product of the four-point scheme in regular regions, with a \
          virtual point beyond extraordinary vertices. Boundaries are four-point curves of their polygons; the surface \
          inside is reflected at them. A first step turns faces of any size into quads.",
    source: "Kobbelt, Computer Graphics Forum 15 (1996), 409-420",
    parameters: &[],
    refines: Refines::Meshes,
    claims: &[Claim::on_meshes("", &[&[]], ["1", "6", "3"], Some([3, 12]))],
    spell: |_| {
        let weighted = vec![Letter::plain(&KobbeltEdges), Letter::plain(&KobbeltFaces)];
        Ok(Spelling::of([letters("U"), weighted].concat()))
    },
};
