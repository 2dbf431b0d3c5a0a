//! The forecast: exact counts of every level, before anything is allocated for them.

use std::sync::Arc;

use super::census::Census;
pub use super::count::Count;
use super::duals::Duals;
pub use super::duals::{MAX_BYTES, forecast_bytes};
use super::extent::Extent;
use super::mesh_net::MeshNet;
use super::operator::{Children, Role};
use super::ops::seen_valence;
use super::plan::{Plan, Scheduled};
use super::polygon_net::{PolygonNet, too_few_points};
use super::sharpness::Remaining;
use super::step_error::StepError;
use crate::fault::Fault;
use crate::shape::tile::Tile;
use crate::shape::topology::Topology;
use crate::watch::{Stopped, Watch};

/// Counts of every level of a job: entry 0 after the prefix, then one a level.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Forecast {
    /// One entry a level.
    pub levels: Vec<Count>,
    /// The largest net met between operators.
    pub peak: Count,
    /// Rows of weights to be made in all: the unit of progress.
    pub work: u128,
    /// Bytes of the topologies that a scheme of its own connectivity, or D, makes in its largest step.
    pub topology_bytes: u128,
}

/// Why there is no forecast.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ForecastError {
    /// An operator cannot be applied.
    #[error("level {level}: {error}")]
    Step {
        /// Where.
        level: u32,
        /// Why.
        error: StepError,
    },
    /// A net with duals passes the cap.
    #[error("level {level} would have more than {cap} vertices")]
    Cap {
        /// The first such level.
        level: u32,
        /// The cap.
        cap: u128,
    },
    /// What has to be made of a net to count it takes too many bytes.
    #[error(
        "level {level}: to count what D leaves along the boundary takes {bytes} bytes; at most {bound} are allowed"
    )]
    Bytes {
        /// The first such level.
        level: u32,
        /// The bytes.
        bytes: u128,
        /// The bound.
        bound: u128,
    },
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// Collects counts step by step.
pub(super) struct Tally {
    levels: Vec<Count>,
    peak: Count,
    work: u128,
    topology_bytes: u128,
}

/// Bytes for each corner of a net whose dual is made: 13 of its topology, 5 of its faces and 5 of a copy of them, and 33 of
/// the dual and its sides before they are sorted; a third of them are held with the points anyway.
const DUAL_CORNER_BYTES: u128 = 40;

impl Tally {
    pub(super) fn new(start: Count) -> Self {
        Self { levels: vec![start], peak: start, work: 0, topology_bytes: 0 }
    }

    /// The count of the last step.
    pub(super) fn last(&self) -> Count {
        self.levels.last().copied().unwrap_or_default()
    }

    pub(super) fn step(&mut self, step: &Scheduled, count: Count) {
        self.work = self.work.saturating_add(count.vertices);
        if step.letter.facts().children == Children::Dual {
            let bytes = self.last().corners.saturating_mul(DUAL_CORNER_BYTES);
            self.topology_bytes = self.topology_bytes.max(bytes);
        }
        if count.vertices > self.peak.vertices {
            self.peak = count;
        }
        let level = step.level as usize;
        while self.levels.len() <= level {
            self.levels.push(count);
        }
        self.levels[level] = count;
    }

    /// Levels that have no operator repeat the one before.
    pub(super) fn finish(self) -> Forecast {
        Forecast { levels: self.levels, peak: self.peak, work: self.work, topology_bytes: self.topology_bytes }
    }
}

/// The forecast of several polygons refined alike.
///
/// # Errors
/// When an operator cannot be applied to one of them.
pub fn of_polygons(nets: &[PolygonNet], steps: &[Scheduled]) -> Result<Forecast, ForecastError> {
    let mut sum: Option<Forecast> = None;
    for net in nets {
        let one = of_polygon(net, steps)?;
        sum = Some(match sum {
            None => one,
            Some(sum) => Forecast {
                levels: sum.levels.iter().zip(&one.levels).map(|(a, b)| a.plus(*b)).collect(),
                peak: sum.peak.plus(one.peak),
                work: sum.work.saturating_add(one.work),
                topology_bytes: 0,
            },
        });
    }
    Ok(sum.unwrap_or(Forecast { levels: vec![Count::default()], peak: Count::default(), work: 0, topology_bytes: 0 }))
}

