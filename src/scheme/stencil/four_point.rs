//! The four-point rule between two points of a line, which is extended by reflection at its ends.

use crate::math::rows::Rows;
use crate::scheme::tags::Tags;
use crate::shape::topology::Topology;

/// The weights `(-w, 1/2 + w, 1/2 + w, -w)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FourPoint {
    /// Weight of each of the two points next to the new one.
    pub near: f64,
    /// Weight of each of the two points beyond them.
    pub far: f64,
}

impl FourPoint {
    /// The rule that reproduces cubics: (-1, 9, 9, -1)/16.
    pub const CUBIC: Self = Self::new(1.0 / 16.0);

    /// The rule with the tension `w`.
    pub const fn new(w: f64) -> Self {
        Self { near: 0.5 + w, far: -w }
    }

    /// Calls `add` for the point beyond `here`, opposite `there`; at the end of the line that is the reflection
    /// `2 here - there`.
    pub(in crate::scheme) fn beyond<P>(self, here: P, there: P, beyond: Option<P>, mut add: impl FnMut(P, f64))
    where
        P: Copy,
    {
        if let Some(beyond) = beyond {
            add(beyond, self.far);
        } else {
            add(here, 2.0 * self.far);
            add(there, -self.far);
        }
    }

    /// Adds the point on the boundary beyond one end of a boundary edge, beyond its second end if `onward`. The
    /// boundary ends at corners.
    pub(in crate::scheme) fn add_beyond(self, old: &Topology, tags: &Tags, e: usize, onward: bool, out: &mut Rows) {
        let [a, b] = old.ends(e);
        let (end, other) = if onward { (b, a) } else { (a, b) };
        let edges = old.boundary_edges(end as usize).filter(|_| !tags.is_corner(end as usize));
        let beyond = edges.map(
            |[next, previous]| {
                if onward { old.ends(next as usize)[1] } else { old.ends(previous as usize)[0] }
            },
        );
        self.beyond(end, other, beyond, |v, weight| out.add(v, weight));
    }
}
