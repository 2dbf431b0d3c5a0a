//! STL: loose triangles in f32, for printers and mesh tools.

use crate::fault::Fault;
use crate::kept::Kept;
use crate::math::parameter::{Default, Parameter, Values};
use crate::math::vector::{plus, unit};
use crate::output::counts::Counts;
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, Requirements};
use crate::output::hard_edges::HardEdges;
use crate::output::left_out::{Datum, left_out};
use crate::output::normals;
use crate::output::numbers::{f32_bytes, total};
use crate::output::options::{LIMIT, POSITIONS};
use crate::output::positions::Positions;
use crate::output::scene::{MeshSource, OnDemandSource, Scene, Shape, triangles};
use crate::output::size::Size;
use crate::output::split_vertices::SplitVertices;
use crate::output::stream::Stream;
use crate::output::surface::NORMALS;
use crate::shape::attachments::Attachments;
use crate::shape::mesh::Mesh;
use crate::shape::tile::Tile;

/// Bytes before the number of triangles; programs take a file that starts with "solid" for text.
const STL_HEADER: &[u8; 80] = b"planish; binary STL, units as in the model                                      ";

/// Bytes per triangle: normal, three corners, two unused bytes.
const BINARY_TRIANGLE_BYTES: u128 = 50;

/// Binary STL: the triangles with their unit normals, which are computed in f64 and zero where undefined.
#[derive(Debug)]
pub(super) struct Stl;

const FACETS: Parameter = Parameter {
    default: Default::Text("area"),
    doc: "Normals of triangles: their own, none (zeros), or the mean of those of the limit surface at their corners.",
    ..NORMALS
};

const FACTS: &FormatFacts = &FormatFacts {
    name: "stl",
    extension: "stl",
    media_type: "model/stl",
    content: Content::Binary,
    doc: "Binary STL: loose triangles with facet normals, f32",
    parameters: &[POSITIONS, FACETS],
    holds: |kind, _| kind.only_meshes("stl holds triangles only, these are curves; ask for json or obj"),
    has_no_tags: true,
    ..FormatFacts::USUAL
};

impl Format for Stl {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn streams(&self, _mesh: &Mesh, options: &Values) -> &'static [Tile] {
        if options.choice(NORMALS.name) == Some(LIMIT) { &[] } else { &[Tile::Quad] }
    }

    fn encode(&self, scene: &Scene<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        match scene.shape {
            Shape::Mesh(mesh) => write_mesh(mesh, options.choice(NORMALS.name), stream),
            Shape::Curves(_) => Err(FormatError::Unfit("stl holds triangles only; ask for json or obj".into())),
        }
    }
}

impl Requirements for Stl {
    fn leaves_out(&self, carried: &Attachments, _: &Values) -> Vec<String> {
        left_out("stl", "glb", carried, &[Datum::Channels, Datum::Uvs, Datum::Groups, Datum::Materials])
    }

    fn fits(&self, counts: &Counts, _options: &Values) -> Result<(), Fault> {
        check_triangles(n_triangles(counts)).map(drop).map_err(|detail| Fault::new("/format", detail))
    }
}

impl Costs for Stl {
    fn size(&self, counts: &Counts, _options: &Values) -> Size {
        Size::Exact(total(&[(1, STL_HEADER.len() as u128 + 4), (n_triangles(counts), BINARY_TRIANGLE_BYTES)]))
    }
}

fn n_triangles(counts: &Counts) -> u128 {
    counts.half_edges.saturating_sub(counts.faces.saturating_mul(2))
}

/// Converts a number of triangles to the 32 bits of STL.
fn check_triangles(n: u128) -> Result<u32, String> {
    let most = u32::MAX;
    u32::try_from(n).map_err(|_| format!("{n} triangles, stl counts at most {most}; ask for ply or obj"))
}

