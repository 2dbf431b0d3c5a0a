//! Small meshes and random ones, for the laws.

use std::collections::BTreeSet;

use planish::math::functions::sqrt;
use proptest::prelude::*;
use serde_json::{Value, json};

/// A mesh as in a request.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Net {
    /// The positions of the vertices.
    pub(crate) positions: Vec<[f64; 3]>,
    /// The faces as lists of vertex indices.
    pub(crate) faces: Vec<Vec<usize>>,
}

impl Net {
    /// Returns the `mesh` of a job.
    pub(crate) fn to_json(&self) -> Value {
        json!({ "positions": self.positions, "faces": self.faces })
    }

    /// Returns the input of a job.
    pub(crate) fn input(&self) -> Value {
        json!({ "mesh": self.to_json() })
    }

    /// Reads the JSON output of a mesh.
    pub(crate) fn of(result: &Value) -> Self {
        let positions = serde_json::from_value(result["positions"].clone()).expect("positions");
        let faces = serde_json::from_value(result["faces"].clone()).expect("faces");
        Self { positions, faces }
    }

    /// Returns the undirected edges, each once.
    pub(crate) fn edges(&self) -> BTreeSet<(usize, usize)> {
        let sides = self.faces.iter().flat_map(|face| {
            (0..face.len()).map(move |j| {
                let (a, b) = (face[j], face[(j + 1) % face.len()]);
                (a.min(b), a.max(b))
            })
        });
        sides.collect()
    }
}

/// Reads the job input in a file of `tests/nets`.
pub(crate) fn control(name: &str) -> Value {
    let path = format!("{}/tests/nets/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).expect("a net")).expect("JSON")
}

/// Returns the largest difference of a coordinate; infinite if the lengths differ or a coordinate is not a number.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(x, y)| (x - y).abs());
    let largest = differences.fold(0.0, |most: f64, x| if x.is_nan() { f64::INFINITY } else { most.max(x) });
    if a.len() == b.len() { largest } else { f64::INFINITY }
}

/// Returns the unit normal of a counter-clockwise triangle.
pub(crate) fn triangle_normal(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> [f64; 3] {
    let [u, v] = [b, c].map(|p| [0, 1, 2].map(|k| p[k] - a[k]));
    let product = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = sqrt(product.iter().map(|x| x * x).sum());
    product.map(|x| x / length)
}

/// Returns for each expected point the index of the nearest found point; the matching must be one to one, within
/// `tolerance` per coordinate.
fn matched(found: &[[f64; 3]], expected: &[[f64; 3]], tolerance: f64) -> Result<Vec<usize>, String> {
    let mut image = Vec::with_capacity(expected.len());
    for point in expected {
        let distances = found.iter().map(|other| distance(point, other)).enumerate();
        let (nearest, off) = distances.min_by(|a, b| a.1.total_cmp(&b.1)).ok_or("there are no vertices")?;
        if off > tolerance {
            return Err(format!("{point:?} is off by {off}"));
        }
        image.push(nearest);
    }
    let distinct = image.iter().collect::<BTreeSet<_>>().len();
    if distinct == found.len() && distinct == image.len() {
        Ok(image)
    } else {
        Err(format!("{} points match {distinct} of {}", expected.len(), found.len()))
    }
}

/// Checks that two meshes are the same surface: points are matched one to one, faces are compared as cycles of matched
/// points.
pub(crate) fn same_surface(found: &Net, expected: &Net, tolerance: f64) -> Result<(), String> {
    let image = matched(&found.positions, &expected.positions, tolerance)?;
    let reference = cycles(&expected.faces, |v| image[v]);
    if reference == cycles(&found.faces, |v| v) { Ok(()) } else { Err("the faces differ".into()) }
}

/// Returns faces as cycles, each starting at its lowest vertex, in ascending order.
fn cycles(faces: &[Vec<usize>], image: impl Fn(usize) -> usize) -> Vec<Vec<usize>> {
    let cycle = |face: &Vec<usize>| {
        let mut face: Vec<usize> = face.iter().map(|&v| image(v)).collect();
        let lowest = (0..face.len()).min_by_key(|&i| face[i]).expect("a face has vertices");
        face.rotate_left(lowest);
        face
    };
    let mut cycles: Vec<_> = faces.iter().map(cycle).collect();
    cycles.sort();
    cycles
}

fn of(positions: &[[f64; 3]], faces: &[&[usize]]) -> Net {
    Net { positions: positions.to_vec(), faces: faces.iter().map(|face| face.to_vec()).collect() }
}

/// Returns a crooked cube.
pub(crate) fn cube() -> Net {
    let positions = (0..8).map(|i| {
        let [x, y, z] = [i & 1, i >> 1 & 1, i >> 2].map(f64::from);
        [x + 0.125 * y, y - 0.25 * z * x, z + 0.0625 * x * y]
    });
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Net { positions: positions.collect(), faces: faces.map(Vec::from).to_vec() }
}

/// Returns a tetrahedron.
pub(crate) fn tetrahedron() -> Net {
    of(&[[0., 0., 0.], [2., 0., 0.25], [0., 2., 0.], [0.5, 0., 2.]], &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]])
}

