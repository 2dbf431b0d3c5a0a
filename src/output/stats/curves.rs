//! Statistics of polygons.

use serde_json::{Value, json};

use crate::math::vector::minus;
use crate::output::bounds::CoordinateBounds;
use crate::output::error::FormatError;
use crate::output::positions::unfit;
use crate::output::scene::{Curve, ROWS_PER_CHUNK};
use crate::watch::{Stopped, Watch};

use super::entries::{add_moments, bounding_box, euler};
use super::hashes::{HashedItem, PositionsHash, ShapeHash};
use super::moments::Moments;

/// Returns the statistics of polygons whose points have `D` coordinates.
pub(super) fn report<const D: usize>(curves: &[Curve], watch: &Watch) -> Result<Value, FormatError> {
    let mut bounds = CoordinateBounds::EMPTY;
    let mut positions_hash = PositionsHash::default();
    let mut shape_hash = ShapeHash::ZERO;
    let mut bytes = Vec::new();
    for curve in curves {
        watch.check()?;
        if let Some(i) = curve.points.iter().position(|x| !x.is_finite()) {
            return Err(unfit(i / curve.dimension, curve.points[i]));
        }
        bounds.add(points::<D>(curve));
        positions_hash.add(&curve.points);
        let part = if curve.closed { HashedItem::Closed } else { HashedItem::Open };
        shape_hash.add(part, points::<D>(curve).iter().map(<[f64; D]>::as_slice), &mut bytes);
    }
    let origin = bounds.center();
    let CurveSums { moments, area, n_edges } = sums::<D>(curves, origin, watch)?;
    let n_points: usize = curves.iter().map(Curve::len).sum();
    let n_closed = curves.iter().filter(|curve| curve.closed).count();
    let plane = D == 2 && n_points > 0 && n_closed == curves.len();
    let mut found = json!({
        "kind": "curves",
        "dimension": D,
        "polygons": curves.len(),
        "closed_polygons": n_closed,
        "points": n_points,
        "edges": n_edges,
        "euler_characteristic": euler([n_points, n_edges, 0]),
        "bounding_box": bounding_box(&bounds),
        "length": moments.measure,
        "area": plane.then_some(area + 0.0),
    });
    add_moments(&mut found, "curve", &moments, origin);
    found["positions_hash"] = positions_hash.hex().into();
    found["shape_hash"] = shape_hash.hex().into();
    Ok(found)
}

/// The sums over edges.
struct CurveSums<const D: usize> {
    moments: Moments<D>,
    /// Signed area, for plane polygons only.
    area: f64,
    n_edges: usize,
}

/// Returns the sums over all edges, with points relative to `origin`.
fn sums<const D: usize>(curves: &[Curve], origin: [f64; D], watch: &Watch) -> Result<CurveSums<D>, Stopped> {
    let mut sums = CurveSums { moments: Moments::ZERO, area: 0.0, n_edges: 0 };
    for curve in curves {
        for [a, b] in edges(points::<D>(curve), curve.closed) {
            if sums.n_edges % ROWS_PER_CHUNK == 0 {
                watch.check()?;
            }
            sums.n_edges += 1;
            let (a, b) = (minus(*a, origin), minus(*b, origin));
            sums.moments.add_segment(a, b);
            if let ([ax, ay], [bx, by]) = (a.as_slice(), b.as_slice()) {
                sums.area += (ax * by - ay * bx) / 2.0;
            }
        }
    }
    Ok(sums)
}

fn points<const D: usize>(curve: &Curve) -> &[[f64; D]] {
    curve.points.as_chunks().0
}

fn edges<T>(points: &[T], closed: bool) -> impl Iterator<Item = [&T; 2]> {
    let last = if closed && points.len() > 1 { points.first() } else { None };
    points.iter().zip(points.iter().skip(1).chain(last)).map(|(a, b)| [a, b])
}
