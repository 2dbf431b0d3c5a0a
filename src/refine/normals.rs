//! Limit normals of refined vertices.

use crate::kept::Numbers;

/// Unit normals; zero at vertices without faces and where the surface has no tangent plane.
#[derive(Debug, Clone, Default)]
pub struct Normals {
    /// One normal per vertex, `n x 3`. At a vertex with several sectors it is the direction of the sum of the sectors'
    /// normals, or zero if one of them has none.
    pub of_vertices: Numbers,
    /// Normals by side at vertices with several sectors: the vertex, the vertex that follows it in a face on that side,
    /// and the normal there; sorted.
    pub sides: Vec<([u32; 2], [f64; 3])>,
}

impl Normals {
    /// Returns the number of bytes that the normals occupy.
    pub(super) fn bytes(&self) -> usize {
        let Self { of_vertices, sides } = self;
        of_vertices.len() * size_of::<f64>() + sides.capacity() * size_of::<([u32; 2], [f64; 3])>()
    }

    /// Returns the normal of vertex `v` on the side of the face in which `next` follows `v`, if `v` has several
    /// sectors.
    pub(super) fn on_side(&self, v: u32, next: u32) -> Option<[f64; 3]> {
        let found = self.sides.binary_search_by_key(&[v, next], |&(side, _)| side);
        found.ok().map(|at| self.sides[at].1)
    }
}
