//! Sharp edges and corners of every kind, on every kind of mesh: results of the forecast size, or refusals that name
//! where sharpness is not allowed.

use planish::fault::Fault;
use planish::job::limits::Limits;
use planish::output::{FORMATS, ShapeKind, Size};
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::{faults, json as refined, nets, parsed, render};

fn tagged(creases: Value, corners: Value) -> Value {
    let mut mesh = nets::cube().to_json();
    mesh["creases"] = creases;
    mesh["corners"] = corners;
    json!({ "mesh": mesh })
}

fn job(input: &Value, plan: &Value) -> Value {
    json!({ "input": input, "plan": plan, "levels": 1 })
}

#[test]
fn words_know_infinitely_sharp_edges_alone() {
    let finite = "of a sharpness between 0 and 10 belong to catmull-clark and loop; here an edge or vertex is smooth \
                  (0) or infinitely sharp (10 or more)";
    let edge = |sharpness: f64| json!([{ "edge": [0, 1], "sharpness": sharpness }]);
    let corner = |sharpness: f64| json!([{ "vertex": 0, "sharpness": sharpness }]);
    for word in ["U", "C", "UC", "UCP", "U(UCP)"] {
        let plan = json!({ "word": word });
        for (tags, name) in [(tagged(edge(9.5), json!([])), "creases"), (tagged(edge(10.0), corner(0.5)), "corners")] {
            let found = faults(job(&tags, &plan));
            assert_eq!((found.len(), found[0].pointer.as_str()), (1, "/plan/word"), "{word}: {found:?}");
            assert_eq!(found[0].detail, format!("{name} {finite}"), "{word}");
        }
        refined(job(&tagged(edge(10.0), corner(10.0)), &plan));
        refined(job(&tagged(edge(0.0), corner(0.0)), &plan));
    }
    for preset in ["push-back", "bilinear"] {
        let found = faults(job(&tagged(edge(1.0), json!([])), &json!({ "preset": preset })));
        assert_eq!((found.len(), found[0].pointer.as_str()), (1, "/plan/preset"), "{preset}: {found:?}");
    }
    refined(job(&tagged(edge(9.5), corner(0.5)), &json!({ "preset": "catmull-clark" })));
    refined(json!({ "input": tagged(edge(9.5), corner(0.5)), "levels": 0 }));
}

/// Many sharp edges at one vertex: counting around it is done once.
#[test]
fn a_vertex_of_many_creases_is_no_trap() {
    let n = 2000_u32;
    let mut positions: Vec<[f64; 3]> = (0..n).map(|i| [f64::from(i % 50), f64::from(i / 50), 0.0]).collect();
    positions.push([25.0, 20.0, 9.0]);
    let faces: Vec<_> = (0..n).map(|i| [i, (i + 1) % n, n]).collect();
    let creases: Vec<_> = (0..n).map(|i| json!({ "edge": [n, i], "sharpness": 1.5 })).collect();
    let mesh = json!({ "positions": positions, "faces": faces, "creases": creases });
    let plan = json!({ "preset": "catmull-clark", "parameters": { "creasing": "chaikin" } });
    let result = refined(json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 1 }));
    assert_eq!(nets::Net::of(&result).positions.get(n as usize), Some(&[25.0, 20.0, 9.0]));
}

fn sharpness() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(10.0), Just(1e300), Just(5e-324), Just(9.999), 0.0..4.0_f64]
}

/// Whether an output is refused: a solid, because fans of faces touch, vertices have two faces, no face is visible, or
/// it has too many; or a model of 3MF, because no face is visible.
fn has_no_solid(format: &str, faults: &[Fault]) -> bool {
    let [fault] = faults else { return false };
    let is_empty = format == "3mf" && fault.detail.starts_with("no face is shown");
    is_empty || SOLID.contains(&format) && fault.pointer.starts_with("/outputs/0")
}

const SOLID: [&str; 2] = ["step", "certificate"];

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bytes_of_creased_meshes_are_as_forecast(
        net in nets::manifold(),
        sharp in (proptest::collection::vec(sharpness(), 40), proptest::collection::vec(sharpness(), 6)),
        hole in any::<prop::sample::Index>(),
        rules in (any::<bool>(), any::<bool>(), 0..3_usize),
        levels in 0..3_u32,
    ) {
        let mut mesh = net.to_json();
        let crease = |((a, b), sharpness): ((usize, usize), &f64)| json!({ "edge": [b, a], "sharpness": sharpness });
        mesh["creases"] = net.edges().into_iter().zip(&sharp.0).map(crease).collect();
        let corner = |(v, sharpness): (usize, &f64)| json!({ "vertex": v, "sharpness": sharpness });
        mesh["corners"] = sharp.1.iter().take(net.positions.len()).enumerate().map(corner).collect();
        mesh["holes"] = json!([hole.index(net.faces.len())]);
        let boundary = ["none", "edge-only", "edge-and-corner"][rules.2];
        let creasing = if rules.0 { "chaikin" } else { "uniform" };
        let triangle_rule = if rules.1 { "smooth" } else { "catmark" };
        let parameters = json!({ "creasing": creasing, "triangle_rule": triangle_rule });
        let plan = json!({ "preset": "catmull-clark", "boundary": boundary, "parameters": parameters });
        for format in FORMATS.iter().filter(|format| format.holds(ShapeKind::Mesh).is_ok()) {
            for normals in [None, Some("area")] {
                let mut output = json!({ "format": format.name() });
                if SOLID.contains(&format.name()) && (normals.is_some() || levels > 0) {
                    continue; // they have none, and edges that are sharp for ten levels take them long
                }
                match (format.name(), normals) {
                    ("step" | "certificate", _) => {
                        (output["tolerance"], output["continuity"]) = (json!(1e-2), json!("bicubic"));
                    }
                    ("png", _) => (output["width"], output["height"]) = (json!(32), json!(24)),
                    ("apng", _) => {
                        (output["width"], output["height"], output["frames"]) = (json!(32), json!(24), json!(3));
                    }
                    ("obj" | "ply" | "glb" | "gltf", Some(normals)) => {
                        (output["normals"], output["ids"]) = (json!(normals), json!(true));
                    }
                    _ => {}
                }
                let text = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels, "outputs": [output] });
                let excuse = |faults: Vec<Fault>| {
                    let known = has_no_solid(format.name(), &faults);
                    if known { Ok(()) } else { Err(TestCaseError::fail(format!("{faults:?} for {text}"))) }
                };
                let job = match parsed(text.to_string().as_bytes()) {
                    Ok(job) => job,
                    Err(faults) => {
                        excuse(faults)?;
                        continue;
                    }
                };
                let size = Limits::default().estimate(&job).expect("it is small").outputs[0].1;
                let bytes = match render(&text) {
                    Ok((bytes, _)) => bytes,
                    Err(faults) => {
                        excuse(faults)?;
                        continue;
                    }
                };
                match size {
                    Size::Exact(n) => prop_assert_eq!(n, bytes.len() as u128, "{}", text),
                    Size::AtMost(n) => prop_assert!(bytes.len() as u128 <= n, "{} > {}: {}", bytes.len(), n, text),
                }
            }
        }
    }
}
