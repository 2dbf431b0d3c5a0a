//! The forecast of words with D on any mesh, in three parts.
//!
//! Until the first U nets are never larger than the input; their duals are made. From then on, where each D comes right
//! after a U that makes quads, there are closed forms (`fans`). Where several D follow each other or faces are split
//! into triangles, a collar along the boundary is refined (`collar`), which grows like the boundary, not like the mesh.
//!
//! What is made is bounded: before anything is allocated its bytes are compared with [`MAX_FORECAST_BYTES`], or with
//! what the duals of the input itself take, whichever is more. The watch is asked before each step.

use super::collar::Collar;
use super::count::Count;
use super::fans::FanCounts;
use super::tally::{Forecast, ForecastError};
use crate::scheme::extent::Ends;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Children, Role};
use crate::scheme::ops::{cannot_carry, lost_points};
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::step_error::StepError;
use crate::scheme::stepper::Stepper;
use crate::scheme::word::Word;
use crate::shape::tile::Tile;
use crate::watch::Watch;

/// Bytes that a forecast may hold: four layers, which UDD needs, along the four sides of a square of 20 million quads
/// take less than half of it.
/// Half of it promises just about what these take; twice of it takes twice as much of the memory beside the jobs.
pub const MAX_FORECAST_BYTES: u128 = 64 << 20;
/// Bytes for each corner of a net while it is split or its dual is made: 13 of the topology, 5 of its faces, and of the
/// dual 12 of the sides of edges, 20 of its own topology and 13 of lists on the way, which grow by doubling.
/// Half of it counts beyond [`MAX_FORECAST_BYTES`]; twice of it refuses forecasts of nets half as large as could be
/// counted.
const SPLIT_CORNER_BYTES: u128 = 96;
/// Layers that are kept at the end, so that no face touches both the boundary and the cut.
/// One layer, half of it, would have faces that touch both; twice of it keeps four and takes more bytes for the same
/// counts.
const LEAST_LAYERS: u32 = 2;

/// Returns the memory in bytes that the forecast of a word takes at most, for a mesh with `n_corners` face corners.
pub fn forecast_bytes(word: &Word, n_corners: usize) -> u128 {
    let has_dual = word.prefix.iter().chain(&word.cycle).any(|letter| letter.facts().children == Children::Dual);
    if has_dual { bound(n_corners) } else { 0 }
}

fn bound(n_corners: usize) -> u128 {
    MAX_FORECAST_BYTES.max(SPLIT_CORNER_BYTES * n_corners as u128)
}

/// The forecast of a word with D.
pub(super) struct Duals<'a> {
    pub(super) net: &'a MeshNet,
    pub(super) steps: &'a [Scheduled],
    pub(super) cap: u128,
    pub(super) watch: &'a Watch,
}

fn is_dual(step: &Scheduled) -> bool {
    step.letter.facts().children == Children::Dual
}

fn is_split(step: &Scheduled) -> bool {
    step.letter.facts().role == Role::Upsample
}

fn at(step: &Scheduled, error: StepError) -> ForecastError {
    ForecastError::Step { level: step.level, error }
}

