//! Statistics of a mesh.

use rayon::prelude::*;
use serde_json::{Value, json};

use crate::math::vector::minus;
use crate::output::bounds::CoordinateBounds;
use crate::output::error::FormatError;
use crate::output::normals;
use crate::output::positions::Positions;
use crate::output::scene::{FaceChunk, MeshSource, in_chunks, triangles};
use crate::watch::{Stopped, Watch};

use super::connectivity::Connectivity;
use super::entries::{add_moments, bounding_box, euler, histogram};
use super::fairness;
use super::hashes::{HashedItem, PositionsHash, ShapeHash};
use super::moments::Moments;

/// Returns the statistics of a mesh, on request with a hash of its normals and with its curvature.
pub(super) fn report(
    mesh: &dyn MeshSource,
    [with_normals, with_curvature]: [bool; 2],
    watch: &Watch,
) -> Result<Value, FormatError> {
    let positions = Positions::of_mesh(mesh).held(watch)?;
    let rows = positions.rows();
    let mut bounds = CoordinateBounds::EMPTY;
    let mut positions_hash = PositionsHash::default();
    in_chunks(rows.len(), |range| {
        watch.check()?;
        bounds.add(&rows[range.clone()]);
        positions_hash.add(rows[range].as_flattened());
        Ok::<_, Stopped>(())
    })?;
    let connectivity = Connectivity::of(mesh, watch)?;
    let origin = bounds.center();
    let mut sums = sums(mesh, rows, origin, watch)?;
    let mut bytes = Vec::new();
    for &vertex in &connectivity.isolated {
        sums.hash.add(HashedItem::Vertex, std::iter::once(rows[vertex as usize].as_slice()), &mut bytes);
    }
    let closed = connectivity.closed;
    let solid = closed && sums.solid.measure != 0.0;
    let (of, moments) = if solid { ("solid", sums.solid) } else { ("surface", sums.surface) };
    let mut found = counts(mesh, &connectivity);
    found["bounding_box"] = bounding_box(&bounds);
    found["area"] = json!(sums.surface.measure);
    found["volume"] = json!(closed.then_some(sums.solid.measure + 0.0));
    add_moments(&mut found, of, &moments, origin);
    found["positions_hash"] = positions_hash.hex().into();
    if with_normals {
        let mut normals_hash = PositionsHash::default();
        normals_hash.add(normals::of(mesh, rows, watch)?.as_flattened());
        found["normals_hash"] = normals_hash.hex().into();
    }
    if with_curvature {
        fairness::add(&mut found, mesh, watch)?;
    }
    found["shape_hash"] = sums.hash.hex().into();
    Ok(found)
}

fn counts(mesh: &dyn MeshSource, connectivity: &Connectivity) -> Value {
    let (n_vertices, n_faces) = (mesh.n_vertices(), mesh.n_faces());
    json!({
        "kind": "mesh",
        "vertices": n_vertices,
        "edges": connectivity.edges,
        "faces": n_faces,
        "triangles": mesh.n_half_edges() - 2 * n_faces,
        "isolated_vertices": connectivity.isolated.len(),
        "components": connectivity.components,
        "closed": connectivity.closed,
        "boundary_edges": connectivity.boundary_edges,
        "boundary_loops": connectivity.boundary_loops,
        "euler_characteristic": euler([n_vertices, connectivity.edges, n_faces]),
        "valences": {
            "interior": histogram(&connectivity.interior_valences),
            "boundary": histogram(&connectivity.boundary_valences),
        },
        "face_sizes": histogram(&connectivity.face_sizes),
    })
}

/// Number of faces in a partial sum; another number would round differently.
const FACES_PER_SUM: usize = 4_096;

/// The sums over faces.
struct MeshSums {
    surface: Moments<3>,
    solid: Moments<3>,
    hash: ShapeHash,
}

impl MeshSums {
    const ZERO: Self = Self { surface: Moments::ZERO, solid: Moments::ZERO, hash: ShapeHash::ZERO };

    /// Returns the sums over some faces, with positions relative to `origin`.
    fn of(faces: &FaceChunk, rows: &[[f64; 3]], origin: [f64; 3]) -> Self {
        let mut sums = Self::ZERO;
        let mut bytes = Vec::new();
        for face in faces.iter() {
            sums.hash.add(HashedItem::Face, face.iter().map(|&v| rows[v as usize].as_slice()), &mut bytes);
            for triangle in triangles(face) {
                let corners = triangle.map(|v| minus(rows[v as usize], origin));
                sums.surface.add_triangle(&corners);
                sums.solid.add_cone(&corners);
            }
        }
        sums
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            surface: self.surface.plus(&other.surface),
            solid: self.solid.plus(&other.solid),
            hash: self.hash.plus(&other.hash),
        }
    }
}

fn sums(mesh: &dyn MeshSource, rows: &[[f64; 3]], origin: [f64; 3], watch: &Watch) -> Result<MeshSums, Stopped> {
    let mut sums = MeshSums::ZERO;
    in_chunks(mesh.n_faces(), |range| {
        watch.check()?;
        let starts: Vec<usize> = range.clone().step_by(FACES_PER_SUM).collect();
        let block = |faces: &mut FaceChunk, start: usize| {
            mesh.faces(start..range.end.min(start + FACES_PER_SUM), faces);
            MeshSums::of(faces, rows, origin)
        };
        let blocks: Vec<MeshSums> =
            starts.into_par_iter().map_init(FaceChunk::default, |faces, start| block(faces, start)).collect();
        sums = blocks.iter().fold(MeshSums::ZERO, |all, block| all.plus(block)).plus(&sums);
        Ok(())
    })?;
    Ok(sums)
}
