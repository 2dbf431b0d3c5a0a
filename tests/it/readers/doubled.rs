//! Vertices that files repeat because of different normals, colours or texture coordinates.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::gltf::{document, floats};
use crate::support;
use crate::support::nets::{self, Net, same_surface};

/// Returns a cube as exporters usually write it: four vertices per side, with their own normals and texture
/// coordinates.
fn cube_of_24() -> Value {
    let net = nets::cube();
    let (mut places, mut normals, mut uvs, mut order) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (f, face) in net.faces.iter().enumerate() {
        let corner = |j: usize| net.positions[face[j]];
        let [a, b, c] = [corner(0), corner(1), corner(2)];
        let normal = nets::triangle_normal(a, b, c);
        for (j, &v) in face.iter().enumerate() {
            #[expect(clippy::cast_possible_truncation, reason = "the numbers of a cube are small and whole")]
            places.extend(net.positions[v].map(|x| x as f32));
            #[expect(clippy::cast_possible_truncation, reason = "the normals of a cube are small and whole")]
            normals.extend(normal.map(|x| x as f32));
            uvs.extend([[0., 1.], [1., 1.], [1., 0.], [0., 0.]][j]);
        }
        let start = u8::try_from(4 * f).unwrap_or(0);
        order.extend([0, 1, 2, 0, 2, 3].map(|j| start + j));
    }
    document(
        &[floats(&places), floats(&normals), floats(&uvs), order],
        &json!({
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": 24, "type": "VEC3" },
                { "bufferView": 1, "componentType": 5126, "count": 24, "type": "VEC3" },
                { "bufferView": 2, "componentType": 5126, "count": 24, "type": "VEC2" },
                { "bufferView": 3, "componentType": 5121, "count": 36, "type": "SCALAR" },
            ],
            "meshes": [{ "primitives": [{
                "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "indices": 3,
            }] }],
            "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }], "scene": 0,
        }),
    )
}

/// The colours of the sides of a cube, in linear light.
const SIDES: [[f32; 3]; 6] = [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [1., 1., 0.], [0., 1., 1.], [1., 0., 1.]];

/// Returns a cube whose sides have different colours, and therefore four vertices each.
fn cube_of_six_colors() -> Value {
    let net = nets::cube();
    let (mut places, mut colors, mut order) = (Vec::new(), Vec::new(), Vec::new());
    for (f, face) in net.faces.iter().enumerate() {
        for &v in face {
            #[expect(clippy::cast_possible_truncation, reason = "the numbers of a cube are small and whole")]
            places.extend(net.positions[v].map(|x| x as f32));
            colors.extend(SIDES[f]);
        }
        let start = u8::try_from(4 * f).unwrap_or(0);
        order.extend([0, 1, 2, 0, 2, 3].map(|j| start + j));
    }
    document(
        &[floats(&places), floats(&colors), order],
        &json!({
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": 24, "type": "VEC3" },
                { "bufferView": 1, "componentType": 5126, "count": 24, "type": "VEC3" },
                { "bufferView": 2, "componentType": 5121, "count": 36, "type": "SCALAR" },
            ],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "COLOR_0": 1 }, "indices": 2 }] }],
            "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }], "scene": 0,
        }),
    )
}

/// PLY has one pair of texture coordinates per vertex, so that vertices at seams are split.
#[test]
fn a_ply_that_planish_wrote_with_texture_coordinates_is_refined_as_the_mesh_that_it_was() {
    let mut cube = nets::cube().to_json();
    cube["uvs"] = json!({ "values": [[0, 0], [1, 0], [1, 1], [0, 1]], "faces": vec![[0, 1, 2, 3]; 6] });
    let refined = |input: Value| {
        let plan = json!({ "preset": "catmull-clark" });
        let job = json!({ "input": input, "plan": plan, "levels": 2, "outputs": [{ "format": "json" }] });
        let (bytes, _) = support::render(&job).expect("it runs");
        serde_json::from_slice::<Value>(&bytes).expect("JSON")
    };
    let meant = refined(json!({ "mesh": cube }));
    for ascii in [false, true] {
        let job = json!({ "input": { "mesh": cube }, "outputs": [{ "format": "ply", "ascii": ascii }] });
        let (file, _) = support::render(&job).expect("it runs");
        let data = STANDARD.encode(&file);
        let text = |data: &str| json!({ "text": { "format": "ply", "data": data, "encoding": "base64" } });
        let back = refined(text(&data));
        let count = |mesh: &Value, what: &str| mesh[what].as_array().map(Vec::len);
        for what in ["positions", "faces"] {
            assert_eq!(count(&back, what), count(&meant, what), "{what}");
        }
        assert_eq!(count(&back["uvs"], "values"), count(&meant["uvs"], "values"));
        assert_eq!(back["warnings"].as_array().map_or(0, Vec::len), 1, "what was welded: {}", back["warnings"]);
        // files of other programs are read literally, and so are our own on request
        let other = String::from_utf8_lossy(&file).contains("comment planish\n").then(|| {
            let at = file.windows(7).position(|word| word == b"planish").expect("it says so");
            [&file[..at], b"another", &file[at + 7..]].concat()
        });
        let torn = refined(text(&STANDARD.encode(other.expect("it says so"))));
        assert!(count(&torn, "positions") > count(&meant, "positions"));
        let mut kept = text(&data);
        kept["weld"] = json!(false);
        assert_eq!(count(&refined(kept), "positions"), count(&torn, "positions"));
    }
}

