//! Hard edges: edges whose faces meet at more than an angle, and on whose two sides normals differ.

use rayon::prelude::*;

use super::error::FormatError;
use super::normals;
use super::positions::Positions;
use super::scene::{FaceChunk, MeshSource, Shape, each_chunk, in_chunks};
use crate::math::functions::sin;
use crate::math::parameter::{Default, Parameter, Value, Values};
use crate::math::vector::{dot, unit};
use crate::output::counts::Counts;
use crate::watch::{Stopped, Watch};

/// The angle from which edges are hard.
pub(super) const CREASE_ANGLE: Parameter = Parameter::number(
    "crease_angle",
    [0.0, LARGEST_ANGLE],
    Default::Absent,
    "Edges of a mesh whose faces meet at more than this angle look hard: normals differ on their two sides. 180 \
     leaves that to sharp edges alone. Left out, 180 where the plan makes a smooth surface, and 30 where it does \
     not, as at level 0.",
)
.in_unit("degrees");

/// The largest angle at which faces meet, degrees.
const LARGEST_ANGLE: f64 = 180.0;

/// The default angle for meshes that no plan makes smooth, degrees. At half of it cylinders of 16 sides are faceted; at
/// twice of it prisms of six sides are not: a nut is smooth.
const FACET_ANGLE: f64 = 30.0;

/// Minimum distance of the cosine between two faces below the cosine of the angle: a prism of twelve sides, whose
/// coordinates were rounded to f32, meets its neighbours at 30 degrees all around or nowhere, and faces of one plane at
/// 0 degrees. At half of it the coordinates may be half as far from the truth, at twice of it twice; edges that meet at
/// less than 0.08 degrees are never hard.
const COSINE_SLACK: f64 = 1e-6;

/// Bytes per half-edge of a mesh with hard edges: each side of an edge with its face (12) and the ends of a hard one
/// (8), a share of the normal of its face (8), the data of the corner (24), the place of a copy of its vertex (16), and
/// that copy with its position and normal, which are gathered, too (4 and 3 times 24).
const HARD_CORNER_BYTES: u128 = 144;

/// Sets the effective angle in the options of an output of a mesh, if they have one: absent if no angle is larger, or
/// if the output has no normals.
pub fn settle(options: &mut Values, makes_smooth: bool) {
    let has_normals = options.choice("normals") != Some("none") && options.choice("shading") != Some("flat");
    let otherwise = if makes_smooth { LARGEST_ANGLE } else { FACET_ANGLE };
    let angle = options.number(CREASE_ANGLE.name).unwrap_or(otherwise);
    let counts = has_normals && angle < LARGEST_ANGLE;
    options.set(&CREASE_ANGLE, if counts { Value::Number(angle) } else { Value::Absent });
}

/// Returns the maximum number of vertices that are added at sharp or hard edges.
pub(super) fn split_vertices(counts: &Counts, options: &Values) -> u128 {
    if angle(options).is_some() { counts.half_edges } else { counts.split_vertices }
}

/// Returns the memory for hard edges, bytes.
pub(super) fn memory(counts: &Counts, options: &Values) -> u128 {
    angle(options).map_or(0, |_| counts.half_edges.saturating_mul(HARD_CORNER_BYTES))
}

/// Returns the angle from which edges are hard, degrees, if there is one.
pub(super) fn angle(options: &Values) -> Option<f64> {
    options.number(CREASE_ANGLE.name)
}

/// The ends of hard edges, the lower first, ascending.
#[derive(Debug, Default)]
pub(super) struct HardEdges(Vec<[u32; 2]>);

