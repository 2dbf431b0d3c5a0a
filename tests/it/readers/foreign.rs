//! Files without a mesh, or in another format than stated: each answer says what the file is.

use planish::input;
use serde_json::{Value, json};

use super::gltf::square;
use super::{mesh, net};
use crate::support;

/// Returns the pointer and the message of the refusal of a file.
fn told(format: &str, bytes: &[u8]) -> (String, String) {
    let data = super::round_trips::base64(bytes);
    let text = json!({ "format": format, "data": data, "encoding": "base64" });
    let found = support::faults(json!({ "input": { "text": text } }));
    (found[0].pointer.clone(), found[0].detail.clone())
}

#[test]
fn pictures_archives_and_documents_are_called_what_they_are() {
    let cases: [(&[u8], &str); 6] = [
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "a PNG picture"),
        (b"\xff\xd8\xff\xe0\0\x10JFIF", "a JPEG picture"),
        (b"GIF89a\x01\0\x01\0", "a GIF picture"),
        (b"PK\x03\x04\x14\0", "a zip archive"),
        (b"\n <?xml version=\"1.0\"?>\n<COLLADA/>", "an XML file"),
        (b"Kaydara FBX Binary  \0", "an FBX file"),
    ];
    for (bytes, what) in cases {
        for format in ["obj", "ply", "stl", "off", "gltf", "glb"] {
            let (pointer, detail) = told(format, bytes);
            assert_eq!(pointer, "/input/text/data");
            assert!(detail.starts_with(&format!("the file is {what}")), "{format}: {detail}");
        }
    }
}

#[test]
fn meshes_of_another_format_are_to_be_read_as_what_they_are() {
    let (pointer, detail) = told("obj", b"ply\nformat ascii 1.0\n");
    assert_eq!(pointer, "/input/text/format");
    assert_eq!(detail, "the file begins like ply, not like obj; read it as ply");
    let obj =
        "# a triangle, and enough of a comment that it might be a header of 80 bytes and more\nv 0 0 0\nf 1 1 1\n";
    assert_eq!(told("stl", obj.as_bytes()).1, "the file begins like obj, not like stl; read it as obj");
    assert_eq!(told("ply", b"OFF\n3 1 0\n").1, "the file begins like off, not like ply; read it as off");
    let mut binary = [b"a part, as exported".as_slice(), &[b' '; 61], &1_u32.to_le_bytes(), &[0; 50]].concat();
    assert_eq!(told("off", &binary).1, "the file begins like stl, not like off; read it as stl");
    binary.truncate(100);
    assert!(told("off", &binary).1.contains("OFF"), "cut, it is nothing that is known");
    // a file that is broken in its own format is reported as such
    assert!(told("ply", b"ply\nformat ascii 1.0\n").1.contains("the file ends within its header"));
}

#[test]
fn every_format_but_gltf_in_json_is_known_by_its_first_bytes() {
    let stl = [[b' '; 80].as_slice(), &0_u32.to_le_bytes()].concat();
    let statements = b"\nv 0 0 0\nf 1 1 1\n";
    let begun: [(&str, &[u8]); 9] = [
        ("obj", b"# made by hand"),
        ("ply", b"ply\nformat ascii 1.0\ncomment"),
        ("stl", b"solid cube"),
        ("off", b"STOFF"),
        ("off", b"  COFF\n3 1 0"),
        ("glb", b"glTF\x02\0\0\0"),
        ("3mf", b"PK\x03\x04\x14\0 3D/3dmodel.model"),
        ("usda", b"#usda 1.0"),
        ("stl", &stl),
    ];
    for (name, start) in begun {
        // statements of OBJ may follow in any text; the length of a binary STL tells what it is
        let after: &[u8] = if start.len() == 84 { b"" } else { statements };
        let found = input::of_bytes(&[start, after].concat()).map(|reader| reader.name);
        assert_eq!(found, Some(name), "{}", String::from_utf8_lossy(start));
    }
    let readers = input::READERS.iter().map(|reader| reader.name);
    assert!(readers.filter(|name| *name != "gltf").all(|name| begun.iter().any(|(known, _)| *known == name)));
    for unknown in [&b""[..], b"{\"asset\":{}}", b"some words", b"PK\x03\x04\x14\0 [Content_Types].xml", b"OFFICE"] {
        assert!(input::of_bytes(unknown).is_none(), "{}", String::from_utf8_lossy(unknown));
    }
}

