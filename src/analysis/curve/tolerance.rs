//! Finds the level at which polygons are within a tolerance of their limit curves.

use super::distance::{Distances, NoBound};
use super::limit::check;
use crate::analysis::no_level::NoLevel;
use crate::math::functions::sqrt;
use crate::refine::{Points, RefineError, advance, polygon_net};
use crate::scheme::extent::Extent;
use crate::scheme::plan::{MAX_PLAN_LEVELS, Plan};
use crate::scheme::polygon_net::PolygonNet;
use crate::shape::polygon::Polygon;
use crate::watch::Watch;

/// Number of points up to which second differences are measured; beyond it they are bounded by their contraction.
/// Measured differences are sharper, because the bound by contraction loosens from level to level. Half of it switches
/// one level earlier for binary schemes, twice of it one level later at twice the time.
const MEASURED_POINTS: usize = 16_384;
/// Maximum level that is measured. A polygon of two points passes [`MEASURED_POINTS`] after 14 binary levels, so that
/// twice of it changes nothing for plans that add points; half of it would bound small polygons less sharply.
const MEASURED_LEVELS: u32 = 16;
/// Least tolerance, relative to the greatest coordinate; below it, rounding is not negligible. It is 4,500 times the
/// spacing of numbers at the greatest coordinate. Half of it leaves rounding half that room; twice of it would refuse
/// tolerances that can be met.
const LEAST_CURVE_TOLERANCE: f64 = 1e-12;

/// Memory of a search in bytes per point that it may visit: new and old points of up to 4 numbers, and their rows. Old
/// and new points take 64 bytes of it. Half of it leaves nothing for rows; twice of it would let half as many searches
/// run at once.
const SEARCH_BYTES_A_POINT: u64 = 128;
/// Number of points for which a search reserves memory at least, for impulses and products of masks. It is four times
/// the points of an impulse, and 32 MiB. Half of it would promise less than wide masks may take; twice of it would let
/// half as many small searches run at once.
const OTHER_POINTS: u64 = 1 << 18;

/// Returns an upper bound of the memory in bytes of a search for polygons with this number of points.
pub fn search_bytes(points: usize) -> u64 {
    // the level after the last one that is measured, at the largest arity
    SEARCH_BYTES_A_POINT.saturating_mul((points as u64).saturating_mul(16).max(OTHER_POINTS))
}

/// The level that meets a tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    /// The level.
    pub level: u32,
    /// An upper bound of the distance of the level from the limit, model units.
    pub bound: f64,
}

impl From<NoBound> for NoLevel {
    fn from(error: NoBound) -> Self {
        if let NoBound::Stopped(stopped) = error { Self::Stopped(stopped) } else { Self::Refused(error.to_string()) }
    }
}

/// Returns the first level at which all polygons are proved to be within `tolerance` of their limits.
///
/// # Errors
/// [`NoLevel`], also when `watch` says stop.
pub fn reach(polygons: &[Polygon], plan: &Plan, tolerance: f64, watch: &Watch) -> Result<Reached, NoLevel> {
    let distances = Distances::of(plan, watch)?;
    for polygon in polygons {
        check(polygon, plan).map_err(|error| NoLevel::Refused(error.to_string()))?;
        if polygon.rational {
            let why = "rational points are divided by their weights at the end, which distances do not survive";
            return Err(NoLevel::Refused(format!("{why}; give \"levels\" as a number")));
        }
        let size = polygon.points.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        if tolerance < LEAST_CURVE_TOLERANCE * size {
            let least = size * LEAST_CURVE_TOLERANCE;
            return Err(NoLevel::Refused(format!(
                "{tolerance:?} is below what rounding leaves of coordinates of {size:?}; ask for at least {least:?}"
            )));
        }
    }
    let bends = measured(polygons, plan, watch)?;
    let found = distances.level(&bends, tolerance)?;
    let (level, bound) = found.ok_or_else(|| {
        let never = format!("no level up to {MAX_PLAN_LEVELS} is known to be within {tolerance:?} of the limit");
        NoLevel::Refused(format!("{never}; ask for a coarser tolerance"))
    })?;
    Ok(Reached { level, bound })
}

/// Returns the greatest second difference of all polygons after 0, 1, ... levels, as long as the polygons have few
/// points.
fn measured(polygons: &[Polygon], plan: &Plan, watch: &Watch) -> Result<Vec<f64>, NoLevel> {
    let mut bends: Vec<f64> = Vec::new();
    for polygon in polygons {
        let most = MEASURED_POINTS / polygons.len().min(MEASURED_POINTS);
        let of_one = measured_one(polygon, plan, most, watch)?;
        // levels at which some polygon is not measured are bounded for all polygons
        let shared = if bends.is_empty() { of_one.len() } else { bends.len().min(of_one.len()) };
        bends.resize(shared, 0.0);
        for (most, bend) in bends.iter_mut().zip(&of_one) {
            *most = most.max(*bend);
        }
    }
    Ok(bends)
}

fn measured_one(polygon: &Polygon, plan: &Plan, most: usize, watch: &Watch) -> Result<Vec<f64>, RefineError> {
    let mut net = polygon_net(polygon, plan);
    let mut points = Points::new(polygon.points.clone(), polygon.dimension);
    let mut bends = Vec::new();
    for level in 0..=MEASURED_LEVELS {
        // a level whose functions have no value is refused when it is requested
        let Ok(steps) = plan.schedule(level) else { break };
        let steps = steps.iter().filter(|step| step.level == level);
        advance(&mut net, std::slice::from_mut(&mut points), plan, steps, watch)?;
        bends.push(greatest_second_difference(&net, &points.now, polygon.dimension));
        if net.n > most {
            break;
        }
    }
    Ok(bends)
}

/// Returns `max |p[i-1] - 2 p[i] + p[i+1]|` over all control points with rules from both sides.
fn greatest_second_difference(net: &PolygonNet, points: &[f64], width: usize) -> f64 {
    let n = net.n;
    let at = |i: usize| &points[i * width..(i + 1) * width];
    let bend = |a: &[f64], b: &[f64], c: &[f64], factors: [f64; 3]| {
        let squares = (0..width).map(|k| {
            let x = factors[0] * a[k] + factors[1] * b[k] + factors[2] * c[k];
            x * x
        });
        sqrt(squares.sum())
    };
    let mut most: f64 = 0.0;
    let inner = match net.extent {
        Extent::Closed => 0..n,
        Extent::Whole | Extent::Natural => 1..n.saturating_sub(1),
        Extent::Half => 2..n.saturating_sub(2),
    };
    for i in inner.filter(|&i| !net.is_corner(i.saturating_sub(net.first()))) {
        most = most.max(bend(at((i + n - 1) % n), at(i), at((i + 1) % n), [1.0, -2.0, 1.0]));
    }
    if net.extent == Extent::Half && n == 3 {
        most = most.max(bend(at(0), at(1), at(2), [2.0, -4.0, 2.0]));
    } else if net.extent == Extent::Half && n > 3 {
        // the point before the first one is its mirror image about the end
        most = most.max(bend(at(0), at(1), at(2), [2.0, -3.0, 1.0]));
        most = most.max(bend(at(n - 1), at(n - 2), at(n - 3), [2.0, -3.0, 1.0]));
    }
    most
}
