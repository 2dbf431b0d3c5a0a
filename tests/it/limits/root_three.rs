//! Limit normals of sqrt 3, whose steps rotate the neighbourhood of a vertex.

use planish::math::functions::{cos, sin, sqrt};
use serde_json::{Value, json};

use super::{limit, warnings};
use crate::support::json_with;
use crate::support::nets::{self, Net, distance};

fn plan() -> Value {
    json!({ "preset": "sqrt-3" })
}

fn icosahedron() -> Net {
    let g = f64::midpoint(1.0, sqrt(5.0));
    let positions = [[0.0, 1.0, g], [0.0, -1.0, g], [0.0, 1.0, -g], [0.0, -1.0, -g]];
    let all = (0..3).flat_map(|k| positions.map(|p| [p[(3 - k) % 3], p[(4 - k) % 3], p[(5 - k) % 3]]));
    let positions: Vec<[f64; 3]> = all.collect();
    let near = |a: usize, b: usize| {
        let differences = [0, 1, 2].map(|k| positions[a][k] - positions[b][k]);
        differences.iter().map(|x| x * x).sum::<f64>() < 4.5
    };
    let outwards = |[a, b, c]: [usize; 3]| {
        let [u, v] = [b, c].map(|i| [0, 1, 2].map(|k| positions[i][k] - positions[a][k]));
        let product = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        (0..3).map(|k| product[k] * positions[a][k]).sum::<f64>() > 0.0
    };
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            faces.extend(
                (b + 1..12)
                    .filter(|&c| near(a, b) && near(b, c) && near(c, a))
                    .map(|c| if outwards([a, b, c]) { vec![a, b, c] } else { vec![a, c, b] }),
            );
        }
    }
    assert_eq!(faces.len(), 20);
    Net { positions, faces }
}

/// The normals of a solid with all its symmetries point away from the centre.
#[test]
fn normals_of_an_icosahedron_are_radial() {
    let net = icosahedron();
    for levels in 0..=3 {
        assert_eq!(warnings(&net, &plan(), levels), Vec::<String>::new(), "level {levels}");
        let (_, normals) = limit(&net, &plan(), levels);
        for (v, (normal, p)) in normals.iter().zip(&net.positions).enumerate() {
            let length = sqrt(p.iter().map(|x| x * x).sum());
            let off = distance(normal, &p.map(|x| x / length));
            assert!(off <= 1e-9, "level {levels}: normal {v} is off by {off}");
        }
    }
}

/// Returns a rim of n vertices between an apex above it and one below.
fn double_cone(n: usize) -> Net {
    let number = |i: usize| f64::from(u32::try_from(i).expect("small"));
    let angle = |i: usize| std::f64::consts::TAU * number(i) / number(n);
    let rim = (0..n).map(|i| [cos(angle(i)), 1.2 * sin(angle(i)), 0.1 * number(i % 3)]);
    let positions = rim.chain([[0.1, 0.0, 0.9], [0.0, -0.1, -0.7]]).collect();
    let side = |i: usize| [vec![i, (i + 1) % n, n], vec![(i + 1) % n, i, n + 1]];
    Net { positions, faces: (0..n).flat_map(side).collect() }
}

#[test]
fn inner_vertices_of_any_valence_have_normals() {
    let mut open = nets::octahedron();
    open.faces.pop();
    let cones = [3, 4, 5, 6, 7, 8, 12, 25].map(double_cone);
    let more = [nets::octahedron(), nets::tetrahedron(), nets::triangulated(nets::prism(5)), open];
    for net in cones.into_iter().chain(more).chain([nets::triangulated(nets::grid(4, 3))]) {
        assert_eq!(warnings(&net, &plan(), 0), Vec::<String>::new(), "{net:?}");
        assert_eq!(warnings(&net, &plan(), 1), Vec::<String>::new(), "{net:?}");
        let job = json!({ "input": net.input(), "plan": plan(), "levels": 6 });
        let deep = json_with(job, &json!({ "normals": "area" }));
        let deep: Vec<[f64; 3]> = serde_json::from_value(deep["normals"].clone()).expect("normals");
        let (_, first) = limit(&net, &plan(), 0);
        let (_, second) = limit(&net, &plan(), 1);
        for v in 0..net.positions.len() {
            let off = distance(&first[v], &second[v]);
            assert!(off <= 1e-8, "{net:?}: normal {v} turns by {off}");
            let off = distance(&first[v], &deep[v]);
            assert!(off <= 0.15, "{net:?}: normal {v} is off by {off}");
        }
    }
}

/// At most two faces lie between any two boundary edges: patches end where new ones begin.
#[test]
fn narrow_open_meshes_have_limits() {
    let faces = [[5, 0, 1], [3, 0, 5], [1, 0, 2], [4, 0, 3], [4, 2, 0], [2, 4, 6], [6, 5, 1], [1, 2, 6], [6, 4, 3]];
    let positions = [
        [-0.437, -0.9, 0.563],
        [-0.547, 0.986, 0.551],
        [-0.13, 0.328, 0.881],
        [1.328, -0.3, 0.315],
        [0.433, -0.245, 0.987],
        [0.411, 0.847, -0.316],
        [-0.207, 1.022, 0.005],
    ];
    let net = Net { positions: positions.to_vec(), faces: faces.map(|face| face.to_vec()).to_vec() };
    let [coarse, fine, finer] = [0, 1, 2].map(|levels| limit(&net, &plan(), levels).0);
    for (before, after) in [(&coarse, &fine), (&fine, &finer)] {
        for (v, (p, q)) in before.positions.iter().zip(&after.positions).enumerate() {
            let off = distance(p, q);
            assert!(off <= 1e-12, "vertex {v} moves by {off}");
        }
    }
}
