//! Sections of solids with known results.

use planish::math::functions::{cos, sin};
use serde_json::json;

use super::{Polyline, area, cut, plane, sections};
use crate::support;
use crate::support::nets::{self, Net};

const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// Returns the unit cube.
fn cube() -> Net {
    let positions = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
    Net { positions, ..nets::cube() }
}

fn closed(points: &[[f64; 3]]) -> Polyline {
    Polyline { points: points.to_vec(), closed: true }
}

#[test]
fn a_cube_is_cut_in_a_square_that_starts_at_its_lowest_edge_and_has_the_inside_on_its_left() {
    // across edges 0-4, 0-5 (a diagonal), 1-5, 1-7 (a diagonal), 2-6, ...
    let found = sections(&cube(), &[plane([7.0, -3.0, 0.25], [0.0, 0.0, 8.0])]);
    let [square] = found[0].as_slice() else { panic!("{found:?}") };
    assert_eq!(square.points[..3], [[0.0, 0.0, 0.25], [0.25, 0.0, 0.25], [1.0, 0.0, 0.25]]);
    assert_eq!((square.points.len(), square.closed), (8, true));
    assert!((area(&found[0], Z) - 1.0).abs() < 1e-15);
    // seen from the other side, the section is reversed
    let behind = sections(&cube(), &[plane([0.0, 0.0, 0.25], [0.0, 0.0, -1.0])]);
    assert!((area(&behind[0], [0.0, 0.0, -1.0]) - 1.0).abs() < 1e-15);
    assert!((area(&behind[0], Z) + 1.0).abs() < 1e-15);
}

#[test]
fn a_vertex_on_the_plane_counts_as_before_it() {
    let outline = closed(&[[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]]);
    // the top face lies in the plane, with the cube just behind it; behind the bottom face there is nothing
    let found = sections(&cube(), &[plane([0.0, 0.0, 1.0], Z), plane([0.0; 3], Z)]);
    assert_eq!(found, [vec![outline], vec![]]);
    // through two opposite edges
    let found = sections(&cube(), &[plane([0.0; 3], [1.0, -1.0, 0.0])]);
    assert_eq!(found[0].len(), 1);
    assert!(found[0][0].closed);
    assert!((area(&found[0], [1.0, -1.0, 0.0]) - 2_f64.sqrt()).abs() < 1e-15);
    // touching an edge, a corner
    let touching = [plane([1.0, 1.0, 0.0], [1.0, 1.0, 0.0]), plane([1.0; 3], [1.0; 3])];
    assert_eq!(sections(&cube(), &touching), [vec![], vec![]]);
}

#[test]
fn a_plane_beside_the_mesh_gives_an_empty_list() {
    let planes = [plane([0.0, 0.0, 2.0], Z), plane([0.0, 0.0, 0.5], Z), plane([0.0, 0.0, -1e300], Z)];
    let found = sections(&cube(), &planes);
    assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [0, 1, 0]);
}

