//! 3MF: written files are read back, the build places the objects, and archives that are broken, too large or bombs are
//! refused.

use std::io::Write;

use flate2::write::DeflateEncoder;
use flate2::{Compression, Crc};
use planish::input::{ReadLimits, named};
use planish::shape::coordinate_system::{Unit, Up};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::{mesh, net, sentences};
use crate::support::nets::{self, Net, triangle_manifold};
use crate::support::{parsed, render};

const RELATIONS: &str = "<Relationships><Relationship Target=\"/3D/3dmodel.model\" Id=\"a\" \
                         Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";

/// Returns an archive of files that are stored or deflated.
fn archive(files: &[(&str, &[u8])], is_deflated: bool) -> Vec<u8> {
    let (mut out, mut list) = (Vec::new(), Vec::new());
    for (name, content) in files {
        let packed = if is_deflated {
            let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
            encoder.write_all(content).expect("memory takes it");
            encoder.finish().expect("memory takes it")
        } else {
            content.to_vec()
        };
        let mut crc = Crc::new();
        crc.update(content);
        let offset = u32::try_from(out.len()).expect("small").to_le_bytes();
        let method = if is_deflated { 8_u16 } else { 0 };
        let head = [20, 0, method, 0, 33].map(u16::to_le_bytes).concat();
        let numbers =
            [crc.sum(), u32::try_from(packed.len()).expect("small"), u32::try_from(content.len()).expect("small")];
        let numbers = numbers.map(u32::to_le_bytes).concat();
        let length = u16::try_from(name.len()).expect("short").to_le_bytes();
        out.extend([&b"PK\x03\x04"[..], &head, &numbers, &length, &[0; 2], name.as_bytes(), &packed].concat());
        let entry = [&b"PK\x01\x02\x14\0"[..], &head, &numbers, &length, &[0; 12], &offset, name.as_bytes()];
        list.extend(entry.concat());
    }
    let [start, length] = [out.len(), list.len()].map(|n| u32::try_from(n).expect("small").to_le_bytes());
    let n = u16::try_from(files.len()).expect("few").to_le_bytes();
    out.extend([&list[..], b"PK\x05\x06", &[0; 4], &n, &n, &length, &start, &[0; 2]].concat());
    out
}

fn model(text: &str) -> Vec<u8> {
    archive(&[("_rels/.rels", RELATIONS.as_bytes()), ("3D/3dmodel.model", text.as_bytes())], true)
}

/// Returns a model with a tetrahedron as object 1, additional attributes of the model, and resources before and after
/// the object.
fn tetrahedron(attributes: &str, [before, behind]: [&str; 2], build: &str) -> Vec<u8> {
    model(&format!(
        "<?xml version=\"1.0\"?><!-- a > b --><model {attributes}><resources>{before}<object id=\"1\" \
         name=\"a&amp;b\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/><vertex \
         x=\"0\" y=\"1\" z=\"0\"/><vertex x=\"0\" y=\"0\" z=\"1\"/></vertices><triangles><triangle v1=\"0\" v2=\"2\" \
         v3=\"1\"/><triangle v1=\"0\" v2=\"1\" v3=\"3\"/><triangle v1=\"1\" v2=\"2\" v3=\"3\"/><triangle v1=\"0\" \
         v2=\"3\" v3=\"2\"/></triangles></mesh></object>{behind}</resources><build>{build}</build></model>"
    ))
}

