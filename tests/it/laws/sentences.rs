//! Messages of refusals are true of the input, and helpful.

use serde_json::{Value, json};

use crate::support::{self, faults, nets};

fn told(input: &Value, plan: &Value) -> String {
    let fault = &faults(json!({ "input": input, "plan": plan, "levels": 1 }))[0];
    format!("{}: {}", fault.pointer, fault.detail)
}

/// A function is evaluated at the plan's alpha as well, whatever alpha points have: the message says so, with the
/// remedy.
#[test]
fn functions_without_a_value_at_the_alpha_of_the_plan_are_told_so() {
    let mut alpha = nets::cube().input();
    alpha["mesh"]["parameters"] = json!({ "alpha": vec![1; 8] });
    let plan = |alpha: f64| json!({ "word": "UCP", "parameters": { "kernel": "sin(alpha)/alpha", "alpha": alpha } });
    let said = told(&alpha, &plan(0.0));
    let expected = "/plan/parameters/kernel: the kernel is NaN at level 1 (alpha = 0); it must be finite at every \
                    level for the alpha of the plan, even where points or latitude lines have their own: give another \
                    \"alpha\" in the plan";
    assert!(said.starts_with(expected), "{said}");
    let [one, two] = [1.0, 2.0].map(|other| support::json(json!({ "input": alpha, "plan": plan(other), "levels": 1 })));
    assert_eq!(one, two);
}

/// The message about a function without a value names its variable.
#[test]
fn functions_without_a_value_name_their_variable() {
    let delta = json!({ "word": "UCP", "parameters": { "delta": "1/(valence-4)" } });
    let said = told(&nets::torus(4, 3).input(), &delta);
    assert_eq!(
        said,
        "/plan/parameters/delta: the expression is not finite (inf) at valence = 4; change the expression or the \
         parameter"
    );
    let tube = nets::torus(4, 3);
    let mut input = tube.input();
    input["mesh"]["latitude"] = json!(tube.faces.iter().map(|face| [face[0], face[1]]).collect::<Vec<_>>());
    input["mesh"]["parameters"] = json!({ "alpha": vec![0.5; tube.positions.len()] });
    let plan = json!({ "word": "UCP", "parameters": { "kernel_longitude": "1/(alpha-0.5)" } });
    let said = told(&input, &plan);
    assert!(said.contains("kernel_longitude of point 0: the expression is not finite (inf) at alpha = 0.5"), "{said}");
}

/// Presets without a kernel refuse kernels of vertices, and tags of lines.
#[test]
fn presets_without_a_kernel_refuse_what_vertices_and_edges_carry() {
    let tube = nets::torus(4, 3);
    let lines: Vec<[usize; 2]> = tube.faces.iter().map(|face| [face[0], face[1]]).collect();
    for preset in ["repeated-averaging", "bilinear", "catmull-clark", "kobbelt", "doo-sabin"] {
        for (key, value, what) in [
            ("latitude", json!(lines), "latitude and longitude tags"),
            ("parameters", json!({ "kernel": vec![3; 12] }), "parameters of vertices"),
        ] {
            let mut input = tube.input();
            input["mesh"][key] = value;
            let said = told(&input, &json!({ "preset": preset }));
            let expected =
                format!("/plan/preset: this scheme knows no {what}; leave them out or use a word over U, C and P");
            assert_eq!(said, expected, "{preset}");
        }
    }
}

/// If one edge or vertex has two sharpnesses, the message contains the full pointer to the other one.
#[test]
fn the_other_of_two_sharpnesses_is_told_with_its_whole_place() {
    let crease = |edge: [usize; 2], sharpness: f64| json!({ "edge": edge, "sharpness": sharpness });
    let edge = nets::cube().faces[0][..2].to_vec();
    let mut input = nets::cube().input();
    input["mesh"]["creases"] = json!([crease([edge[0], edge[1]], 1.0), crease([edge[1], edge[0]], 3.0)]);
    let plan = json!({ "preset": "catmull-clark" });
    let said = told(&input, &plan);
    assert!(said.starts_with("/input/mesh/creases/1/sharpness: edge ("), "{said}");
    assert!(said.ends_with(") has sharpness 1 at /input/mesh/creases/0 and 3 here; give it one"), "{said}");
    // no pointer leads into a file
    let text = json!({ "text": { "format": "json", "data": input["mesh"].to_string() } });
    let said = told(&text, &plan);
    assert!(said.starts_with("/input/text/data: in the mesh, /creases/1/sharpness: edge ("), "{said}");
    assert!(said.ends_with(") has sharpness 1 at /creases/0 and 3 here; give it one"), "{said}");
}
