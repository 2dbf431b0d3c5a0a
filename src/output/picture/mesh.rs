//! A picture of a mesh: its surface, the edges of its faces, and the control net.

use std::borrow::Cow;

use rayon::prelude::*;

use super::coat::Coat;
use super::options::Options;
use crate::math::vector::unit;
use crate::output::error::FormatError;
use crate::output::hard_edges::HardEdges;
use crate::output::normals;
use crate::output::scene::{FaceChunk, MeshSource, Scene, Shape, in_chunks, triangles};
use crate::output::split_vertices::SplitVertices;
use crate::raster::{Crowding, Model, Normals, Strokes, Surface, render};
use crate::watch::{Stopped, Watch};

pub(super) const DEFAULT_SHOW: &[&str] = &["surface"];
const SURFACE: [u8; 4] = [112, 160, 222, 255];
const WIRE: [u8; 4] = [22, 38, 66, 255];
const CONTROL: [u8; 4] = [217, 93, 57, 255];
const POINT: [u8; 4] = [176, 58, 32, 255];

/// Rows of red, green, blue and alpha (straight), from the top.
pub(crate) fn picture(
    scene: &Scene<'_>,
    mesh: &dyn MeshSource,
    options: &Options<'_>,
    watch: &Watch,
) -> Result<Vec<u8>, FormatError> {
    let shows = |item| options.shows(item, DEFAULT_SHOW);
    let body = shows("surface") || shows("wireframe") || shows("isolines");
    let shaded = shows("surface") && !options.flat();
    let hard = if shaded { HardEdges::of(scene.shape, options.values, watch)? } else { HardEdges::default() };
    let split_vertices = if shaded { SplitVertices::of(scene.shape, &hard, watch)? } else { None };
    // copies of vertices stand after all others, so that the edges of the mesh are the same ones
    let sides = split_vertices.as_ref().map_or(mesh, |split_vertices| split_vertices);
    let positions = if body { positions(sides, watch)? } else { Cow::default() };
    let triangles = if body { triangulated(sides, watch)? } else { Vec::new() };
    let smooth = if shaded { normals::of(sides, &positions, watch)? } else { Vec::new() };
    let flat = if shows("surface") && options.flat() { face_normals(mesh, &positions, watch)? } else { Vec::new() };
    let coat = if shows("surface") { Some(Coat::of(sides, options, options.color(SURFACE), watch)?) } else { None };
    let wires = if shows("wireframe") { edges(mesh, watch)? } else { Vec::new() };
    let isolines = if shows("isolines") { isolines(mesh, watch)? } else { Vec::new() };
    let net = match scene.control.shape() {
        Shape::Mesh(net) if shows("control") || shows("points") => Net::of(net, watch)?,
        _ => Net::default(),
    };
    let unit = options.unit_px();
    let ring = options.background;
    let ring = if ring[3] == 255 { ring } else { [255; 4] };
    let room = options.room(net.positions.len());
    let (thin, small) = (room.min(25.0) * 0.08, room.min(32.0) * 0.25);
    let line = |positions, segments, width: f32, color| Strokes {
        positions,
        segments,
        width_px: width * unit,
        color,
        crowding: Crowding::Keep,
    };
    let mut strokes = Vec::new();
    if shows("wireframe") {
        strokes.push(Strokes { crowding: Crowding::Fade, ..line(&positions[..], &wires[..], 1.3, WIRE) });
    }
    if shows("isolines") {
        strokes.push(line(&positions, &isolines, 2.2, WIRE));
    }
    if shows("control") {
        strokes.push(line(&net.positions, &net.edges, thin, CONTROL));
    }
    if shows("points") {
        strokes.push(line(&net.positions, &net.points, 1.31 * small, ring));
        strokes.push(line(&net.positions, &net.points, small, POINT));
    }
    let model = Model {
        positions: &positions,
        triangles: &triangles,
        normals: if options.flat() { Normals::Triangles(&flat) } else { Normals::Vertices(&smooth) },
        surface: coat.as_ref().map_or(Surface::Unseen, Coat::surface),
        strokes: &strokes,
    };
    let camera = options.camera(&[&positions, &net.positions]);
    Ok(render(&model, &camera, options.background, options.size, watch)?.bytes)
}

/// The control net: its points, edges and, for discs, each used point joined to itself.
#[derive(Default)]
struct Net<'a> {
    positions: Cow<'a, [[f64; 3]]>,
    edges: Vec<[u32; 2]>,
    points: Vec<[u32; 2]>,
}

