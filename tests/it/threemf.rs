//! 3MF: a reproducible archive, and a model with unit, up axis, looks and parts.

use std::io::Read;

use planish::job::limits::Limits;
use planish::output::Size;
use serde_json::{Value, json};

use crate::support::nets::{self, Net};
use crate::support::{parsed, render};

/// Returns the files of an archive by name, in the order of its directory.
fn files(bytes: &[u8]) -> Vec<(String, String)> {
    let number =
        |at: usize, n: usize| bytes[at..at + n].iter().rev().fold(0, |all, &byte| all << 8 | usize::from(byte));
    let end = bytes.len() - 22;
    let mut at = number(end + 16, 4);
    let file = |_| {
        let (packed, name, offset) = (number(at + 20, 4), number(at + 28, 2), number(at + 42, 4));
        let start = offset + 30 + number(offset + 26, 2) + number(offset + 28, 2);
        let mut text = String::new();
        let mut decoder = flate2::read::DeflateDecoder::new(&bytes[start..start + packed]);
        decoder.read_to_string(&mut text).expect("it is deflated text");
        assert_eq!(text.len(), number(at + 24, 4));
        let found = (String::from_utf8(bytes[at + 46..at + 46 + name].to_vec()).expect("a name"), text);
        at += 46 + name + number(at + 30, 2) + number(at + 32, 2);
        found
    };
    (0..number(end + 10, 2)).map(file).collect()
}

fn model(job: &Value) -> String {
    let found = files(&bytes(job));
    let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"]);
    found[2].1.clone()
}

fn bytes(job: &Value) -> Vec<u8> {
    render(job).unwrap_or_else(|faults| panic!("{faults:?} for {job}")).0
}

fn warnings(job: &Value) -> Vec<String> {
    render(job).expect("it is written").1.warnings
}

fn job(net: &Net, extra: &Value, options: &Value) -> Value {
    let mut mesh = net.to_json();
    for (name, value) in extra.as_object().expect("fields of a mesh") {
        mesh[name] = value.clone();
    }
    let mut output = options.clone();
    output["format"] = json!("3mf");
    json!({ "input": { "mesh": mesh, "up": "z" }, "outputs": [output] })
}

/// Returns two cubes beside each other.
fn two() -> Net {
    let one = nets::cube();
    let positions = one.positions.iter().copied().chain(one.positions.iter().map(|&[x, y, z]| [x + 9.0, y, z]));
    let faces = one.faces.iter().cloned().chain(one.faces.iter().map(|face| face.iter().map(|v| v + 8).collect()));
    Net { positions: positions.collect(), faces: faces.collect() }
}

fn count(text: &str, what: &str) -> usize {
    text.matches(what).count()
}

#[test]
fn a_mesh_is_one_object_of_triangles_in_the_unit_of_the_input() {
    let mut asked = job(&nets::cube(), &json!({}), &json!({}));
    let found = model(&asked);
    for (what, n) in [("<object ", 1), ("<vertex ", 8), ("<triangle ", 12), ("<item ", 1), ("pid=", 0)] {
        assert_eq!(count(&found, what), n, "{what} in {found}");
    }
    assert!(found.contains("<model unit=\"meter\"") && !found.contains("transform"), "{found}");
    assert!(found.contains("<triangle v1=\""), "{found}");
    for (unit, name) in [("mm", "millimeter"), ("cm", "centimeter"), ("in", "inch"), ("m", "meter")] {
        asked["input"]["unit"] = json!(unit);
        assert!(model(&asked).contains(&format!("<model unit=\"{name}\"")), "{unit}");
    }
    asked["input"]["up"] = json!("y");
    assert!(model(&asked).contains("<item objectid=\"3\" transform=\"1 0 0 0 0 1 0 -1 0 0 0 0\"/>"));
    assert_eq!(bytes(&asked), bytes(&asked), "the archive holds no time and no chance");
}

#[test]
fn materials_are_base_materials_and_faces_without_one_have_the_default() {
    let materials = json!({ "materials": [
        { "name": "red&<\"", "faces": [0], "color": [1, 0, 0, 0.5] }, { "name": "plain", "faces": [1, 2] },
    ] });
    let found = model(&job(&nets::cube(), &materials, &json!({})));
    assert!(found.contains("<base name=\"red&amp;&lt;&quot;\" displaycolor=\"#FF000080\"/>"), "{found}");
    assert!(found.contains("<base name=\"default\"") && found.contains(" pid=\"1\" pindex=\"2\">"), "{found}");
    assert_eq!([count(&found, "pid=\"1\" p1=\"0\""), count(&found, "pid=\"1\" p1=\"1\"")], [2, 4]);
    let all = json!({ "materials": [{ "name": "blue", "faces": [0, 1, 2, 3, 4, 5], "color": [0, 0, 1] }] });
    let found = model(&job(&nets::cube(), &all, &json!({})));
    assert!(found.contains(" pid=\"1\" pindex=\"0\">") && !found.contains("p1="), "{found}");
}

