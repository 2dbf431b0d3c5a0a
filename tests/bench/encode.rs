//! Encoding: from a refined mesh in memory to the bytes of a file in memory.

use std::hint::black_box;

use planish::math::parameter::Values;
use planish::output::scene::{Frame, Scene, Shape};
use planish::shape::source::MeshSource;
use planish::watch::Watch;

use crate::nets;
use crate::table::{Aim, Table, best, millions_a_second, ms};

pub(crate) fn measure(table: &mut Table) {
    let mesh = nets::refined(25, 4);
    let scene =
        Scene { shape: Shape::Mesh(&mesh), control: &Shape::Mesh(&mesh), warnings: &[], frame: Frame::default() };
    for name in ["obj", "glb", "ply"] {
        let format = planish::output::named(name).expect("a format of the catalogue");
        let options = Values::resolve(format.facts().parameters, &[]).expect("defaults are allowed");
        let mut bytes = Vec::new();
        let time = best(|| {
            bytes.clear();
            format.write(&scene, &options, &mut bytes, &Watch::new()).expect("a vector takes everything");
        });
        let mut copy = bytes.clone();
        let copying = best(|| {
            copy.copy_from_slice(black_box(&bytes));
            black_box(&copy);
        });
        let ratio = format!("{:.3} of copying the bytes", copying.as_secs_f64() / time.as_secs_f64());
        let detail = format!("{} vertices, {} MB in {:.0} ms", mesh.n_vertices(), bytes.len() / 1_000_000, ms(time));
        let rate = millions_a_second(bytes.len(), time);
        table.add(&format!("encode {name}"), (rate, "MB/s"), &ratio, Aim::None, &detail);
    }
}
