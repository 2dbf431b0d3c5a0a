//! Results of OpenSubdiv 3.5 for meshes: levels, limit positions and limit normals.

use planish::job::Input;
use planish::math::functions::sqrt;
use planish::refine::refine_mesh;
use planish::shape::source::CarriedSource;
use planish::watch::Watch;
use serde_json::{Value, json};

use super::{check_mesh, points, tolerance};
use crate::support::nets::{Net, distance};
use crate::support::{json, json_with, parsed, render};

/// Returns the job of a vector of OpenSubdiv without levels.
fn job(vector: &Value) -> Value {
    let input = &vector["input"];
    let preset = match vector["scheme"].as_str() {
        Some("catmull_clark") => "catmull-clark",
        Some("loop") => "loop",
        other => panic!("no preset is known for {other:?}"),
    };
    let list = |name: &str| input[name].as_array().expect("tags are a list").iter();
    let creases: Vec<_> =
        list("creases").map(|crease| json!({ "edge": [crease[0], crease[1]], "sharpness": crease[2] })).collect();
    let corners: Vec<_> =
        list("corners").map(|corner| json!({ "vertex": corner[0], "sharpness": corner[1] })).collect();
    let mesh = json!({ "positions": input["points"], "faces": input["faces"], "creases": creases, "corners": corners });
    let creasing = &vector["creasing"];
    let mut parameters = json!({ "creasing": creasing });
    if preset == "catmull-clark" {
        parameters["triangle_rule"] = vector["triangle_rule"].clone();
    }
    let boundary = match vector["boundary_interpolation"].as_str() {
        Some("edge") => "edge-only",
        Some("edgecorner") => "edge-and-corner",
        Some("none") => "none",
        other => panic!("no rule is known for {other:?}"),
    };
    let plan = json!({ "preset": preset, "boundary": boundary, "parameters": parameters });
    json!({ "input": { "mesh": mesh }, "plan": plan })
}

/// Compares every level.
pub(super) fn levels(vector: &Value) -> usize {
    let job = job(vector);
    let (mesh, plan) = (&job["input"]["mesh"], &job["plan"]);
    // OpenSubdiv does not keep Chaikin's weights below 1, as the note in the file says; planish does
    let same = if vector["creasing"] == "chaikin" { 1 } else { usize::MAX };
    let levels = vector["levels"].as_array().expect("levels are a list").iter().take(same);
    let check = |level: &Value| {
        check_sharp_edges(vector, &job, level);
        match plan["boundary"].as_str() {
            Some("none") => check_shown(vector, mesh, plan, level),
            _ => check_mesh(vector, mesh, plan, level, "vertices"),
        }
    };
    levels.map(check).count()
}

/// Compares the edges that are still sharp.
fn check_sharp_edges(vector: &Value, job: &Value, level: &Value) {
    let mut job = job.clone();
    job["levels"] = level["level"].clone();
    job["outputs"] = json!([{ "format": "json" }]);
    let job = parsed(job.to_string().as_bytes()).expect("a job");
    let Input::Mesh(control) = &*job.input else { panic!("the input is a mesh") };
    let steps = job.plan.schedule(job.levels).expect("the plan has no functions");
    let refined = refine_mesh(control, &job.plan, &steps, &Watch::new()).expect("it is small");
    let positions = refined.all_positions();
    let found: Vec<_> = refined.sharp_edges().iter().map(|edge| edge.map(|v| positions[v as usize])).collect();
    let vertices: Vec<[f64; 3]> = points(&level["vertices"]);
    let edges: Vec<(usize, usize, f64)> = points(&level["edge_sharpness"]);
    assert_eq!(found.len(), edges.len(), "{} level {}", vector["id"], level["level"]);
    for (a, b, _) in edges {
        let close = |p: &[f64; 3], v: usize| distance(p, &vertices[v]) <= tolerance(vector);
        let same = |[p, q]: &[[f64; 3]; 2]| close(p, a) && close(q, b) || close(p, b) && close(q, a);
        assert!(found.iter().any(same), "{} level {}: edge ({a}, {b})", vector["id"], level["level"]);
    }
}

/// Compares the visible faces: each is a face of the vector.
fn check_shown(vector: &Value, mesh: &Value, plan: &Value, level: &Value) {
    let found = Net::of(&json(json!({ "input": { "mesh": mesh }, "plan": plan, "levels": level["level"] })));
    let expected: Vec<[f64; 3]> = points(&level["vertices"]);
    let faces: Vec<Vec<usize>> = points(&level["faces"]);
    // 4 of 16 faces do not touch the boundary
    assert_eq!(4 * found.faces.len(), faces.len(), "{}", vector["id"]);
    let close = |p: &[f64; 3], q: &[f64; 3]| distance(p, q) <= tolerance(vector);
    for face in &found.faces {
        let same =
            |other: &Vec<usize>| face.iter().all(|&v| other.iter().any(|&u| close(&found.positions[v], &expected[u])));
        assert!(faces.iter().any(same), "{} level {}: {face:?}", vector["id"], level["level"]);
    }
}

