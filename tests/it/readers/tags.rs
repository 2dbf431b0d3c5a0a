//! The tags of subdivision surfaces in OBJ.

use planish::scheme::tags::Boundary;
use serde_json::json;

use super::{mesh, sentences};
use crate::support;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

fn tagged(tags: &str) -> planish::input::ReadMesh {
    mesh("obj", format!("{SQUARE}{tags}").as_bytes())
}

#[test]
fn creases_and_corners_have_one_sharpness_for_all_or_one_each() {
    let found = tagged("t crease 2/1/0 0 1 2.5\nt crease 4/2/0 1 2 2 3 4 10\nt corner 2/1/0 0 3 1e1\n");
    assert_eq!(found.creases, [([0, 1], 2.5), ([1, 2], 4.0), ([2, 3], 10.0)]);
    assert_eq!(found.corners, [(0, 10.0), (3, 10.0)]);
    assert_eq!(tagged("t hole 1/0/0 0\n").holes, [0]);
}

#[test]
fn the_boundary_is_one_of_three() {
    assert_eq!(tagged("").boundary, None);
    for (n, boundary) in [(0, Boundary::None), (1, Boundary::EdgeAndCorner), (2, Boundary::EdgeOnly)] {
        assert_eq!(tagged(&format!("t interpolateboundary 1/0/0 {n}\n")).boundary, Some(boundary));
    }
}

/// The rule of the file applies if the plan states none; the plan's rule has precedence.
#[test]
fn the_plan_beats_the_file() {
    let file = format!("{SQUARE}t interpolateboundary 1/0/0 2\n");
    let job = |input: serde_json::Value, plan: serde_json::Value| {
        support::json(json!({ "input": input, "plan": plan, "levels": 1 }))
    };
    let text = json!({ "text": { "format": "obj", "data": file } });
    let plain = json!({ "text": { "format": "obj", "data": SQUARE } });
    let said = |boundary: &str| json!({ "preset": "catmull-clark", "boundary": boundary });
    let silent = json!({ "preset": "catmull-clark" });
    assert_eq!(job(text.clone(), silent.clone()), job(plain.clone(), said("edge-only")));
    assert_ne!(job(text.clone(), silent.clone()), job(plain.clone(), silent));
    assert_eq!(job(text, said("edge-and-corner")), job(plain, said("edge-and-corner")));
}

#[test]
fn other_tags_are_left_out_by_name() {
    let found = tagged("t facevaryinginterpolateboundary 1/0/0 1\nt facevaryinginterpolateboundary 1/0/0 2\n");
    assert_eq!(found.notes, ["tags \"facevaryinginterpolateboundary\" are left out: 2"]);
}

#[test]
fn a_wrong_tag_is_refused_by_its_line() {
    let check = |tags: &str, sentence: &str| {
        assert_eq!(sentences("obj", format!("{SQUARE}{tags}\n").as_bytes()), [format!("line 6: {sentence}")]);
    };
    check("t", "a tag without a name");
    check("t crease", "a tag without the numbers of its arguments; write for example 2/1/0");
    check("t crease 2/1 0 1 2", "\"2/1\" are no numbers of arguments; write for example 2/1/0");
    check("t crease 2/1/0 0 1", "the tag has 2 arguments, \"2/1/0\" says otherwise");
    check(
        "t crease 18446744073709551615/1/0 0 1",
        "the tag has 2 arguments, \"18446744073709551615/1/0\" says otherwise",
    );
    check("t crease 3/1/0 0 1 2 5", "a crease of 3 vertices; give pairs");
    check("t crease 2/0/0 0 1", "the tag names 1 places and has 0 numbers; give one for all, or one for each");
    check("t crease 2/1/0 0 1 -2", "-2 is no sharpness; 0 is smooth, 10 or more infinitely sharp");
    check("t crease 2/1/0 0 1.5 2", "\"1.5\" is no whole number of at least 0");
    check("t crease 2/1/0 0 4 2", "there is no vertex 4; the file has 4, in tags counted from 0");
    check("t corner 1/1/0 9 2", "there is no vertex 9; the file has 4, in tags counted from 0");
    check("t hole 1/0/0 1", "there is no face 1; the file has 1, in tags counted from 0");
    check(
        "t interpolateboundary 1/0/0 3",
        "interpolateboundary takes one of 0 (none), 1 (edge and corner), 2 (edge only)",
    );
}