fn written(mesh: &Value, options: &Value) -> Vec<u8> {
    let mut output = options.clone();
    output["format"] = json!("3mf");
    let job = json!({ "input": { "mesh": mesh, "up": "z", "unit": "cm" }, "outputs": [output] });
    render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}")).0
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn triangles_come_back_bit_for_bit(
        given in triangle_manifold(),
        factor in prop_oneof![Just(1.0), Just(1.0 / 3.0), Just(-7.1e-20)],
    ) {
        let positions = given.positions.iter().map(|p| p.map(|x| x * factor + 0.0)).collect();
        let given = Net { positions, faces: given.faces };
        let kept = super::round_trips::kept(&given);
        let found = mesh("3mf", &written(&given.to_json(), &json!({})));
        prop_assert_eq!(net(&found), kept);
        prop_assert_eq!((found.unit, found.up), (Some(Unit::Centimetre), Some(Up::Z)));
    }

    #[test]
    fn no_bytes_make_it_fail(
        at in any::<prop::sample::Index>(),
        byte in any::<u8>(),
        cut in any::<prop::sample::Index>(),
    ) {
        let text = "<model><resources><object id=\"1\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/></vertices>\
                    <triangles><triangle v1=\"0\" v2=\"0\" v3=\"0\"/></triangles></mesh></object></resources></model>";
        let files = [("_rels/.rels", RELATIONS.as_bytes()), ("3D/3dmodel.model", text.as_bytes())];
        for is_deflated in [false, true] {
            let mut bytes = archive(&files, is_deflated);
            let place = at.index(bytes.len());
            bytes[place] = byte;
            let _ = super::read("3mf", &bytes);
            let _ = super::read("3mf", &bytes[..cut.index(bytes.len())]);
        }
    }
}

#[test]
fn groups_and_materials_and_colors_come_back() {
    let mut given = nets::tetrahedron().to_json();
    given["materials"] = json!([{ "name": "red", "faces": [0, 1], "color": [1, 0, 0, 1] }]);
    let found = mesh("3mf", &written(&given, &json!({})));
    assert_eq!(found.materials.len(), 1, "faces without a material have none: {:?}", found.materials);
    assert_eq!((found.materials[0].name.as_str(), &found.materials[0].faces), ("red", &vec![0, 1]));
    assert_eq!(found.looks[0].color, Some([1.0, 0.0, 0.0, 1.0]));
    let mut given = nets::tetrahedron().to_json();
    given["channels"] = json!({ "color": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.4, 1]] });
    let found = mesh("3mf", &written(&given, &json!({})));
    let color = &found.channels[0];
    assert_eq!((color.name.as_str(), color.width, color.seams.is_none()), ("color", 3, true));
    let expected = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.2, 0.4, 1.0];
    assert!(color.values.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-12), "{:?}", color.values);
}

/// Refined meshes are written in far fewer bytes than they take in memory, as their triangles follow a pattern.
#[test]
fn refined_meshes_come_back_with_all_that_they_carry() {
    let net = nets::cube();
    let colors: Vec<[f64; 3]> = (0..8).map(|i| [f64::from(i) / 7.0, 0.25, 1.0]).collect();
    let carried = [
        (6, json!({})),
        (5, json!({ "materials": [{ "name": "red", "faces": [0, 3], "color": [1, 0, 0] }] })),
        (5, json!({ "channels": { "color": colors } })),
        (5, json!({ "channels": { "color": vec![[1, 0, 0]; 8] } })),
    ];
    for (levels, carried) in carried {
        let mut given = net.to_json();
        for (name, value) in carried.as_object().expect("fields") {
            given[name] = value.clone();
        }
        let job = json!({
            "input": { "mesh": given }, "plan": { "preset": "bilinear" }, "levels": levels,
            "outputs": [{ "format": "3mf" }],
        });
        let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{faults:?}"));
        let found = mesh("3mf", &bytes);
        assert_eq!(found.faces.len(), 12 * 4_usize.pow(levels), "{carried}");
        assert_eq!(found.materials.len(), usize::from(carried.get("materials").is_some()), "{carried}");
        assert_eq!(found.channels.len(), usize::from(carried.get("channels").is_some()), "{carried}");
    }
}

#[test]
fn parts_are_groups_again() {
    let one = nets::tetrahedron();
    let n = one.positions.len();
    let positions = one.positions.iter().copied().chain(one.positions.iter().map(|&[x, y, z]| [x + 9.0, y, z]));
    let faces = one.faces.iter().cloned().chain(one.faces.iter().map(|face| face.iter().map(|v| v + n).collect()));
    let two = Net { positions: positions.collect(), faces: faces.collect() };
    let mut given = two.to_json();
    given["groups"] = json!([{ "name": "left", "faces": [0, 1, 2, 3] }]);
    let found = mesh("3mf", &written(&given, &json!({ "parts": "components" })));
    assert_eq!(net(&found), two);
    let names: Vec<_> = found.groups.iter().map(|set| (set.name.as_str(), set.faces.len())).collect();
    assert_eq!(names, [("left", 4), ("part-2", 4)]);
}