#[test]
fn a_cube_of_six_colours_is_refined_into_a_closed_ball_whose_colours_meet_sharply() {
    let given = text(&cube_of_six_colors());
    let job = json!({ "input": given, "plan": { "preset": "catmull-clark" }, "levels": 2 });
    let found = support::json_with(job.clone(), &json!({ "ids": true }));
    let ball = refined(&nets::cube().input(), 2);
    same_surface(&Net::of(&found), &Net::of(&ball), 1e-6).expect("the same closed surface");
    let warnings = found["warnings"].to_string();
    assert!(!warnings.contains("differ") && !warnings.contains("boundary"), "{warnings}");
    // the 16 quads of each side have its colour in all their corners
    let color = &found["channels"]["color"];
    let index = |value: &Value| usize::try_from(value.as_u64().expect("an index")).expect("small");
    let faces = color["faces"].as_array().expect("the corners of faces");
    assert_eq!(faces.len(), 96);
    for (face, origin) in faces.iter().zip(found["ids"]["faces"].as_array().expect("ids")) {
        let expected = SIDES[index(origin)].map(f64::from);
        for place in face.as_array().expect("four places") {
            let value = color["values"][index(place)].as_array().expect("a color").iter().map(Value::as_f64);
            assert_eq!(value.collect::<Vec<_>>(), expected.map(Some), "{origin}");
        }
    }
    // as GLB it has the 25 vertices of each side, and under a plan it is read as it was
    let mut glb = job;
    glb["outputs"] = json!([{ "format": "glb", "normals": "none" }]);
    let (bytes, report) = support::render(&glb).expect("it is written");
    assert!(report.warnings.iter().all(|warning| !warning.contains("color")), "{:?}", report.warnings);
    let file = json!({ "format": "glb", "data": super::round_trips::base64(&bytes), "encoding": "base64" });
    let kept = support::json(json!({ "input": { "text": file } }));
    assert_eq!(kept["positions"].as_array().map(Vec::len), Some(6 * 25));
    let input = json!({ "text": file, "pair_quads": true });
    let again = refined(&input, 1);
    let finer = refined(&given, 3);
    assert_eq!(again["channels"]["color"]["values"].as_array().map(Vec::len), Some(6 * 81));
    assert_eq!(again["positions"].as_array().map(Vec::len), finer["positions"].as_array().map(Vec::len));
}

fn text(file: &Value) -> Value {
    json!({ "text": { "format": "gltf", "data": file.to_string() }, "pair_quads": true })
}

fn refined(input: &Value, levels: u32) -> Value {
    support::json(json!({ "input": input, "plan": { "preset": "catmull-clark" }, "levels": levels }))
}

#[test]
fn a_cube_of_24_vertices_is_refined_like_that_of_8() {
    let doubled = refined(&text(&cube_of_24()), 3);
    let cube = refined(&nets::cube().input(), 3);
    same_surface(&Net::of(&doubled), &Net::of(&cube), 1e-6).expect("the same surface");
    let warnings = doubled["warnings"].to_string();
    assert!(warnings.contains("welding merged 16 vertices"), "{warnings}");
    // each side keeps its own square of texture coordinates: its 4 corners give 24 places after all
    let uvs = &doubled["uvs"];
    assert_eq!(uvs["faces"].as_array().map(Vec::len), Some(384));
    let corners: Vec<&Value> = uvs["values"].as_array().into_iter().flatten().take(24).collect();
    let is = |value: &Value, k: usize, x: f64| value[k].as_f64() == Some(x);
    let at = |u: f64, v: f64| corners.iter().filter(|value| is(value, 0, u) && is(value, 1, v)).count();
    assert_eq!([at(0., 0.), at(1., 0.), at(0., 1.), at(1., 1.)], [6; 4]);
}

