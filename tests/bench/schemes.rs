//! Every scheme on meshes at about a million faces, next to Catmull-Clark in the same run.

use std::hint::black_box;
use std::time::Duration;

use planish::refine::refine_mesh;
use planish::shape::mesh::Mesh;
use planish::shape::source::{FaceChunk, MeshSource};
use planish::watch::Watch;

use crate::nets;
use crate::table::{Aim, Table, best, millions_a_second, ms};

/// A preset, its parameters, and levels.
type Scheme = (&'static str, &'static [(&'static str, &'static str)], u32);

/// For meshes of quads.
const QUADS: &[Scheme] = &[
    ("catmull-clark", &[], 4),
    ("doo-sabin", &[], 4),
    ("kobbelt", &[], 4),
    ("repeated-averaging", &[("degree", "2")], 4),
    ("repeated-averaging", &[("degree", "5")], 4),
];
/// For meshes of triangles.
const TRIANGLES: &[Scheme] = &[("loop", &[], 5), ("butterfly", &[], 5), ("sqrt-3", &[], 6)];

pub(crate) fn measure(table: &mut Table) {
    let mut first = None;
    for (scheme, mesh) in QUADS
        .iter()
        .map(|scheme| (scheme, nets::sphere(26)))
        .chain(TRIANGLES.iter().map(|scheme| (scheme, nets::triangles(11))))
    {
        let (preset, parameters, levels) = scheme;
        let (n, time) = refined(&mesh, preset, parameters, *levels);
        let rate = millions_a_second(n, time);
        let ratio = format!("{:.2} of catmull-clark", rate / *first.get_or_insert(rate));
        let values: Vec<_> = parameters.iter().flat_map(|(name, value)| [*name, *value]).collect();
        let detail = format!("{n} faces in {:.0} ms", ms(time));
        table.add(
            format!("scheme {preset} {}", values.join(" ")).trim_end(),
            (rate, "M faces/s"),
            &ratio,
            Aim::None,
            &detail,
        );
    }
}

/// Faces, and the time from a coarse mesh to all positions and faces.
fn refined(mesh: &Mesh, preset: &str, parameters: &[(&str, &str)], levels: u32) -> (usize, Duration) {
    let (plan, steps) = nets::plan(preset, parameters, levels);
    let watch = Watch::new();
    let (mut positions, mut faces) = (Vec::new(), FaceChunk::default());
    let time = best(|| {
        let refined = refine_mesh(mesh, &plan, &steps, &watch).expect("nobody stops it");
        refined.positions(0..refined.n_vertices(), &mut positions);
        refined.faces(0..refined.n_faces(), &mut faces);
        black_box((&positions, &faces));
    });
    (faces.len(), time)
}
