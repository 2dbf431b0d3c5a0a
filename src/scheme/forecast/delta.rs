//! Where a push-back factor would have no value.

use std::sync::Arc;

use crate::fault::Fault;
use crate::scheme::ops::seen_valence;
use crate::scheme::plan::Plan;
use crate::shape::tile::Tile;
use crate::shape::topology::Topology;

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
