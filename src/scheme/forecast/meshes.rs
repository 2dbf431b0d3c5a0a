//! The forecast of meshes.

use super::census::Census;
use super::count::Count;
use super::duals::Duals;
use super::tally::{Forecast, ForecastError};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Children, Role};
use crate::scheme::plan::Scheduled;
use crate::scheme::sharpness::Remaining;
use crate::watch::Watch;

/// Returns the forecast of a mesh. Nets with duals are counted up to `cap` vertices.
///
/// # Errors
/// When an operator cannot be applied, the cap is passed, what has to be made of the net to count it takes more than
/// [`MAX_FORECAST_BYTES`](super::duals::MAX_FORECAST_BYTES), or the watch says stop.
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
    let split_vertices = |splits, pieces| sharp.as_ref().map_or(0, |sharp| split_vertices(sharp, splits, pieces));
    let (mut splits, mut pieces) = (0, 1_u128);
    count.split_vertices = split_vertices(splits, pieces);
    let mut tally = Forecast::new(count);
    let mut is_quads = net.mesh.base.is_quads();
    for step in steps {
        if step.letter.facts().role == Role::Upsample {
            splits += 1;
            pieces = pieces.saturating_mul(step.letter.settings.pieces(is_quads).into());
            count = Count {
                split_vertices: split_vertices(splits, pieces),
                ..count.upsampled(&step.letter.settings, is_quads)
            };
            is_quads = true;
        }
        tally.step(step, count);
    }
    tally
}

/// Returns the forecast of a scheme that rebuilds the connectivity.
fn rebuilt(net: &MeshNet, steps: &[Scheduled]) -> Forecast {
    let mut census = Census::of(net);
    let mut tally = Forecast::new(census.count);
    let mut topology_bytes = 0;
    for step in steps {
        let before = census;
        census = step.letter.operator.census(&census);
        topology_bytes = topology_bytes.max(census.bytes().saturating_add(before.bytes()));
        tally.step(step, census.count);
    }
    Forecast { topology_bytes, ..tally }
}

/// Returns an upper bound of the number of vertices copied along sharp edges after some splits into `pieces` pieces:
/// one per inner point of a sharp edge, and one per face corner at its ends.
fn split_vertices(sharp: &[Remaining], splits: usize, pieces: u128) -> u128 {
    let remaining = sharp[splits.min(sharp.len() - 1)];
    remaining.edges.saturating_mul(pieces - 1).saturating_add(remaining.corners)
}
