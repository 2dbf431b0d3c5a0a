//! Refinement: applies a plan's steps to points. Nothing outside knows how a net is stored.

mod normals;
mod origins;
mod polygon;
mod refined;
mod unfolded;
mod uvs;

pub use normals::Normals;
pub use polygon::{refine_polygon, refined_points};
pub use refined::RefinedMesh;
pub use uvs::uv_net;

use uvs::RefinedUvs;
pub use uvs::refined as refined_uvs;

use std::sync::Arc;

use rayon::prelude::*;

use crate::math::planar;
use crate::math::rows::{MAX_RUN, RowSource, blend, blend_run};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::ops::LatitudeRule;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::sharpness::Sharpness;
use crate::scheme::step::{Action, PointMap, StepError, Values};
use crate::shape::attributes::Attributes;
use crate::shape::directions::Directions;
use crate::shape::mesh::Mesh;
use crate::shape::polygon::Polygon;
use crate::shape::topology::NONE;
use crate::watch::{Stopped, Watch};

/// Numbers that one thread takes at a time.
const CHUNK: usize = 1 << 16;

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
    let net = MeshNet::new(mesh.topology.clone(), &mesh.corners, &mesh.holes, plan.boundary);
    let (attributes, directions) = carried(mesh, plan);
    net.with_sharpness(sharpness, plan.rules).carrying(attributes, directions)
}

/// What the vertices and edges of a mesh carry under a plan: closed latitude lines of n vertices have the alpha
/// `2 pi / n` where neither the plan nor the vertices give one.
pub fn carried(mesh: &Mesh, plan: &Plan) -> (Option<Attributes>, Option<Directions>) {
    let (Some(latitude), Some(directions)) = (&plan.latitude, &mesh.directions) else {
        return (mesh.attributes.clone(), None);
    };
    let mut attributes = mesh.attributes.clone().unwrap_or_default();
    if latitude.own_alpha && attributes.alpha.is_none() {
        let mut alpha = vec![plan.alpha; mesh.topology.n_vertices()];
        for line in directions.lines(&mesh.topology).iter().filter(|line| line.closed) {
            #[expect(clippy::cast_precision_loss, reason = "lines have far fewer than 2^52 vertices")]
            let own = std::f64::consts::TAU / line.vertices.len() as f64;
            line.vertices.iter().for_each(|&v| alpha[v as usize] = own);
        }
        attributes.alpha = Some(alpha);
    }
    (Some(attributes), Some(directions.clone()))
}

/// The tangents of a polygon in the plane: those given, or else those of circles through neighbours.
pub fn start_tangents(polygon: &Polygon, watch: &Watch) -> Result<Vec<f64>, Stopped> {
    match &polygon.tangents {
        Some(tangents) => Ok(tangents.clone()),
        None => planar::tangents(polygon.points.as_chunks().0, polygon.closed, watch).map(Vec::into_flattened),
    }
}

/// Refines a mesh with its channels, all by the same rows, and its texture coordinates by the same scheme.
///
/// # Errors
/// [`RefineError`].
pub fn refine_mesh(mesh: &Mesh, plan: &Plan, steps: &[Scheduled], watch: &Watch) -> Result<RefinedMesh, RefineError> {
    let (net, points) = act_on(mesh_net(mesh, plan), numbers(mesh), plan, steps, watch)?;
    let uvs = uvs::refined(mesh, plan, steps, watch)?;
    let refined = assembled(mesh, &net, points.into_iter().map(|points| points.now).collect(), uvs);
    Ok(if steps.is_empty() { refined.with_tags(mesh.tags()) } else { refined })
}

/// What is refined of a mesh: its positions, then its channels.
pub fn numbers(mesh: &Mesh) -> Vec<Points> {
    let channels = mesh.attachments.channels.iter().map(|c| Points::new(c.values.clone(), c.width));
    std::iter::once(Points::new(mesh.positions.clone(), 3)).chain(channels).collect()
}

/// The refined mesh of a net, with its positions, channels and texture coordinates.
pub fn assembled(mesh: &Mesh, net: &MeshNet, numbers: Vec<Vec<f64>>, uvs: Option<RefinedUvs>) -> RefinedMesh {
    let mut numbers = numbers.into_iter();
    let points = numbers.next().unwrap_or_default();
    let refined = RefinedMesh::new(net, points).carrying(mesh.attachments.clone(), numbers.collect(), uvs);
    // a connectivity of its own tells no origins in the input
    let stays = Arc::ptr_eq(&net.mesh.base, &mesh.topology);
    if stays { refined.split_from(mesh.split_from.clone()) } else { refined }
}

