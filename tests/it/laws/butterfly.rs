//! Butterfly: cubics on regular nets, the weights of rings elsewhere, four-point curves on boundaries.

use planish::math::functions::{cos, sin};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::{refined, refined_mesh};
use crate::support::nets::{self, Net, distance};

fn butterfly(boundary: &str) -> Value {
    json!({ "preset": "butterfly", "boundary": boundary })
}

fn whole(i: usize) -> f64 {
    f64::from(u32::try_from(i).expect("small"))
}

/// Returns a sheet of `2 n^2` triangles over the lattice, with valence 6 inside.
fn sheet(n: usize, height: impl Fn(f64, f64) -> f64) -> Net {
    let at = |i: usize, j: usize| j * (n + 1) + i;
    let place = |k: usize| [whole(k % (n + 1)), whole(k / (n + 1))];
    let cells = (0..n * n).map(|k| (k % n, k / n));
    let triangles = cells.flat_map(|(i, j)| {
        [vec![at(i, j), at(i + 1, j), at(i, j + 1)], vec![at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]]
    });
    let points = (0..(n + 1) * (n + 1)).map(place).map(|[x, y]| [x, y, height(x, y)]);
    Net { positions: points.collect(), faces: triangles.collect() }
}

/// Returns the largest distance from a graph, away from the boundary.
fn off(net: &Net, height: impl Fn(f64, f64) -> f64, from: f64, to: f64) -> f64 {
    let inside = |x: &f64| (from..=to).contains(x);
    let points = net.positions.iter().filter(|p| inside(&p[0]) && inside(&p[1]));
    points.map(|p| (p[2] - height(p[0], p[1])).abs()).fold(0.0, f64::max)
}

/// Dyn, Levin and Gregory 1990: cubics at w = 1/16, and no more.
#[test]
fn regular_regions_reproduce_cubics() {
    let cubic =
        |x: f64, y: f64| 1.0 + x - 2.0 * y + x * y - y * y + x * x * x - 2.0 * x * x * y + 0.5 * x * y * y - y * y * y;
    let fine = refined_mesh(&sheet(8, cubic), &butterfly("edge-only"), 1);
    assert!(off(&fine, cubic, 2.0, 6.0) <= 1e-11);
    let quartic = |x: f64, _: f64| x * x * x * x;
    let fine = refined_mesh(&sheet(8, quartic), &butterfly("edge-only"), 1);
    assert!(off(&fine, quartic, 2.0, 6.0) > 0.1);
    let tense = json!({ "preset": "butterfly", "parameters": { "w": "1/20" } });
    assert!(off(&refined_mesh(&sheet(8, cubic), &tense, 1), cubic, 2.0, 6.0) > 0.01);
}

/// Returns two rings of triangles around a vertex, where vertices of the inner ring have valence 6; `ring(s)` places
/// these.
fn disc(n: usize, ring: impl Fn(usize) -> [f64; 3]) -> Net {
    let next = |s: usize| (s + 1) % n;
    // 1 + s on the inner ring; 1 + n + 2 s on the outer ring beyond it, and 2 + n + 2 s between
    let (inner, beyond, between) = (|s: usize| 1 + s, |s: usize| 1 + n + 2 * s, |s: usize| 2 + n + 2 * s);
    let sector = |s: usize| {
        [
            vec![0, inner(s), inner(next(s))],
            vec![inner(s), beyond(s), between(s)],
            vec![inner(s), between(s), inner(next(s))],
            vec![inner(next(s)), between(s), beyond(next(s))],
        ]
    };
    let mut positions = vec![[0.0; 3]; 1 + 3 * n];
    (0..n).for_each(|s| positions[inner(s)] = ring(s));
    Net { positions, faces: (0..n).flat_map(sector).collect() }
}

/// Around an inner vertex, the eigenvalues are 1, twice 1/2, 1/4 and 0 (Zorin, Schroeder and Sweldens 1996).
#[test]
fn eigenvalues_are_halves_and_quarters() {
    for n in [3, 4, 5, 7, 8, 12] {
        for frequency in 0..=n / 2 {
            let angle = |s: usize| 2.0 * std::f64::consts::PI * whole(frequency * s % n) / whole(n);
            let net = disc(n, |s| [cos(angle(s)), sin(angle(s)), 0.0]);
            let fine = refined_mesh(&net, &butterfly("edge-only"), 1);
            let value = [0.25, 0.5, 0.25].get(frequency).copied().unwrap_or(0.0);
            // edges by first appearance: 0-1 comes first, then those of the sectors
            for s in 0..n {
                let expected = net.positions[1 + s].map(|x| value * x);
                let near = fine.positions[net.positions.len()..].iter().any(|p| distance(p, &expected) <= 1e-14);
                assert!(near, "{n}, {frequency}: {expected:?} is missing");
            }
        }
    }
}

