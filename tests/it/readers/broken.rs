//! Broken files: each is refused with a sentence that names the line or byte, the value, and the expected one.

use planish::input::{ReadLimits, named};
use serde_json::json;

use super::sentences;
use crate::support;

fn check(format: &str, text: &str, sentence: &str) {
    assert_eq!(sentences(format, text.as_bytes()), [sentence], "{text}");
}

#[test]
fn obj() {
    let check = |text: &str, sentence: &str| check("obj", text, sentence);
    check("v 0 0\n", "line 1: a vertex of 2 numbers; it has 3, with a weight 4, with a colour 6 or 7");
    check("v 0 0 0 2\n", "line 1: the weight 2 of a vertex; polygons have the weight 1");
    check("v 0 0 zero\n", "line 1: \"zero\" is no number");
    check("v 0 0 nan\n", "line 1: \"nan\" is not finite; coordinates are at most about 1.8e308");
    check("v 0 0 1e999\n", "line 1: \"1e999\" is not finite; coordinates are at most about 1.8e308");
    check("v 0 0 0\n\nf 1 1\n", "line 3: a face of 2 vertices; a face has at least 3");
    check("v 0 0 0\nf\n", "line 2: a face of 0 vertices; a face has at least 3");
    check("v 0 0 0\nf 1 2 3\n", "line 2: there is no vertex 2; the file has 1, counted from 1");
    check("v 0 0 0\nf 1 1 0\n", "line 2: there is no vertex 0; they are counted from 1");
    check("v 0 0 0\nf -1 -2 -1\n", "line 2: there is no vertex -2; 1 have come before it");
    check("v 0 0 0\nf 1 1 99999999999\n", "line 2: there is no vertex 99999999999; 1 have come before it");
    check(
        "v 0 0 0\nf 1/1 1/1 1/2\nvt 0 0\n",
        "line 2: there is no texture coordinate 2; the file has 1, counted from 1",
    );
    check("v 0 0 0\nf 1//1 1//3 1//2\nvn 0 0 1\n", "line 2: there is no normal 3; the file has 1, counted from 1");
    check("v 0 0 0\nf 1/1 1 1\n", "line 2: corner \"1\" has other parts than the corners before it");
    check("v 0 0 0\nf 1/1/1/1 1 1\n", "line 2: \"1/1/1/1\" is no corner; write v, v/vt, v//vn or v/vt/vn");
    check("v 0 0 0\nf 1 a 1\n", "line 2: \"a\" is no index of a vertex");
    check("vn 0 0\n", "line 1: a normal has 2 numbers; it needs 3");
    check("vt 0 0 0 0\n", "line 1: \"0\" follows a texture coordinate of at most three numbers");
    check("hello world\n", "line 1: \"hello\" is no statement of OBJ; known are v, vt, vn, f, g, o, usemtl, t, l, p");
    check(
        "\u{fffd}\u{0}PNG",
        "line 1: \"\u{fffd}\\0PNG\" is no statement of OBJ; known are v, vt, vn, f, g, o, usemtl, t, l, p",
    );
    let names = (0..17).fold(String::new(), |names, i| format!("{names} g{i}"));
    check(&format!("g{names}\n"), "line 1: more than 16 groups at once; a face may be in 16");
}

/// Elements of a wrong line are counted all the same, so that references to them are not reported as faults.
#[test]
fn obj_counts_wrong_lines() {
    check("obj", "v 0 0 0\nv 1 0 zero\nv 0 1 0\nf 1 2 3\nf -1 -2 -3\n", "line 2: \"zero\" is no number");
    let faces = "f 1/1/1 1/2/2 1/1/2\n".repeat(30);
    let found = sentences("obj", format!("v 0 0 0\nvt 0 0\nvt a 0\nvn 0 0 1\nvn 0 1\n{faces}").as_bytes());
    assert_eq!(found, ["line 3: \"a\" is no number", "line 5: a normal has 2 numbers; it needs 3"]);
}