/// Compares limit positions and normals of the last level, at the positions of its vertices.
pub(super) fn limits(vector: &Value) -> usize {
    let mut job = job(vector);
    if vector["creasing"] == "chaikin" || vector["boundary_interpolation"] == "none" {
        return 0;
    }
    let level = vector["levels"].as_array().and_then(|levels| levels.last()).expect("levels are a list");
    job["levels"] = level["level"].clone();
    let refined: Vec<[f64; 3]> = points(&json(job.clone())["positions"]);
    let found = json_with(job.clone(), &json!({ "positions": "limit" }));
    let positions: Vec<[f64; 3]> = points(&found["positions"]);
    let (normals, warnings) = sides(job, refined.len());
    let expected = [&level["vertices"], &level["limit"], &level["limit_normal"]].map(points::<[f64; 3]>);
    assert_eq!(refined.len(), expected[0].len(), "{}", vector["id"]);
    let (darts, others) = special_vertices(&vector["input"]);
    assert!(warnings.is_empty() || !list(&vector["input"], "corners").is_empty(), "{}: {warnings:?}", vector["id"]);
    let mut compared = 0;
    for (i, vertex) in refined.iter().enumerate() {
        let place = expected[0].iter().position(|other| distance(vertex, other) <= tolerance(vector));
        let place = place.unwrap_or_else(|| panic!("{}: {vertex:?} is no vertex", vector["id"]));
        if !darts.contains(&i) {
            let off = distance(&positions[i], &expected[1][place]);
            assert!(off <= tolerance(vector), "{}: the limit of {vertex:?} is off by {off}", vector["id"]);
        }
        let normal = expected[2][place];
        let length = sqrt(normal.iter().map(|x| x * x).sum());
        if length > 1e-6 && !darts.contains(&i) && !others.contains(&i) {
            // beside edges that remain sharp, it is that of one side
            let off = normals[i].iter().map(|side| distance(side, &normal.map(|x| x / length)));
            let off = off.fold(f64::INFINITY, f64::min);
            let most = tolerance(vector).max(1e-8);
            assert!(off <= most, "{}: the normals at {vertex:?} are {:?}, not {normal:?}", vector["id"], normals[i]);
            compared += 1;
        }
    }
    assert!(10 * compared >= 9 * refined.len(), "{}: {compared} normals of {}", vector["id"], refined.len());
    1
}

/// Returns the limit normals of each vertex, one for each side of sharp edges, and the warnings.
fn sides(mut job: Value, n: usize) -> (Vec<Vec<[f64; 3]>>, Vec<String>) {
    job["outputs"] = json!([{ "format": "obj", "normals": "limit" }]);
    let (bytes, report) = render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
    let text = String::from_utf8(bytes).expect("OBJ is text");
    let row = |line: &str| -> [f64; 3] {
        let row: Vec<f64> = line.split(' ').map(|x| x.parse().expect("a number")).collect();
        row.try_into().expect("three numbers")
    };
    let normals: Vec<[f64; 3]> = text.lines().filter_map(|line| line.strip_prefix("vn ")).map(row).collect();
    let mut sides = vec![Vec::new(); n];
    for pair in text.lines().filter_map(|line| line.strip_prefix("f ")).flat_map(|line| line.split(' ')) {
        let (v, normal) = pair.split_once("//").expect("a vertex and a normal");
        let [v, normal] = [v, normal].map(|i| i.parse::<usize>().expect("an index") - 1);
        sides[v].push(normals[normal]);
    }
    (sides, report.warnings)
}

fn list<'a>(input: &'a Value, name: &str) -> &'a [Value] {
    input[name].as_array().expect("tags are a list")
}

/// Returns two lists of vertices of the input. At the first, ends of single creases, OpenSubdiv uses the smooth mask,
/// which differs from the rules by which it refines. At the second, there is no normal to compare: boundary vertices
/// with more than two faces, where it uses tangents of other weights, and corners, where it uses those of some faces.
fn special_vertices(input: &Value) -> (Vec<usize>, Vec<usize>) {
    let faces: Vec<Vec<usize>> = points(&input["faces"]);
    let creases: Vec<(usize, usize, f64)> = points(&input["creases"]);
    let net = Net { positions: points(&input["points"]), faces };
    let n = net.positions.len();
    let ends = |v: usize| creases.iter().filter(|&&(a, b, s)| s >= 10.0 && (a == v || b == v)).count();
    let n_faces = |v: usize| net.faces.iter().filter(|face| face.contains(&v)).count();
    let n_edges = |v: usize| net.edges().iter().filter(|&&(a, b)| a == v || b == v).count();
    let darts = (0..n).filter(|&v| ends(v) == 1).collect();
    let corners: Vec<(usize, f64)> = points(&input["corners"]);
    let is_corner = |v: usize| corners.iter().any(|&(corner, s)| corner == v && s >= 10.0);
    let others = (0..n).filter(|&v| is_corner(v) || n_edges(v) > n_faces(v) && n_faces(v) > 2).collect();
    (darts, others)
}
