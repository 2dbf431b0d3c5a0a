//! Bounds of faces and valences, for schemes that give a new point weights of a whole face or of all faces around a vertex.

use crate::scheme::step::StepError;
use crate::shape::topology::Topology;

/// Most vertices of a face, and most faces around a vertex: around one of n there are n new points of n weights.
const MOST: usize = 1024;

/// Whether a scheme can take all faces and vertices of a mesh.
///
/// # Errors
/// The first face or vertex that is too large.
pub(super) fn check(scheme: &'static str, topology: &Topology) -> Result<(), StepError> {
    let size = |f: usize| topology.face(f).len();
    if let Some(face) = (0..topology.n_faces()).find(|&f| size(f) > MOST) {
        return Err(StepError::LargeFace { scheme, face, size: size(face), most: MOST });
    }
    let around = |v: usize| topology.ring(v).count();
    match (0..topology.n_vertices()).find(|&v| around(v) > MOST) {
        Some(vertex) => Err(StepError::LargeRing { scheme, vertex, n: around(vertex), most: MOST }),
        None => Ok(()),
    }
}
