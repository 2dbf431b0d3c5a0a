//! Limit points and tangents of a refined polygon.

use super::cycle::NoMask;
use super::rows::{LimitRows, WeightRow};
use crate::math::rows::{RowSource, Rows, RowsBy, blend};
use crate::refine::{RefineError, refined_points};
use crate::scheme::extent::{Ends, Extent};
use crate::scheme::mask_range::{MaskRange, steps};
use crate::scheme::operator::Role;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::polygon_net::PolygonNet;
use crate::shape::polygon::Polygon;
use crate::shape::source::Curve;
use crate::shape::topology::index;
use crate::watch::{Stopped, Watch};

/// The reason why a polygon has no limit rows.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoLimit {
    /// The plan has no limit rows.
    #[error("{0}, so that it has no limit masks")]
    Plan(#[from] NoMask),
    /// Single points have parameters of their own.
    #[error("points with parameters of their own have no common limit mask; leave \"parameters\" out")]
    Parameters,
    /// Points are lost at natural ends.
    #[error("limit masks reach beyond natural ends; use clamped ends")]
    NaturalEnds,
    /// A mask at clamped ends is not symmetric.
    #[error(
        "at clamped ends the points of a mask that is not its own mirror image have no common limit mask; close the \
         polygon"
    )]
    OneSided,
    /// Rules reach across corners.
    #[error("the rules of this plan reach across corners; leave \"corners\" out, or use a word over U, C and P")]
    Corners,
    /// The limit has no tangents at the points.
    #[error("the limit curve has no tangents at its points, as the scheme is not C1")]
    NoTangent,
}

/// Limit points and tangents of a polygon, `n x width` numbers each.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// Limit points, model units.
    pub points: Vec<f64>,
    /// Tangent vectors of any length, zero at corners; empty if the plan has no tangents.
    pub tangents: Vec<f64>,
}

/// Checks that limit rows apply to a polygon under a plan: the rules are linear and the same everywhere, or end at
/// corners.
///
/// # Errors
/// [`NoLimit`].
pub fn check(polygon: &Polygon, plan: &Plan) -> Result<(), NoLimit> {
    if polygon.attributes.is_some() {
        return Err(NoLimit::Parameters);
    }
    if !polygon.closed && plan.ends == Ends::Natural {
        return Err(NoLimit::NaturalEnds);
    }
    let mut letters = plan.word.prefix.iter().chain(&plan.word.cycle);
    if !polygon.closed && letters.any(|letter| letter.settings.mask().is_some_and(|mask| !mask.is_symmetric())) {
        return Err(NoLimit::OneSided);
    }
    // a rule that reaches one point on each side never crosses a corner, which is fixed
    let near = |range: MaskRange| range.first >= -1 && range.last <= 1;
    let mut letters = plan.word.prefix.iter().chain(&plan.word.cycle);
    let crosses = letters.any(|letter| {
        let range = letter.operator.mask_range(&letter.settings, 0);
        letter.facts().role == Role::Average && !range.is_some_and(near)
    });
    if !polygon.corners.is_empty() && crosses { Err(NoLimit::Corners) } else { Ok(()) }
}

/// Refines one polygon and computes its limit points and tangents.
///
/// # Errors
/// [`RefineError`].
pub fn refine_to_limit(
    polygon: &Polygon,
    plan: &Plan,
    steps: &[Scheduled],
    rows: &LimitRows,
    watch: &Watch,
) -> Result<(Curve, Limit), RefineError> {
    let (net, points) = refined_points(polygon, plan, steps, watch)?;
    let limit = limit(&net, &points.now, polygon.dimension, rows, watch)?;
    Ok((Curve { points: points.now, dimension: polygon.dimension, closed: polygon.closed, tangents: None }, limit))
}