#[test]
fn obj_tells_many_faults_and_stops_at_twenty() {
    assert_eq!(sentences("obj", b"v 0\nv 1\nv 0 0 0\n").len(), 2);
    let many = sentences("obj", "v 0\n".repeat(50).as_bytes());
    assert_eq!((many.len(), many[20].as_str()), (21, "there may be more faults behind these"));
    let late = sentences("obj", format!("v 0 0 0\n{}", "f 1 1 2\n".repeat(50)).as_bytes());
    assert_eq!(late.len(), 20);
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                   element face 1\nproperty list uchar int vertex_indices\nend_header\n";

#[test]
fn ply_headers() {
    let check = |text: &str, sentence: &str| check("ply", text, sentence);
    check("", "the file ends within its header, which ends with a line \"end_header\"");
    check("plyx\n", "line 1: \"plyx\" stands where \"ply\" should");
    check("ply\nformat ascii 1.0\n", "the file ends within its header, which ends with a line \"end_header\"");
    check("ply\nend_header\n", "line 2: the header names no format before its end");
    check(
        "ply\nformat text 1.0\n",
        "line 2: the format \"text\"; known are ascii, binary_little_endian, binary_big_endian",
    );
    check("ply\nformat ascii 2.0\n", "line 2: version \"2.0\" of the format; 1.0 is read");
    check("ply\nelement vertex -1\n", "line 2: \"-1\" is no whole number of at least 0");
    check("ply\nelement vertex\n", "line 2: an element has a name and a number of rows");
    check("ply\nproperty int x\n", "line 2: a property belongs to an element, and there are at most 512");
    let unknown = "line 3: \"real\" is no type; known are char, uchar, short, ushort, int, uint, float, double";
    check("ply\nelement vertex 1\nproperty real x\n", unknown);
    check("ply\nelement a 1\nproperty x\n", "line 3: a property has a type and a name, a list two types and a name");
    let list = "line 3: the length of a list is \"float\"; it has to be a whole number";
    check("ply\nelement a 1\nproperty list float int x\n", list);
    check("ply\nelement a 1\nproperty int x\nproperty int x\n", "line 4: the element has two properties \"x\"");
    check("ply\nformat ascii 1.0\nelement a 4000000000\nend_header\n", "line 4: the element \"a\" has no properties");
    check("ply\nformat ascii 1.0\nend_header\n", "the header has 0 elements \"vertex\"; a mesh has one");
    check(&PLY.replace("float y", "float why"), "line 9: 3 rows of \"vertex\"; the file has room for 1 at most");
    let why = PLY.replace("float y", "float why") + &"0 ".repeat(20);
    check(&why, "the vertices have no property \"y\"; they need x, y and z");
    let faceless = PLY.replace("element face 1\n", "") + &"0 ".repeat(20);
    let missing = "the header has the list \"vertex_indices\" among the properties of \"vertex\"; a line \
                   \"element face\" with the number of faces is missing before it";
    check(&faceless, missing);
    let index = PLY.replace("vertex_indices", "corners") + &"0 ".repeat(20);
    check(&index, "the faces need one list \"vertex_indices\" (or \"vertex_index\")");
    let unknown = "line 2: \"elemnt\" belongs in no header; known are format, comment, obj_info, element (at most 64), \
                   property, end_header";
    check("ply\nelemnt vertex 1\n", unknown);
}

#[test]
fn ply_text() {
    let check = |body: &str, sentence: &str| check("ply", &format!("{PLY}{body}"), sentence);
    check("0 0 0 1 0 0 0 1\n", "line 10: the file ends where a number should follow");
    check("0 0 0 1 0 0 0 1 0\n\n2 0 1\n", "line 12: face 0: a face of 2 vertices; a face has at least 3");
    check("0 0 0 1 0 0 0 1 0\n3 0 1 3\n", "line 11: face 0: there is no vertex 3; the file has 3, counted from 0");
    check("0 0 0 1 0 0 0 1 0\n3 0 1 -1\n", "line 11: \"-1\" is no whole number of at least 0");
    check("0 0 0 1 0 0 0 1 0\n200 0 1 2\n", "line 11: a list of 200 numbers; the file has room for 4 more");
    check("0 0 0 1 0 0 0 1 0\n3 0 1 2 7\n", "line 11: \"7\" follows the last element");
    check("0 0 0 1 0 0 0 1 nan\n3 0 1 2\n", "line 10: z of vertex 2 is not finite");
    check("0 0 0 1 0 0 0 1 1,5\n3 0 1 2\n", "line 10: \"1,5\" is no number");
}

#[test]
fn ply_bytes() {
    let header = PLY.replace("ascii", "binary_big_endian");
    let file = |body: &[u8]| [header.as_bytes(), body].concat();
    let n = header.len();
    let check = |body: &[u8], sentence: String| assert_eq!(sentences("ply", &file(body)), [sentence]);
    check(&[], format!("byte {n}: 3 rows of \"vertex\"; the file has room for 0 at most"));
    check(&[0; 35], format!("byte {}: the file ends where 4 more bytes should follow", n + 32));
    check(&[0; 36], format!("byte {}: 1 rows of \"face\"; the file has room for 0 at most", n + 36));
    check(
        &[&[0; 36][..], &[200, 0, 0, 0, 0]].concat(),
        format!("byte {}: a list of 200 numbers; the file has room for 1 more", n + 37),
    );
    check(
        &[&[0; 36][..], &[1, 255, 255, 255, 255]].concat(),
        format!("byte {}: -1 is no whole number of at least 0", n + 37),
    );
    let triangle = [3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2];
    check(&[&[0; 36][..], &triangle, &[1]].concat(), format!("byte {}: 1 bytes follow the last element", n + 49));
    check(
        &[&[0x7f, 0x80, 0, 0][..], &[0; 32], &triangle].concat(),
        format!("byte {}: x of vertex 0 is not finite", n + 4),
    );
    assert!(super::read("ply", &file(&[&[0; 36][..], &triangle].concat())).is_ok());
}

/// Counts that no file of this length can hold are refused before any allocation.
#[test]
fn huge_counts_allocate_nothing() {
    let huge = "4294967295";
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let header = PLY.replace("ascii", encoding).replace("vertex 3", &format!("vertex {huge}"));
        let found = sentences("ply", header.as_bytes());
        assert!(
            found[0].ends_with("the file has room for 0 at most") || found[0].ends_with("for 1 at most"),
            "{found:?}"
        );
        let within = header.replace(huge, "39999999");
        assert!(sentences("ply", within.as_bytes())[0].contains("39999999 rows of \"vertex\""));
    }
    let found = sentences("off", b"OFF\n4294967295 4294967295 0\n");
    assert_eq!(found, ["line 2: the file has 4294967295 vertices or more; 40000000 are allowed; send a smaller mesh"]);
    let found = sentences("off", b"OFF\n39999999 1 0\n");
    let told = "line 2: 39999999 vertices and 1 faces take 240000002 bytes at least, the file has 17; send it whole";
    assert_eq!(found, [told]);
    let mut stl = vec![0; 84];
    stl[80..].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(
        sentences("stl", &stl)[0].starts_with("byte 80: 4294967295 triangles take 214748364834 bytes, the file has 84")
    );
}

