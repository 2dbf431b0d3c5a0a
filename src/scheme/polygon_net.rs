//! A polygon as the operators see it: how many points, how its ends go on, which points are vertices of the last U.

use std::sync::Arc;

use super::step::StepError;
use crate::math::rows::Rows;
use crate::shape::topology::index;

/// End rule of open polygons.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ends {
    /// The polygon goes on by point reflection about its end points, which stay where they are.
    #[default]
    Clamped,
    /// Only points whose whole stencil exists.
    Natural,
}

/// How a polygon goes on beyond its stored points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// Cyclically.
    Closed,
    /// By reflection about the first and the last point, which are points of the polygon: `P[-j] = 2 P[0] - P[j]`.
    Whole,
    /// By reflection about the first and the last stored point, which are no points of the polygon but lie half a step
    /// before and after it: `q[-1-j] = 2 e - q[j]`.
    Half,
    /// Not at all.
    Natural,
}

/// The state of a polygon under refinement.
#[derive(Debug, Clone)]
pub struct PolygonNet {
    /// Stored points.
    pub n: usize,
    /// How it goes on.
    pub extent: Extent,
    /// Number of D since the last U (or since the start).
    pub duals: u32,
    /// After a U of arity d: control point `i` is a vertex if `(i + offset) % d == 0`; `None` before any U.
    pub phase: Option<Phase>,
    /// Control points that keep their place, ascending.
    pub corners: Arc<[u32]>,
    /// What entered the last U.
    pub anchor: Option<Anchor>,
}

/// Which control points are children of vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Phase {
    /// Arity of the last U.
    pub arity: u32,
    /// Offset of the first control point.
    pub offset: u32,
}

/// The polygon that entered the last U.
#[derive(Debug, Clone)]
pub struct Anchor {
    /// Stored points.
    pub n: usize,
    /// Index of the first control point among the stored ones.
    pub first: usize,
    /// Number of control points.
    pub n_control: usize,
    /// Its corners.
    pub corners: Arc<[u32]>,
    /// Whether points were lost since.
    pub lost: bool,
}

impl PolygonNet {
    /// The net of a control polygon.
    pub fn new(n: usize, closed: bool, ends: Ends, corners: &[u32]) -> Self {
        let extent = match (closed, ends) {
            (true, _) => Extent::Closed,
            (false, Ends::Clamped) => Extent::Whole,
            (false, Ends::Natural) => Extent::Natural,
        };
        Self { n, extent, duals: 0, phase: None, corners: corners.into(), anchor: None }
    }

    /// Whether the polygon is closed.
    pub fn is_closed(&self) -> bool {
        self.extent == Extent::Closed
    }

    /// Number of control points: the stored ones less the two end points of [`Extent::Half`].
    pub fn n_control(&self) -> usize {
        if self.extent == Extent::Half { self.n - 2 } else { self.n }
    }

    /// Index of control point 0 among the stored points.
    pub fn first(&self) -> usize {
        usize::from(self.extent == Extent::Half)
    }

    /// Whether control point `i` is a child of a vertex of the last U.
    pub fn is_vertex(&self, i: usize) -> bool {
        self.phase.is_none_or(|phase| (index(i) + phase.offset).is_multiple_of(phase.arity))
    }

    /// Whether control point `i` keeps its place.
    pub fn is_corner(&self, i: usize) -> bool {
        self.corners.binary_search(&index(i)).is_ok()
    }

    /// Fails when fewer than two points would remain.
    pub(super) fn remaining(n: usize) -> Result<usize, StepError> {
        if n < 2 { Err(StepError::TooFewPoints(n)) } else { Ok(n) }
    }

    /// Adds `weight x` control point `i` to a row, `i` taken beyond the ends by the extent's rule.
    ///
    /// # Panics
    /// When `i` lies outside a polygon with natural ends.
    pub fn add(&self, i: isize, weight: f64, rows: &mut Rows) {
        let n = self.n_control().cast_signed();
        let (mut i, mut weight) = (i, weight);
        let (before, after) = match self.extent {
            Extent::Closed => {
                rows.add(index(i.rem_euclid(n).cast_unsigned()), weight);
                return;
            }
            Extent::Natural | Extent::Whole => (0, 2 * (n - 1)),
            Extent::Half => (-1, 2 * n - 1),
        };
        while i < 0 || i >= n {
            assert!(self.extent != Extent::Natural, "natural ends are never exceeded");
            let (end, mirrored) = if i < 0 { (0, before - i) } else { (self.n - 1, after - i) };
            rows.add(index(end), 2.0 * weight);
            (i, weight) = (mirrored, -weight);
        }
        rows.add(index(i.cast_unsigned() + self.first()), weight);
    }
}
