//! Texture coordinates from files, through repairs.

use serde_json::{Value, json};

use super::told;

/// Returns the result of a mesh file with texture coordinates, after repairs.
fn of_file(file: &str, repairs: &Value) -> Value {
    let mut job = json!({ "input": { "text": { "format": "obj", "data": file } } });
    for (name, value) in repairs.as_object().expect("fields of the input") {
        job["input"][name] = value.clone();
    }
    told(job)
}

#[test]
fn files_bring_texture_coordinates_and_repairs_keep_them() {
    let strip = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.5 0.5\n";
    let seam = format!("{strip}f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 2/1 5/2 6/3\nf 2/5 6/3 3/4\n");
    let plain = of_file(&seam, &json!({}));
    let values = |result: &Value, f: usize| -> Vec<Value> {
        let places = result["uvs"]["faces"][f].as_array().expect("a face").clone();
        let place = |place: Value| usize::try_from(place.as_u64().expect("an index")).expect("small");
        places.into_iter().map(|at| result["uvs"]["values"][place(at)].clone()).collect()
    };
    assert_eq!(values(&plain, 3), [json!([0.5, 0.5]), json!([1, 1]), json!([0, 1])]);
    // the first two triangles agree along their edge, the others do not
    let paired = of_file(&seam, &json!({ "pair_quads": true }));
    assert_eq!(paired["faces"].as_array().map(Vec::len), Some(3));
    let mut quad = values(&paired, 0);
    quad.sort_by_key(ToString::to_string);
    assert_eq!(quad, [json!([0, 0]), json!([0, 1]), json!([1, 0]), json!([1, 1])]);
    assert_eq!(values(&paired, 2), values(&plain, 3));
    // a face that welding removes takes its corners along
    let sliver = format!("{strip}v 0 1 0\nf 1/1 3/3 4/4\nf 4/1 7/2 3/3\nf 1/1 2/2 3/3\n");
    let welded = of_file(&sliver, &json!({ "weld": 0 }));
    assert_eq!(values(&welded, 1), [json!([0, 0]), json!([1, 0]), json!([1, 1])]);
}