fn of_polygon(net: &PolygonNet, steps: &[Scheduled]) -> Result<Forecast, ForecastError> {
    let mut extent = net.extent;
    let mut n = net.n as u128;
    let count = |n: u128, extent: Extent| {
        let edges = if extent == Extent::Closed { n } else { n.saturating_sub(1) };
        Count { vertices: n, edges, ..Count::default() }
    };
    let mut tally = Tally::new(count(n, extent));
    let mut duals = 0;
    for step in steps {
        if step.letter.facts().role == Role::Upsample {
            duals = 0;
        }
        if let Some(window) = step.letter.operator.window(&step.letter.settings, duals) {
            let landing = window.land(n, extent);
            (n, extent) = (landing.n, landing.extent);
        }
        duals += u32::from(step.letter.shifts());
        if n < 2 {
            let error = too_few_points(usize::try_from(n).unwrap_or(0));
            return Err(ForecastError::Step { level: step.level, error });
        }
        tally.step(step, count(n, extent));
    }
    Ok(tally.finish())
}

/// The forecast of a mesh. Nets with duals are counted up to `cap` vertices.
///
/// # Errors
/// When an operator cannot be applied, the cap is passed, what has to be made of the net to count it takes more than
/// [`MAX_BYTES`], or the watch says stop.
pub fn of_mesh(net: &MeshNet, steps: &[Scheduled], cap: u128, watch: &Watch) -> Result<Forecast, ForecastError> {
    for (i, step) in steps.iter().enumerate() {
        let operator = step.letter.operator;
        if steps[..i].iter().all(|before| before.letter.facts().name != operator.facts().name) {
            operator.admits(net).map_err(|error| ForecastError::Step { level: step.level, error })?;
        }
    }
    if steps.iter().any(|step| step.letter.facts().rebuilds) {
        return Ok(rebuilt(net, steps));
    }
    if steps.iter().any(|step| step.letter.facts().children == Children::Dual) {
        return Duals { net, steps, cap, watch }.forecast();
    }
    Ok(counted(net, steps))
}

fn counted(net: &MeshNet, steps: &[Scheduled]) -> Forecast {
    let mut count = Count::of_mesh(net);
    let sharp = net.sharpness.as_ref().map(|sharpness| sharpness.remaining(&net.mesh.base, net.rules.creasing));
    let parted = |splits, pieces| sharp.as_ref().map_or(0, |sharp| parted(sharp, splits, pieces));
    let (mut splits, mut pieces) = (0, 1_u128);
    count.parted = parted(splits, pieces);
    let mut tally = Tally::new(count);
    let mut is_quads = net.mesh.base.is_quads();
    for step in steps {
        if step.letter.facts().role == Role::Upsample {
            splits += 1;
            pieces = pieces.saturating_mul(step.letter.settings.pieces(is_quads).into());
            count = Count { parted: parted(splits, pieces), ..count.upsampled(&step.letter.settings, is_quads) };
            is_quads = true;
        }
        tally.step(step, count);
    }
    tally.finish()
}

/// The forecast of a scheme that makes a connectivity of its own.
fn rebuilt(net: &MeshNet, steps: &[Scheduled]) -> Forecast {
    let mut census = Census::of(net);
    let mut tally = Tally::new(census.count);
    let mut topology_bytes = 0;
    for step in steps {
        let before = census;
        census = step.letter.operator.census(&census);
        topology_bytes = topology_bytes.max(census.bytes().saturating_add(before.bytes()));
        tally.step(step, census.count);
    }
    Forecast { topology_bytes, ..tally.finish() }
}

/// Copies of vertices, at most, after some splits into so many pieces of an edge: one for each inner point of a sharp edge, and around its ends as many
/// as there are faces.
fn parted(sharp: &[Remaining], splits: usize, pieces: u128) -> u128 {
    let remaining = sharp[splits.min(sharp.len() - 1)];
    remaining.edges.saturating_mul(pieces - 1).saturating_add(remaining.corners)
}

/// Checks that delta has a value at every valence that the first levels of a mesh can show it.
///
/// # Errors
/// A fault naming the valence.
pub fn check_delta(plan: &Plan, topology: &Arc<Topology>) -> Result<(), Fault> {
    if plan.delta.is_constant() {
        return Ok(());
    }
    let tile = plan.tile();
    let mut valences: Vec<usize> = match tile {
        Tile::Quad => (0..topology.n_vertices()).map(|v| topology.ring(v).count()).collect(),
        Tile::Triangle => (0..topology.n_vertices()).map(|v| seen_valence(topology, tile, v)).collect(),
    };
    if tile == Tile::Quad {
        valences.extend((0..topology.n_faces()).map(|f| topology.face(f).len()));
    }
    valences.sort_unstable();
    valences.dedup();
    for valence in valences.into_iter().filter(|&n| n > 0) {
        #[expect(clippy::cast_precision_loss, reason = "valences are far below 2^52")]
        let value = plan.delta.value(valence as f64);
        if let Err(error) = value {
            return Err(Fault::new("/parameters/delta", error.to_string()));
        }
    }
    Ok(())
}
