//! The incenter scheme, which is not linear.

use crate::math::parameter::Value;
use crate::scheme::letter::Letter;
use crate::scheme::ops::Incenter;
use crate::scheme::preset::{Preset, Refines, Spelling};

pub(super) const INCENTER: Preset = Preset {
    name: "incenter",
    doc: "Incenter (biarc) subdivision of polygons in the plane: between A and B, with direction e of the edge and \
          turnings a from A's tangent to e and b from e to B's, the point A + |AB| sin(b/2) / sin((a+b)/2) rot(e, \
          -a/2) is inserted, the incenter of edge and tangents, with tangent e; at inflections (a b <= 0) the midpoint \
          with tangent rot(e, (a-b)/2). Then each tangent is turned by mu of the angle to that of the circle through \
          the point and its neighbours. Interpolates, keeps circles and convexity; G1, and to all appearance G2 at mu \
          = 1/4. Uses the tangents of the input when given, those of circles through three points else; pinned ones \
          stay.",
    source: "after Deng and Wang, CAGD 27 (2010), 48-59; tangents as in Deng and Ma, CAGD 31 (2014), 656-673",
    parameters: &[Incenter::CIRCLE_SHARE],
    refines: Refines::Curves,
    claims: &[],
    spell: |values| {
        let mu = Value::Number(values.number("mu").unwrap_or(0.25));
        Ok(Spelling::of(vec![Letter::plain(&Incenter).with(&Incenter::CIRCLE_SHARE, mu)]))
    },
};