fn write_mesh(mesh: &dyn MeshSource, normals: Option<&str>, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let watch = stream.watch;
    let n = check_triangles(mesh.n_half_edges() as u128 - 2 * mesh.n_faces() as u128).map_err(FormatError::Unfit)?;
    if let Some(source) = mesh.on_demand() {
        return write_on_demand(mesh, source, n, normals, stream);
    }
    let at_limit = normals == Some(LIMIT);
    let split_vertices =
        if at_limit { SplitVertices::of(Shape::Mesh(mesh), &HardEdges::default(), watch)? } else { None };
    let mesh = split_vertices.as_ref().map_or(mesh, |split_vertices| split_vertices);
    let positions = Positions::of_mesh(mesh).within_f32().held(watch)?;
    let rows = positions.rows();
    let corners = if at_limit { normals::of(mesh, rows, watch)? } else { Kept::default() };
    let scale = normals::scale(rows);
    let at = |v: u32| rows[v as usize];
    stream.bytes(STL_HEADER)?;
    stream.bytes(&n.to_le_bytes())?;
    let write = |record: &mut StlTriangle, triangle: [u32; 3]| {
        let own = || normals::of_triangle(triangle.map(at), scale);
        let normal = match normals {
            Some("none") => [0.0; 3],
            _ if at_limit => mean(triangle.map(|v| corners[v as usize])).unwrap_or_else(own),
            _ => own(),
        };
        put(normal, triangle.map(|v| f32_bytes(at(v))), record);
    };
    stream.faces(mesh, |_, faces, out| {
        if let Some(quads) = faces.rows::<4>().filter(|_| !at_limit) {
            let pairs = out.rows(2 * quads.len()).as_chunks_mut().0;
            pairs.iter_mut().zip(quads).for_each(|(pair, quad)| put_halves(normals, quad.map(at), scale, pair));
        } else {
            let records = out.rows(faces.vertices.len() - 2 * faces.len());
            let triangles = faces.iter().flat_map(triangles);
            records.iter_mut().zip(triangles).for_each(|(record, triangle)| write(record, triangle));
        }
    })
}

/// Writes a mesh of quads whose positions are made while it is written.
fn write_on_demand(
    mesh: &dyn MeshSource,
    source: &dyn OnDemandSource,
    n_triangles: u32,
    normals: Option<&str>,
    stream: &mut Stream<'_>,
) -> Result<(), FormatError> {
    let scale = normals::scale_of(&Positions::of_mesh(mesh).within_f32().bounds(stream.watch)?);
    stream.bytes(STL_HEADER)?;
    stream.bytes(&n_triangles.to_le_bytes())?;
    stream.corners(mesh.n_faces(), source, |quads, out| {
        let pairs = out.rows(2 * quads.len()).as_chunks_mut().0;
        pairs.iter_mut().zip(quads).for_each(|(pair, quad)| put_halves(normals, *quad, scale, pair));
    })
}

/// The bytes of a triangle.
type StlTriangle = [u8; BINARY_TRIANGLE_BYTES as usize];

fn put(normal: [f64; 3], [a, b, c]: [[u8; 12]; 3], record: &mut StlTriangle) {
    let (slots, nothing) = record.as_chunks_mut();
    slots.copy_from_slice(&[f32_bytes(normal), a, b, c]);
    nothing.fill(0);
}

/// Puts the two triangles of a quad, with their own normals or none.
#[inline]
fn put_halves(normals: Option<&str>, quad: [[f64; 3]; 4], scale: f64, [first, second]: &mut [StlTriangle; 2]) {
    let [n, m] = if normals == Some("none") { [[0.0; 3]; 2] } else { normals::of_halves(quad, scale) };
    let [a, b, c, d] = quad.map(f32_bytes);
    put(n, [a, b, c], first);
    put(m, [a, c, d], second);
}

/// Returns the direction of the sum of unit normals; `None` if they cancel.
fn mean([a, b, c]: [[f64; 3]; 3]) -> Option<[f64; 3]> {
    let normal = unit(plus(plus(a, b), c));
    normal.iter().any(|&x| x != 0.0).then_some(normal)
}