#[test]
fn the_limits_of_the_server_hold() {
    let limits = ReadLimits { max_vertices: 3, max_faces: 1 };
    let check = |format: &str, text: &str, sentence: &str| {
        let faults =
            (named(format).expect("a reader").read)(&text.as_bytes().into(), &limits).expect_err("it is refused");
        assert_eq!(faults[0], sentence, "{format}");
    };
    let vertices = "the file has 4 vertices or more; 3 are allowed; send a smaller mesh";
    let faces = "the file has 2 faces or more; 1 are allowed; send a smaller mesh";
    check("obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nv 0 0 0\n", &format!("line 4: {vertices}"));
    check("obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\nf 3 2 1\n", &format!("line 5: {faces}"));
    check("off", "OFF\n4 1 0\n", &format!("line 2: {vertices}"));
    check("off", "OFF\n3 2 0\n", &format!("line 2: {faces}"));
    check("ply", &(PLY.replace("vertex 3", "vertex 4") + &"0 ".repeat(99)), vertices);
    check("ply", &(PLY.replace("face 1", "face 2") + &"0 ".repeat(99)), faces);
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    check("stl", &format!("solid\n{facet}{facet}endsolid\n"), &format!("line 15: {faces}"));
    let other = facet.replace("vertex 0 1 0", "vertex 0 1 1\n").replace("vertex 1 0 0", "vertex 2 0 0");
    let limits = ReadLimits { max_vertices: 3, max_faces: 9 };
    let text = format!("solid\n{facet}{other}endsolid\n");
    let faults = (named("stl").expect("a reader").read)(&text.as_bytes().into(), &limits).expect_err("it is refused");
    assert!(faults[0].starts_with("the file has 5 vertices or more"), "{faults:?}");
}

