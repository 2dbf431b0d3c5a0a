//! Refines nets with weights instead of points.

use std::ops::Range;

use super::error::RefineError;
use super::origins;
use super::recorder::Recorder;
use super::start::{mesh_net, polygon_net};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::stepper::Stepper;
use crate::shape::mesh::Mesh;
use crate::shape::polygon::Polygon;
use crate::watch::Watch;

/// Refines a mesh, records its weights and returns the net after the steps.
///
/// # Errors
/// [`RefineError`].
pub fn weigh_mesh(
    recorder: &mut Recorder,
    mesh: &Mesh,
    plan: &Plan,
    steps: &[Scheduled],
    watch: &Watch,
) -> Result<MeshNet, RefineError> {
    recorder.begin(0, mesh.topology.n_vertices());
    weigh_net(recorder, mesh_net(mesh, plan), plan, steps, watch)
}

/// Refines the net of a mesh further, records its weights and returns the net after the steps.
///
/// # Errors
/// [`RefineError`].
pub fn weigh_net(
    recorder: &mut Recorder,
    mut net: MeshNet,
    plan: &Plan,
    steps: &[Scheduled],
    watch: &Watch,
) -> Result<MeshNet, RefineError> {
    for step in steps {
        let named = |error| origins::on_mesh(&net, error);
        let next = Stepper::new(plan).next(&net, step).map_err(named).map_err(RefineError::at(step))?;
        recorder.act(&next.action, step.level, watch)?;
        net = next.net;
    }
    Ok(net)
}

/// Returns the vertices of a net in the documented order, by their indices in the order of construction.
pub fn documented(net: &MeshNet, n_vertices: usize) -> Vec<usize> {
    match net.mesh.order() {
        Some(order) => (0..order.n_vertices()).map(|v| order.constructed(v) as usize).collect(),
        None => (0..n_vertices).collect(),
    }
}

/// Refines a polygon whose points are the input points `points`, records its weights and returns the net after the
/// steps.
///
/// # Errors
/// [`RefineError`].
pub fn weigh_polygon(
    recorder: &mut Recorder,
    (polygon, points): (&Polygon, Range<usize>),
    plan: &Plan,
    steps: &[Scheduled],
    watch: &Watch,
) -> Result<PolygonNet, RefineError> {
    recorder.begin(points.start, points.len());
    let mut net = polygon_net(polygon, plan);
    for step in steps {
        let named = |error| origins::on_polygon(polygon, &net, step.letter.settings.arity(), error);
        let next = Stepper::new(plan).next(&net, step).map_err(named).map_err(RefineError::at(step))?;
        recorder.act(&next.action, step.level, watch)?;
        net = next.net;
    }
    Ok(net)
}