impl HardEdges {
    /// Finds the hard edges of a shape: edges between two faces with normals `n` and `m` (Newell's, of length 1) if
    /// `n . m` is below the cosine of the angle by more than [`COSINE_SLACK`], and edges of more than two faces. Edges
    /// of faces without area are not hard.
    ///
    /// # Errors
    /// A stopped watch, or positions that are not finite.
    pub(super) fn of(shape: Shape<'_>, options: &Values, watch: &Watch) -> Result<Self, FormatError> {
        let (Shape::Mesh(mesh), Some(angle)) = (shape, angle(options)) else { return Ok(Self::default()) };
        let (normals, sides) = faces(mesh, watch)?;
        // the sine of the complement, which is exact at 0 and 90 degrees
        let cosine = sin((90.0 - angle) * (std::f64::consts::PI / 180.0)) - COSINE_SLACK;
        let has_area = |normal: [f64; 3]| normal.iter().any(|&x| x != 0.0);
        let is_hard = |[n, m]: [[f64; 3]; 2]| has_area(n) && has_area(m) && dot(n, m) < cosine;
        let edges = sides.chunk_by(|a, b| a[..2] == b[..2]).filter(|sides| match sides {
            [_] => false,
            [[.., f], [.., g]] => is_hard([f, g].map(|&face| normals[face as usize])),
            _ => true,
        });
        Ok(Self(edges.map(|sides| [sides[0][0], sides[0][1]]).collect()))
    }

    /// Returns the same edges in `unfolded`, a mesh with the same faces in the same order and with copies of some
    /// vertices of `mesh`.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub(super) fn among(
        &self,
        mesh: &dyn MeshSource,
        unfolded: &dyn MeshSource,
        watch: &Watch,
    ) -> Result<Self, Stopped> {
        let mut edges = Vec::new();
        let (mut here, mut there) = (FaceChunk::default(), FaceChunk::default());
        in_chunks(if self.0.is_empty() { 0 } else { mesh.n_faces() }, |range| {
            watch.check()?;
            mesh.faces(range.clone(), &mut here);
            unfolded.faces(range, &mut there);
            let pairs = here.iter().zip(there.iter()).flat_map(|(here, there)| edges_of(here).zip(edges_of(there)));
            edges.extend(pairs.filter(|(edge, _)| self.0.binary_search(edge).is_ok()).map(|(_, edge)| edge));
            Ok::<_, Stopped>(())
        })?;
        edges.par_sort_unstable();
        edges.dedup();
        Ok(Self(edges))
    }

    /// Returns these and the sharp edges, ascending.
    pub(super) fn and(&self, sharp: Vec<[u32; 2]>) -> Vec<[u32; 2]> {
        let mut all: Vec<[u32; 2]> = sharp.into_iter().map(|[a, b]| [a.min(b), a.max(b)]).collect();
        all.extend_from_slice(&self.0);
        all.par_sort_unstable();
        all
    }
}

/// Returns the edges of a face, the lower end of each first.
pub(super) fn edges_of(face: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    face.iter().zip(face.iter().cycle().skip(1)).map(|(&a, &b)| [a.min(b), a.max(b)])
}

/// A side of an edge: its ends, the lower first, and its face.
pub(super) type EdgeSide = [u32; 3];

/// Returns the unit normals of all faces, and the sides of all edges, ascending.
pub(super) fn faces(mesh: &dyn MeshSource, watch: &Watch) -> Result<(Vec<[f64; 3]>, Vec<EdgeSide>), FormatError> {
    let positions = Positions::of_mesh(mesh).held(watch)?;
    let scale = normals::scale(positions.rows());
    let mut normals = Vec::with_capacity(mesh.n_faces());
    let mut sides = Vec::with_capacity(mesh.n_half_edges());
    each_chunk(mesh, watch, |range, chunk| {
        let faces: Vec<&[u32]> = chunk.iter().collect();
        let normal = |&face: &&[u32]| unit(normals::area_vector(face, positions.rows(), scale));
        normals.par_extend(faces.par_iter().map(normal));
        for (f, face) in range.zip(faces) {
            let f = crate::shape::topology::index(f);
            sides.extend(edges_of(face).map(|[a, b]| [a, b, f]));
        }
    })?;
    sides.par_sort_unstable();
    Ok((normals, sides))
}
