//! Refines polygons.

use super::apply::Points;
use super::error::RefineError;
use super::origins;
use super::start::{polygon_net, start_tangents};
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::stepper::Stepper;
use crate::shape::polygon::Polygon;
use crate::shape::source::Curve;
use crate::watch::Watch;

/// Refines one polygon into a curve.
///
/// # Errors
/// [`RefineError`].
pub fn refine_polygon(
    polygon: &Polygon,
    plan: &Plan,
    steps: &[Scheduled],
    watch: &Watch,
) -> Result<Curve, RefineError> {
    let (_, points) = refined_points(polygon, plan, steps, watch)?;
    Ok(Curve { points: points.now, dimension: polygon.dimension, closed: polygon.closed, tangents: points.tangents })
}

/// Refines a polygon and returns its net after the steps, and its points.
///
/// # Errors
/// [`RefineError`].
pub fn refined_points(
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
            let named = |error| origins::on_polygon(polygon, &net, step.letter.settings.arity(), error);
            let next = Stepper::new(plan).next(&net, step).map_err(named).map_err(RefineError::at(step))?;
            actions.push(next.action);
            net = next.net;
        }
        points.act_all(&actions, steps[0].level, watch)?;
    }
    Ok((net, points))
}
