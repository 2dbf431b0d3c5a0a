//! Accumulator of the vertices and faces of a file, which are counted against the limits before they are stored.

use super::reader::{ReadLimits, ReadMesh};

/// Maximum number of corners of all faces: corners are numbered with 32 bits, and a refined face has several for each.
const MAX_CORNERS: usize = u32::MAX as usize / 5;

/// A mesh that is being read.
#[derive(Debug, Default)]
pub(super) struct MeshBuilder {
    /// The contents read so far.
    pub(super) mesh: ReadMesh,
    limits: ReadLimits,
}

impl MeshBuilder {
    /// Creates an empty mesh.
    pub(super) fn new(limits: &ReadLimits) -> Self {
        Self { mesh: ReadMesh::default(), limits: *limits }
    }

    /// Checks that `n` vertices are allowed.
    ///
    /// # Errors
    /// `n` exceeds the limit.
    pub(super) fn expect_vertices(&self, n: u64) -> Result<(), String> {
        at_most(self.limits.max_vertices, n, "vertices")
    }

    /// Checks that `n` faces are allowed.
    ///
    /// # Errors
    /// `n` exceeds the limit.
    pub(super) fn expect_faces(&self, n: u64) -> Result<(), String> {
        at_most(self.limits.max_faces, n, "faces")
    }

    /// Adds a vertex.
    ///
    /// # Errors
    /// The limit is reached.
    pub(super) fn vertex(&mut self, position: [f64; 3]) -> Result<(), String> {
        self.expect_vertices(self.mesh.positions.len() as u64 + 1)?;
        self.mesh.positions.push(position);
        Ok(())
    }

    /// Adds a face.
    ///
    /// # Errors
    /// The limit is reached, or the face has fewer than three vertices.
    pub(super) fn face(&mut self, vertices: &[u32]) -> Result<(), String> {
        if vertices.len() < 3 {
            return Err(format!("a face of {} vertices; a face has at least 3", vertices.len()));
        }
        self.expect_faces(self.mesh.faces.len() as u64 + 1)?;
        let corners = self.mesh.faces.n_half_edges() + vertices.len();
        if corners > MAX_CORNERS {
            return Err(format!(
                "the faces have {corners} corners or more; {MAX_CORNERS} are allowed; send a smaller mesh"
            ));
        }
        self.mesh.faces.push(vertices.iter().copied());
        Ok(())
    }
}

fn at_most(bound: u64, n: u64, what: &str) -> Result<(), String> {
    let refusal = || format!("the file has {n} {what} or more; {bound} are allowed; send a smaller mesh");
    if n <= bound { Ok(()) } else { Err(refusal()) }
}

/// Checks a vertex number against the count `n` and returns it as an index.
///
/// # Errors
/// There is no such vertex.
pub(super) fn vertex_index(vertex: u64, n: usize) -> Result<u32, String> {
    let found = u32::try_from(vertex).ok().filter(|&v| (v as usize) < n);
    found.ok_or_else(|| format!("there is no vertex {vertex}; the file has {n}, counted from 0"))
}

/// Converts a non-negative whole number below 2^32, as all indices are.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is whole and below 2^32")]
pub(super) fn whole(x: f64) -> Option<u32> {
    (x >= 0.0 && x <= f64::from(u32::MAX) && x.fract() == 0.0).then_some(x as u32)
}
