//! Normals differ across edges that are still sharp, and not elsewhere.

use serde_json::{Value, json};

use crate::support::nets::{self, Net, distance};
use crate::support::render;

/// Returns a job on a net with sharp edges; without levels there is no plan.
fn job(net: &Net, edges: &[[usize; 2]], sharpness: f64, levels: u32, output: &Value) -> Value {
    let mut input = net.input();
    input["mesh"]["creases"] = edges.iter().map(|edge| json!({ "edge": edge, "sharpness": sharpness })).collect();
    let plan = json!({ "preset": "catmull-clark" });
    let mut job = json!({ "input": input, "levels": levels, "outputs": [output] });
    if levels > 0 {
        job["plan"] = plan;
    }
    job
}

fn text(job: &Value) -> String {
    String::from_utf8(render(job).expect("a result").0).expect("the format is text")
}

/// The positions and normals of an OBJ, and for each face its pairs of them.
type Obj = (Vec<[f64; 3]>, Vec<[f64; 3]>, Vec<Vec<[usize; 2]>>);

fn obj(net: &Net, edges: &[[usize; 2]], sharpness: f64, levels: u32) -> Obj {
    let text = text(&job(net, edges, sharpness, levels, &json!({ "format": "obj", "normals": "area" })));
    let rows = |start: &str| -> Vec<[f64; 3]> {
        let rows = text.lines().filter_map(|line| line.strip_prefix(start));
        let row = |row: &str| row.split(' ').map(|x| x.parse().expect("a number")).collect::<Vec<f64>>();
        rows.map(|line| row(line).try_into().expect("three numbers")).collect()
    };
    let pair = |pair: &str| {
        let (v, n) = pair.split_once("//").expect("a vertex and a normal");
        [v, n].map(|i| i.parse::<usize>().expect("an index") - 1)
    };
    let faces = text.lines().filter_map(|line| line.strip_prefix("f "));
    (rows("v "), rows("vn "), faces.map(|face| face.split(' ').map(pair).collect()).collect())
}

#[test]
fn a_cube_of_sharp_edges_has_a_normal_for_each_side() {
    let net = nets::cube();
    let edges: Vec<[usize; 2]> = net.edges().into_iter().map(|(a, b)| [a, b]).collect();
    let (positions, normals, faces) = obj(&net, &edges, 0.5, 0);
    assert_eq!((positions.len(), normals.len(), faces.len()), (8, 24, 6));
    for face in &faces {
        let side = normals[face[0][1]];
        assert!(face.iter().all(|&[_, n]| distance(&normals[n], &side) <= 1e-12), "{face:?}");
    }
    let vertices = |face: &Vec<[usize; 2]>| face.iter().map(|corner| corner[0]).collect::<Vec<_>>();
    assert_eq!(faces.iter().map(vertices).collect::<Vec<_>>(), net.faces);
}

#[test]
fn a_closed_crease_parts_each_of_its_points_once() {
    let net = nets::torus(4, 5);
    let ring = [[0, 1], [1, 2], [2, 3], [3, 0]];
    for levels in 0..=3 {
        let (positions, normals, _) = obj(&net, &ring, 10.0, levels);
        assert_eq!(normals.len(), positions.len() + (4 << levels), "level {levels}");
    }
    // 1.7 is sharp before the levels, and after the first
    let parted = [0, 1, 2].map(|levels| {
        let (positions, normals, _) = obj(&net, &ring, 1.7, levels);
        normals.len() - positions.len()
    });
    assert_eq!(parted, [4, 8, 0]);
}

#[test]
fn the_ends_of_a_crease_inside_are_not_parted() {
    for levels in 0..=3 {
        let (positions, normals, _) = obj(&nets::torus(4, 5), &[[0, 1]], 10.0, levels);
        assert_eq!(normals.len(), positions.len() + (1 << levels) - 1, "level {levels}");
    }
}

#[test]
fn a_crease_that_reaches_the_boundary_parts_its_end_there() {
    let (positions, normals, _) = obj(&nets::grid(2, 2), &[[1, 4], [4, 7]], 10.0, 1);
    assert_eq!(normals.len(), positions.len() + 5);
}

/// The other formats have the same faces and points; those without normals have no copies of vertices.
#[test]
fn formats_agree_on_what_is_parted() {
    let (net, edges) = (nets::torus(4, 5), [[0, 1], [1, 2], [2, 3], [3, 0], [0, 4]]);
    let with = |output: Value| text(&job(&net, &edges, 10.0, 2, &output));
    let (positions, normals, faces) = obj(&net, &edges, 10.0, 2);
    let n = normals.len();
    assert!(n > positions.len());
    let ply = with(json!({ "format": "ply", "ascii": true, "normals": "area" }));
    assert!(ply.contains(&format!("element vertex {n}\n")), "{n} vertices");
    assert!(ply.contains(&format!("element face {}\n", faces.len())));
    let plain = with(json!({ "format": "ply", "ascii": true }));
    assert!(plain.contains(&format!("element vertex {}\n", positions.len())));
    for (normals, count) in [("area", n), ("none", positions.len())] {
        let gltf: Value = serde_json::from_str(&with(json!({ "format": "gltf", "normals": normals }))).expect("JSON");
        assert_eq!(gltf["accessors"][0]["count"], count, "{normals}");
    }
    // each corner of each face has the same position and normal in PLY and OBJ
    let rows: Vec<Vec<f64>> = ply
        .lines()
        .skip_while(|line| *line != "end_header")
        .skip(1)
        .map(|line| line.split(' ').map(|x| x.parse().expect("a number")).collect())
        .collect();
    for (face, row) in faces.iter().zip(&rows[n..]) {
        for (&[v, normal], &at) in face.iter().zip(&row[1..]) {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index of a small mesh")]
            let vertex = &rows[at as usize];
            assert_eq!(vertex[..3], positions[v]);
            assert_eq!(vertex[3..], normals[normal]);
        }
    }
}

/// The picture of a creased mesh differs from that of the same points without a crease.
#[test]
fn pictures_show_the_edge() {
    let net = nets::cube();
    let edges: Vec<[usize; 2]> = net.edges().into_iter().map(|(a, b)| [a, b]).collect();
    let output =
        |shading: &str| json!({ "format": "png", "width": 64, "height": 48, "shading": shading, "crease_angle": 180 });
    let picture =
        |edges: &[[usize; 2]], shading| render(&job(&net, edges, 1.0, 0, &output(shading))).expect("a picture").0;
    assert_ne!(picture(&edges, "smooth"), picture(&[], "smooth"));
    assert_eq!(picture(&edges, "flat"), picture(&[], "flat"));
}
