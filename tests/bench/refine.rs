//! Refinement: from a coarse mesh in memory to positions and quad indices in memory, in the documented order.

use std::hint::black_box;
use std::time::{Duration, Instant};

use planish::analysis::limit::{LimitRequest, refine_mesh_to_limit};
use planish::refine::refine_mesh;
use planish::shape::source::{FaceChunk, MeshSource};
use planish::watch::Watch;
use rayon::prelude::*;

use crate::nets;
use crate::table::{Aim, Table, best, millions_a_second, ms};

/// The circle-preserving parameters of push-back.
const CIRCLES: &[(&str, &str)] =
    &[("alpha", "pi/6"), ("kernel", "cos(alpha/2)"), ("compensation", "1/cos(alpha/2)"), ("delta", "1/2")];

pub(crate) fn measure(table: &mut Table) {
    for levels in 3..=6 {
        scheme(table, "catmull-clark", &[], levels, Aim::AtLeast(5.0));
    }
    for levels in 3..=6 {
        scheme(table, "push-back", CIRCLES, levels, Aim::None);
    }
}

/// The limit surface: what it costs beside the level it belongs to, and beside one more level.
pub(crate) fn measure_limits(table: &mut Table) {
    for (preset, parameters) in [("catmull-clark", &[][..]), ("push-back", CIRCLES)] {
        let (levels, mesh, watch) = (6, nets::sphere(16), Watch::new());
        let (plan, steps) = nets::plan(preset, parameters, levels);
        let (_, finer) = nets::plan(preset, parameters, levels + 1);
        let refined = best(|| drop(black_box(refine_mesh(&mesh, &plan, &steps, &watch))));
        let next = best(|| drop(black_box(refine_mesh(&mesh, &plan, &finer, &watch))));
        for (what, asked) in [
            ("positions", LimitRequest { positions: true, normals: false }),
            ("positions and normals", LimitRequest { positions: true, normals: true }),
        ] {
            let all = best(|| drop(black_box(refine_mesh_to_limit(&mesh, &plan, levels, asked, &watch))));
            let limit = all.saturating_sub(refined);
            let ratio = limit.as_secs_f64() / next.saturating_sub(refined).as_secs_f64();
            let what = format!("limit {what} of {preset}, level {levels}");
            let detail = format!("{:.0} ms after {:.0} ms of refining", ms(limit), ms(refined));
            table.add(&what, (ratio, "of one more level"), "", Aim::Below(1.5), &detail);
        }
    }
}

fn scheme(table: &mut Table, preset: &str, parameters: &[(&str, &str)], levels: u32, aim: Aim) {
    let mesh = nets::sphere(32);
    let (plan, steps) = nets::plan(preset, parameters, levels);
    let watch = Watch::new();
    let (mut positions, mut faces) = (Vec::new(), FaceChunk::default());
    let mut refining = Duration::MAX;
    let all = best(|| {
        let start = Instant::now();
        let refined = refine_mesh(&mesh, &plan, &steps, &watch).expect("nobody stops it");
        refining = refining.min(start.elapsed());
        refined.positions(0..refined.n_vertices(), &mut positions);
        refined.faces(0..refined.n_faces(), &mut faces);
        black_box((&positions, &faces));
    });
    let n = faces.len();
    let limit = best(|| touch(&mut positions, &mut faces.vertices));
    let what = format!("refine {preset}, level {levels}");
    let ratio = format!("{:.3} of filling memory", limit.as_secs_f64() / all.as_secs_f64());
    let detail = format!("{n} faces in {:.0} ms, {:.0} of them before reordering", ms(all), ms(refining));
    table.add(&what, (millions_a_second(n, all), "M faces/s"), &ratio, aim, &detail);
}

/// Writes as many bytes as the result has, into memory that was touched before.
fn touch(positions: &mut [[f64; 3]], vertices: &mut [u32]) {
    positions.par_chunks_mut(1 << 16).enumerate().for_each(|(i, chunk)| {
        #[expect(clippy::cast_precision_loss, reason = "any number will do")]
        chunk.fill([i as f64, 1.5, -2.5]);
    });
    vertices.par_chunks_mut(1 << 18).for_each(|chunk| chunk.fill(0x0102_0304));
    black_box((positions, vertices));
}
