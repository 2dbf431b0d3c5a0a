//! Encoding: from a refined mesh in memory to the bytes of a file in memory.

use std::hint::black_box;

use planish::math::parameter::{Literal, Values};
use planish::output::scene::{CoordinateSystem, Notes, Scene, Shape};
use planish::refine::RefinedMesh;
use planish::shape::source::MeshSource;
use planish::watch::Watch;

use crate::nets;
use crate::table::{Aim, Table, best, millions_a_second, ms};

/// A format, an option that is not left at its default, and the aim in GB/s.
type Written = (&'static str, Option<(&'static str, &'static str)>, Aim);

/// What is written.
const FORMATS: &[Written] = &[
    ("obj", None, Aim::AtLeast(1.2)),
    ("json", None, Aim::None),
    ("glb", None, Aim::AtLeast(3.0)),
    ("glb", Some(("normals", "none")), Aim::AtLeast(3.0)),
    ("ply", None, Aim::AtLeast(3.0)),
    ("ply", Some(("precision", "f32")), Aim::AtLeast(3.0)),
    ("stl", None, Aim::AtLeast(3.0)),
];

pub(crate) fn measure(table: &mut Table) {
    let mesh = nets::refined(25, 4);
    for &(name, option, aim) in FORMATS {
        let with = option.map_or_else(String::new, |(name, value)| format!(" with {name} {value}"));
        written(&mesh, (name, option), table, &format!("encode {name}{with}"), aim);
    }
    // what a front end shows: 0.37 million faces
    written(&nets::refined(31, 3), ("glb", None), table, "encode glb of 5,766 faces, level 3", Aim::None);
}

fn written(mesh: &RefinedMesh, (name, option): (&str, Option<(&str, &str)>), table: &mut Table, what: &str, aim: Aim) {
    let scene = Scene {
        shape: Shape::Mesh(mesh),
        control: &Shape::Mesh(mesh),
        warnings: &[],
        coordinate_system: CoordinateSystem::default(),
        notes: &Notes::default(),
        weights: None,
        details: &[],
    };
    let format = planish::output::named(name).expect("a format of the catalogue");
    let given = option.map(|(name, value)| (name.to_owned(), Literal::Text(value.to_owned())));
    let values = Values::resolve(format.facts().parameters, given.as_slice()).expect("options of the format");
    let mut bytes = Vec::new();
    let time = best(|| {
        bytes.clear();
        format.write(&scene, &values, &mut bytes, &Watch::new()).expect("a vector takes everything");
    });
    let mut copy = bytes.clone();
    let copying = best(|| {
        copy.copy_from_slice(black_box(&bytes));
        black_box(&copy);
    });
    let ratio = format!("{:.2} of copying the bytes", copying.as_secs_f64() / time.as_secs_f64());
    let detail = format!("{} vertices, {} MB in {:.0} ms", mesh.n_vertices(), bytes.len() / 1_000_000, ms(time));
    table.add(what, (millions_a_second(bytes.len(), time) / 1e3, "GB/s"), &ratio, aim, &detail);
}