#[test]
fn colors_of_vertices_come_before_materials() {
    let colors: Vec<[f64; 3]> = (0..8).map(|i| [f64::from(i) / 7.0, 0.0, 1.0]).collect();
    let extra = json!({ "channels": { "color": colors }, "materials": [{ "name": "red", "faces": [0] }] });
    let asked = job(&nets::cube(), &extra, &json!({}));
    let found = model(&asked);
    assert_eq!([count(&found, "<m:color "), count(&found, "<base ")], [8, 0]);
    assert!(found.contains("<m:color color=\"#0000FFFF\"/>\n<m:color color=\"#2400FFFF\"/>"), "{found}");
    assert!(found.contains(" pid=\"2\" pindex=\"0\">"), "{found}");
    let warnings = warnings(&asked);
    assert!(warnings.iter().any(|warning| warning.starts_with("materials are left out")), "{warnings:?}");
}

#[test]
fn connected_parts_are_objects_named_by_their_groups() {
    let groups = json!({ "groups": [{ "name": "left", "faces": [0, 1, 2, 3, 4, 5] }] });
    let one = job(&two(), &groups, &json!({}));
    assert_eq!(count(&model(&one), "<object "), 1);
    assert!(warnings(&one).iter().any(|warning| warning.contains("groups are left out")));
    let parted = job(&two(), &groups, &json!({ "parts": "components" }));
    let found = model(&parted);
    assert!(found.contains("<object id=\"3\" type=\"model\" name=\"left\">"), "{found}");
    assert!(found.contains("<object id=\"4\" type=\"model\" name=\"part-2\">"), "{found}");
    assert!(found.contains("<item objectid=\"3\"/>\n<item objectid=\"4\"/>"), "{found}");
    let [first, second] = [0, 1].map(|i| found.split("<object ").nth(i + 1).expect("an object"));
    assert_eq!([first, second].map(|object| [count(object, "<vertex "), count(object, "<triangle ")]), [[8, 12]; 2]);
    let triangles = |object: &str| object.lines().filter(|line| line.starts_with("<triangle")).collect::<String>();
    assert_eq!(triangles(first), triangles(second), "each is numbered from 0");
    assert!(warnings(&parted).is_empty(), "{:?}", warnings(&parted));
}

#[test]
fn a_refined_mesh_has_the_same_parts_whatever_its_scheme() {
    for (preset, faces) in [("catmull-clark", 24), ("doo-sabin", 26)] {
        let mut asked = job(&two(), &json!({}), &json!({ "parts": "components" }));
        asked["plan"] = json!({ "preset": preset });
        asked["levels"] = json!(1);
        let found = model(&asked);
        assert_eq!(count(&found, "<object "), 2, "{preset}");
        assert!(count(&found, "<triangle ") >= 2 * 2 * (faces - 8), "{preset}");
    }
}

#[test]
fn the_forecast_bounds_the_length() {
    let colors: Vec<[f64; 4]> = (0..16).map(|i| [f64::from(i) / 15.0, 0.3, 1.0, 0.5]).collect();
    let materials =
        json!({ "materials": [{ "name": "red", "faces": [0] }], "groups": [{ "name": "a", "faces": [1] }] });
    for extra in [json!({}), json!({ "channels": { "color": colors } }), materials] {
        for parts in ["one", "components"] {
            let mut asked = job(&two(), &extra, &json!({ "parts": parts }));
            asked["plan"] = json!({ "preset": "catmull-clark" });
            for levels in 0..4 {
                asked["levels"] = json!(levels);
                let length = bytes(&asked).len() as u128;
                let checked = parsed(asked.to_string().as_bytes()).expect("a job");
                let estimate = Limits::default().estimate(&checked).expect("within limits");
                let Size::AtMost(most) = estimate.outputs[0].1 else { panic!("how far it packs is not known before") };
                assert!(length <= most && most < 30 * length + 20_000, "{length} and {most}");
            }
        }
    }
}

#[test]
fn curves_and_meshes_without_a_shown_face_are_refused() {
    let curve = json!({
        "input": { "polygon": { "points": [[0, 0], [1, 0], [0, 1]], "closed": true } },
        "outputs": [{ "format": "3mf" }],
    });
    assert_eq!(render(&curve).expect_err("3mf holds no curves")[0].pointer, "/outputs/0/format");
    let mut hidden = job(&nets::cube(), &json!({ "holes": [0, 1, 2, 3, 4, 5] }), &json!({}));
    hidden["plan"] = json!({ "preset": "catmull-clark" });
    hidden["levels"] = json!(1);
    let found = render(&hidden).expect_err("no face is shown");
    assert!(found[0].detail.contains("no face is shown"), "{found:?}");
}
