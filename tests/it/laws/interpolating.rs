//! Kobbelt's interpolating scheme: the tensor product of the four-point scheme, and its properties at other valences.

use planish::math::functions::{cos, sin, sqrt};
use serde_json::{Value, json};

use super::{refined, refined_mesh};
use crate::support::nets::{self, Net, distance};

const TOLERANCE: f64 = 1e-12;
/// The valence, and the double eigenvalue below 1.
const EIGENVALUES: [(usize, f64); 5] =
    [(3, 0.426_330_91), (4, 0.5), (5, 0.537_943_86), (6, 0.559_684_52), (8, 0.582_134_30)];

fn kobbelt(boundary: &str) -> Value {
    json!({ "preset": "kobbelt", "boundary": boundary })
}

fn four_point() -> Value {
    json!({ "preset": "four-point" })
}

fn whole(i: usize) -> f64 {
    f64::from(u32::try_from(i).expect("small"))
}

#[test]
fn a_grid_is_the_tensor_product_of_the_clamped_four_point_scheme() {
    for (n, m) in [(1, 1), (3, 2), (4, 4)] {
        let net = nets::grid(n, m);
        let fine = refined_mesh(&net, &kobbelt("edge-and-corner"), 2);
        let row = |points: &[[f64; 3]]| refined(points, false, &four_point(), 2);
        let rows: Vec<Vec<[f64; 3]>> = net.positions.chunks(n + 1).map(row).collect();
        let column = |i: usize| row(&rows.iter().map(|row| row[i]).collect::<Vec<_>>());
        let expected: Vec<[f64; 3]> = (0..=4 * n).flat_map(column).collect();
        assert_eq!(fine.positions.len(), expected.len());
        for p in &expected {
            assert!(fine.positions.iter().any(|q| distance(p, q) <= TOLERANCE), "{n} x {m}: {p:?} is missing");
        }
    }
}

/// Kobbelt's scheme is not the push-back with delta 1, though both interpolate and have the same curves.
#[test]
fn it_differs_from_push_back_inside() {
    let net = nets::torus(5, 4);
    let (kobbelt, push_back) =
        (refined_mesh(&net, &kobbelt("edge-only"), 1), refined_mesh(&net, &json!({ "word": "UCP" }), 1));
    let n = net.positions.len();
    assert_eq!(kobbelt.positions[..n], net.positions);
    let off = kobbelt.positions[n..].iter().zip(&push_back.positions[n..]).map(|(p, q)| distance(p, q));
    assert!(off.fold(0.0, f64::max) > 1e-3);
}

#[test]
fn boundaries_are_four_point_curves() {
    let net = nets::mixed();
    let rim = [0, 1, 5, 6, 7, 2, 3, 4].map(|v: usize| net.positions[v]);
    let surface = refined_mesh(&net, &kobbelt("edge-only"), 3);
    for p in refined(&rim, true, &four_point(), 3) {
        assert!(surface.positions.iter().any(|q| distance(&p, q) <= TOLERANCE), "{p:?} is missing");
    }
}

/// Returns quads around a vertex: the point i steps along spoke s and j across has the number `1 + (s r + i - 1) r +
/// j`, with `1 <= i <= r` and `0 <= j < r`.
fn disc(n: usize, r: usize, place: impl Fn(usize, usize, usize) -> [f64; 3]) -> Net {
    let number = |s: usize, i: usize, j: usize| match (i, j) {
        (0, 0) => 0,
        (0, j) => 1 + ((s + 1) % n * r + j - 1) * r,
        (i, j) => 1 + (s * r + i - 1) * r + j,
    };
    // the outermost row across a spoke is omitted, as it has no number
    let quads = (0..n).flat_map(|s| (0..r * r).map(move |at| (s, at / r, at % r))).filter(|&(_, _, j)| j + 1 < r);
    let quad = |(s, i, j)| vec![number(s, i, j), number(s, i + 1, j), number(s, i + 1, j + 1), number(s, i, j + 1)];
    let points = (0..n * r * r).map(|at| place(at / (r * r), at / r % r + 1, at % r));
    Net { positions: [[0.0; 3]].into_iter().chain(points).collect(), faces: quads.map(quad).collect() }
}