#[test]
fn stl() {
    let check = |text: &str, sentence: &str| check("stl", text, sentence);
    check("", "0 bytes; a binary STL has at least 84, a text starts with \"solid\"");
    check("solid x\n", "line 1: the file ends where \"facet\" or \"endsolid\" should follow");
    check("solid x\nvertex 0 0 0\n", "line 2: \"vertex\" stands where \"facet\" or \"endsolid\" should");
    let facet = "solid\nfacet normal 0 0 1\n";
    check(&format!("{facet}endfacet\n"), "line 3: \"endfacet\" stands where \"outer\" should");
    check(&format!("{facet}outer\n"), "line 3: the file ends where \"loop\" should follow");
    check("solid\nfacet\nouter loop\n", "line 3: \"outer\" stands where \"normal\" should");
    check("solid\nfacet normal 0 0\nouter loop\n", "line 3: \"outer\" stands where a normal of three numbers should");
    check("solid\nfacet normal a b c\n", "line 2: \"a\" stands where a normal of three numbers should");
    let junk = "solid\nfacet normal 0 0 1 outer loop junk\nvertex 0 0 0\n";
    check(junk, "line 2: \"junk\" stands where \"vertex\" should");
    check(&format!("{facet}outer loop extra\n"), "line 3: \"extra\" stands where \"vertex\" should");
    check(&format!("{facet}outer loop\nvertex 0 0\n"), "line 4: a vertex has 2 numbers; it needs 3");
    check(&format!("{facet}outer loop\nvertex 0 0\nvertex 1 0 0"), "line 4: a vertex has 2 numbers; it needs 3");
    check(&format!("{facet}outer loop\nvertex 0 zero 0\n"), "line 4: \"zero\" is no number");
    check(&format!("{facet}outer loop\nvertex 0 0 0 0\n"), "line 4: \"0\" stands where \"vertex\" should");
    check(
        &format!("{facet}outer loop\nvertex 0 0 inf\n"),
        "line 4: \"inf\" is not finite; coordinates are at most about 1.8e308",
    );
    let corners = "outer loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n";
    let four = format!("{facet}{corners}vertex 1 1 0\nendloop\nendfacet\nendsolid\n");
    check(&four, "line 7: \"vertex\" stands where \"endloop\" should");
    check(&format!("{facet}{corners}endloop zz\n"), "line 7: \"zz\" stands where \"endfacet\" should");
    check("solid\nendsolid\nfacet\n", "line 3: \"facet\" stands where \"solid\" should");
    let mut bytes = vec![0_u8; 84 + 50];
    bytes[80] = 1;
    bytes[84 + 12 + 8..84 + 12 + 12].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_eq!(sentences("stl", &bytes), ["byte 104: a coordinate of triangle 0 is not finite"]);
    let cut =
        ["byte 80: 1 triangles take 134 bytes, the file has 120; send it whole, or as text that starts with \"solid\""];
    assert_eq!(sentences("stl", &bytes[..120]), cut);
    // the header may be any text, also "solid"
    bytes[..20].copy_from_slice(b"solid made by a tool");
    assert_eq!(sentences("stl", &bytes[..120]), cut);
}

