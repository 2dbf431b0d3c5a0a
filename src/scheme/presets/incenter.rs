//! The incenter scheme, which is not linear.

use crate::math::parameter::{Default, Kind, Parameter};
use crate::scheme::ops::Incenter;
use crate::scheme::preset::{Preset, Refines, Spelling};
use crate::scheme::word::Letter;

pub(super) const INCENTER: Preset = Preset {
    name: "incenter",
    doc: "Incenter (biarc) subdivision of polygons in the plane: between A and B, with direction e of the edge and \
          turnings a from A's tangent to e and b from e to B's, the point A + |AB| sin(b/2) / sin((a+b)/2) rot(e, -a/2) \
          is inserted, the incenter of edge and tangents, with tangent e; at inflections (a b <= 0) the midpoint with \
          tangent rot(e, (a-b)/2). Then each tangent is turned by mu of the angle to that of the circle through the point \
          and its neighbours. Interpolates, keeps circles and convexity; G1, and to all appearance G2 at mu = 1/4. Uses \
          the tangents of the input when given, those of circles through three points else; pinned ones stay.",
    source: "after Deng and Wang, CAGD 27 (2010), 48-59; tangents as in Deng and Ma, CAGD 31 (2014), 656-673",
    parameters: &[Parameter {
        name: "mu",
        kind: Kind::Number { min: 0.0, max: 1.0 },
        unit: "",
        default: Default::Number(0.25),
        doc: "How far tangents follow the circle through three points: 0 keeps those of the biarcs, 1 takes the circle's.",
    }],
    refines: Refines::Curves,
    spell: |values| {
        let blending = Some(values.number("mu").unwrap_or(0.25));
        Ok(Spelling::of(vec![Letter { blending, ..Letter::plain(&Incenter) }]))
    },
};