#[test]
fn items_and_components_put_objects_where_they_belong() {
    let twice = "<object id=\"2\"><components><component objectid=\"1\"/><component objectid=\"1\" \
                 transform=\"1 0 0 0 1 0 0 0 1 10 0 0\"/></components></object>";
    let item = "<item objectid=\"2\" transform=\"0 2 0 -2 0 0 0 0 2 0 0 5\"/>";
    let found = mesh("3mf", &tetrahedron("unit=\"foot\"", ["", twice], item));
    // x maps to 2 y, y to -2 x, z to 2 z; a foot is twelve inches, and the transform moves by 10 feet and 5 of its own
    assert_eq!(found.unit, Some(Unit::Inch));
    let expected = [[0.0, 0.0, 60.0], [0.0, 24.0, 60.0], [-24.0, 0.0, 60.0], [0.0, 0.0, 84.0]];
    assert_eq!(found.positions[..4], expected);
    assert_eq!(found.positions[4..], expected.map(|[x, y, z]| [x, y + 240.0, z]));
    assert_eq!([found.faces.face(0), found.faces.face(4)], [&[0, 2, 1], &[4, 6, 5]]);
    let mirrored = "<item objectid=\"1\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/>";
    let found = mesh("3mf", &tetrahedron("", ["", ""], mirrored));
    assert_eq!(found.unit, Some(Unit::Millimetre), "the unit of models that say none");
    assert_eq!(found.faces.face(0), [0, 1, 2], "what is mirrored is turned, so that it is no inside out body");
}

#[test]
fn the_unit_of_a_file_is_that_of_the_job_unless_it_says_another() {
    let data = super::round_trips::base64(&tetrahedron("unit=\"inch\"", ["", ""], "<item objectid=\"1\"/>"));
    let mut job = json!({
        "input": { "text": { "format": "3mf", "data": data, "encoding": "base64" } }, "outputs": [{ "format": "obj" }],
    });
    let text = |job: &Value| String::from_utf8(render(job).expect("it is written").0).expect("obj is text");
    assert!(text(&job).starts_with("# planish\n# unit in\n# up z\n"), "{}", text(&job));
    job["input"]["unit"] = json!("mm");
    job["input"]["up"] = json!("y");
    assert!(text(&job).starts_with("# planish\n# unit mm\nv "), "{}", text(&job));
    assert!(parsed(job.to_string().as_bytes()).is_ok());
}

#[test]
fn broken_models_are_refused_by_line_and_name() {
    let plain = |build: &str| tetrahedron("", ["", ""], build);
    let cases: [(Vec<u8>, &str); 11] = [
        (plain("<item objectid=\"7\"/>"), "there is no object 7"),
        (plain("<item objectid=\"1\" transform=\"1 0 0\"/>"), "a transform has 3 numbers; it needs 12"),
        (plain("<item objectid=\"1\" path=\"/a.model\"/>"), "stands in another file, \"/a.model\""),
        (plain("<item/>"), "\"item\" has no objectid"),
        (plain("<item objectid=\"1\">"), "it is no XML"),
        (tetrahedron("unit=\"mile\"", ["", ""], ""), "there is no unit \"mile\""),
        (
            tetrahedron("requiredextensions=\"b\" xmlns:b=\"http://a/beamlattice/\"", ["", ""], ""),
            "the extension \"b\"",
        ),
        (tetrahedron("", ["<colorgroup id=\"5\"><color color=\"red\"/></colorgroup>", ""], ""), "\"red\" is no color"),
        (tetrahedron("", ["<object id=\"1\"/>", ""], ""), "two resources have the id 1"),
        (model("<!DOCTYPE a [<!ENTITY b \"c\">]><model/>"), "a document type"),
        (model("<svg/>"), "\"svg\" stands where a model should"),
    ];
    for (bytes, expected) in cases {
        let found = sentences("3mf", &bytes);
        assert!(found[0].contains(expected), "{expected}: {found:?}");
    }
}