/// Returns the same disc around the centre of a refined one, found by walking straight on.
fn inner_disc(fine: &Net, n: usize, r: usize) -> Vec<[f64; 3]> {
    let mut faces = std::collections::BTreeMap::new();
    for face in &fine.faces {
        for j in 0..4 {
            faces.insert((face[j], face[(j + 1) % 4]), [face[(j + 2) % 4], face[(j + 3) % 4]]);
        }
    }
    let mut spoke = fine.faces.iter().find_map(|face| Some(face[(face.iter().position(|&v| v == 0)? + 1) % 4]));
    let mut points = vec![[0.0; 3]; 1 + n * r * r];
    for s in 0..n {
        let first = spoke.expect("the centre has spokes");
        let mut row = vec![0, first];
        while row.len() <= r {
            // across the quad to the left of the last edge, and straight on
            let [from, to] = [row[row.len() - 2], row[row.len() - 1]];
            let [ahead, _] = faces[&(from, to)];
            row.push(faces[&(ahead, to)][0]);
        }
        for j in 0..r {
            (1..=r).for_each(|i| points[1 + (s * r + i - 1) * r + j] = fine.positions[row[i]]);
            if j + 1 < r {
                let above = (0..r).map(|i| faces[&(row[i], row[i + 1])]);
                let [far, near]: [Vec<usize>; 2] =
                    [above.clone().map(|q| q[0]).collect(), above.map(|q| q[1]).collect()];
                row = [near[0]].into_iter().chain(far).collect();
            }
        }
        spoke = Some(faces[&(0, first)][1]);
    }
    points
}

/// Both directions across a face next to an extraordinary vertex give the same face point.
#[test]
fn face_points_do_not_depend_on_the_direction() {
    let r = 5;
    for n in [3, 5, 6, 8] {
        let bump =
            |s: usize, i: usize, j: usize| [whole(s * 7 % 5 + i), whole(i * j % 3 + s), whole((s + 3 * i + j * j) % 4)];
        let near = inner_disc(&refined_mesh(&disc(n, r, bump), &kobbelt("edge-only"), 1), n, r);
        let at = |s: usize, i: usize, j: usize| match (i, j) {
            (0, j) => near[1 + ((s + 1) % n * r + j - 1) * r],
            (i, j) => near[1 + (s * r + i - 1) * r + j],
        };
        let rule = |a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]| {
            [0, 1, 2].map(|i| (9.0 * (b[i] + c[i]) - a[i] - d[i]) / 16.0)
        };
        for s in 0..n {
            // one step from the centre along spoke s, and along the next: two steps back lie in the sectors beyond them
            let first = rule(at((s + n - 1) % n, 2, 1), at(s, 1, 0), at(s, 1, 2), at(s, 1, 4));
            let second = rule(at((s + 1) % n, 1, 2), at(s, 0, 1), at(s, 2, 1), at(s, 4, 1));
            let found = at(s, 1, 1);
            assert!(distance(&found, &first) <= TOLERANCE, "{n}: sector {s}, {found:?} is not {first:?}");
            assert!(distance(&found, &second) <= TOLERANCE, "{n}: sector {s}, {found:?} is not {second:?}");
        }
    }
}

/// Returns the growth per level of the points around a vertex of valence n, after many levels; `frequency` is that of
/// the points around the centre, which remains at 0.
fn eigenvalue(n: usize, frequency: usize) -> f64 {
    let r = 6;
    let turn = |s: usize| 2.0 * std::f64::consts::PI * whole(frequency * s) / whole(n);
    let start = |s: usize, i: usize, j: usize| {
        let (near, far) = (whole(i * i + 1), whole(j + i * j));
        [near * cos(turn(s)) + far * cos(turn(s + 1)), near * sin(turn(s)) + far * sin(turn(s + 1)), 0.0]
    };
    let mut net = disc(n, r, start);
    let mut value = 0.0;
    for _ in 0..28 {
        net.positions = inner_disc(&refined_mesh(&net, &kobbelt("edge-only"), 1), n, r);
        value = sqrt(net.positions.as_flattened().iter().map(|x| x * x).sum());
        net.positions.as_flattened_mut().iter_mut().for_each(|x| *x /= value);
    }
    value
}

/// The largest eigenvalues below 1 belong to the first frequency; the values are from the matrices of a separate
/// program.
#[test]
fn eigenvalues_at_extraordinary_vertices() {
    for (n, expected) in EIGENVALUES {
        let first = eigenvalue(n, 1);
        assert!((first - expected).abs() <= 1e-6, "{n}: {first}");
        for frequency in [0].into_iter().chain(2..=n / 2) {
            let other = eigenvalue(n, frequency);
            assert!(other < first - 0.01, "{n}, {frequency}: {other} is not below {first}");
        }
    }
}