impl<'a> Net<'a> {
    fn of(mesh: &'a dyn MeshSource, watch: &Watch) -> Result<Self, Stopped> {
        let positions = positions(mesh, watch)?;
        let n = u32::try_from(positions.len()).expect("indices of vertices have 32 bits");
        Ok(Self { positions, edges: edges(mesh, watch)?, points: (0..n).map(|i| [i, i]).collect() })
    }
}

/// The positions of all vertices: those that the mesh holds, or read at once.
fn positions<'a>(mesh: &'a dyn MeshSource, watch: &Watch) -> Result<Cow<'a, [[f64; 3]]>, Stopped> {
    if let Some(held) = mesh.held_positions() {
        return Ok(held.into());
    }
    let mut all = Vec::with_capacity(mesh.n_vertices());
    let mut chunk = Vec::new();
    in_chunks(mesh.n_vertices(), |range| {
        watch.check()?;
        mesh.positions(range, &mut chunk);
        all.extend_from_slice(&chunk);
        Ok(())
    })?;
    Ok(all.into())
}

fn each_face(mesh: &dyn MeshSource, watch: &Watch, mut each: impl FnMut(&[u32])) -> Result<(), Stopped> {
    let mut chunk = FaceChunk::default();
    in_chunks(mesh.n_faces(), |range| {
        watch.check()?;
        mesh.faces(range, &mut chunk);
        chunk.iter().for_each(&mut each);
        Ok(())
    })
}

/// Faces that one thread cuts into triangles at a time.
/// Half of it asks the mesh twice as often; twice of it leaves small meshes to fewer threads.
const PART: usize = 4096;

fn triangulated(mesh: &dyn MeshSource, watch: &Watch) -> Result<Vec<[u32; 3]>, Stopped> {
    let n_faces = mesh.n_faces();
    let mut all = vec![[0; 3]; mesh.n_half_edges().saturating_sub(2 * n_faces)];
    // where all faces have equally many vertices, as after any split, each part has as many triangles as this
    let share = PART * (all.len() / n_faces.max(1)).max(1);
    let cut = |chunk: &mut FaceChunk, (i, places): (usize, &mut [[u32; 3]])| {
        watch.check()?;
        mesh.faces(n_faces.min(i * PART)..n_faces.min((i + 1) * PART), chunk);
        if let Some(quads) = chunk.rows::<4>().filter(|quads| 2 * quads.len() == places.len()) {
            let halves = places.as_chunks_mut().0.iter_mut().zip(quads);
            halves.for_each(|(halves, &[a, b, c, d])| *halves = [[a, b, c], [a, c, d]]);
            return Ok(true);
        }
        let mut places = places.iter_mut();
        let mut put = |triangle| places.next().map(|place| *place = triangle).is_some();
        Ok(chunk.iter().flat_map(triangles).all(&mut put) && places.len() == 0)
    };
    let parts = all.par_chunks_mut(share).enumerate();
    let fitting: Vec<bool> = parts.map_init(FaceChunk::default, cut).collect::<Result<_, Stopped>>()?;
    if fitting.contains(&false) {
        all.clear();
        each_face(mesh, watch, |face| all.extend(triangles(face)))?;
    }
    Ok(all)
}

/// Each edge of the shown faces once.
fn edges(mesh: &dyn MeshSource, watch: &Watch) -> Result<Vec<[u32; 2]>, Stopped> {
    let mut keys: Vec<[u32; 2]> = Vec::with_capacity(mesh.n_half_edges());
    each_face(mesh, watch, |face| {
        let next = face.iter().cycle().skip(1);
        keys.extend(face.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)]));
    })?;
    keys.par_sort_unstable();
    keys.dedup();
    Ok(keys)
}

/// The pieces of the edges of the input beside which a face is shown.
fn isolines(mesh: &dyn MeshSource, watch: &Watch) -> Result<Vec<[u32; 2]>, Stopped> {
    let mut pieces = Vec::new();
    let mut line = Vec::new();
    in_chunks(mesh.input_cells()[1], |range| {
        watch.check()?;
        for edge in range {
            if mesh.isoline(edge, &mut line) {
                pieces.extend(line.windows(2).map(|pair| [pair[0], pair[1]]));
            }
        }
        Ok(())
    })?;
    Ok(pieces)
}

/// For each triangle the normal of its face, by Newell's sum of cross products; of length one or zero.
fn face_normals(mesh: &dyn MeshSource, positions: &[[f64; 3]], watch: &Watch) -> Result<Vec<[f64; 3]>, Stopped> {
    let mut all = Vec::with_capacity(mesh.n_half_edges().saturating_sub(2 * mesh.n_faces()));
    each_face(mesh, watch, |face| {
        let normal = unit(normals::area_vector(face, positions, 1.0));
        all.extend(triangles(face).map(|_| normal));
    })?;
    Ok(all)
}