#[test]
fn open_meshes_and_holes_leave_open_polylines() {
    // without its top and bottom faces the cube is a tube, cut lengthwise in two lines
    let mut tube = cube();
    tube.faces.drain(0..2);
    let across = plane([0.5, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let check = |found: &[Polyline]| {
        assert_eq!(found.len(), 2, "{found:?}");
        for polyline in found {
            assert!(!polyline.closed);
            let ends = [polyline.points[0][2], polyline.points[polyline.points.len() - 1][2]];
            assert_eq!(ends.map(f64::to_bits).iter().min(), Some(&0.0_f64.to_bits()), "{polyline:?}");
            assert_eq!(ends.map(f64::to_bits).iter().max(), Some(&1.0_f64.to_bits()), "{polyline:?}");
        }
    };
    check(&sections(&tube, std::slice::from_ref(&across))[0]);
    let mut holed = cube().to_json();
    holed["holes"] = json!([0, 1]);
    let (_, found) = cut(json!({ "input": { "mesh": holed } }), &[across]);
    check(&found[0]);
}

#[test]
fn the_hole_of_a_torus_runs_the_other_way_round() {
    let at = |i: u32, n: u32| f64::from(i) * std::f64::consts::TAU / f64::from(n);
    let point = |i: u32, j: u32| {
        let (u, v) = (at(i, 24), at(j, 12));
        let r = 3.0 + cos(v);
        [r * cos(u), r * sin(u), sin(v)]
    };
    let positions = (0..12).flat_map(|j| (0..24).map(move |i| point(i, j))).collect();
    let torus = Net { positions, ..nets::torus(24, 12) };
    let found = sections(&torus, &[plane([0.0, 0.0, 0.1], Z), plane([0.0; 3], [1.0, 0.2, 0.0])]);
    let areas: Vec<f64> = found[0].iter().map(|polyline| area(std::slice::from_ref(polyline), Z)).collect();
    assert!(areas.len() == 2 && areas[0] * areas[1] < 0.0 && areas[0] + areas[1] > 0.0, "{areas:?}");
    assert_eq!(found[1].len(), 2);
    assert!(found[1].iter().all(|polyline| area(std::slice::from_ref(polyline), [1.0, 0.2, 0.0]) > 0.0));
}

/// Returns a ball of radius 1 with `n` rings of `2 n` vertices and two poles.
fn ball(n: usize) -> Net {
    let angle = |i: usize, n: usize| {
        let whole = |i: usize| f64::from(u32::try_from(i).expect("small"));
        whole(i) * std::f64::consts::PI / whole(n)
    };
    let ring = |j: usize| (0..2 * n).map(move |i| (angle(i, n), angle(j + 1, n + 1)));
    let mut positions: Vec<[f64; 3]> =
        (0..n).flat_map(ring).map(|(u, v)| [sin(v) * cos(u), sin(v) * sin(u), -cos(v)]).collect();
    positions.extend([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]);
    let at = |i: usize, j: usize| j * 2 * n + i % (2 * n);
    let mut faces: Vec<Vec<usize>> = Vec::new();
    for i in 0..2 * n {
        faces.push(vec![2 * n * n, at(i + 1, 0), at(i, 0)]);
        faces.extend((1..n).map(|j| vec![at(i, j - 1), at(i + 1, j - 1), at(i + 1, j), at(i, j)]));
        faces.push(vec![2 * n * n + 1, at(i, n - 1), at(i + 1, n - 1)]);
    }
    Net { positions, faces }
}

#[test]
fn sections_of_a_ball_are_discs() {
    // chords of pi/40 at most: a polygon inside the disc, whose area is smaller by a share of about (pi/40)^2 / 6 twice
    for (normal, height) in [(Z, 0.3), ([1.0, 2.0, -0.5], -0.6), ([0.0, 1.0, 0.0], 0.0)] {
        let length = super::dot(normal, normal).sqrt();
        let found = sections(&ball(40), &[plane(normal.map(|x| x * height / length), normal)]);
        let disc = std::f64::consts::PI * (1.0 - height * height);
        let ratio = area(&found[0], normal) / disc;
        assert!(found[0].len() == 1 && found[0][0].closed);
        assert!(ratio < 1.0 && ratio > 0.99, "{ratio}");
    }
}

#[test]
fn areas_of_sections_add_up_to_the_volume() {
    // Cavalieri; the areas are piecewise quadratic, so that the error of the midpoint rule is of the order of the
    // squared step
    let job = json!({ "input": nets::cube().input(), "plan": { "preset": "catmull-clark" }, "levels": 3 });
    let mut stats = job.clone();
    stats["outputs"] = json!([{ "format": "stats" }]);
    let stats: serde_json::Value =
        serde_json::from_slice(&support::render(&stats).expect("it can be refined").0).expect("JSON");
    let volume = stats["volume"].as_f64().expect("it is closed");
    for normal in [Z, [1.0, 2.0, 3.0], [-0.3, 1.0, 0.1]] {
        let along = super::unit(normal);
        let (from, n) = (-4.0, 512);
        let step = 8.0 / f64::from(n);
        let planes: Vec<_> =
            (0..n).map(|i| plane(along.map(|x| x * (from + (f64::from(i) + 0.5) * step)), normal)).collect();
        let sections = planes.chunks(64).flat_map(|planes| cut(job.clone(), planes).1);
        let sum: f64 = sections.map(|section| area(&section, normal) * step).sum();
        assert!((sum / volume - 1.0).abs() < 1e-3, "{sum} is not {volume}");
    }
}

#[test]
fn coordinates_of_every_magnitude_are_cut() {
    for size in [f64::MAX, 1e300, 1e6, 1e-6, 1e-300, f64::MIN_POSITIVE] {
        let positions = cube().positions.iter().map(|p| p.map(|x| (2.0 * x - 1.0) * size)).collect();
        let net = Net { positions, ..cube() };
        let planes = [plane([0.0; 3], [1.0; 3]), plane([0.25 * size, 0.0, 0.0], [1.0, 0.0, 0.0])];
        let found = sections(&net, &planes);
        assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [1, 1], "{size:e}");
        for polyline in found.iter().flatten() {
            assert!(polyline.closed, "{size:e}");
            let inside = |x: &f64| x.abs() <= size;
            assert!(polyline.points.iter().flatten().all(inside), "{size:e}: {polyline:?}");
        }
    }
}