/// Returns a bumpy rectangle of `n x m` quads.
pub(crate) fn grid(n: usize, m: usize) -> Net {
    let bump = |i: usize, j: usize| f64::from(u8::try_from((3 * i * i + 5 * j + i * j) % 7).expect("below 7")) / 8.0;
    let whole = |i: usize| f64::from(u32::try_from(i).expect("a small net"));
    let points = (0..=m).flat_map(|j| (0..=n).map(move |i| [whole(i), whole(j), bump(i, j)]));
    let first = (0..m).flat_map(|j| (0..n).map(move |i| j * (n + 1) + i));
    Net { positions: points.collect(), faces: first.map(|a| vec![a, a + 1, a + n + 2, a + n + 1]).collect() }
}

/// Returns a torus of `n x m` quads, `n` and `m` at least 3.
pub(crate) fn torus(n: usize, m: usize) -> Net {
    let Net { positions, .. } = grid(n - 1, m - 1);
    let at = |i: usize, j: usize| (j % m) * n + i % n;
    let quads = (0..m).flat_map(|j| (0..n).map(move |i| vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]));
    Net { positions, faces: quads.collect() }
}

/// Returns a torus of `n x m` quads without its last ring of faces.
pub(crate) fn cylinder(n: usize, m: usize) -> Net {
    let Net { positions, mut faces } = torus(n, m);
    faces.truncate(n * (m - 1));
    Net { positions, faces }
}

/// Returns an open strip of a triangle, a quad and a pentagon.
pub(crate) fn mixed() -> Net {
    of(
        &[
            [0., 0., 0.],
            [2., 0., 1.],
            [2., 2., 0.],
            [0., 2., 0.5],
            [-2., 1., 0.],
            [4., -1., 0.],
            [5., 1., 2.],
            [4., 3., 0.],
        ],
        &[&[0, 1, 2, 3], &[3, 4, 0], &[1, 5, 6, 7, 2]],
    )
}

/// Returns a closed prism over an `n`-gon.
pub(crate) fn prism(n: usize) -> Net {
    let mut positions = grid(n - 1, 1).positions;
    positions.truncate(2 * n);
    let mut faces: Vec<Vec<usize>> = (0..n).map(|i| vec![i, (i + 1) % n, n + (i + 1) % n, n + i]).collect();
    faces.push((0..n).rev().collect());
    faces.push((n..2 * n).collect());
    Net { positions, faces }
}

