//! Pictures: from a refined mesh in memory to PNG bytes, and where the time goes.

use std::hint::black_box;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use planish::kept::Kept;
use planish::math::parameter::{Literal, Values};
use planish::output::normals;
use planish::output::scene::{CoordinateSystem, FaceChunk, Notes, Scene, Shape, triangles};
use planish::raster::{Camera, Ground, Model, RenderStyle, ShadingNormals, TriangleAppearance, View, render};
use planish::refine::RefinedMesh;
use planish::shape::source::MeshSource;
use planish::watch::{Stage, Watch};

use crate::nets;
use crate::table::{Aim, Table, best, ms};

const SIDE: u32 = 1024;

pub(crate) fn measure(table: &mut Table) {
    picture(table, "picture of 100k triangles", &nets::refined(23, 2), 20.0);
    picture(table, "picture of 1M triangles", &nets::refined(18, 4), 60.0);
}

/// One picture, of which rendering should take less than `most_ms`; the ratio is that to copying what a picture reads
/// and writes: positions, faces and pixels.
fn picture(table: &mut Table, what: &str, mesh: &RefinedMesh, most_ms: f64) {
    let (all, encoding, n_bytes) = written(mesh);
    let n_triangles = mesh.n_half_edges() - 2 * mesh.n_faces();
    let pixels = (SIDE * SIDE) as usize;
    let read = vec![1_u8; 24 * mesh.n_vertices() + 4 * mesh.n_half_edges() + 4 * pixels];
    let mut copy = read.clone();
    let copying = best(|| {
        copy.copy_from_slice(black_box(&read));
        black_box(&copy);
    });
    let in_copies = |time: Duration| format!("{:.1} x copying it all", time.as_secs_f64() / copying.as_secs_f64());
    let detail = format!("{n_triangles} triangles, {SIDE} x {SIDE}, {} KB of PNG", n_bytes / 1000);
    table.add(what, (ms(all), "ms"), &in_copies(all), Aim::None, &detail);

    let positions = mesh.all_positions();
    let watch = Watch::new();
    let mut of_vertices = Kept::default();
    let lit = best(|| of_vertices = normals::area(mesh, &positions, &watch).expect("nobody stops it"));
    table.add(&format!("normals, {what}"), (ms(lit), "ms"), &in_copies(lit), Aim::None, "");

    let mut faces = FaceChunk::default();
    mesh.faces(0..mesh.n_faces(), &mut faces);
    let all_triangles: Vec<[u32; 3]> = faces.iter().flat_map(triangles).collect();
    let camera = Camera::framing(&View::default(), &[&positions], SIDE, SIDE);
    let model = Model {
        positions: &positions,
        triangles: &all_triangles,
        normals: ShadingNormals::Vertices(&of_vertices),
        surface: TriangleAppearance::Lit([112, 160, 222, 255]),
        strokes: &[],
    };
    let look = RenderStyle { background: [255; 4], is_fine: true, is_occluded: true, shadow: Ground::Stood };
    let drawn = best(|| {
        black_box(render(&model, &camera, look, [SIDE, SIDE], &watch)).expect("nobody stops it");
    });
    let aim = Aim::Below(most_ms);
    table.add(&format!("render, {what}"), (ms(drawn), "ms"), &in_copies(drawn), aim, "");

    let megabytes = f64::from(SIDE * SIDE * 3) / 1e6;
    let detail = format!("{:.0} MB/s of pixels", megabytes / encoding.as_secs_f64());
    table.add(&format!("encode, {what}"), (ms(encoding), "ms"), &in_copies(encoding), Aim::Below(8.0), &detail);
}

/// The time of a whole picture, that of its encoding, and the length of its bytes.
fn written(mesh: &RefinedMesh) -> (Duration, Duration, usize) {
    let png = planish::output::named("png").expect("png is a format");
    let size = ["width", "height"].map(|name| (name.to_owned(), Literal::Number(f64::from(SIDE))));
    let options = Values::resolve(png.facts().parameters, &size).expect("a picture that is allowed");
    let scene = Scene {
        shape: Shape::Mesh(mesh),
        control: &Shape::Mesh(mesh),
        warnings: &[],
        coordinate_system: CoordinateSystem::default(),
        notes: &Notes::default(),
        weights: None,
        details: &[],
    };
    let mut bytes = Vec::new();
    let mut encoding = Duration::MAX;
    let all = best(|| {
        let begun = Arc::new(Mutex::new(None));
        let watch = Watch::new();
        let noted = begun.clone();
        watch.observe(move |stage| {
            if stage == Stage::Encode {
                *noted.lock().expect("one thread") = Some(Instant::now());
            }
        });
        bytes.clear();
        png.write(&scene, &options, &mut bytes, &watch).expect("a vector takes everything");
        let begun = begun.lock().expect("one thread").expect("every picture is encoded");
        encoding = encoding.min(begun.elapsed());
    });
    (all, encoding, bytes.len())
}
