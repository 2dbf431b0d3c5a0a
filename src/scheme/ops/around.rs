//! Checks and errors that several mesh schemes share.

use crate::scheme::step_error::StepError;
use crate::shape::topology::Topology;

/// Maximum number of vertices of a face, and of faces around a vertex: one of size n has n new points with n weights
/// each. Half as many would quarter the cost of the largest face, and refuse faces of more than 512 vertices; twice as
/// many take four million weights for one face.
const MAX_AROUND: usize = 1024;

/// Checks that a scheme can handle the sizes of all faces and vertices of a mesh.
///
/// # Errors
/// The first face or vertex that is too large.
pub(in crate::scheme) fn check(scheme: &'static str, topology: &Topology) -> Result<(), StepError> {
    let size = |f: usize| topology.face(f).len();
    if let Some(face) = (0..topology.n_faces()).find(|&f| size(f) > MAX_AROUND) {
        let size = size(face);
        let found = format!("face {face} has {size} vertices; {scheme} takes at most {MAX_AROUND}: split the face");
        return Err(StepError::new(found));
    }
    let around = |v: usize| topology.ring(v).count();
    match (0..topology.n_vertices()).find(|&v| around(v) > MAX_AROUND) {
        Some(vertex) => {
            let bound = format!("{scheme} takes at most {MAX_AROUND} around a vertex: split the vertex");
            Err(StepError::new(format!("vertex {vertex} has {} faces; {bound}", around(vertex))))
        }
        None => Ok(()),
    }
}

/// Returns the error for an interior vertex with only two faces.
pub(in crate::scheme) fn two_faces(scheme: &str, vertex: usize) -> StepError {
    let found = format!("all around vertex {vertex} there are only two faces; {scheme} needs at least three there");
    StepError::new(format!("{found}: remove the vertex or split the faces"))
}

/// Returns the error for tags that a scheme with a connectivity of its own cannot carry.
pub(in crate::scheme) fn cannot_follow(scheme: &str, tags: &str) -> StepError {
    StepError::new(format!("{scheme} cannot carry {tags}, as its faces lie across several old ones; leave them out"))
}

/// Returns the error for rules that need a net right after an upsampling.
pub(in crate::scheme) fn not_upsampled() -> StepError {
    StepError::new("these rules are for the points of an upsampling that halved all edges")
}
