//! Results of OpenSubdiv 3.5 for texture coordinates: values in several fans of a vertex, values of several vertices,
//! seams that meet and seams that end inside, under all interpolations.

use serde_json::{Value, json};

use super::{points, tolerance};
use crate::support::json;
use crate::support::nets::distance;

/// Compares the values of all cases, each as a set: OpenSubdiv has one value where ours has several equal ones.
pub(super) fn cases(vector: &Value) -> usize {
    let cases = vector["cases"].as_array().expect("cases are a list");
    cases.iter().map(|case| check(vector, case)).count()
}

fn check(vector: &Value, case: &Value) {
    let shape = &vector["meshes"][case["mesh"].as_str().expect("the name of a mesh")];
    let mut mesh = json!({ "positions": shape["positions"], "faces": shape["faces"], "uvs": shape["uvs"] });
    mesh["uvs"]["interpolation"] = case["interpolation"].clone();
    if case["sharp"] == true {
        let list = |name: &str| shape[name].as_array().expect("tags are a list").iter();
        let creases = list("creases").map(|crease| json!({ "edge": [crease[0], crease[1]], "sharpness": crease[2] }));
        mesh["creases"] = creases.collect();
        mesh["corners"] = list("corners").map(|c| json!({ "vertex": c[0], "sharpness": c[1] })).collect();
    }
    let job = json!({
        "input": { "mesh": mesh },
        "plan": { "preset": case["preset"], "boundary": case["boundary"] },
        "levels": case["level"],
    });
    let result = json(job);
    let found: Vec<[f64; 2]> = points(&result["uvs"]["values"]);
    let expected: Vec<[f64; 2]> = points(&case["values"]);
    for (some, others, whose) in [(&found, &expected, "ours"), (&expected, &found, "theirs")] {
        for p in some {
            let nearest = others.iter().map(|q| distance(p, q)).fold(f64::INFINITY, f64::min);
            assert!(
                nearest <= tolerance(vector),
                "{whose} {p:?} is {nearest} off: {} {} {} sharp {} level {}",
                case["mesh"],
                case["interpolation"],
                case["boundary"],
                case["sharp"],
                case["level"]
            );
        }
    }
}