/// Returns an object with other objects as its components.
fn composed(id: u64, parts: &[u64]) -> String {
    let parts: Vec<String> = parts.iter().map(|part| format!("<component objectid=\"{part}\"/>")).collect();
    format!("<object id=\"{id}\"><components>{}</components></object>", parts.concat())
}

#[test]
fn objects_that_hold_themselves_are_refused_by_name() {
    let itself = composed(2, &[2]);
    let mutual = composed(3, &[1, 4]) + &composed(4, &[1, 5]) + &composed(5, &[1, 4]);
    // without a build no object stands for those that hold each other
    for (objects, build, id) in [(&itself, "", 2), (&itself, "<item objectid=\"2\"/>", 2), (&mutual, "", 4)] {
        let found = sentences("3mf", &tetrahedron("", ["", objects], build));
        assert!(found[0].contains(&format!("object {id} holds itself by its components")), "{found:?}");
    }
    let twice = composed(3, &[1, 1]) + &composed(4, &[3, 1, 3]) + &composed(5, &[4, 3]);
    let found = mesh("3mf", &tetrahedron("", ["", &twice], ""));
    assert_eq!(found.faces.len(), 4 * 7, "an object may come again, in others");
    let deep: String = (2..20).map(|id| composed(id, &[id - 1])).collect();
    let found = sentences("3mf", &tetrahedron("", ["", &deep], ""));
    assert!(found[0].contains("lies deeper in others than 16; "), "{found:?}");
}

#[test]
fn broken_archives_are_refused() {
    let whole = tetrahedron("", ["", ""], "<item objectid=\"1\"/>");
    assert!(sentences("3mf", &whole[..whole.len() - 30])[0].contains("cut off or broken"));
    assert!(sentences("3mf", b"PK\x03\x04")[0].contains("cut off or broken"));
    let other = archive(&[("word/document.xml", b"<a/>")], false);
    assert!(sentences("3mf", &other)[0].contains("the archive has no model"));
    let missing = archive(&[("_rels/.rels", RELATIONS.as_bytes())], false);
    assert!(sentences("3mf", &missing)[0].contains("the archive has no file \"3D/3dmodel.model\""));
    let mut locked = archive(&[("_rels/.rels", RELATIONS.as_bytes())], false);
    let list = locked.windows(4).position(|window| window == b"PK\x01\x02").expect("there is a list");
    locked[list + 8] |= 1;
    assert!(sentences("3mf", &locked)[0].contains("is encrypted"));
}

#[test]
fn bombs_are_refused_before_they_burst() {
    let blanks = format!("<model>{}</model>", " ".repeat(64 << 20));
    let found = sentences("3mf", &model(&blanks));
    assert!(found[0].contains("more than 200 times what the file has"), "{found:?}");
    // objects of objects of objects, each referenced twenty times: 20^10 bodies
    let level = |i: usize| {
        let part = format!("<component objectid=\"{}\"/>", i - 1);
        format!("<object id=\"{i}\"><components>{}</components></object>", part.repeat(20))
    };
    let levels: String = (2..12).map(level).collect();
    let found = sentences("3mf", &tetrahedron("", ["", &levels], "<item objectid=\"11\"/>"));
    assert!(found[0].contains("objects are built") || found[0].contains("it takes"), "{found:?}");
    let deep = "<a>".repeat(100);
    assert!(sentences("3mf", &model(&format!("<model>{deep}")))[0].contains("deeper in each other than 64"));
}

#[test]
fn limits_are_kept() {
    let bytes = tetrahedron("", ["", ""], "<item objectid=\"1\"/><item objectid=\"1\"/>");
    let read = |max_vertices, max_faces| {
        (named("3mf").expect("the reader exists").read)(&bytes[..].into(), &ReadLimits { max_vertices, max_faces })
    };
    assert!(read(8, 8).is_ok());
    assert!(read(7, 8).expect_err("it is refused")[0].contains("8 vertices or more; 7 are allowed"));
    assert!(read(8, 3).expect_err("it is refused")[0].contains("4 triangles or more; 3 are allowed"));
}
