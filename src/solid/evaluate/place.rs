//! Places on the faces of a control mesh.

use crate::shape::topology::Topology;

/// A place on an input face.
///
/// A quad has one square of parameters: its corner 0 is at (0, 0), u runs towards corner 1 and v towards the last
/// corner. A face of another number of corners has a square for each of them, the quad that the first split makes
/// there: the corner is at (0, 0), u runs to the middle of the edge to the next corner, v to the middle of the edge to
/// the corner before, and the centre of the face is at (1, 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// The index of the face.
    pub face: u32,
    /// The corner whose square the place lies in; 0 on quads.
    pub corner: u32,
    /// u and v, 0 to 1.
    pub uv: [f64; 2],
}

impl Place {
    /// Returns why the place is not on a mesh, or `None` if it is: the wrong number (0 for the face, 1 for u, 2 for v,
    /// 3 for the corner), and a sentence.
    pub fn fault(&self, topology: &Topology) -> Option<(usize, String)> {
        let n_faces = topology.n_faces();
        if self.face as usize >= n_faces {
            return Some((0, format!("there is no face {}; the mesh has {n_faces}, from 0", self.face)));
        }
        for (i, x) in self.uv.iter().enumerate() {
            if !(0.0..=1.0).contains(x) {
                return Some((i + 1, format!("{x} is outside of the face; give 0 to 1")));
            }
        }
        let squares = squares(topology, self.face);
        (self.corner >= squares).then(|| match squares {
            1 => (3, format!("face {} is a quad, which has no corner but 0; leave the corner out", self.face)),
            n => (3, format!("face {} has {n} corners, from 0; there is no corner {}", self.face, self.corner)),
        })
    }
}

/// Returns the number of parameter squares of a face.
pub(super) fn squares(topology: &Topology, face: u32) -> u32 {
    match topology.half_edges(face as usize) {
        range if range.len() == 4 => 1,
        range => range.end - range.start,
    }
}