#[test]
fn an_octahedron_grows_towards_a_sphere() {
    let positions = vec![
        [16.0, 0.0, 0.0],
        [-16.0, 0.0, 0.0],
        [0.0, 16.0, 0.0],
        [0.0, -16.0, 0.0],
        [0.0, 0.0, 16.0],
        [0.0, 0.0, -16.0],
    ];
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let net = Net { positions, faces: faces.map(Vec::from).to_vec() };
    let fine = refined_mesh(&net, &butterfly("edge-only"), 1);
    assert_eq!(fine.positions[..6], net.positions);
    // 9/16 (a + b) - 1/16 (the opposites of a and b)
    assert_eq!(fine.positions.get(6), Some(&[10.0, 10.0, 0.0]));
    assert_eq!(fine.positions.len(), 18);
}

/// Two triangles back to back: weights sum to 1 at vertices with two faces, too.
#[test]
fn a_pillow_keeps_its_place() {
    let net = Net { positions: vec![[5.0, 7.0, 9.0]; 3], faces: vec![vec![0, 1, 2], vec![2, 1, 0]] };
    let fine = refined_mesh(&net, &butterfly("edge-only"), 1);
    assert!(fine.positions.iter().all(|p| distance(p, &[5.0, 7.0, 9.0]) <= 1e-14), "{:?}", fine.positions);
}

/// An edge between two triangles without neighbours: all four far vertices are reflected, which leaves 1/2 (a + b) +
/// (1/8 - 2/16) (c + d).
#[test]
fn missing_vertices_are_reflected() {
    let positions = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 2.0], [2.0, 3.0, 5.0], [2.0, -3.0, 7.0]];
    let net = Net { positions, faces: vec![vec![0, 1, 2], vec![1, 0, 3]] };
    let fine = refined_mesh(&net, &butterfly("edge-and-corner"), 1);
    assert_eq!(fine.positions.get(4), Some(&[2.0, 0.0, 1.0]));
    // from 1 to 2: vertex 2 has one face and ends the curve, vertex 1 does not
    let expected = [0, 1, 2].map(|i| {
        let [_, b, c, d] = [0, 1, 2, 3].map(|v: usize| net.positions[v][i]);
        9.0 / 16.0 * (b + c) - d / 16.0 - (2.0 * c - b) / 16.0
    });
    assert!(fine.positions.iter().any(|p| distance(p, &expected) <= 1e-15), "{expected:?} is missing");
}

#[test]
fn boundaries_are_four_point_curves() {
    let fan = |face: Vec<usize>| (1..face.len() - 1).map(move |j| vec![face[0], face[j], face[j + 1]]);
    let net = Net { faces: nets::mixed().faces.into_iter().flat_map(fan).collect(), ..nets::mixed() };
    let rim = [0, 1, 5, 6, 7, 2, 3, 4].map(|v: usize| net.positions[v]);
    for w in ["1/16", "1/24"] {
        let parameters = json!({ "w": w });
        let plan = json!({ "preset": "butterfly", "parameters": parameters, "boundary": "edge-only" });
        let curve = refined(&rim, true, &json!({ "preset": "four-point", "parameters": parameters }), 3);
        let surface = refined_mesh(&net, &plan, 3);
        for p in curve {
            assert!(surface.positions.iter().any(|q| distance(&p, q) <= 1e-12), "w = {w}: {p:?} is missing");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn vertices_stay_and_without_tension_edges_are_halved(net in nets::triangles()) {
        let n = net.positions.len();
        let fine = refined_mesh(&net, &butterfly("edge-and-corner"), 2);
        prop_assert_eq!(&fine.positions[..n], &net.positions[..]);
        let slack = json!({ "preset": "butterfly", "parameters": { "w": 0 } });
        let split = json!({ "word": "U", "parameters": { "split": "triangle" } });
        prop_assert_eq!(refined_mesh(&net, &slack, 2), refined_mesh(&net, &split, 2));
    }

    #[test]
    fn refinement_commutes_with_affine_maps(
        net in nets::triangles(),
        boundary in prop::sample::select(vec!["edge-only", "edge-and-corner"]),
    ) {
        let moved = |p: &[f64; 3]| {
            [0.6 * p[0] - 0.8 * p[1] + 3.0, 1.6 * p[0] + 1.2 * p[1] - 1.0, 0.5 * p[2] + 0.25 * p[0]]
        };
        let image = Net { positions: net.positions.iter().map(moved).collect(), ..net.clone() };
        let [there, here] = [&image, &net].map(|net| refined_mesh(net, &butterfly(boundary), 2));
        prop_assert_eq!(&there.faces, &here.faces);
        for (p, q) in there.positions.iter().zip(&here.positions) {
            prop_assert!(distance(p, &moved(q)) <= 1e-11, "{:?}", p);
        }
    }
}
