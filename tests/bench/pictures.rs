//! Pictures: from a refined mesh in memory to PNG bytes.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use planish::math::parameter::{Literal, Values};
use planish::output::scene::{Frame, Scene, Shape};
use planish::refine::RefinedMesh;
use planish::shape::source::MeshSource;
use planish::watch::{Stage, Watch};

use crate::nets;
use crate::table::{Aim, Table, best, ms};

const SIDE: f64 = 1024.0;

pub(crate) fn measure(table: &mut Table) {
    let hundred_thousand = picture(table, "picture of 100k triangles", &nets::refined(23, 2), Aim::Below(100.0), None);
    picture(table, "picture of 1M triangles", &nets::refined(18, 4), Aim::None, Some(hundred_thousand));
}

fn picture(table: &mut Table, what: &str, mesh: &RefinedMesh, aim: Aim, smaller: Option<f64>) -> f64 {
    let png = planish::output::named("png").expect("png is a format");
    let size = ["width", "height"].map(|name| (name.to_owned(), Literal::Number(SIDE)));
    let options = Values::resolve(png.facts().parameters, &size).expect("a picture that is allowed");
    let scene = Scene { shape: Shape::Mesh(mesh), control: &Shape::Mesh(mesh), warnings: &[], frame: Frame::default() };
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
    let triangles = mesh.n_half_edges() - 2 * mesh.n_faces();
    let ratio = smaller.map_or_else(String::new, |smaller| format!("{:.2} x 100k", ms(all) / smaller));
    let detail = format!(
        "{triangles} triangles, {SIDE} x {SIDE}, {:.1} ms of it for {} KB of PNG",
        ms(encoding),
        bytes.len() / 1000
    );
    table.add(what, (ms(all), "ms"), &ratio, aim, &detail);
    let pixels_mb = SIDE * SIDE * 3.0 / 1e6;
    let detail = format!("{pixels_mb:.1} MB of pixels");
    table.add(&format!("encode png, {what}"), (pixels_mb / encoding.as_secs_f64(), "MB/s"), "", Aim::None, &detail);
    ms(all)
}
