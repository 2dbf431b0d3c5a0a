//! Data on the vertices, edges and faces of a mesh that only words over U, C and P use.

use std::sync::Arc;

use crate::math::functions::real;
use crate::shape::attributes::Attributes;
use crate::shape::directions::Directions;
use crate::shape::numbering::Numbering;
use crate::shape::topology::Topology;

/// Vertex parameters, edge directions, and the indices in the whole net. D discards all of them.
#[derive(Debug, Clone, Default)]
pub struct Annotations {
    /// The vertex parameters.
    pub attributes: Option<Arc<Attributes>>,
    /// Directions of edges along latitude and longitude lines.
    pub directions: Option<Arc<Directions>>,
    /// The indices in the whole net, if this net is a part of one.
    pub numbering: Option<Arc<Numbering>>,
}

impl Annotations {
    /// Returns the annotations after an upsampling of `entered`, which must halve edges and make quads if there are
    /// any.
    pub(super) fn after_split(&self, entered: &Topology) -> Self {
        let upsampled = |attributes: &Arc<Attributes>| Arc::new(attributes.changed(|array| upsampled(array, entered)));
        Self {
            attributes: self.attributes.as_ref().map(upsampled),
            directions: self.directions.as_ref().map(|directions| Arc::new(directions.split(entered))),
            numbering: self.numbering.as_ref().map(|numbering| Arc::new(numbering.split(entered))),
        }
    }
}

/// Returns the values of the vertices after an upsampling of arity 2.
fn upsampled(array: &[f64], topology: &Topology) -> Vec<f64> {
    let made = (0..topology.n_edges() + topology.n_faces()).map(|i| mean(array, topology, i));
    array.iter().copied().chain(made).collect()
}

/// Returns the mean over the ends of edge `i`, or over the vertices of face `i - n_e`. The mean of equal numbers is
/// exactly that number, so that constant parameters stay constant.
pub(super) fn mean(array: &[f64], topology: &Topology, i: usize) -> f64 {
    let n_e = topology.n_edges();
    if i < n_e {
        let [a, b] = topology.ends(i);
        return f64::midpoint(array[a as usize], array[b as usize]);
    }
    let face = topology.face(i - n_e);
    let first = array[face[0] as usize];
    if face.iter().all(|&v| array[v as usize].to_bits() == first.to_bits()) {
        return first;
    }
    face.iter().map(|&v| array[v as usize]).sum::<f64>() / real(face.len())
}
