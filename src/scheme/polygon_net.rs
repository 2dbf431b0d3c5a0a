//! The state of a polygon as operators see it: its number of points, its ends, and the children of vertices.

use std::sync::Arc;

use super::extent::{Ends, Extent};
use super::local::LocalValues;
use super::mask_range::{MaskRange, steps};
use super::phase::ChildPhase;
use super::polygon_anchor::PolygonAnchor;
use super::preimage::Preimages;
use super::step_error::{About, StepError};
use crate::math::rows::Rows;
use crate::shape::attributes::Attributes;
use crate::shape::topology::index;

/// The state of a polygon under refinement.
#[derive(Debug, Clone)]
pub struct PolygonNet {
    /// Number of stored points.
    pub n: usize,
    /// How the polygon is extended beyond its stored points.
    pub extent: Extent,
    /// Number of D since the last U (or since the start).
    pub duals: u32,
    /// After a U of arity d: control point `i` is a vertex if `(i + offset) % d == 0`; `None` before any U.
    pub phase: Option<ChildPhase>,
    /// Corners, which keep their position, ascending.
    pub corners: Arc<[u32]>,
    /// Control points whose tangents stay fixed, ascending; only steps that turn tangents keep track of them.
    pub pinned: Arc<[u32]>,
    /// The polygon that entered the last U.
    pub anchor: Option<PolygonAnchor>,
    /// The parameters of control points.
    pub attributes: Option<Arc<Attributes>>,
    /// Values of single points at the last U.
    pub local: Option<Arc<LocalValues>>,
}

impl PolygonNet {
    /// Creates the net of a control polygon.
    pub fn new(n: usize, closed: bool, ends: Ends, corners: &[u32]) -> Self {
        let extent = match (closed, ends) {
            (true, _) => Extent::Closed,
            (false, Ends::Clamped) => Extent::Whole,
            (false, Ends::Natural) => Extent::Natural,
        };
        Self {
            n,
            extent,
            duals: 0,
            phase: None,
            corners: corners.into(),
            pinned: Arc::default(),
            anchor: None,
            attributes: None,
            local: None,
        }
    }

    /// Returns whether the polygon is closed.
    pub fn is_closed(&self) -> bool {
        self.extent == Extent::Closed
    }

    /// Returns the number of control points: the stored ones without the two end points of [`Extent::Half`].
    pub fn n_control(&self) -> usize {
        if self.extent == Extent::Half { self.n - 2 } else { self.n }
    }

    /// Returns the index of control point 0 among the stored points.
    pub fn first(&self) -> usize {
        usize::from(self.extent == Extent::Half)
    }

    /// Returns whether control point `i` is a child of a vertex of the last U.
    pub fn is_vertex(&self, i: isize) -> bool {
        let on = |phase: ChildPhase| (i + steps(phase.offset)).rem_euclid(steps(phase.arity)) == 0;
        self.phase.is_none_or(on)
    }

    /// Returns the net after an average that moved it by `by` half steps; with natural ends, points were lost.
    pub(super) fn shifted(self, by: u32) -> Self {
        let lost = self.extent == Extent::Natural;
        let anchor = self.anchor.map(|anchor| PolygonAnchor { lost: lost || anchor.lost, ..anchor });
        Self { duals: self.duals + by, anchor, ..self }
    }

    /// Returns the net as the anchor of an upsampling.
    pub(super) fn as_anchor(&self) -> PolygonAnchor {
        PolygonAnchor {
            n: self.n,
            first: self.first(),
            n_control: self.n_control(),
            closed: self.is_closed(),
            corners: self.corners.clone(),
            lost: false,
        }
    }

    /// Returns the phase after an upsampling of this net.
    pub(super) fn phase_after(&self, arity: u32) -> ChildPhase {
        let start = MaskRange::upsample(arity).land(self.n as u128, self.extent).start;
        ChildPhase { arity, offset: 0 }.moved(start)
    }

    /// Returns the weight of control point `i` in the first average after a U: `f`, or the point's own kernel, at
    /// vertices, else 1.
    pub(super) fn weight(&self, i: isize, f: f64, first: bool) -> f64 {
        if !self.is_vertex(i) {
            return 1.0;
        }
        let (Some(local), Some(phase)) = (self.local.as_ref().filter(|_| first), self.phase) else { return f };
        let (d, n) = (steps(phase.arity), local.kernel.len().cast_signed());
        local.kernel[(i + phase.start()).div_euclid(d).rem_euclid(n).unsigned_abs()]
    }

    /// Returns whether all points away from the ends have the same rules; values of single points matter in the first
    /// average after an upsampling and in push-backs.
    pub(super) fn is_uniform(&self, first: bool) -> bool {
        self.corners.is_empty() && (self.local.is_none() || !first)
    }

    /// Returns the period in points with which the labels of the last upsampling repeat.
    pub(super) fn period(&self) -> usize {
        self.phase.map_or(1, |phase| phase.arity as usize)
    }

    /// Returns the index of a control point, modulo the number of control points.
    pub fn control(&self, i: isize) -> usize {
        i.rem_euclid(self.n_control().cast_signed()).unsigned_abs()
    }

    /// Returns whether control point `i` is a corner, which keeps its position.
    pub fn is_corner(&self, i: usize) -> bool {
        self.corners.binary_search(&index(i)).is_ok()
    }

    /// Returns the net after an operator with a mask of this range, and the sources of its points. Labels, the number
    /// of D and the anchor are left unchanged.
    pub(super) fn land(&self, range: MaskRange) -> Result<(Self, Preimages), StepError> {
        let landing = range.land(self.n as u128, self.extent);
        let n = usize::try_from(landing.n).unwrap_or(usize::MAX);
        if n < 2 {
            return Err(too_few_points(n));
        }
        let fixed_ends = matches!(self.extent, Extent::Whole | Extent::Half);
        let first = isize::from(landing.extent == Extent::Half);
        let preimages = Preimages { n, ends: fixed_ends.then_some(self.n - 1), start: landing.start as isize - first };
        let (d, start) = (i64::from(range.arity), i64::from(landing.start));
        let corners = self.corners.iter().map(|&c| i64::from(c) * d - start);
        let corners = corners.filter_map(|c| u32::try_from(c).ok()).filter(|&c| (c as usize) < n).collect();
        let phase = self.phase.map(|phase| phase.moved(landing.start));
        let trimmed = usize::try_from(landing.start).ok().filter(|_| self.extent == Extent::Natural && d == 1);
        let part = |attributes: &Arc<Attributes>| trimmed.map(|start| Arc::new(attributes.slice(start, n)));
        let attributes = self.attributes.as_ref().map(|kept| part(kept).unwrap_or_else(|| kept.clone()));
        Ok((Self { n, extent: landing.extent, corners, phase, attributes, ..self.clone() }, preimages))
    }

    /// Adds `weight x` control point `i` to a row; beyond the ends, `i` is resolved by the extent's rule.
    ///
    /// # Panics
    /// If `i` lies outside a polygon with natural ends.
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

/// Returns the error for natural ends that leave too few points.
pub(super) fn too_few_points(n: usize) -> StepError {
    let found = format!("natural ends leave {n} points; at least 2 must remain");
    StepError::about(About::Ends, format!("{found}: give more points or use clamped ends"))
}
