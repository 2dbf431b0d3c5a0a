//! Edges whose faces meet at more than an angle look hard: the normals on their two sides differ.

use planish::math::functions::{cos, real, sin};
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::nets::{self, Net};
use crate::support::{parsed, render};

/// Returns the glTF of a mesh under a plan.
fn gltf(mesh: &Value, plan: &Value, levels: u32, options: &Value) -> Value {
    let mut output = options.clone();
    output["format"] = json!("gltf");
    let mut job = json!({ "input": { "mesh": mesh }, "levels": levels, "outputs": [output] });
    if !plan.is_null() {
        job["plan"] = plan.clone();
    }
    let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
    serde_json::from_slice(&bytes).expect("glTF is JSON")
}

/// Returns the number of vertices in a glTF.
fn n_vertices(document: &Value) -> u64 {
    let positions = document["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().expect("an accessor");
    document["accessors"][usize::try_from(positions).expect("small")]["count"].as_u64().expect("a count")
}

fn straight_cube() -> Net {
    let positions = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
    Net { positions, ..nets::cube() }
}

/// Returns a prism over a regular polygon of `n` corners.
fn tube(n: usize) -> Net {
    let at = |i: usize, z: f64| {
        let angle = 2.0 * std::f64::consts::PI * real(i) / real(n);
        // as many digits as f32 has
        [cos(angle), sin(angle), z].map(|x| f64::from_bits(x.to_bits() >> 29 << 29))
    };
    let positions = [0.0, 1.0].iter().flat_map(|&z| (0..n).map(move |i| at(i, z))).collect();
    Net { positions, ..nets::prism(n) }
}

#[test]
fn a_cube_is_hard_at_level_0_and_under_linear_interpolation_and_smooth_under_smooth_schemes() {
    let cube = straight_cube().to_json();
    let (none, bilinear) = (json!(null), json!({ "preset": "bilinear" }));
    assert_eq!(n_vertices(&gltf(&cube, &none, 0, &json!({}))), 24);
    assert_eq!(n_vertices(&gltf(&cube, &none, 0, &json!({ "crease_angle": 180 }))), 8);
    assert_eq!(n_vertices(&gltf(&cube, &none, 0, &json!({ "crease_angle": 90 }))), 8);
    assert_eq!(n_vertices(&gltf(&cube, &none, 0, &json!({ "normals": "none" }))), 8);
    // each of the twelve edges adds a copy of its new vertex, each of the eight corners two copies
    assert_eq!(n_vertices(&gltf(&cube, &bilinear, 1, &json!({}))), 26 + 12 + 16);
    assert_eq!(n_vertices(&gltf(&cube, &json!({ "word": "UC" }), 0, &json!({}))), 24);
    assert_eq!(n_vertices(&gltf(&cube, &json!({ "preset": "catmull-clark" }), 1, &json!({}))), 26);
    // all of its 24 faces are separate
    assert_eq!(n_vertices(&gltf(&cube, &json!({ "preset": "catmull-clark" }), 1, &json!({ "crease_angle": 5 }))), 96);
}

#[test]
fn a_prism_of_twelve_sides_is_round_and_one_of_eleven_is_not() {
    let of = |n: usize, angle: f64| {
        n_vertices(&gltf(&tube(n).to_json(), &json!(null), 0, &json!({ "crease_angle": angle })))
    };
    // its two lids are hard everywhere
    assert_eq!([of(12, 30.0), of(12, 29.0), of(11, 30.0)], [48, 72, 66]);
}

#[test]
fn the_angle_that_is_meant_enters_the_key_however_it_is_said() {
    let key = |levels: u32, options: Value| {
        let mut output = options;
        output["format"] = json!("png");
        let job = json!({ "input": straight_cube().input(), "plan": { "preset": "catmull-clark" }, "levels": levels,
            "outputs": [output] });
        parsed(job.to_string().as_bytes()).expect("a job").keys()[0]
    };
    assert_eq!(key(0, json!({})), key(0, json!({ "crease_angle": 30 })));
    assert_eq!(key(1, json!({})), key(1, json!({ "crease_angle": 180 })));
    assert_ne!(key(0, json!({})), key(0, json!({ "crease_angle": 180 })));
    assert_ne!(key(1, json!({})), key(1, json!({ "crease_angle": 30 })));
    assert_eq!(key(0, json!({ "normals": "limit" })), key(0, json!({ "normals": "limit", "crease_angle": 180 })));
    assert_eq!(key(0, json!({ "shading": "flat" })), key(0, json!({ "shading": "flat", "crease_angle": 7 })));
}

#[test]
fn hard_edges_split_what_seams_of_texture_coordinates_have_left_whole() {
    // all faces have the corners of the unit square: every edge is a seam, and every vertex occurs three times
    let mut mesh = straight_cube().to_json();
    let corners = json!([[0, 0], [1, 0], [1, 1], [0, 1]]);
    mesh["uvs"] = json!({ "values": corners, "faces": vec![[0, 1, 2, 3]; 6] });
    for angle in [30, 180] {
        let document = gltf(&mesh, &json!(null), 0, &json!({ "crease_angle": angle }));
        assert!((8..=24).contains(&n_vertices(&document)), "{angle}");
    }
    // one value for all corners: no seam
    mesh["uvs"] = json!({ "values": [[0, 0]], "faces": vec![[0, 0, 0, 0]; 6] });
    assert_eq!(n_vertices(&gltf(&mesh, &json!(null), 0, &json!({}))), 24);
}

#[test]
fn all_frames_are_split_where_the_first_one_is() {
    let mut mesh = straight_cube().to_json();
    let flat: Vec<_> = straight_cube().positions.iter().map(|&[x, y, z]| [x, y, 1e-6 * z]).collect();
    mesh["frames"] = json!([flat]);
    let document = gltf(&mesh, &json!(null), 0, &json!({}));
    assert_eq!(n_vertices(&document), 24);
    let target = &document["meshes"][0]["primitives"][0]["targets"][0]["POSITION"];
    let target = usize::try_from(target.as_u64().expect("an accessor")).expect("small");
    assert_eq!(document["accessors"][target]["count"], 24);
}

#[test]
fn an_angle_beyond_180_degrees_is_refused() {
    let mut job = json!({ "input": straight_cube().input() });
    job["outputs"] = json!([{ "format": "png", "crease_angle": 181 }]);
    let faults = parsed(job.to_string().as_bytes()).expect_err("no angle");
    assert_eq!(faults[0].pointer, "/outputs/0/crease_angle");
    assert!(faults[0].detail.contains("from 0 to 180"), "{}", faults[0].detail);
    job["outputs"] = json!([{ "format": "obj", "crease_angle": 30 }]);
    let faults = parsed(job.to_string().as_bytes()).expect_err("obj has no such option");
    assert_eq!(faults[0].pointer, "/outputs/0/crease_angle");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Which edges are hard does not depend on the order of the faces.
    #[test]
    fn the_order_of_faces_does_not_matter(net in nets::manifold(), angle in 0.0..180.0_f64) {
        let options = json!({ "crease_angle": angle });
        let mut turned = net.clone();
        turned.faces.reverse();
        let [here, there] = [net, turned].map(|net| n_vertices(&gltf(&net.to_json(), &json!(null), 0, &options)));
        prop_assert_eq!(here, there);
    }
}
