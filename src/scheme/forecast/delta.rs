//! Checks that the push-back factor has a value wherever it is needed.

use std::sync::Arc;

use crate::fault::Fault;
use crate::math::functions::real;
use crate::scheme::ops::seen_valence;
use crate::scheme::plan::Plan;
use crate::shape::tile::Tile;
use crate::shape::topology::Topology;

/// Checks that delta has a value at every valence that occurs in the first levels of a mesh.
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
        plan.delta.value(real(valence)).map_err(|error| Fault::new("/parameters/delta", error.to_string()))?;
    }
    Ok(())
}