/// Returns a vertex with `n` sectors of `rings x rings` quads around it, and for each vertex but the centre its place
/// in its sector: `i` steps along the sector's first side, `j` to the left.
pub(crate) fn sectors_of_quads(n: usize, rings: usize) -> (Net, Vec<Option<[usize; 2]>>) {
    let mut places = vec![None];
    let mut positions = vec![[0.0, 0.0, 1.0]];
    for sector in 0..n {
        for (i, j) in (1..=rings).flat_map(|i| (0..=rings).map(move |j| (i, j))) {
            places.push(Some([i, j]));
            let whole = |k: usize| f64::from(u32::try_from(k).expect("small"));
            let angle = |s: usize| 2.0 * std::f64::consts::PI * whole(s) / whole(n);
            let (a, b) = (angle(sector), angle(sector + 1));
            let along = |f: fn(f64) -> f64| whole(i) * f(a) + whole(j) * f(b);
            positions.push([
                along(planish::math::functions::cos),
                along(planish::math::functions::sin),
                whole((3 * i + j * j) % 5) / 16.0,
            ]);
        }
    }
    let at = |sector: usize, i: usize, j: usize| match (i, j) {
        (0, 0) => 0,
        (0, j) => 1 + ((sector + 1) % n * rings + j - 1) * (rings + 1),
        (i, j) => 1 + (sector * rings + i - 1) * (rings + 1) + j,
    };
    let cells = (0..n).flat_map(|s| (0..rings).flat_map(move |i| (0..rings).map(move |j| (s, i, j))));
    let faces = cells.map(|(s, i, j)| vec![at(s, i, j), at(s, i + 1, j), at(s, i + 1, j + 1), at(s, i, j + 1)]);
    (Net { positions, faces: faces.collect() }, places)
}

/// Returns a random manifold: a net of one of the families, with some faces removed, some split into triangles, some
/// pairs merged, vertices renumbered, and some isolated ones added.
pub(crate) fn manifold() -> impl Strategy<Value = Net> {
    let family = prop_oneof![
        Just(cube()),
        Just(tetrahedron()),
        Just(mixed()),
        (1..5_usize, 1..5_usize).prop_map(|(n, m)| grid(n, m)),
        (3..6_usize, 3..6_usize).prop_map(|(n, m)| torus(n, m)),
        (3..8_usize).prop_map(prism),
    ];
    let choices = proptest::collection::vec(any::<u8>(), 64);
    (family, choices, 0..3_usize, any::<bool>()).prop_map(|(net, choices, isolated, whole)| {
        let mut net = if whole { net } else { punctured(net, &choices) };
        net = partly_triangulated(net, &choices[16..]);
        net = merged(net, usize::from(choices[40]));
        for i in 0..isolated {
            let at = usize::from(choices[50 + i]) % (net.positions.len() + 1);
            net.positions.insert(at, [0.5, -1.0, 3.0]);
            net.faces.iter_mut().flatten().filter(|v| **v >= at).for_each(|v| *v += 1);
        }
        let turn = usize::from(choices[60]);
        net.faces.iter_mut().for_each(|face| {
            let by = turn % face.len();
            face.rotate_left(by);
        });
        net
    })
}

/// Returns a random manifold of triangles, with or without boundary and isolated vertices. Larger faces get a vertex in
/// their centre, as a diagonal may already be an edge elsewhere.
pub(crate) fn triangle_manifold() -> impl Strategy<Value = Net> {
    manifold().prop_map(|Net { mut positions, faces }| {
        let mut triangles = Vec::new();
        for face in faces {
            if face.len() == 3 {
                triangles.push(face);
                continue;
            }
            let middle = positions.len();
            positions.push([0, 1, 2].map(|k| 0.5 * (positions[face[0]][k] + positions[face[2]][k])));
            triangles.extend((0..face.len()).map(|j| vec![middle, face[j], face[(j + 1) % face.len()]]));
        }
        Net { positions, faces: triangles }
    })
}