/// Computes limit points and tangents from the `points` (`n x width`) of a refined polygon.
///
/// # Errors
/// [`Stopped`] when the watch says so.
fn limit(net: &PolygonNet, points: &[f64], width: usize, rows: &LimitRows, watch: &Watch) -> Result<Limit, Stopped> {
    let positions = blend(&positions(net, rows), points, width, watch)?;
    let tangents = match &rows.tangent {
        None => Vec::new(),
        Some(pair) => {
            let rows = RowsBy::new(net.n, net.n, |stored, out: &mut Rows| match kind(net, stored) {
                PointKind::Inner(i) | PointKind::End(i) => add(net, i, &pair[0], out),
                PointKind::Corner => {}
                PointKind::Middle(i) => add(net, i, &pair[1], out),
            });
            blend(&rows, points, width, watch)?
        }
    };
    Ok(Limit { points: positions, tangents })
}

/// Returns the rows of the limit points of a refined polygon, over its points.
pub fn positions(net: &PolygonNet, rows: &LimitRows) -> impl RowSource {
    RowsBy::new(net.n, net.n, |stored, out: &mut Rows| match kind(net, stored) {
        PointKind::Inner(i) => add(net, i, &rows.position[0], out),
        _ => out.add(index(stored), 1.0),
    })
}

/// The kind of a stored point; all but inner points stay where they are in the limit.
enum PointKind {
    /// A control point with rules from both sides, by index.
    Inner(isize),
    /// A corner between two pieces, without a tangent.
    Corner,
    /// A control point at an end, by index.
    End(isize),
    /// An end, half an edge before the control point of this index.
    Middle(isize),
}

fn kind(net: &PolygonNet, stored: usize) -> PointKind {
    let i = stored.cast_signed() - net.first().cast_signed();
    let n = net.n_control().cast_signed();
    match net.extent {
        Extent::Half if i < 0 => PointKind::Middle(0),
        Extent::Half if i >= n => PointKind::Middle(n),
        Extent::Whole if i == 0 || i + 1 == n => PointKind::End(i),
        _ if net.is_corner(i.unsigned_abs()) => PointKind::Corner,
        _ => PointKind::Inner(i),
    }
}

/// Adds the row around control point `i`, or around the midpoint of the edge before it. The polygon is cut at its
/// corners; each piece is continued beyond its ends by reflection.
fn add(net: &PolygonNet, i: isize, row: &WeightRow, out: &mut Rows) {
    let piece = piece(net, i);
    for (offset, weight) in row.entries() {
        // around a midpoint, the offsets -1/2 and 1/2 are the points i - 1 and i
        let at = i + isize::try_from(offset.div_euclid(2)).unwrap_or(0);
        match piece {
            None => net.add(at, weight, out),
            Some(ends) => add_within(net, ends, at, weight, out),
        }
    }
}

/// Adds `weight` times control point `at` of the piece between two corners; a point beyond a corner is reflected about
/// it.
fn add_within(net: &PolygonNet, [start, end]: [isize; 2], mut at: isize, mut weight: f64, out: &mut Rows) {
    let stored = |i: isize| index(net.control(i) + net.first());
    while at < start || at > end {
        let corner = if at < start { start } else { end };
        out.add(stored(corner), 2.0 * weight);
        (at, weight) = (2 * corner - at, -weight);
    }
    out.add(stored(at), weight);
}

/// Returns the corners, or ends, between which control point `i` lies; on closed polygons an index may lie a full round
/// outside. `None` if there are no corners.
fn piece(net: &PolygonNet, i: isize) -> Option<[isize; 2]> {
    let corners = &net.corners;
    let (&lowest, &highest) = (corners.first()?, corners.last()?);
    let n = net.n_control().cast_signed();
    let here = corners.partition_point(|&c| steps(c) <= i);
    let (before, after) = (here.checked_sub(1).map(|k| steps(corners[k])), corners.get(here).map(|&c| steps(c)));
    if net.is_closed() {
        Some([before.unwrap_or(steps(highest) - n), after.unwrap_or(steps(lowest) + n)])
    } else {
        Some([before.unwrap_or(0), after.unwrap_or(n - 1)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_at_a_corner_allocates_nothing_of_its_own() {
        let net = PolygonNet::new(12, true, Ends::Clamped, &[3, 7]);
        let row = WeightRow { first: -12, weights: vec![1.0; 13] };
        let mut out = Rows::default();
        add(&net, 4, &row, &mut out);
        out.clear();
        let taken = allocation_counter::measure(|| add(&net, 4, &row, &mut out));
        assert_eq!(taken.count_total, 0);
    }
}
