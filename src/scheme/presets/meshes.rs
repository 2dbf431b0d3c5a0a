//! Classical schemes on meshes.

use crate::math::parameter::{Parameter, Values};
use crate::scheme::claim::Claim;
use crate::scheme::letter::Letter;
use crate::scheme::ops::{CatmullClark, LoopSmoothing};
use crate::scheme::preset::{Preset, Refines, Spelling, letters};
use crate::scheme::rules::{Rules, TriangleRule};
use crate::scheme::sharpness::Creasing;
use crate::shape::tile::Tile;

pub(super) const CATMULL_CLARK: Preset = Preset {
    name: "catmull-clark",
    doc: "Catmull-Clark for faces of any size: bicubic B-splines in regular regions, C1 at extraordinary vertices. \
          Boundaries by the plan's `boundary`, sharp edges and corners by the input's `creases` and `corners`.",
    source: "Catmull and Clark, CAD 10 (1978), 350-355; boundaries as OpenSubdiv 3.5",
    parameters: &[CREASING, TRIANGLE_RULE],
    refines: Refines::Meshes,
    claims: &[Claim::on_meshes("", &[&[]], ["2", "4", "1"], Some([3, 50]))],
    spell: |values| {
        let cycle = [letters("U"), vec![Letter::plain(&CatmullClark)]].concat();
        let triangles =
            if values.choice("triangle_rule") == Some("smooth") { TriangleRule::Smooth } else { TriangleRule::Catmark };
        Ok(Spelling { rules: Rules { creasing: creasing(values), triangles }, ..Spelling::of(cycle) })
    },
};

pub(super) const LOOP: Preset = Preset {
    name: "loop",
    doc: "Loop's scheme for meshes of triangles: a box spline, C2, in regular regions (valence 6), C1 at other \
          vertices. Boundaries by the plan's `boundary`, sharp edges and corners by the input's `creases` and \
          `corners`.",
    source: "Loop, Smooth subdivision surfaces based on triangles, 1987; boundaries as OpenSubdiv 3.5",
    parameters: &[CREASING],
    refines: Refines::Meshes,
    claims: &[Claim::on_meshes("", &[&[]], ["2", "4", "1"], Some([3, 50]))],
    spell: |values| {
        let cycle = [letters("U"), vec![Letter::plain(&LoopSmoothing)]].concat();
        let rules = Rules { creasing: creasing(values), ..Rules::default() };
        Ok(Spelling { tile: Tile::Triangle, rules, ..Spelling::of(cycle) })
    },
};

pub(super) const BILINEAR: Preset = Preset {
    name: "bilinear",
    doc: "Bilinear refinement: every n-gon becomes n quads, no vertex moves. The word U.",
    source: "Zorin and Schroeder, CAGD 18 (2001), 429-454",
    parameters: &[],
    refines: Refines::Meshes,
    claims: &[Claim::on_meshes("", &[&[]], ["0", "2", "1"], None)],
    spell: |_| Ok(Spelling::of(letters("U"))),
};

const CREASING: Parameter = Parameter::choice(
    "creasing",
    &[Creasing::Uniform.name(), Creasing::Chaikin.name()],
    "How much of its sharpness s an edge hands on to its halves: s - 1, or 3/4 s + 1/4 m - 1 with m the mean of the \
     other semi-sharp edges at the half's end.",
);

const TRIANGLE_RULE: Parameter = Parameter::choice(
    "triangle_rule",
    &["catmark", "smooth"],
    "Edge points beside triangles: the usual (V1 + V2 + F1 + F2)/4, or (1/2 - w)(V1 + V2) + w (F1 + F2), with w the \
     mean of 0.47 for a triangle and 1/4 for any other face.",
);

fn creasing(values: &Values) -> Creasing {
    if values.choice("creasing") == Some(Creasing::Chaikin.name()) { Creasing::Chaikin } else { Creasing::Uniform }
}
