//! The control mesh as the result instead of the refined mesh.

use serde_json::{Value, json};

use super::files::check_size;
use super::{bytes, job, written};
use crate::support::{json_with, nets, render};

/// Returns a cube with two hidden faces, sharp edges, groups, colours and texture coordinates.
fn cube(levels: u32) -> Value {
    let faces = [[0, 1, 2, 3], [3, 2, 1, 0], [0, 1, 2, 3], [0, 1, 2, 3], [1, 2, 3, 0], [0, 1, 2, 3]];
    let extra = json!({
        "holes": [1, 4],
        "creases": [{ "edge": [1, 0], "sharpness": 2.5 }],
        "corners": [{ "vertex": 3, "sharpness": 10 }],
        "groups": [{ "name": "hidden", "faces": [1, 4] }, { "name": "shown", "faces": [0, 2] }],
        "channels": { "weight": [0.25, 0, 0, 1, 0, 0, 0.5, 0] },
        "uvs": { "values": [[0, 0], [1, 0], [1, 1], [0, 1]], "faces": faces },
    });
    job(&nets::cube(), &extra, &json!({ "preset": "catmull-clark" }), levels)
}

#[test]
fn it_is_a_mesh_that_makes_the_same_job() {
    for levels in [0, 1, 2] {
        let given = cube(levels);
        let cage = json_with(given.clone(), &json!({ "cage": true }));
        for entry in ["faces", "holes", "creases", "corners", "groups", "channels"] {
            assert_eq!(cage[entry], given["input"]["mesh"][entry], "{entry}");
        }
        let mut sized = given.clone();
        sized["outputs"] = json!([{ "format": "json", "cage": true }]);
        check_size(&sized);
        let again = json!({ "input": { "mesh": cage }, "plan": given["plan"], "levels": levels });
        for output in [json!({ "format": "json" }), json!({ "format": "glb" }), json!({ "format": "usda" })] {
            assert_eq!(written(&again, &output), written(&given, &output), "{output} at level {levels}");
        }
    }
}

#[test]
fn holes_of_an_obj_file_are_kept_in_it() {
    let obj = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nf 1 2 5 4\nf 2 3 6 5\nt hole 1/0/0 1\n";
    let input = json!({ "text": { "format": "obj", "data": obj } });
    let file = json!({ "input": input, "plan": { "preset": "catmull-clark" }, "levels": 0 });
    let cage = json_with(file.clone(), &json!({ "cage": true }));
    assert_eq!(cage["faces"], json!([[0, 1, 4, 3], [1, 2, 5, 4]]));
    assert_eq!(cage["holes"], json!([1]));
    assert_eq!(json_with(file, &json!({}))["faces"], json!([[0, 1, 4, 3]]));
}

#[test]
fn it_goes_with_no_other_option_and_is_of_meshes() {
    let mut mesh = cube(1);
    mesh["outputs"] = json!([{ "format": "json", "cage": true, "ids": true }]);
    let refused = |job: &Value| render(job).expect_err("it is refused").remove(0);
    let fault = refused(&mesh);
    assert_eq!(fault.pointer, "/outputs/0/cage");
    assert!(fault.detail.contains("leave out what is beside it"), "{}", fault.detail);
    let line = json!({
        "input": { "polygon": { "points": [[0], [1]] } }, "outputs": [{ "format": "json", "cage": true }]
    });
    assert_eq!(refused(&line).pointer, "/outputs/0/cage");
    mesh["outputs"] = json!([{ "format": "json", "cage": false, "ids": true }]);
    assert!(!bytes(&mesh).is_empty());
}