impl Duals<'_> {
    /// Returns the counts of every level.
    pub(super) fn forecast(&self) -> Result<Forecast, ForecastError> {
        let mut tally = Forecast::new(Count::of_mesh(self.net));
        let first = self.steps.iter().position(is_split).unwrap_or(self.steps.len());
        let (before, after) = self.steps.split_at(first);
        let net = self.built(before, &mut tally)?;
        if after.is_empty() {
            return Ok(tally);
        }
        if let Some(tags) = net.tags.lost_by_dual
            && let Some(step) = after.iter().find(|step| is_dual(step))
        {
            return Err(at(step, cannot_carry(tags)));
        }
        if alone(after) {
            self.by_fans(&net, after, &mut tally)?;
        } else {
            self.by_collar(&net, after, &mut tally)?;
        }
        Ok(tally)
    }

    /// Refines a net by the operators themselves.
    fn built(&self, steps: &[Scheduled], tally: &mut Forecast) -> Result<MeshNet, ForecastError> {
        let mut net = self.net.clone();
        let mut count = tally.last();
        let plan = Plan::none(net.tags.boundary, Ends::default());
        let stepper = Stepper::new(&plan);
        for step in steps {
            self.watch.check()?;
            if is_split(step) || is_dual(step) {
                let next =
                    if is_split(step) { count.upsampled(&step.letter.settings, net.mesh.is_quads()) } else { count };
                self.fits(step, next.corners)?;
                // the connectivity does not depend on values
                net = stepper.next_from(&net, step, None).map_err(|error| at(step, error))?.net;
                count = Count::of_mesh(&net);
            }
            tally.step(step, count);
        }
        Ok(net)
    }

    fn by_fans(&self, net: &MeshNet, steps: &[Scheduled], tally: &mut Forecast) -> Result<(), ForecastError> {
        let mut fans = FanCounts::of(&net.mesh.base, tally.last());
        let mut lost = false;
        for step in steps {
            self.watch.check()?;
            if is_split(step) {
                let halved = step.letter.settings.pieces(fans.is_quads()) != step.letter.settings.arity();
                halved.then(|| fans.split(2));
                fans.split(step.letter.settings.arity());
                lost = false;
            } else if is_dual(step) {
                lost |= fans.dual();
            }
            self.count(step, fans.count(), lost, tally)?;
        }
        Ok(())
    }

    fn by_collar(&self, net: &MeshNet, steps: &[Scheduled], tally: &mut Forecast) -> Result<(), ForecastError> {
        let layers = layers(steps);
        let mut collar = Collar::of(&net.mesh.base, tally.last(), layers[0]).map_err(|error| at(&steps[0], error))?;
        let mut lost = false;
        for (step, layers) in steps.iter().zip(layers) {
            self.watch.check()?;
            if is_split(step) {
                collar.keep(layers).map_err(|error| at(step, error))?;
                let (tile, arity) = (step.letter.settings.tile(), step.letter.settings.arity());
                if tile == Tile::Triangle && !collar.are_all(3) {
                    return Err(self.other_faces(step));
                }
                let pieces = step.letter.settings.pieces(collar.are_all(4));
                let cells = u128::from(pieces) * u128::from(pieces);
                self.fits(step, cells.saturating_mul(collar.n_corners() as u128))?;
                (pieces != arity).then(|| collar.split(tile, 2));
                collar.split(tile, arity);
                lost = false;
            } else if is_dual(step) {
                lost |= collar.dual().map_err(|error| at(step, error))?;
            }
            self.count(step, collar.count(), lost, tally)?;
        }
        Ok(())
    }

    /// Records a count and checks it against the cap. A P changes no count, but needs all vertices of the anchor.
    fn count(&self, step: &Scheduled, count: Count, lost: bool, tally: &mut Forecast) -> Result<(), ForecastError> {
        if count.vertices > self.cap || count.corners > self.cap.saturating_mul(8) {
            return Err(ForecastError::Cap { level: step.level, cap: self.cap });
        }
        if lost && step.letter.facts().role == Role::PushBack {
            return Err(at(step, lost_points("a boundary or a valence below 3")));
        }
        tally.step(step, count);
        Ok(())
    }

    /// Checks that a net of `corners` corners may be held in memory.
    fn fits(&self, step: &Scheduled, corners: u128) -> Result<(), ForecastError> {
        let bytes = corners.saturating_mul(SPLIT_CORNER_BYTES);
        let bound = bound(self.net.mesh.base.n_half_edges());
        if bytes <= bound { Ok(()) } else { Err(ForecastError::Bytes { level: step.level, bytes, bound }) }
    }

    /// Returns the error for faces after a D that cannot be split into triangles; the faces are built to name the first
    /// one.
    fn other_faces(&self, step: &Scheduled) -> ForecastError {
        let end = self.steps.iter().position(|other| std::ptr::eq(other, step)).map_or(self.steps.len(), |i| i + 1);
        let made = self.built(&self.steps[..end], &mut Forecast::new(Count::of_mesh(self.net)));
        made.err().unwrap_or(at(step, StepError::new("only triangles are split into triangles")))
    }
}

/// Returns whether each D comes right after an upsampling that makes quads, as far as connectivity is concerned.
fn alone(steps: &[Scheduled]) -> bool {
    let mut after_split = false;
    steps.iter().all(|step| {
        if is_split(step) {
            after_split = true;
            return step.letter.settings.tile() == Tile::Quad;
        }
        let allowed = !is_dual(step) || after_split;
        after_split &= !is_dual(step);
        allowed
    })
}

/// Returns the number of layers of faces that must be known before each step, computed from the end of the schedule.
fn layers(steps: &[Scheduled]) -> Vec<u32> {
    let mut needed = LEAST_LAYERS;
    let mut layers: Vec<u32> = Vec::with_capacity(steps.len());
    for step in steps.iter().rev() {
        if is_dual(step) {
            needed = needed.saturating_add(1);
        } else if is_split(step) {
            needed = needed.div_ceil(step.letter.settings.arity()).max(LEAST_LAYERS);
        }
        layers.push(needed);
    }
    layers.reverse();
    layers
}