/// Sharpness is written to formats that can hold it: a converted mesh refines like the original.
#[test]
fn converted_meshes_stay_sharp() {
    let mut input = support::nets::cube().input();
    input["mesh"]["creases"] = json!([
        { "edge": [0, 1], "sharpness": 2.5 }, { "edge": [2, 0], "sharpness": 11 }, { "edge": [5, 4], "sharpness": 0 }
    ]);
    input["mesh"]["corners"] = json!([{ "vertex": 7, "sharpness": 0.1 }, { "vertex": 3, "sharpness": 10 }]);
    let refined = |input: &serde_json::Value| {
        let plan = json!({ "preset": "catmull-clark" });
        let job = json!({ "input": input, "plan": plan, "levels": 2, "outputs": [{ "format": "json" }] });
        support::render(&job).unwrap_or_else(|faults| panic!("{faults:?}")).0
    };
    let direct = refined(&input);
    for options in
        [json!({ "format": "obj" }), json!({ "format": "obj", "normals": "area" }), json!({ "format": "json" })]
    {
        let written = |input: &serde_json::Value, levels: u32| {
            let plan = json!({ "preset": "catmull-clark" });
            let job = json!({ "input": input, "plan": plan, "levels": levels, "outputs": [options] });
            String::from_utf8(support::render(&job).unwrap_or_else(|faults| panic!("{faults:?}")).0).expect("text")
        };
        let text = written(&input, 0);
        if options["format"] == "obj" {
            let tags = "t crease 2/1/0 0 2 10\nt crease 2/1/0 1 0 2.5\nt corner 1/1/0 3 10\nt corner 1/1/0 7 0.1\n";
            assert!(text.ends_with(tags), "{text}");
        }
        let file = json!({ "text": { "format": options["format"], "data": text } });
        assert_eq!(written(&file, 0), text);
        assert_eq!(refined(&file), direct);
        let finer = written(&input, 1);
        assert!(!finer.contains("t crease") && !finer.contains("\"creases"), "{finer}");
    }
}

/// Tags of a file are equivalent to `creases`, `corners` and `holes` of a mesh: the same job, the same key.
#[test]
fn tags_say_what_a_mesh_says() {
    let grid = support::nets::grid(2, 1);
    let vertex = |obj: String, [x, y, z]: &[f64; 3]| format!("{obj}v {x} {y} {z}\n");
    let mut obj = grid.positions.iter().fold(String::new(), vertex);
    obj += "f 1 2 5 4\nf 2 3 6 5\nt crease 2/1/0 4 1 1.5\nt corner 2/2/0 0 2 3 10\nt hole 1/0/0 1\n";
    let mut mesh = grid.input();
    mesh["mesh"]["creases"] = json!([{ "edge": [1, 4], "sharpness": 1.5 }]);
    mesh["mesh"]["corners"] = json!([{ "vertex": 0, "sharpness": 3 }, { "vertex": 2, "sharpness": 10 }]);
    mesh["mesh"]["holes"] = json!([1]);
    let plan = json!({ "preset": "catmull-clark" });
    let job = |input| json!({ "input": input, "plan": plan, "levels": 2, "outputs": [{ "format": "json" }] });
    let [file, mesh] = [json!({ "text": { "format": "obj", "data": obj } }), mesh].map(job);
    let id = |job: &serde_json::Value| support::parsed(job.to_string().as_bytes()).expect("a job").id();
    assert_eq!(id(&file), id(&mesh));
    assert_eq!(support::render(&file), support::render(&mesh));
}
