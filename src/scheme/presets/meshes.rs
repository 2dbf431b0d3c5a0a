//! Classical schemes on meshes.

use super::{Preset, Refines, Spelling, letters};
use crate::scheme::ops::CatmullClark;
use crate::scheme::word::Letter;

pub(super) const CATMULL_CLARK: Preset = Preset {
    name: "catmull-clark",
    doc: "Catmull-Clark for faces of any size: bicubic B-splines in regular regions, C1 at extraordinary vertices. \
          Boundaries by the plan's `boundary`.",
    source: "Catmull and Clark, CAD 10 (1978), 350-355; boundaries as OpenSubdiv 3.5",
    parameters: &[],
    refines: Refines::Meshes,
    spell: |_| {
        let mut cycle = letters("U");
        cycle.push(Letter::plain(&CatmullClark));
        Ok(Spelling::of(cycle))
    },
};

pub(super) const BILINEAR: Preset = Preset {
    name: "bilinear",
    doc: "Bilinear refinement: every n-gon becomes n quads, no vertex moves. The word U.",
    source: "Zorin and Schroeder, CAGD 18 (2001), 429-454",
    parameters: &[],
    refines: Refines::Meshes,
    spell: |_| Ok(Spelling::of(letters("U"))),
};
