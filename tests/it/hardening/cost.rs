//! Costs are predicted from their components: the rows that a job counts while it runs stay within the prediction.

use planish::job::limits::{Admitted, Limits};
use planish::job::run;
use planish::math::functions::{cos, sin};
use planish::watch::Watch;
use serde_json::{Value, json};

use crate::support::nets::torus;
use crate::support::parsed;

/// Number of rows per millisecond in estimates.
const ROWS_A_MS: u128 = 10_000;

fn admitted(job: &Value) -> Admitted {
    Limits::default().admit(parsed(job.to_string().as_bytes()).unwrap()).unwrap()
}

/// Returns the rows that were forecast for a job with one output, and those that were counted.
fn rows(job: &Value) -> (u128, u128) {
    let admitted = admitted(job);
    let watch = Watch::new();
    run(&admitted, &admitted.job().outputs[0], &mut std::io::sink(), &watch).unwrap();
    (ROWS_A_MS * admitted.estimate().time_ms, watch.done().into())
}

/// Fails if fewer rows were predicted than counted, or more than `factor` times as many beyond `spare` milliseconds.
fn told(job: &Value, factor: u128, spare: u128) {
    let (told, done) = rows(job);
    assert!(done <= told, "{done} rows were counted and {told} told");
    assert!(told <= factor * done + spare * ROWS_A_MS, "{told} rows were told and {done} counted");
}

fn picture(positions: &[[f64; 3]], faces: &[Vec<usize>], side: u32) -> Value {
    json!({
        "input": { "mesh": { "positions": positions, "faces": faces } },
        "outputs": [{ "format": "png", "width": side, "height": side }]
    })
}

/// Returns squares above each other, the last uppermost.
fn stacked(n: usize) -> (Vec<[f64; 3]>, Vec<Vec<usize>>) {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let height = |i: usize| 1e-6 * f64::from(u32::try_from(i).unwrap());
    let positions = (0..n).flat_map(|i| corners.map(|[x, z]| [x, height(i), -z])).collect();
    (positions, (0..n).map(|i| (4 * i..4 * i + 4).collect()).collect())
}

/// Returns points around the z axis.
fn circle(n: usize) -> Vec<[f64; 3]> {
    let angle =
        |i: usize| std::f64::consts::TAU * f64::from(u32::try_from(i).unwrap()) / f64::from(u32::try_from(n).unwrap());
    (0..n).map(|i| [cos(angle(i)), sin(angle(i)), 0.0]).collect()
}

/// Returns two points and a circle between them, joined by triangles.
fn spindle(n: usize) -> (Vec<[f64; 3]>, Vec<Vec<usize>>) {
    let mut positions = circle(n);
    positions.extend([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
    let above = (0..n).map(|i| vec![n, i, (i + 1) % n]);
    let below = (0..n).map(|i| vec![n + 1, (i + 1) % n, i]);
    (positions, above.chain(below).collect())
}

#[test]
fn h3_a_picture_of_stacked_quads_is_told_by_what_they_cover() {
    let (positions, faces) = stacked(40_000);
    told(&picture(&positions, &faces, 64), 3, 1);
}

#[test]
fn h3_a_picture_of_one_face_with_many_corners_is_told_by_its_triangles() {
    told(&picture(&circle(100_000), &[(0..100_000).collect()], 64), 3, 100);
}

#[test]
fn h3_a_picture_of_an_ordinary_mesh_is_told_as_before() {
    let mut input = torus(12, 12).input();
    input["mesh"]["positions"] = json!(
        circle(144)
            .iter()
            .enumerate()
            .map(|(i, p)| [p[0], p[1], 0.1 * f64::from(u32::try_from(i % 12).unwrap())])
            .collect::<Vec<_>>()
    );
    let job = json!({
        "input": input, "plan": { "preset": "catmull-clark" }, "levels": 3,
        "outputs": [{ "format": "png", "width": 256, "height": 256 }]
    });
    told(&job, 3, 20);
}

fn limit(n: usize, plan: &Value, normals: &str) -> Value {
    let (positions, faces) = spindle(n);
    json!({
        "input": { "mesh": { "positions": positions, "faces": faces } }, "plan": plan, "levels": 0,
        "outputs": [{ "format": "ply", "positions": "limit", "normals": normals }]
    })
}

#[test]
fn h3_limits_around_a_vertex_of_many_faces_take_as_long_as_there_are_faces() {
    let plan = json!({ "preset": "loop" });
    for normals in ["none", "limit"] {
        // tangents that are not distinct are not searched for
        let [(few_told, few), (many_told, many)] = [2_500, 10_000].map(|n| rows(&limit(n, &plan, normals)));
        assert!(few <= few_told && many <= many_told, "{few} of {few_told}, {many} of {many_told}");
        assert!(many < 5 * few && many_told < 5 * few_told, "{few} of {few_told}, {many} of {many_told}");
    }
}

#[test]
fn h3_limits_that_look_at_whole_fans_are_told_by_the_square_of_the_faces() {
    let plan = json!({ "word": "UCC", "parameters": { "split": "triangle" } });
    told(&limit(600, &plan, "none"), 3, 1_000);
    let [few, many] = [300, 1_200].map(|n| admitted(&limit(n, &plan, "none")).estimate().time_ms);
    assert!(many > 4 * few, "{few} ms, {many} ms");
}
