//! What is known of the limit of refined polygons: its points and tangents, how far it is, whether there is one.

mod convergence;
mod cycle;
mod distance;
mod limit;
mod rows;
mod tolerance;

pub use convergence::warnings;
pub use cycle::{Cycle, NoMask};
pub use distance::{Distances, MAX_WORK, NoBound};
pub use limit::{Limit, NoLimit, check};
pub use rows::{LimitRows, Row};
pub use tolerance::{NoLevel, Reached, reach, search_bytes};

use super::{Points, RefineError, at, origins, polygon_net, start_tangents, values};
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::polygon_net::PolygonNet;
use crate::shape::polygon::Polygon;
use crate::shape::source::Curve;
use crate::watch::Watch;

/// Refines one polygon.
///
/// # Errors
/// [`RefineError`].
pub fn refine_polygon(
    polygon: &Polygon,
    plan: &Plan,
    steps: &[Scheduled],
    watch: &Watch,
) -> Result<Curve, RefineError> {
    let (_, points) = refined(polygon, plan, steps, watch)?;
    Ok(Curve { points: points.now, dimension: polygon.dimension, closed: polygon.closed, tangents: points.tangents })
}

/// Refines one polygon and finds its limit points and tangents.
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
    let (net, points) = refined(polygon, plan, steps, watch)?;
    let limit = limit::limit(&net, &points.now, polygon.dimension, rows, watch)?;
    Ok((Curve { points: points.now, dimension: polygon.dimension, closed: polygon.closed, tangents: None }, limit))
}

fn refined(
    polygon: &Polygon,
    plan: &Plan,
    steps: &[Scheduled],
    watch: &Watch,
) -> Result<(PolygonNet, Points), RefineError> {
    let mut net = polygon_net(polygon, plan);
    let mut points = Points::new(polygon.points.clone(), polygon.dimension);
    if plan.turns_tangents().is_some() {
        points.tangents = Some(start_tangents(polygon, watch)?);
    }
    for steps in steps.chunk_by(|a, b| a.level == b.level) {
        let mut actions = Vec::with_capacity(steps.len());
        for step in steps {
            let next = step.letter.operator.on_polygon(&net, &values(plan, step));
            let named = |error| origins::on_polygon(polygon, &net, step.letter.arity, error);
            let next = next.map_err(|error| at(step, named(error)))?;
            actions.push(next.action);
            net = next.net;
        }
        points.act_all(&actions, steps[0].level, watch)?;
    }
    Ok((net, points))
}
