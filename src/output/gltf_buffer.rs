//! The binary half of glTF: f32 positions and normals, then u32 indices.

use std::io::Write;

use crate::output::bounds::Bounds;
use crate::output::numbers::{rounded, total};
use crate::output::scene::{MeshSource, Shape, triangles};
use crate::output::stream::{Positions, Stream};
use crate::output::{Counts, FormatError, ShapeKind, normals};
use crate::watch::Watch;

/// The middle of the model is moved to the origin when it is farther away than this many times half its longest side.
const FAR: f64 = 4.0;

/// Bytes of a position or a normal.
pub(super) const VECTOR: u128 = 12;

/// Bytes of three indices.
pub(super) const TRIANGLE: u128 = 12;

/// Everything that goes into the buffer, and the numbers that describe it.
pub(super) struct Buffer<'a> {
    mesh: Option<&'a dyn MeshSource>,
    /// One for the mesh or for each polygon.
    pub(super) parts: Vec<Part<'a>>,
    /// What was subtracted from all positions (model units); each coordinate is an f32, so that it can be added again
    /// without a loss.
    pub(super) center: [f64; 3],
    /// How much there is of what.
    pub(super) amounts: Amounts,
}

/// The vertices of one primitive.
pub(super) struct Part<'a> {
    positions: Positions<'a>,
    /// Where they are, in model units.
    pub(super) bounds: Bounds<3>,
    /// For a polygon whether it is closed, for a mesh nothing.
    pub(super) closed: Option<bool>,
}

impl Part<'_> {
    /// Number of vertices.
    pub(super) fn len(&self) -> usize {
        self.positions.len()
    }
}

/// Numbers of rows in the buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Amounts {
    /// Positions.
    pub(super) vertices: u128,
    /// Whether each position has a normal.
    pub(super) normals: bool,
    /// Triples of indices.
    pub(super) triangles: u128,
}

impl Amounts {
    /// The amounts for these counts; shapes without faces have no normals.
    pub(super) fn of(counts: &Counts, normals: bool) -> Self {
        let faces = if counts.kind == ShapeKind::Mesh { counts.faces } else { 0 };
        let triangles = if faces == 0 { 0 } else { counts.corners.saturating_sub(faces.saturating_mul(2)) };
        Self { vertices: counts.vertices, normals: normals && faces > 0, triangles }
    }

    /// Length of the buffer in bytes, a multiple of 4.
    pub(super) fn bytes(&self) -> u128 {
        let vectors = if self.normals { 2 } else { 1 };
        total(&[(self.vertices, vectors * VECTOR), (self.triangles, TRIANGLE)])
    }
}

impl<'a> Buffer<'a> {
    /// Measures a shape.
    ///
    /// # Errors
    /// Coordinates that f32 cannot hold, more vertices than 32-bit indices reach, or a stopped watch.
    pub(super) fn of(shape: Shape<'a>, normals: bool, watch: &Watch) -> Result<Self, FormatError> {
        let (mesh, counts, sources) = match shape {
            Shape::Mesh(mesh) => {
                let positions = Positions::of_mesh(mesh);
                let normals = normals && mesh.n_faces() > 0;
                let positions = if normals { positions.held(watch)? } else { positions };
                (Some(mesh), counts(shape), vec![(positions, None)])
            }
            Shape::Curves(curves) => {
                let positions = curves.iter().map(|curve| (Positions::of_curve(curve), Some(curve.closed)));
                (None, counts(shape), positions.collect())
            }
        };
        let mut parts = Vec::with_capacity(sources.len());
        for (positions, closed) in sources {
            let mut bounds = Bounds::EMPTY;
            positions.each_chunk(watch, |_, rows| {
                bounds.add(rows);
                Ok(())
            })?;
            parts.push(Part { positions, bounds, closed });
        }
        let center = center(&parts.iter().fold(Bounds::EMPTY, |all, part| all.joined(&part.bounds)))?;
        Ok(Self { mesh, parts, center, amounts: Amounts::of(&counts, normals) })
    }

    /// Whether it is the buffer of a mesh.
    pub(super) fn is_mesh(&self) -> bool {
        self.mesh.is_some()
    }

    /// A position as it is stored.
    pub(super) fn local(&self, position: [f64; 3]) -> [f32; 3] {
        local(position, self.center)
    }

    /// Writes all bytes.
    pub(super) fn write(&self, out: &mut dyn Write, watch: &Watch) -> Result<(), FormatError> {
        let mut stream = Stream::new(out, watch);
        for part in &self.parts {
            stream.positions(&part.positions, |_, rows, out| vectors(rows, out, |row| self.local(row)))?;
        }
        let (Some(mesh), Some(part)) = (self.mesh, self.parts.first()) else { return Ok(()) };
        if self.amounts.normals {
            let normals = normals::area(mesh, part.positions.rows(), watch)?;
            stream.rows(0, &normals, |_, rows, out| {
                vectors(rows, out, |normal| normals::or_up(normal).map(rounded));
            })?;
        }
        stream.faces(mesh, |_, face, out| {
            for triangle in triangles(face) {
                out.extend_from_slice(triangle.map(u32::to_le_bytes).as_flattened());
            }
        })
    }
}

/// The counts of a shape that is there.
fn counts(shape: Shape<'_>) -> Counts {
    match shape {
        Shape::Mesh(mesh) => Counts {
            kind: ShapeKind::Mesh,
            polygons: 1,
            control: 0,
            vertices: mesh.n_vertices() as u128,
            faces: mesh.n_faces() as u128,
            corners: mesh.n_corners() as u128,
        },
        Shape::Curves(curves) => Counts {
            kind: ShapeKind::Curves { dimension: 3 },
            polygons: curves.len() as u128,
            control: 0,
            vertices: curves.iter().map(|curve| curve.len() as u128).sum(),
            faces: 0,
            corners: 0,
        },
    }
}

/// What to subtract from all positions: the middle of the box, rounded to f32, when it is far from the origin.
fn center(bounds: &Bounds<3>) -> Result<[f64; 3], FormatError> {
    let middle = bounds.center();
    let distance = middle.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let center = if distance > FAR * bounds.half_side() { middle.map(|x| f64::from(rounded(x))) } else { [0.0; 3] };
    let corners = [bounds.min, bounds.max].map(|corner| local(corner, center));
    if !bounds.is_empty() && !(corners.as_flattened().iter().all(|x| x.is_finite())) {
        let (min, max, most) = (bounds.min, bounds.max, f32::MAX);
        let detail = format!("the model reaches from {min:?} to {max:?}, glTF holds at most {most:e}; ask for obj");
        return Err(FormatError::Unfit(detail));
    }
    Ok(center)
}

fn local(position: [f64; 3], center: [f64; 3]) -> [f32; 3] {
    [0, 1, 2].map(|k| rounded(position[k] - center[k]))
}

fn vectors(rows: &[[f64; 3]], out: &mut Vec<u8>, as_f32: impl Fn([f64; 3]) -> [f32; 3]) {
    out.resize(rows.len() * VECTOR as usize, 0);
    for (row, slot) in rows.iter().zip(out.as_chunks_mut::<{ VECTOR as usize }>().0) {
        slot.copy_from_slice(as_f32(*row).map(f32::to_le_bytes).as_flattened());
    }
}
