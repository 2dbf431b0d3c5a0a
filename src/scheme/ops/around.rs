//! Refusals that several schemes on meshes have in common.

use crate::scheme::step_error::StepError;
use crate::shape::topology::Topology;

/// Most vertices of a face, and most faces around a vertex: around one of n there are n new points of n weights.
/// Half of it quarters what the largest face costs, and refuses faces of more than 512 vertices; twice of it takes four
/// million weights for one face.
const MOST: usize = 1024;

/// Whether a scheme can take all faces and vertices of a mesh.
///
/// # Errors
/// The first face or vertex that is too large.
pub(in crate::scheme) fn check(scheme: &'static str, topology: &Topology) -> Result<(), StepError> {
    let size = |f: usize| topology.face(f).len();
    if let Some(face) = (0..topology.n_faces()).find(|&f| size(f) > MOST) {
        let size = size(face);
        let found = format!("face {face} has {size} vertices; {scheme} takes at most {MOST}: split the face");
        return Err(StepError::new(found));
    }
    let around = |v: usize| topology.ring(v).count();
    match (0..topology.n_vertices()).find(|&v| around(v) > MOST) {
        Some(vertex) => {
            let bound = format!("{scheme} takes at most {MOST} around a vertex: split the vertex");
            Err(StepError::new(format!("vertex {vertex} has {} faces; {bound}", around(vertex))))
        }
        None => Ok(()),
    }
}

/// The refusal of a vertex that has two faces all around.
pub(in crate::scheme) fn two_faces(scheme: &str, vertex: usize) -> StepError {
    let found = format!("all around vertex {vertex} there are only two faces; {scheme} needs at least three there");
    StepError::new(format!("{found}: remove the vertex or split the faces"))
}

/// The refusal of what a connectivity of its own cannot carry.
pub(in crate::scheme) fn cannot_follow(scheme: &str, tags: &str) -> StepError {
    StepError::new(format!("{scheme} cannot carry {tags}, as its faces lie across several old ones; leave them out"))
}

/// The refusal of rules for a net that was just upsampled where it was not.
pub(in crate::scheme) fn not_upsampled() -> StepError {
    StepError::new("these rules are for the points of an upsampling that halved all edges")
}
