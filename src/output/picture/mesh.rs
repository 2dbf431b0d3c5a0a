//! Renders a mesh in pixels: its surface, and the lines over it.

use std::borrow::Cow;

use rayon::prelude::*;

use super::contours::contours;
use super::lines::{self, MeshLines};
use super::look::SurfaceLook;
use super::options::Options;
use super::{legend, shading};
use crate::kept::Kept;
use crate::math::vector::unit;
use crate::output::error::FormatError;
use crate::output::hard_edges::HardEdges;
use crate::output::normals;
use crate::output::scene::{FaceChunk, MeshSource, Scene, each_face, positions, triangles};
use crate::output::split_vertices::SplitVertices;
use crate::raster::{Model, ShadingNormals, TriangleAppearance, render};
use crate::watch::{Stopped, Watch};

/// Renders a mesh. Returns the rows of pixels from the top, with red, green, blue and straight alpha in one byte each.
pub(crate) fn picture(
    scene: &Scene<'_>,
    mesh: &dyn MeshSource,
    options: &Options<'_>,
    watch: &Watch,
) -> Result<Kept<u8>, FormatError> {
    let shows = |item| shading::shows(options, item);
    let body = lines::shows_body(options);
    let drawn = shows("surface") && shading::is_drawing(options.values);
    let shaded = shows("surface") && !options.flat() && !drawn;
    let hard = if shaded || drawn { HardEdges::of(scene.shape, options.values, watch)? } else { HardEdges::default() };
    let split_vertices = if shaded { SplitVertices::of(scene.shape, &hard, watch)? } else { None };
    // copies of vertices come after all others, so the edges of the mesh keep their indices
    let sides = split_vertices.as_ref().map_or(mesh, |split_vertices| split_vertices);
    let positions = if body { positions(sides, watch)? } else { Cow::default() };
    let triangles = if body { triangulated(sides, watch)? } else { Kept::default() };
    let smooth = if shaded { normals::of(sides, &positions, watch)? } else { Kept::default() };
    let flat = if shows("surface") && options.flat() { face_normals(mesh, &positions, watch)? } else { Vec::new() };
    let lines = MeshLines::of(scene, mesh, options, watch)?;
    let strip = legend::width(mesh.attachments(), options, shows("surface"));
    let size = [options.size[0] - strip, options.size[1]];
    let camera = options.camera(&[&positions, lines.net_positions()], size);
    let look =
        if shows("surface") { Some(SurfaceLook::of(scene, sides, &positions, options, &camera, watch)?) } else { None };
    let contours =
        if drawn { contours(mesh, &positions, &hard.and(mesh.sharp_edges()), &camera, watch)? } else { Vec::new() };
    let strokes = lines.strokes(&positions, &contours, options);
    let model = Model {
        positions: &positions,
        triangles: &triangles,
        normals: match (drawn, options.flat()) {
            (true, _) => ShadingNormals::Planes,
            (_, true) => ShadingNormals::Triangles(&flat),
            _ => ShadingNormals::Vertices(&smooth),
        },
        surface: look.as_ref().map_or(TriangleAppearance::Unseen, SurfaceLook::surface),
        strokes: &strokes,
    };
    let pixels = render(&model, &camera, options.look(), size, watch)?.bytes;
    if strip == 0 {
        return Ok(pixels);
    }
    let scale = look.as_ref().and_then(SurfaceLook::scale);
    legend::beside(&pixels, scale, strip, mesh.attachments(), options, watch)
}

/// Number of faces that a thread cuts into triangles at a time. Half of it queries the mesh twice as often; twice of it
/// leaves small meshes to fewer threads.
const FACES_PER_TASK: usize = 4096;

fn triangulated(mesh: &dyn MeshSource, watch: &Watch) -> Result<Kept<[u32; 3]>, Stopped> {
    let n_faces = mesh.n_faces();
    let mut all = Kept::to_overwrite(mesh.n_half_edges().saturating_sub(2 * n_faces));
    // if all faces have equally many vertices, as after any split, each part has this many triangles
    let share = FACES_PER_TASK * (all.len() / n_faces.max(1)).max(1);
    let cut = |chunk: &mut FaceChunk, (i, places): (usize, &mut [[u32; 3]])| {
        watch.check()?;
        mesh.faces(n_faces.min(i * FACES_PER_TASK)..n_faces.min((i + 1) * FACES_PER_TASK), chunk);
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
        let n = all.len();
        drop(all);
        let mut all = Vec::with_capacity(n);
        each_face(mesh, watch, |face| all.extend(triangles(face)))?;
        return Ok(all.into());
    }
    Ok(all)
}

/// Returns the normal of the face of each triangle, by Newell's sum of cross products, of length one or zero.
fn face_normals(mesh: &dyn MeshSource, positions: &[[f64; 3]], watch: &Watch) -> Result<Vec<[f64; 3]>, Stopped> {
    let mut all = Vec::with_capacity(mesh.n_half_edges().saturating_sub(2 * mesh.n_faces()));
    each_face(mesh, watch, |face| {
        let normal = unit(normals::area_vector(face, positions, 1.0));
        all.extend(triangles(face).map(|_| normal));
    })?;
    Ok(all)
}