#[test]
fn off() {
    let check = |text: &str, sentence: &str| check("off", text, sentence);
    check("", "line 1: the file ends where \"OFF\" should follow");
    check("3 1 0\n", "line 1: \"3\" stands where OFF, COFF, NOFF or STOFF should");
    check("4OFF\n", "line 1: \"4OFF\" has points of other than 3 coordinates; send OFF");
    check(
        "OFF BINARY\n",
        "byte 11: the file ends where the numbers of vertices, faces and edges should follow; send it whole",
    );
    check("4OFF BINARY\n", "line 1: \"4OFF\" has points of other than 3 coordinates; send OFF");
    let counts = "OFF BINARY\n\0\0\0\x03\0\0\0\x01\0\0\0\x03";
    check(counts, "byte 23: 3 vertices and 1 faces take 56 bytes at least, the file has 23; send it whole");
    check("OFF\n3\n", "line 2: 1 numbers; give those of vertices, faces and edges");
    check("OFF\n0 0 0\n0 0 0\n", "line 3: \"0\" follows the last of 0 faces");
    let three = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
    check(three, "line 5: the file ends where face 0 of 1 should follow");
    check(&format!("{three}3 0 1\n"), "line 6: face 0: 2 vertices; it says 3");
    check(&format!("{three}2 0 1\n"), "line 6: face 0: a face of 2 vertices; a face has at least 3");
    check(&format!("{three}3 0 1 3\n"), "line 6: face 0: there is no vertex 3; the file has 3, counted from 0");
    check(
        &format!("{three}3 0 1 2 0 0 0 0 0\n"),
        "line 6: face 0: 5 numbers after its vertices; a colour has at most 4",
    );
    check(&format!("{three}99999999999 0 1 2\n"), "line 6: face 0: 3 vertices; it says 99999999999");
    check("OFF\n1 0 0\n0 0\n", "line 3: vertex 0: 2 numbers; it needs 3");
    check("COFF\n1 0 0\n0 0 0\n", "line 3: vertex 0: 3 numbers; it needs 6 or 7");
}

