//! Laws of sections of every mesh by every plane.

use std::collections::BTreeMap;

use planish::math::functions::{cos, sin};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::{Polyline, cut, dot, minus, plane, sections, unit};
use crate::support::nets::{self, Net};

/// Returns choices of planes: through a corner, the middle of an edge or of a face, or any point; across an axis, an
/// edge or any direction.
fn planes() -> impl Strategy<Value = [[usize; 2]; 2]> {
    [[0..4_usize, 0..64_usize], [0..4_usize, 0..64_usize]]
}

fn chosen(net: &Net, [[place, i], [way, j]]: [[usize; 2]; 2]) -> Option<([f64; 3], [f64; 3])> {
    let face = |i: usize| &net.faces[i % net.faces.len()];
    let vertex = |v: usize| net.positions[v];
    let middle = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| 0.5 * (a[k] + b[k]));
    let point = match place {
        0 => vertex(face(i)[i % face(i).len()]),
        1 => middle(vertex(face(i)[0]), vertex(face(i)[1])),
        2 => middle(vertex(face(i)[0]), vertex(face(i)[2])),
        _ => [0.37 * f64::from(u8::try_from(i).ok()?) - 5.0, 0.61, 0.23],
    };
    let f = face(j);
    let normal = match way {
        0 => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]][j % 4],
        1 => minus(vertex(f[0]), vertex(f[1])),
        // the plane of a triangle of the mesh
        2 => super::cross(minus(vertex(f[1]), vertex(f[0])), minus(vertex(f[2]), vertex(f[0]))),
        _ => [1.0, 0.3 * f64::from(u8::try_from(j).ok()?) - 9.0, 0.77],
    };
    normal.iter().any(|x| *x != 0.0).then_some((point, normal))
}

/// Returns the triangles of all faces, as fans from their first vertices.
fn triangles(net: &Net) -> Vec<[usize; 3]> {
    net.faces.iter().flat_map(|f| (1..f.len() - 1).map(|k| [f[0], f[k], f[k + 1]])).collect()
}

/// Whether a point lies on a segment, within the tolerance.
fn lies_on(point: [f64; 3], a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
    let (way, from) = (minus(b, a), minus(point, a));
    let share = (dot(way, from) / dot(way, way)).clamp(0.0, 1.0);
    let share = if share.is_nan() { 0.0 } else { share };
    let off = [0, 1, 2].map(|k| from[k] - share * way[k]);
    dot(off, off).sqrt() <= tolerance
}

/// Checks the laws of every mesh; returns the number of open polylines.
fn check(net: &Net, (point, normal): ([f64; 3], [f64; 3]), section: &[Polyline]) -> Result<usize, TestCaseError> {
    let largest = net.positions.iter().flatten().chain(&point).fold(1.0, |most: f64, x| most.max(x.abs()));
    // a crossing has the rounding errors of heights, which are sums of products
    let tolerance = 1e-13 * largest;
    let triangles = triangles(net);
    for polyline in section {
        let least = if polyline.closed { 3 } else { 2 };
        prop_assert!(polyline.points.len() >= least);
        prop_assert!(
            polyline.points.windows(2).all(|pair| nets::distance(&pair[0], &pair[1]) > 0.0),
            "equal neighbours: {:?}",
            polyline
        );
        prop_assert!(!polyline.closed || polyline.points.first() != polyline.points.last());
        for &p in &polyline.points {
            prop_assert!(dot(unit(normal), minus(p, point)).abs() <= tolerance, "{:?} is off the plane", p);
            let on_side = triangles
                .iter()
                .any(|t| (0..3).any(|j| lies_on(p, net.positions[t[j]], net.positions[t[(j + 1) % 3]], tolerance)));
            prop_assert!(on_side, "{:?} is on no side", p);
        }
    }
    Ok(section.iter().filter(|polyline| !polyline.closed).count())
}

/// Returns the sides with one face.
fn rim(net: &Net) -> Vec<[usize; 2]> {
    let mut sides: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for face in &net.faces {
        for j in 0..face.len() {
            let (a, b) = (face[j], face[(j + 1) % face.len()]);
            *sides.entry((a.min(b), a.max(b))).or_default() += 1;
        }
    }
    sides.into_iter().filter(|(_, n)| *n == 1).map(|((a, b), _)| [a, b]).collect()
}

/// Returns manifolds with no three vertices on one line, so that crossings of different sides are different.
fn bent() -> impl Strategy<Value = Net> {
    nets::manifold().prop_map(|mut net| {
        for (i, p) in (0_u32..).zip(&mut net.positions) {
            *p = [0, 1, 2].map(|k| p[k as usize] + 0.1 * f64::from((i * 3 + k + 1).wrapping_mul(2_654_435_761)) / 4e9);
        }
        net
    })
}