/// Applies steps to a net and its points.
pub fn act_on(
    mut net: MeshNet,
    mut points: Vec<Points>,
    plan: &Plan,
    steps: &[Scheduled],
    watch: &Watch,
) -> Result<(MeshNet, Vec<Points>), RefineError> {
    for step in steps {
        let next = step.letter.operator.on_mesh(&net, &values(plan, step));
        let next = next.map_err(|error| at(step, origins::on_mesh(&net, error)))?;
        points.iter_mut().try_for_each(|points| points.act(&next.action, step.level, watch))?;
        net = next.net;
    }
    Ok((net, points))
}

pub fn values<'a>(plan: &'a Plan, step: &'a Scheduled) -> Values<'a> {
    Values {
        letter: &step.letter,
        alpha: step.alpha,
        kernel: step.kernel,
        mu: plan.mu,
        compensation: step.compensation,
        delta: &plan.delta,
        first: step.first,
        latitude_rule: plan.latitude.as_ref().map_or(LatitudeRule::Isotropic, |latitude| latitude.rule),
        sources: plan.sources(step),
    }
}

pub fn at(step: &Scheduled, error: StepError) -> RefineError {
    RefineError::Step { level: step.level, error }
}

fn ensure(finite: bool, level: u32) -> Result<(), RefineError> {
    if finite { Ok(()) } else { Err(RefineError::NotFinite { level }) }
}

/// Points of a net, `n x width`, with those that entered the last U.
#[derive(Clone)]
pub struct Points {
    pub now: Vec<f64>,
    anchor: Vec<f64>,
    /// Unit tangents, `n x width`, under plans that turn them.
    tangents: Option<Vec<f64>>,
    pub width: usize,
}

impl Points {
    pub fn new(now: Vec<f64>, width: usize) -> Self {
        Self { now, anchor: Vec::new(), tangents: None, width }
    }

    pub fn act(&mut self, action: &Action, level: u32, watch: &Watch) -> Result<(), RefineError> {
        match action {
            Action::Blend(rows) => return self.blend(false, &[&**rows], level, watch),
            Action::BlendFromAnchor(rows) => return self.blend(true, &[&**rows], level, watch),
            Action::PushBack { rows, children } => self.push_back(&**rows, children, watch)?,
            Action::Map(map) => self.map(&**map, watch)?,
            Action::Sequence(actions) => {
                return actions.iter().try_for_each(|action| self.act(action, level, watch));
            }
            Action::Keep => return Ok(()),
        }
        let finite = |numbers: &[f64]| numbers.par_chunks(CHUNK).all(|chunk| chunk.iter().all(|x| x.is_finite()));
        ensure(finite(&self.now) && self.tangents.as_deref().is_none_or(finite), level)
    }

    /// All actions of one level. Blends of rows that repeat themselves are made in one sweep, without the points between
    /// them.
    pub fn act_all(&mut self, actions: &[Action], level: u32, watch: &Watch) -> Result<(), RefineError> {
        let repeat = |action: &Action| action.rows().is_some_and(|rows| rows.pattern().is_some());
        let runs = actions.chunk_by(|a, b| repeat(a) && repeat(b) && matches!(b, Action::Blend(_)));
        runs.flat_map(|run| run.chunks(MAX_RUN)).try_for_each(|run| match run {
            [action] => self.act(action, level, watch),
            run => {
                let rows: Vec<_> = run.iter().filter_map(Action::rows).collect();
                self.blend(matches!(run[0], Action::BlendFromAnchor(_)), &rows, level, watch)
            }
        })
    }

    /// `points <- rows x points` for the rows of a run, one after another; on request what was there becomes the anchor.
    fn blend(&mut self, anchor: bool, run: &[&dyn RowSource], level: u32, watch: &Watch) -> Result<(), RefineError> {
        let next = blend_run(run, &self.now, self.width, watch)?;
        let before = std::mem::replace(&mut self.now, next.points);
        if anchor {
            self.anchor = before;
        }
        ensure(next.finite, level)
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
        let chunks = differences.par_chunks_mut(CHUNK * w).zip(children.par_chunks(CHUNK));
        chunks.for_each(|(differences, children)| {
            for (difference, &child) in differences.chunks_exact_mut(w).zip(children) {
                if child == NONE {
                    difference.fill(0.0);
                    continue;
                }
                let child = child as usize * w;
                for (d, x) in difference.iter_mut().zip(&self.now[child..child + w]) {
                    *d -= x;
                }
            }
        });
        let moves = blend(rows, &differences, w, watch)?;
        self.now.par_chunks_mut(CHUNK).zip(moves.par_chunks(CHUNK)).for_each(|(points, moves)| {
            for (x, m) in points.iter_mut().zip(moves) {
                *x += m;
            }
        });
        Ok(())
    }
}