/// Returns the net without the faces that `choices` selects; the first face always remains. Vertices may become
/// isolated or belong to two fans.
fn punctured(net: Net, choices: &[u8]) -> Net {
    let keep = |i: usize| i == 0 || !choices[i % choices.len()].is_multiple_of(4);
    let faces = net.faces.into_iter().enumerate().filter(|(i, _)| keep(*i)).map(|(_, face)| face).collect();
    Net { faces, ..net }
}

/// Cuts all faces into triangles: quads along the diagonal from corner 0, larger ones as fans.
pub(crate) fn triangulated(net: Net) -> Net {
    let fan =
        |face: Vec<usize>| (1..face.len() - 1).map(move |i| vec![face[0], face[i], face[i + 1]]).collect::<Vec<_>>();
    Net { faces: net.faces.into_iter().flat_map(fan).collect(), ..net }
}

/// Returns an octahedron.
pub(crate) fn octahedron() -> Net {
    let positions = [[1., 0., 0.], [-1., 0.25, 0.], [0., 1., 0.], [0.25, -1., 0.], [0., 0., 1.25], [0., 0., -1.]];
    let faces: [&[usize]; 8] =
        [&[0, 2, 4], &[2, 1, 4], &[1, 3, 4], &[3, 0, 4], &[2, 0, 5], &[1, 2, 5], &[3, 1, 5], &[0, 3, 5]];
    of(&positions, &faces)
}

/// Cuts some quads along a diagonal.
fn partly_triangulated(net: Net, choices: &[u8]) -> Net {
    let faces = net.faces.into_iter().enumerate().flat_map(|(i, face)| match (face.as_slice(), choices[i % 24] % 3) {
        (&[a, b, c, d], 0) => vec![vec![a, b, c], vec![c, d, a]],
        _ => vec![face],
    });
    Net { faces: faces.collect(), ..net }
}

/// Merges one face with a neighbour over their only common edge, if there is one.
fn merged(mut net: Net, start: usize) -> Net {
    let n = net.faces.len();
    for f in (0..n).map(|i| (i + start) % n) {
        let face = net.faces[f].clone();
        for j in 0..face.len() {
            let (a, b) = (face[j], face[(j + 1) % face.len()]);
            let Some(g) = (0..n).find(|&g| g != f && side(&net.faces[g], b, a).is_some()) else { continue };
            let other = net.faces[g].clone();
            if face.iter().filter(|v| other.contains(v)).count() != 2 {
                continue;
            }
            let k = side(&other, b, a).expect("just found");
            let mut whole: Vec<usize> = (1..=face.len()).map(|i| face[(j + i) % face.len()]).collect();
            whole.extend((2..other.len()).map(|i| other[(k + i) % other.len()]));
            net.faces[f] = whole;
            net.faces.remove(g);
            return net;
        }
    }
    net
}

/// Returns the index of the corner from which a face runs from `a` to `b`.
fn side(face: &[usize], a: usize, b: usize) -> Option<usize> {
    (0..face.len()).find(|&j| face[j] == a && face[(j + 1) % face.len()] == b)
}

/// Returns a random manifold of triangles: the faces of a [`manifold`] cut into fans.
pub(crate) fn triangles() -> impl Strategy<Value = Net> {
    let fan = |face: Vec<usize>| (1..face.len() - 1).map(move |j| vec![face[0], face[j], face[j + 1]]);
    let whole = manifold().prop_map(move |net| Net { faces: net.faces.into_iter().flat_map(fan).collect(), ..net });
    // fans of neighbouring faces may share a diagonal
    whole.prop_filter("an edge has four faces", |net| {
        let mut sides: Vec<_> = net
            .faces
            .iter()
            .flat_map(|face| (0..3).map(|j| (face[j], face[(j + 1) % 3])).collect::<Vec<_>>())
            .collect();
        sides.sort_unstable();
        sides.windows(2).all(|pair| pair[0] != pair[1])
    })
}