#[test]
fn they_stay_apart_where_that_is_asked_for_and_nothing_is_refined_with_gaps_unsaid() {
    let mut input = text(&cube_of_24());
    input["weld"] = json!(false);
    let torn = refined(&input, 1);
    let warnings = torn["warnings"].to_string();
    assert!(warnings.contains("24 edges of the boundary lie where others do"), "{warnings}");
    assert_eq!(Net::of(&torn).positions.len(), 6 * 9);
    // a conversion keeps the vertices of the file
    let kept = support::json(json!({ "input": text(&cube_of_24()) }));
    assert_eq!(Net::of(&kept).positions.len(), 24);
    assert!(kept.get("warnings").is_none_or(|warnings| !warnings.to_string().contains("edges")), "{kept}");
    for (wrong, sentence) in [(json!(true), "true says no distance"), (json!("0"), "a distance of at least 0")] {
        input["weld"] = wrong;
        let faults = support::parsed(json!({ "input": input }).to_string().as_bytes()).expect_err("it is refused");
        assert!(faults[0].pointer == "/input/weld" && faults[0].detail.contains(sentence), "{faults:?}");
    }
}

/// STL has no vertices: equal corners are joined, unless that is forbidden.
#[test]
fn facets_of_stl_stay_apart_where_that_is_asked_for() {
    let stl = json!({ "input": nets::tetrahedron().input(), "outputs": [{ "format": "stl" }] });
    let (bytes, _) = support::render(&stl).expect("it is written");
    let file = json!({ "format": "stl", "data": super::round_trips::base64(&bytes), "encoding": "base64" });
    let vertices = |input: Value| Net::of(&support::json(json!({ "input": input }))).positions.len();
    assert_eq!(vertices(json!({ "text": file })), 4);
    assert_eq!(vertices(json!({ "text": file, "weld": false })), 12);
    assert_eq!(vertices(json!({ "text": file, "weld": 0 })), 4);
    let torn = json!({ "input": { "text": file, "weld": false }, "plan": { "preset": "loop" }, "levels": 1 });
    assert!(support::json(torn)["warnings"].to_string().contains("12 edges of the boundary lie where others do"));
}

/// Formats with shared vertices are read literally; a warning reports gaps all the same.
#[test]
fn an_obj_with_gaps_is_told_of_them_with_the_remedy() {
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nf 1 2 3 4\nf 5 6 7 8\n";
    let input = json!({ "text": { "format": "obj", "data": obj } });
    let expected = "2 edges of the boundary lie where others do, and gaps open along them; \"weld\": 0 joins them: \
                    (1, 2), (7, 4)";
    assert_eq!(refined(&input, 1)["warnings"], json!([expected]));
    let mut welded = input.clone();
    welded["weld"] = json!(0);
    assert_eq!(refined(&welded, 1)["warnings"], json!(["welding merged 2 vertices: 4 into 1, 7 into 2"]));
    assert!(support::json(json!({ "input": input })).get("warnings").is_none());
}

/// Under a plan, a written file is read as the original mesh, with its seams.
#[test]
fn our_own_files_are_refined_as_the_mesh_that_was_written() {
    let job: Value = serde_json::from_str(include_str!("../../../api/examples/jobs/cube-uvs-obj.json")).expect("a job");
    let mut mesh = json!({ "mesh": job["input"]["mesh"] });
    // no file states how texture coordinates are interpolated
    mesh["mesh"]["uvs"]["interpolation"] = json!("all");
    for format in ["glb", "gltf"] {
        let written = json!({ "input": mesh, "outputs": [{ "format": format }] });
        let (bytes, _) = support::render(&written).expect("it is written");
        let data = super::round_trips::base64(&bytes);
        let file = json!({ "format": format, "data": data, "encoding": "base64" });
        let input = json!({ "text": file, "pair_quads": true });
        let (read, given) = (refined(&input, 2), refined(&mesh, 2));
        same_surface(&Net::of(&read), &Net::of(&given), 1e-6).expect("the same surface");
        // as many places, and the same texture coordinates at every corner of every face
        assert_eq!(read["uvs"]["values"].as_array().map(Vec::len), given["uvs"]["values"].as_array().map(Vec::len));
        assert_eq!(corners(&read), corners(&given), "{format}");
    }
}

