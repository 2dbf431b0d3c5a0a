//! The connected parts of a mesh, which become separate objects.

use crate::output::disjoint_sets::DisjointSets;
use crate::output::error::FormatError;
use crate::output::scene::{MeshSource, each_face, triangles};
use crate::watch::Watch;

/// Maximum number of parts of a mesh, each of which is an object: sheets of thousands of small parts are written, loose
/// triangles by the million are refused.
pub(super) const MAX_PARTS: usize = 10_000;

/// Bytes of memory of the parts, besides positions, per vertex and per triangle.
pub(super) const PART_VERTEX_BYTES: u128 = 24 + 16;
pub(super) const PART_TRIANGLE_BYTES: u128 = 20;

/// The parts of a mesh, in the order of their first triangles.
#[derive(Debug)]
pub(super) struct MeshParts {
    /// The vertices of each part, ascending.
    pub(super) vertices: Vec<Vec<u32>>,
    /// The triangles of each part with the number of their face.
    pub(super) triangles: Vec<Vec<([u32; 3], u32)>>,
    /// The number of each vertex within its part.
    pub(super) local: Vec<u32>,
}

impl MeshParts {
    /// Finds the parts: faces that share vertices are in one part.
    ///
    /// # Errors
    /// A stopped watch, or more than [`MAX_PARTS`] parts.
    pub(super) fn of(mesh: &dyn MeshSource, watch: &Watch) -> Result<Self, FormatError> {
        let n = mesh.n_vertices();
        let mut sets = DisjointSets::new(n);
        each_face(mesh, watch, |face| face.array_windows().for_each(|&[a, b]| sets.join(a, b)))?;
        let mut number = vec![u32::MAX; n];
        let (mut all, mut n_faces, mut is_over) = (Vec::<Vec<([u32; 3], u32)>>::new(), 0, false);
        each_face(mesh, watch, |face| {
            let slot = &mut number[sets.root(face[0]) as usize];
            if *slot == u32::MAX {
                *slot = u32::try_from(all.len()).unwrap_or(u32::MAX);
                is_over |= all.len() >= MAX_PARTS;
                if !is_over {
                    all.push(Vec::new());
                }
            }
            if let Some(part) = all.get_mut(*slot as usize) {
                part.extend(triangles(face).map(|triangle| (triangle, n_faces)));
            }
            n_faces += 1;
        })?;
        if is_over {
            let detail = format!(
                "the mesh has more than {MAX_PARTS} parts, as many as 3mf may have objects here; leave \"parts\" out"
            );
            return Err(FormatError::Unfit(detail));
        }
        let (mut vertices, mut local) = (vec![Vec::new(); all.len()], vec![0; n]);
        for v in 0..u32::try_from(n).unwrap_or(u32::MAX) {
            let part = number[sets.root(v) as usize] as usize;
            // a vertex without faces is in no part
            if let Some(part) = vertices.get_mut(part) {
                local[v as usize] = u32::try_from(part.len()).unwrap_or(u32::MAX);
                part.push(v);
            }
        }
        Ok(Self { vertices, triangles: all, local })
    }
}
