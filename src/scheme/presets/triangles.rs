//! Classical schemes on triangles besides Loop.

use super::{Preset, Refines, Spelling};
use crate::scheme::ops::RootThree;
use crate::scheme::word::Letter;

pub(super) const SQRT_3: Preset = Preset {
    name: "sqrt-3",
    doc: "Kobbelt's sqrt 3 scheme for triangles: each level makes three times as many, C2 in regular regions, C1 at \
          extraordinary vertices. Boundaries are cubic B-splines of their polygons, cut in three every second level.",
    source: "Kobbelt, SIGGRAPH 2000, 103-112",
    parameters: &[],
    refines: Refines::Meshes,
    spell: |_| Ok(Spelling::of(vec![Letter::plain(&RootThree)])),
};