/// Returns position and texture coordinates at all corners of all faces, rounded, in ascending order.
fn corners(result: &Value) -> Vec<[i64; 5]> {
    let number = |value: &Value, k: usize| {
        #[expect(clippy::cast_possible_truncation, reason = "the numbers are small")]
        let rounded = (value[k].as_f64().unwrap_or(f64::NAN) * 1e5).round() as i64;
        rounded
    };
    let mut found = Vec::new();
    let faces = result["faces"].as_array().into_iter().flatten();
    for (face, places) in faces.zip(result["uvs"]["faces"].as_array().into_iter().flatten()) {
        let both = face.as_array().into_iter().flatten().zip(places.as_array().into_iter().flatten());
        for (v, place) in both.map(|(v, place)| (v.as_u64().unwrap_or(0), place.as_u64().unwrap_or(0))) {
            let at = |list: &Value, i: u64| list[usize::try_from(i).unwrap_or(0)].clone();
            let (p, uv) = (at(&result["positions"], v), at(&result["uvs"]["values"], place));
            found.push([number(&p, 0), number(&p, 1), number(&p, 2), number(&uv, 0), number(&uv, 1)]);
        }
    }
    found.sort_unstable();
    found
}

/// Returns two cubes that touch along an edge, each with its own vertices: the second is the first, reflected at the
/// middle of the edge.
fn touching() -> Net {
    let one = nets::cube();
    let [a, b] = [one.positions[0], one.positions[1]];
    let other = one.positions.iter().map(|p| [0, 1, 2].map(|k| a[k] + b[k] - p[k]));
    let turned = one.faces.iter().map(|face| face.iter().rev().map(|v| v + 8).collect());
    let positions = one.positions.iter().copied().chain(other).collect();
    Net { positions, faces: one.faces.iter().cloned().chain(turned).collect() }
}

#[test]
fn bodies_that_touch_are_parted_again_where_nobody_asked_for_a_weld() {
    let apart = refined(&nets::triangulated(touching()).input(), 1);
    for format in ["glb", "gltf", "stl"] {
        let written = json!({ "input": touching().input(), "outputs": [{ "format": format }] });
        let (bytes, _) = support::render(&written).expect("it is written");
        let file = json!({ "format": format, "data": super::round_trips::base64(&bytes), "encoding": "base64" });
        let mut input = json!({ "text": file });
        let found = refined(&input, 1);
        same_surface(&Net::of(&found), &Net::of(&apart), 1e-6).expect("both cubes");
        let warnings = found["warnings"].to_string();
        for part in ["welding gives 1 edge more than two faces", "1 edge has more than two faces"] {
            assert!(warnings.contains(part), "{format}: {warnings}");
        }
        // with `refuse`, the fault mentions the other remedy
        input["non_manifold"] = json!("refuse");
        let job = json!({ "input": input, "plan": { "preset": "catmull-clark" }, "levels": 1 });
        let faults = support::faults(job.clone());
        assert!(faults[0].detail.contains("has 4 faces"), "{format}: {faults:?}");
        assert!(faults[0].detail.contains("\"weld\": false"), "{format}: {faults:?}");
        let mut welded = job;
        welded["input"]["non_manifold"] = Value::Null;
        welded["input"]["weld"] = json!(0);
        assert!(support::faults(welded)[0].detail.contains("\"non_manifold\": \"split\""), "{format}");
    }
}

/// A reversed face is a fault of the file, with or without a body beside it.
#[test]
fn bodies_that_touch_are_not_cut_where_a_face_is_turned() {
    let mut net = touching();
    // away from the common edge, whose four faces do not determine the winding
    let f = net.faces.iter().position(|face| !face.contains(&0) && !face.contains(&1)).expect("such a face");
    net.faces[f].reverse();
    let mut turned_back = nets::triangulated(net.clone());
    turned_back.faces[2 * f..2 * f + 2].iter_mut().for_each(|face| face.reverse());
    let apart = refined(&turned_back.input(), 1);
    for format in ["glb", "gltf", "stl"] {
        let written = json!({ "input": net.input(), "outputs": [{ "format": format }] });
        let (bytes, _) = support::render(&written).expect("it is written");
        let file = json!({ "format": format, "data": super::round_trips::base64(&bytes), "encoding": "base64" });
        let plan = json!({ "preset": "catmull-clark" });
        let mut job = json!({ "input": { "text": file }, "plan": plan, "levels": 1 });
        let faults = support::faults(job.clone());
        assert!(faults[0].detail.contains("in the same direction"), "{format}: {faults:?}");
        assert!(faults[0].detail.contains("\"orient\": \"repair\""), "{format}: {faults:?}");
        job["input"]["orient"] = json!("repair");
        let found = support::json(job);
        same_surface(&Net::of(&found), &Net::of(&apart), 1e-6).expect("both cubes");
    }
}