#[test]
fn point_clouds_say_how_many_points_they_are() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n";
    let cloud = "the file is a point cloud: 2 points and no faces";
    assert!(told("ply", format!("{ply}end_header\n0 0 0\n1 1 1\n").as_bytes()).1.starts_with(cloud));
    let empty = format!("{ply}element face 0\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 1 1\n");
    assert!(told("ply", empty.as_bytes()).1.starts_with(cloud));
    assert!(told("off", b"OFF\n2 0 0\n0 0 0\n1 1 1\n").1.starts_with(cloud));
    let lines = told("obj", b"v 0 0 0\nv 1 0 0\nl 1 2\n").1;
    assert!(lines.starts_with(&format!("{cloud} (lines are left out: 1)")), "{lines}");
    let lines = told("gltf", square(1, &[0, 1]).to_string().as_bytes()).1;
    assert!(lines.contains("no mesh") && lines.contains("primitives of points or lines are left out: 1"), "{lines}");
}

#[test]
fn files_of_gltf_1_are_told_so() {
    let old = br#"{"accessors":{"a":{}},"asset":{"version":"1.0"},"meshes":{"m":{"primitives":[]}}}"#;
    let unnumbered = br#"{"accessors":{"a":{}},"meshes":{"m":{"primitives":[]}}}"#;
    for document in [&old[..], &unnumbered[..]] {
        assert!(told("gltf", document).1.contains("the file is glTF 1.0"));
    }
    // an object in place of a list does not indicate an old version
    let wrong = br#"{"asset":{"version":"2.0"},"meshes":{}}"#;
    assert!(told("gltf", wrong).1.contains("invalid type: object"));
}

#[test]
fn what_touches_textures_and_materials_alone_may_be_required() {
    let mut document = square(4, &[0, 1, 2]);
    for (name, is_read) in [("KHR_techniques_webgl", true), ("EXT_texture_webp", true), ("EXT_other", false)] {
        document["extensionsRequired"] = json!([name]);
        document["extensionsUsed"] = json!([name]);
        assert_eq!(super::read("gltf", document.to_string().as_bytes()).is_ok(), is_read, "{name}");
    }
}

#[test]
fn texts_of_16_bit_units_are_read() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\ng größe\nf 1 2 3\n";
    let units: Vec<u16> = text.encode_utf16().collect();
    let little: Vec<u8> = [0xff, 0xfe].into_iter().chain(units.iter().flat_map(|unit| unit.to_le_bytes())).collect();
    let big: Vec<u8> = [0xfe, 0xff].into_iter().chain(units.iter().flat_map(|unit| unit.to_be_bytes())).collect();
    let expected = mesh("obj", text.as_bytes());
    assert_eq!(expected.groups[0].name, "größe");
    assert_eq!([mesh("obj", &little), mesh("obj", &big)], [expected.clone(), expected]);
}

#[test]
fn free_form_parts_of_an_obj_are_left_out_and_counted() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ncstype bspline\ndeg 2\ncurv 0 1 1 2 3\nparm u 0 1\nend\n\
                surf 0 1 0 1 1\nend\n";
    let found = mesh("obj", text.as_bytes());
    assert_eq!(net(&found).faces, [[0, 1, 2]]);
    assert_eq!(found.notes, ["free-form curves and surfaces are left out: 2"]);
}

#[test]
fn strips_of_triangles_of_ply_are_faces() {
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
                  0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
    let faces = |list: &str| net(&mesh("ply", format!("{header}{list}\n").as_bytes())).faces;
    assert_eq!(faces("4 0 1 2 3"), [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(faces("7 0 1 2 -1 1 3 2"), [[0, 1, 2], [1, 3, 2]]);
    // a repeated vertex restarts the strip without a mark
    assert_eq!(faces("5 0 1 2 2 3"), vec![vec![0, 1, 2]]);
    let (_, detail) = told("ply", format!("{header}3 0 1 9\n").as_bytes());
    assert_eq!(detail, "line 14: there is no vertex 9; the file has 4, counted from 0");
}

/// Binary STL files are read even if their header is the beginning of another format.
#[test]
fn a_beginning_alone_refuses_nothing() {
    let mut stl = [0; 84 + 50];
    stl[..2].copy_from_slice(b"PK");
    stl[2..4].copy_from_slice(&[3, 4]);
    stl[80] = 1;
    for (k, x) in [1.0_f32, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0].into_iter().enumerate() {
        stl[96 + 4 * k..100 + 4 * k].copy_from_slice(&x.to_le_bytes());
    }
    assert_eq!(mesh("stl", &stl).faces.len(), 1);
    let job: Value = json!({ "input": { "text": { "format": "stl", "data": super::round_trips::base64(&stl),
        "encoding": "base64" } } });
    support::json(job);
}
