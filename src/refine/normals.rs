//! Normals of refined vertices, where the limit has them.

use crate::kept::Numbers;

/// Unit normals; zero where there are none: at vertices without faces, and where the surface has no tangent plane.
#[derive(Debug, Clone, Default)]
pub struct Normals {
    /// For each vertex its normal, `n x 3`, or the direction of the sum of those of its sectors, or zero where one has
    /// none.
    pub of_vertices: Numbers,
    /// At vertices with several sectors: the vertex, the next one of a face there, and the normal on that side;
    /// ascending.
    pub sides: Vec<([u32; 2], [f64; 3])>,
}

impl Normals {
    /// Bytes that they hold.
    pub(super) fn bytes(&self) -> usize {
        let Self { of_vertices, sides } = self;
        of_vertices.len() * size_of::<f64>() + sides.capacity() * size_of::<([u32; 2], [f64; 3])>()
    }

    /// The normal of vertex `v` on the side of the face in which `next` follows it, if its sides have their own.
    pub(super) fn on_side(&self, v: u32, next: u32) -> Option<[f64; 3]> {
        let found = self.sides.binary_search_by_key(&[v, next], |&(side, _)| side);
        found.ok().map(|at| self.sides[at].1)
    }
}