#[test]
fn gltf() {
    let check = |text: &str, sentence: &str| check("gltf", text, sentence);
    check("glTF\u{2}", "the file is binary; read it as glb");
    let found = sentences("gltf", b"{");
    assert!(found[0].starts_with("the document is no glTF: EOF while parsing"), "{found:?}");
    let found = sentences("gltf", br#"{ "asset": { "version": "2.0" }, "scene": -1 }"#);
    let told = "the document is no glTF: invalid type: integer `-1`, expected an index from 0 at line 1 column ";
    assert!(found[0].starts_with(told), "{found:?}");
    check(r#"{"asset":{"version":"1.0"}}"#, "the file is glTF 1.0, which is built otherwise; 2.0 is read: convert it");
    let empty = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{}]}"#;
    check(empty, "scene 0 has no nodes, so that nothing is in it; give it some, or leave it out");
    let newer = r#"{"asset":{"version":"2.1","minVersion":"2.1"}}"#;
    check(newer, "the file asks for version \"2.1\" of glTF at least; 2.0 is read");
    let draco = r#"{"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"]}"#;
    check(draco, "the file requires \"KHR_draco_mesh_compression\", which is not read; export it without");
    let buffers = |buffer: &str| format!(r#"{{"asset":{{"version":"2.0"}},"buffers":[{buffer}]}}"#);
    let outside = "buffer 0: \"a.bin\" lies outside the file, which came by itself: save all in one file, or render \
                   it from its folder on the command line";
    check(&buffers(r#"{"byteLength":4,"uri":"a.bin"}"#), outside);
    check(&buffers(r#"{"byteLength":4}"#), "buffer 0 has no data; give it a data URI, or send glb");
    let plain = "buffer 0: the data URI is not in base64; write data:application/octet-stream;base64,...";
    check(&buffers(r#"{"byteLength":4,"uri":"data:,abcd"}"#), plain);
    let wrong = "buffer 0: character 2 is no base64; letters are A-Z, a-z, 0-9, + and /";
    check(&buffers(r#"{"byteLength":4,"uri":"data:;base64,AA!A"}"#), wrong);
    let short = "buffer 0 says it has 4 bytes, and has 3; send it whole";
    check(&buffers(r#"{"byteLength":4,"uri":"data:;base64,AAAA"}"#), short);
}

#[test]
fn glb() {
    let check = |bytes: &[u8], sentence: &str| assert_eq!(sentences("glb", bytes), [sentence]);
    let file = |length: u32, rest: &[u8]| [b"glTF", &2_u32.to_le_bytes(), &length.to_le_bytes(), rest].concat();
    check(b"glTF", "4 bytes; a GLB has at least 12");
    check(b"solid, rather", "byte 0: a GLB starts with \"glTF\"; read the text form as gltf");
    check(
        &[b"glTF", [1_u32; 2].map(u32::to_le_bytes).as_flattened()].concat(),
        "byte 4: the file is glTF 1.0, which is built otherwise; 2.0 is read: convert it",
    );
    check(&file(99, &[]), "byte 8: the header counts 99 bytes, the file has 12; send it whole");
    check(&file(12, &[]), "byte 12: the file ends within a chunk's header");
    let bin = [[0_u8, 0, 0, 0], *b"BIN\0"].concat();
    check(&file(20, &bin), "byte 16: the first chunk is \"BIN\\0\"; it has to be JSON");
    let json = [[9_u8, 0, 0, 0], *b"JSON"].concat();
    check(&file(20, &json), "byte 12: a chunk of 9 bytes; the file has 0 more");
}

/// In a job, the fault points to the text, and faults within the mesh name their place, with the line if there is one.
#[test]
fn a_job_points_to_its_text() {
    let check = |text: serde_json::Value, pointer: &str, detail: &str| {
        let found = support::faults(json!({ "input": { "text": text, "non_manifold": "refuse" } }));
        assert_eq!((found[0].pointer.as_str(), found[0].detail.as_str()), (pointer, detail));
    };
    let data = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 1 2 3\n";
    let twice = "line 5, in the mesh, /faces/1: faces 0 and 1 run along edge (0, 1) in the same direction; turn one \
                 of them, or set \"orient\": \"repair\"";
    check(json!({ "format": "obj", "data": data }), "/input/text/data", twice);
    let repeated = "line 7, in the mesh, /faces/1: ";
    let face = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n\n# the next goes on\nf 1 2 \\\n 2\n";
    let text = json!({ "format": "obj", "data": face });
    let found = support::faults(json!({ "input": { "text": text, "non_manifold": "refuse" } }));
    assert!(found[0].detail.starts_with(repeated), "{found:?}");
    // repairs renumber the faces
    let text = json!({ "format": "obj", "data": data });
    let found = support::faults(json!({ "input": { "text": text, "weld": 0, "non_manifold": "refuse" } }));
    assert!(found[0].detail.starts_with("in the mesh, /faces/"), "{found:?}");
    check(
        json!({ "format": "obj", "data": "v" }),
        "/input/text/data",
        "line 1: a vertex of 0 numbers; it has 3, with a weight 4, with a colour 6 or 7",
    );
    let unknown = "there is no reader \"fbx\"; known are obj, ply, stl, off, gltf, glb, 3mf, usda, json";
    check(json!({ "format": "fbx", "data": "" }), "/input/text/format", unknown);
    let letters = "character 0 is no base64; letters are A-Z, a-z, 0-9, + and /";
    check(json!({ "format": "glb", "data": "?", "encoding": "base64" }), "/input/text/data", letters);
    let broken = "the base64 breaks off within a byte; send it whole";
    check(json!({ "format": "glb", "data": "AAAAA", "encoding": "base64" }), "/input/text/data", broken);
    let inside = "in the mesh, /faces: expected a list";
    let found =
        support::faults(json!({ "input": { "text": { "format": "json", "data": "{\"positions\":[],\"faces\":3}" } } }));
    assert!(
        found[0].detail.starts_with("in the mesh, /faces: ") && found[0].detail.ends_with("expected a list"),
        "{inside}: {found:?}"
    );
    let empty = "the file holds no mesh: neither vertices nor faces";
    check(json!({ "format": "obj", "data": "" }), "/input/text/data", empty);
}