fn plans() -> Vec<Value> {
    vec![
        json!({ "input": null }),
        json!({ "plan": { "preset": "catmull-clark" }, "levels": 1 }),
        json!({ "plan": { "word": "U3C" }, "levels": 1 }),
        json!({ "plan": { "preset": "doo-sabin" }, "levels": 1 }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 192, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn polylines_are_closed_but_at_boundaries(net in nets::manifold(), choice in planes(), plan in 0..4_usize) {
        let mut job = plans().swap_remove(plan);
        job["input"] = net.input();
        let Some((point, normal)) = chosen(&net, choice) else { return Ok(()) };
        let job_is_sound = crate::support::render(&with_json(&job)).is_ok();
        prop_assume!(job_is_sound);
        let (surface, found) = cut(job, &[plane(point, normal)]);
        let open = check(&surface, (point, normal), &found[0])?;
        let rim = rim(&surface);
        prop_assert!(!rim.is_empty() || open == 0, "open polylines without a boundary");
        for polyline in found[0].iter().filter(|polyline| !polyline.closed) {
            for end in [polyline.points[0], polyline.points[polyline.points.len() - 1]] {
                let on_rim = |[a, b]: &[usize; 2]| lies_on(end, surface.positions[*a], surface.positions[*b], 1e-12);
                prop_assert!(rim.iter().any(on_rim), "{:?} is an end inside", end);
            }
        }
    }

    /// The plane avoids vertices, and no two sides are on one line, so that rounding decides nothing: every side with
    /// ends on both sides of the plane is crossed once, by one polyline.
    #[test]
    fn every_crossing_side_is_met_once(net in bent(), normal in [-1.0..1.0_f64, -1.0..1.0, 0.5..1.0]) {
        let point = [0.613, 0.287, 0.459];
        let height = |v: usize| dot(normal, minus(net.positions[v], point));
        prop_assume!((0..net.positions.len()).all(|v| height(v).abs() > 1e-6) && !folded(&net));
        let sides: std::collections::BTreeSet<(usize, usize)> = triangles(&net)
            .iter()
            .flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
            .map(|(a, b)| (a.min(b), a.max(b)))
            .collect();
        let crossed = sides.iter().filter(|(a, b)| (height(*a) > 0.0) != (height(*b) > 0.0)).count();
        let found = sections(&net, &[plane(point, normal)]);
        let met: usize = found[0].iter().map(|polyline| polyline.points.len()).sum();
        prop_assert_eq!(met, crossed);
    }

    #[test]
    fn sections_move_with_the_mesh(
        net in bent(),
        angle in -3.0..3.0_f64,
        shift in [-5.0..5.0_f64, -5.0..5.0, -5.0..5.0],
    ) {
        let turn = |[x, y, z]: [f64; 3]| {
            let (s, c) = (sin(angle), cos(angle));
            // about z, then the axes in another order
            [z, c * x - s * y, s * x + c * y]
        };
        let moved = |p: [f64; 3]| [0, 1, 2].map(|k| turn(p)[k] + shift[k]);
        let (point, normal) = ([0.613, 0.287, 0.459], [0.31, -0.24, 0.9]);
        prop_assume!(net.positions.iter().all(|&p| dot(normal, minus(p, point)).abs() > 1e-6));
        let there = Net { positions: net.positions.iter().map(|&p| moved(p)).collect(), faces: net.faces.clone() };
        let here = sections(&net, &[plane(point, normal)]);
        let there = sections(&there, &[plane(moved(point), turn(normal))]);
        prop_assert_eq!(here[0].len(), there[0].len());
        for (a, b) in here[0].iter().zip(&there[0]) {
            prop_assert_eq!((a.closed, a.points.len()), (b.closed, b.points.len()));
            for (&p, q) in a.points.iter().zip(&b.points) {
                prop_assert!(nets::distance(&moved(p), q) < 1e-12, "{:?} is not {:?}", moved(p), q);
            }
        }
    }
}

/// Whether a diagonal of a face joins vertices that another edge or diagonal joins as well.
fn folded(net: &Net) -> bool {
    let mut pairs = net.edges();
    let diagonals = net.faces.iter().flat_map(|face| face[2..face.len() - 1].iter().map(|&end| (face[0], end)));
    let fresh = diagonals.map(|(a, b)| pairs.insert((a.min(b), a.max(b)))).collect::<Vec<_>>();
    fresh.contains(&false)
}

fn with_json(job: &Value) -> Value {
    let mut job = job.clone();
    job["outputs"] = json!([{ "format": "json" }]);
    job
}

#[test]
fn a_plane_and_its_multiples_have_one_key() {
    let job = |normal: [f64; 3]| {
        let output = json!({ "format": "json", "sections": [plane([0.5; 3], normal)] });
        let text = json!({ "input": nets::cube().input(), "outputs": [output] }).to_string();
        let job = crate::support::parsed(text.as_bytes()).expect("a job");
        job.keys()[0]
    };
    assert_eq!(job([1.0, -2.0, 4.0]), job([0.5, -1.0, 2.0]));
    assert_eq!(job([0.0, 0.0, 3.0]), job([0.0, -0.0, 0.1]));
    assert_ne!(job([1.0, -2.0, 4.0]), job([-1.0, 2.0, -4.0]));
    assert_ne!(job([1.0, -2.0, 4.0]), job([1.0, -2.0, 4.5]));
}
