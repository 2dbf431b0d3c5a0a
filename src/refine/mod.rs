//! Refinement: applies a plan's steps to points. Nothing outside knows how a net is stored.

pub mod curve;

mod refined;

pub use curve::refine_polygon;
pub use refined::RefinedMesh;

use std::sync::Arc;

use crate::math::planar;
use crate::math::rows::{RowSource, blend};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::sharpness::Sharpness;
use crate::scheme::step::{Action, PointMap, StepError, Values};
use crate::shape::mesh::Mesh;
use crate::shape::polygon::Polygon;
use crate::watch::{Stopped, Watch};

/// Why a refinement ended early.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RefineError {
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// An operator could not be applied.
    #[error("level {level}: {error}")]
    Step {
        /// Where.
        level: u32,
        /// Why.
        error: StepError,
    },
    /// A coordinate grew beyond all bounds.
    #[error("level {level}: a coordinate is no longer finite; choose tamer parameters or fewer levels")]
    NotFinite {
        /// The first such level.
        level: u32,
    },
}

/// The net of a polygon before refinement.
pub fn polygon_net(polygon: &Polygon, plan: &Plan) -> PolygonNet {
    let attributes = polygon.attributes.clone().map(Arc::new);
    let pinned = polygon.pinned.as_slice().into();
    PolygonNet { pinned, attributes, ..PolygonNet::new(polygon.len(), polygon.closed, plan.ends, &polygon.corners) }
}

/// The net of a mesh before refinement.
pub fn mesh_net(mesh: &Mesh, plan: &Plan) -> MeshNet {
    let sharpness = Sharpness::of(&mesh.creases, &mesh.semi_sharp_corners);
    let mut net = MeshNet::new(mesh.topology.clone(), &mesh.corners, &mesh.holes, plan.boundary);
    if mesh.attachments.names_faces() {
        net.tagged = net.tagged.or(Some("groups and materials"));
    }
    net.with_sharpness(sharpness, plan.rules)
}

/// The tangents of a polygon in the plane: those given, or else those of circles through neighbours.
fn start_tangents(polygon: &Polygon, watch: &Watch) -> Result<Vec<f64>, Stopped> {
    match &polygon.tangents {
        Some(tangents) => Ok(tangents.clone()),
        None => planar::tangents(polygon.points.as_chunks().0, polygon.closed, watch).map(Vec::into_flattened),
    }
}

/// Refines a mesh with its channels, all by the same rows.
///
/// # Errors
/// [`RefineError`].
pub fn refine_mesh(mesh: &Mesh, plan: &Plan, steps: &[Scheduled], watch: &Watch) -> Result<RefinedMesh, RefineError> {
    let mut net = mesh_net(mesh, plan);
    let mut points = Points::new(mesh.positions.clone(), 3);
    let channels = mesh.attachments.channels.iter();
    let mut channels: Vec<Points> = channels.map(|c| Points::new(c.values.clone(), c.width)).collect();
    for step in steps {
        let next = step.letter.operator.on_mesh(&net, &values(plan, step)).map_err(|error| at(step, error))?;
        points.act(&next.action, step, watch)?;
        channels.iter_mut().try_for_each(|channel| channel.act(&next.action, step, watch))?;
        net = next.net;
    }
    let channels = channels.into_iter().map(|channel| channel.now).collect();
    Ok(RefinedMesh::new(&net, points.now).carrying(mesh.attachments.clone(), channels))
}

fn values<'a>(plan: &'a Plan, step: &'a Scheduled) -> Values<'a> {
    Values {
        letter: &step.letter,
        alpha: step.alpha,
        kernel: step.kernel,
        mu: plan.mu,
        compensation: step.compensation,
        delta: &plan.delta,
        first: step.first,
        sources: plan.sources(step),
    }
}

fn at(step: &Scheduled, error: StepError) -> RefineError {
    RefineError::Step { level: step.level, error }
}

/// Points of a net, `n x width`, with those that entered the last U.
struct Points {
    now: Vec<f64>,
    anchor: Vec<f64>,
    /// Unit tangents, `n x width`, under plans that turn them.
    tangents: Option<Vec<f64>>,
    width: usize,
}

impl Points {
    fn new(now: Vec<f64>, width: usize) -> Self {
        Self { now, anchor: Vec::new(), tangents: None, width }
    }

    fn act(&mut self, action: &Action, step: &Scheduled, watch: &Watch) -> Result<(), RefineError> {
        match action {
            Action::Blend(rows) => self.now = blend(&**rows, &self.now, self.width, watch)?,
            Action::BlendFromAnchor(rows) => {
                let next = blend(&**rows, &self.now, self.width, watch)?;
                self.anchor = std::mem::replace(&mut self.now, next);
            }
            Action::PushBack { rows, children } => self.push_back(&**rows, children, watch)?,
            Action::Map(map) => self.map(&**map, watch)?,
            Action::Keep => {}
        }
        // a sum of finite numbers that overflows stays infinite or NaN, so a sample of the sums would not do
        if self.now.iter().chain(self.tangents.iter().flatten()).all(|x| x.is_finite()) {
            Ok(())
        } else {
            Err(RefineError::NotFinite { level: step.level })
        }
    }

    fn map(&mut self, map: &dyn PointMap, watch: &Watch) -> Result<(), Stopped> {
        let tangents = self.tangents.as_ref().expect("plans with such a step start with tangents");
        let (points, tangents) = map.apply(self.now.as_chunks().0, tangents.as_chunks().0, watch)?;
        (self.now, self.tangents) = (points.into_flattened(), Some(tangents.into_flattened()));
        Ok(())
    }

    /// `points + rows x (anchor - children)`.
    fn push_back(&mut self, rows: &dyn RowSource, children: &Arc<[u32]>, watch: &Watch) -> Result<(), Stopped> {
        let w = self.width;
        let mut differences = self.anchor.clone();
        for (difference, &child) in differences.chunks_exact_mut(w).zip(children.iter()) {
            let child = child as usize * w;
            for (d, x) in difference.iter_mut().zip(&self.now[child..child + w]) {
                *d -= x;
            }
        }
        let moves = blend(rows, &differences, w, watch)?;
        for (x, m) in self.now.iter_mut().zip(&moves) {
            *x += m;
        }
        Ok(())
    }
}
