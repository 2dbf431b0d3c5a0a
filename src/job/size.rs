//! What an input holds in memory.

use super::Input;

impl Input {
    /// Bytes that the input holds in memory, roughly.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Polygons(polygons) => 64 * polygons.iter().map(|polygon| polygon.len() as u64).sum::<u64>(),
            Self::Mesh(mesh) => 160 * (mesh.topology.n_vertices() + mesh.topology.n_edges()) as u64,
        }
    }
}
