//! Plane sections of meshes: their shapes, their pictures, and the refused ones.

mod drawn;
mod laws;
mod refused;
mod solids;

use serde::Deserialize;
use serde_json::{Value, json};

use crate::support;
use crate::support::nets::Net;

/// A polyline of the JSON output.
#[derive(Debug, Clone, PartialEq, Deserialize)]
struct Polyline {
    points: Vec<[f64; 3]>,
    closed: bool,
}

fn plane(point: [f64; 3], normal: [f64; 3]) -> Value {
    json!({ "point": point, "normal": normal })
}

/// Returns the JSON output of a job without outputs, cut by planes: the surface, and the polylines of each plane.
fn cut(job: Value, planes: &[Value]) -> (Net, Vec<Vec<Polyline>>) {
    let result = support::json_with(job, &json!({ "sections": planes }));
    let sections = serde_json::from_value(result["sections"].clone()).expect("lists of polylines");
    (Net::of(&result), sections)
}

/// Returns the sections of an unrefined mesh.
fn sections(net: &Net, planes: &[Value]) -> Vec<Vec<Polyline>> {
    cut(json!({ "input": net.input() }), planes).1
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

/// Returns the area enclosed by closed polylines, positive if they run counter-clockwise as seen against the normal.
fn area(section: &[Polyline], normal: [f64; 3]) -> f64 {
    let one = |polyline: &Polyline| {
        let from = |i: usize| minus(polyline.points[i % polyline.points.len()], polyline.points[0]);
        let turns = (0..polyline.points.len()).map(|i| dot(cross(from(i), from(i + 1)), unit(normal)) / 2.0);
        turns.sum::<f64>()
    };
    section.iter().map(one).sum()
}
