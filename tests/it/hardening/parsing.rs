//! The memory of reading is bounded by the received bytes, whatever they claim to be.

use allocation_counter::measure;
use planish::input::{self, ReadLimits};
use planish::wire::JobRequest;
use planish::wire::input::Purpose;
use planish::wire::read::read;

/// One more than a power of two: lists that double their capacity have just done so, and hold the old and the new one.
const MANY: usize = (1 << 16) + 1;

/// Returns the largest number of bytes that a reader takes while it reads.
fn peak(format: &str, file: &[u8]) -> u64 {
    let reader = input::named(format).unwrap();
    measure(|| drop((reader.read)(&file.into(), &ReadLimits::default()))).bytes_max
}

/// Returns the first message of a refusal.
fn refusal(format: &str, file: &str) -> String {
    let reader = input::named(format).unwrap();
    (reader.read)(&file.as_bytes().into(), &ReadLimits::default()).unwrap_err().swap_remove(0)
}

fn many(start: &str, part: &str, end: &str) -> Vec<u8> {
    [start, &part.repeat(MANY), end].concat().into_bytes()
}

/// Concatenates `n` texts.
fn joined(n: usize, text: impl Fn(usize) -> String) -> String {
    (0..n).map(text).collect::<Vec<_>>().concat()
}

fn check(name: &str, format: &str, file: &[u8]) {
    let (taken, length) = (peak(format, file), file.len() as u64);
    let most = input::reading_memory(length);
    assert!(taken <= most, "{format}, {name}: {length} bytes take {taken}, {most} are allowed");
}

/// Returns a glTF document with one list.
fn document(list: &str, part: &str) -> Vec<u8> {
    many(&format!(r#"{{"asset":{{"version":"2.0"}},"{list}":["#), &format!("{part},"), &format!("{part}]}}"))
}

#[test]
fn c3_documents_are_counted_before_anything_is_made_of_them() {
    let file = String::from_utf8(document("nodes", "{}")).unwrap();
    let found = refusal("gltf", &file);
    assert!(found.starts_with("\"nodes\": 65538 entries take "), "{found}");
    assert!(peak("gltf", file.as_bytes()) < 4096, "the sentence and no more");
    // a name with an escape in it is the same name
    let escaped = file.replace("nodes", "n\\u006fdes");
    assert!(refusal("gltf", &escaped).starts_with("\"n\\\\u006fdes\": 65538 entries take "));
    // nodes with a translation
    let told = String::from_utf8(document("nodes", r#"{"mesh":0,"name":"a chair","translation":[1.25,0.5,2.75]}"#));
    assert_eq!(refusal("gltf", &told.unwrap()), "node 0: there is no mesh 0");
}

#[test]
fn c3_gltf_takes_no_more_than_its_weight() {
    let entries = [
        ("nodes", "{}"),
        ("nodes", r#"{"scale":[1,1,1]}"#),
        ("nodes", r#"{"mesh":0,"name":"a chair","translation":[1.25,0.5,2.75]}"#),
        ("nodes", r#"{"extras":{"a":[[[]]]},"name":"\u0041\u0041\u0041"}"#),
        ("accessors", r#"{"componentType":5126,"count":9,"type":"VEC3"}"#),
        ("accessors", r#"{"componentType":5126,"count":9,"type":"VEC3","min":[[0]]}"#),
        ("accessors", r#"{"componentType":5126,"count":9,"type":"VEC3","min":[{"":0}]}"#),
        ("materials", "{}"),
        ("materials", r#"{"name":"red","extras":[[]]}"#),
        ("meshes", r#"{"primitives":[]}"#),
        ("meshes", r#"{"primitives":[{"attributes":{}}]}"#),
        ("meshes", r#"{"primitives":[{"attributes":{"POSITION":0,"_A":0,"_B":0},"targets":[{}]}]}"#),
        ("animations", r#"{"channels":[{"sampler":0,"target":{"node":0,"path":"scale"}}],"samplers":[]}"#),
        ("buffers", r#"{"byteLength":0,"uri":"data:;base64,AAAA"}"#),
        ("bufferViews", r#"{"buffer":0,"byteLength":1}"#),
        ("images", "{}"),
        ("samplers", "{}"),
        ("scenes", r#"{"nodes":[0]}"#),
        ("skins", r#"{"joints":[0]}"#),
        ("textures", r#"{"source":0}"#),
        ("extensionsUsed", r#""""#),
        ("unknown", "[{}]"),
    ];
    for (list, part) in entries {
        check(&format!("{list} of {part}"), "gltf", &document(list, part));
    }
    let long = [
        ("a node's children", r#"{"asset":{"version":"2.0"},"nodes":[{"children":["#, "0,", "0]}]}"),
        ("a node's members", r#"{"asset":{"version":"2.0"},"nodes":[{"#, r#""":0,"#, r#""b":0}]}"#),
        ("the root's members", r#"{"asset":{"version":"2.0"},"#, r#""":0,"#, r#""b":0}"#),
        (
            "least numbers",
            r#"{"asset":{"version":"2.0"},"accessors":[{"componentType":5126,"count":9,"type":"VEC3","min":["#,
            "0,",
            "0]}]}",
        ),
        (
            "least lists",
            r#"{"asset":{"version":"2.0"},"accessors":[{"componentType":5126,"count":9,"type":"VEC3","min":["#,
            "[],",
            "0]}]}",
        ),
        (
            "primitives",
            r#"{"asset":{"version":"2.0"},"meshes":[{"primitives":["#,
            r#"{"attributes":{}},"#,
            r#"{"attributes":{}}]}]}"#,
        ),
        (
            "targets",
            r#"{"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{},"targets":["#,
            "{},",
            "{}]}]}]}",
        ),
        ("a name", r#"{"asset":{"version":"2.0","generator":"\n"#, "abc", r#""}}"#),
        ("a scene", r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":["#, "0,", "0]}]}"),
        ("depth", r#"{"asset":{"version":"2.0"},"nodes":"#, "[", ""),
    ];
    for (name, start, part, end) in long {
        check(name, "gltf", &many(start, part, end));
    }
    let chain = joined(20_000, |i| format!(r#"{{"children":[{}]}},"#, i + 1));
    check("a chain", "gltf", format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{chain}{{}}]}}"#).as_bytes());
    let names = joined(5_000, |i| format!(r#""_{i}":0,"#));
    let accessor = r#""accessors":[{"componentType":5126,"count":3,"type":"VEC3"}]"#;
    let mesh = format!(r#""meshes":[{{"primitives":[{{"attributes":{{{names}"POSITION":0}}}}]}}]"#);
    let file = format!(r#"{{"asset":{{"version":"2.0"}},{accessor},{mesh},"nodes":[{{"mesh":0}}]}}"#);
    check("attributes", "gltf", file.as_bytes());
}

#[test]
fn c3_text_takes_no_more_than_its_weight() {
    let count = |text: &str| text.replace("MANY", &MANY.to_string()).replace("MORE", &(MANY + 1).to_string());
    let ply = |header: &str| count(&format!("ply\nformat ascii 1.0\n{header}end_header\n0 0 0\n"));
    let places = "property char x\nproperty char y\nproperty char z\n";
    let point = format!("element vertex 1\n{places}");
    let list = "property list uint char vertex_index\n";
    let cases = [
        ("usda", "numbers", "#usda 1.0\ndef \"a\" { int[] b = [".into(), "0,", "]}"),
        ("usda", "words", "#usda 1.0\ndef \"a\" { token[] b = [".into(), "a,", "]}"),
        ("usda", "lists", "#usda 1.0\ndef \"a\" { int[] b = [".into(), "[],", "]}"),
        ("usda", "prims", "#usda 1.0\n".into(), "def\"\"{}", ""),
        ("usda", "prims with a property", "#usda 1.0\n".into(), "def\"\"{int a}", ""),
        ("usda", "properties", "#usda 1.0\ndef\"\"{".into(), "int a;", "}"),
        ("usda", "metadata", "#usda 1.0\n(".into(), "a=0;", ")"),
        ("usda", "points", "#usda 1.0\ndef Mesh\"\"{point3f[] points=[".into(), "0,0,0,", "]}"),
        ("usda", "meshes", "#usda 1.0\n".into(), "def Mesh\"\"{rel material:binding=</a>}", ""),
        ("usda", "primvars", "#usda 1.0\ndef Mesh\"\"{".into(), "float[] primvars:a=[0]", "}"),
        ("usda", "variants", "#usda 1.0\ndef \"a\" {".into(), "variantSet \"a\" = {}", "}"),
        ("obj", "positions", String::new(), "v 0 0 0\n", "f 1 2 3\n"),
        ("obj", "one long position", "v ".into(), "0 ", ""),
        ("obj", "colours", String::new(), "v 0 0 0 1 1 1\n", "f 1 2 3\n"),
        ("obj", "texture coordinates", "v 0 0 0\n".into(), "vt 0\n", "f 1/1 1/1 1/1\n"),
        ("obj", "faces", "v 0 0 0\n".into(), "f 1 1 1\n", ""),
        ("obj", "one long face", "v 0 0 0\nf ".into(), "1 ", "1\n"),
        (
            "obj",
            "faces in many groups",
            "v 0 0 0\no q\nusemtl r\ng a b c d e f g h i j k l m n o p\n".into(),
            "f 1 1 1\n",
            "",
        ),
        ("obj", "holes", count("v 0 0 0\nf 1 1 1\nt hole MANY/0/0 "), "0 ", "\n"),
        ("obj", "corners", count("v 0 0 0\nf 1 1 1\nt corner MANY/1/0 "), "0 ", "1\n"),
        ("obj", "a hole each", "v 0 0 0\nf 1 1 1\n".into(), "t hole 1/0/0 0\n", ""),
        ("obj", "a line that goes on", "v 0 0 0\nf 1 1 1 ".into(), "\\\n", "1\n"),
        ("obj", "faults", String::new(), "?\n", ""),
        ("ply", "positions", ply(&format!("element vertex MORE\n{places}element face 0\n{list}")), "0 0 0\n", ""),
        ("ply", "faces", ply(&format!("{point}element face MANY\n{list}")), "3 0 0 0\n", ""),
        ("ply", "one long face", count(&format!("{}MANY ", ply(&format!("{point}element face 1\n{list}")))), "0 ", ""),
        (
            "stl",
            "triangles",
            "solid\n".into(),
            "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\n",
            "endsolid",
        ),
        ("stl", "solids", String::new(), "solid endsolid\n", ""),
        ("stl", "a name", "solid ".into(), "a ", "\nendsolid"),
        ("off", "positions", count("OFF\nMANY 1 0\n"), "0 0 0\n", "3 0 1 2\n"),
        ("off", "faces", count("OFF\n1 MANY 0\n0 0 0\n"), "3 0 0 0\n", ""),
        ("off", "colours", count("STCOFF\nMANY 1 0\n"), "0 0 0 0 0 0 0 0\n", "3 0 1 2\n"),
        ("off", "one long face", count("OFF\n1 1 0\n0 0 0\nMANY "), "0 ", "\n"),
        ("off", "a long head", "OFF ".into(), "0 ", "\n"),
        ("off", "one long position", "OFF\n1 1 0\n0 0 0 ".into(), "0 ", "\n"),
    ];
    for (format, name, start, part, end) in cases {
        check(name, format, &many(&start, part, end));
    }
    let lists =
        format!("int[] faceVertexCounts=[{}] int[] faceVertexIndices=[{}]", "3,".repeat(MANY), "0,".repeat(3 * MANY));
    let faces = |more: &str| format!("#usda 1.0\ndef Mesh\"\"{{point3f[] points=[0,0,0] {lists} {more}}}");
    let uniform = format!("color3f[] primvars:displayColor=[{}](interpolation=\"uniform\")", "0,0,0,".repeat(MANY));
    let constant = "color3f[] primvars:displayColor=[0,0,0] float[] primvars:displayOpacity=[1] texCoord2f[] \
                    primvars:st=[0,0] rel material:binding=</a>";
    let subset = format!("def GeomSubset\"\"{{int[] indices=[{}]}}", "0,".repeat(MANY));
    for more in ["", &uniform, constant, &subset] {
        check("faces", "usda", faces(more).as_bytes());
    }
    let names = joined(MANY, |i| format!("g {i:x}\n"));
    check("names", "obj", names.as_bytes());
    let sets = joined(MANY, |i| format!("g {i:x}\nf 1 1 1\n"));
    check("groups", "obj", format!("v 0 0 0\n{sets}").as_bytes());
    check("no text", "obj", &[0xff, b'\r'].repeat(MANY));
    check("words that are no text", "obj", &[b"v ", [0xff, b' '].repeat(MANY).as_slice()].concat());
}

#[test]
fn c3_bytes_take_no_more_than_their_weight() {
    let ply = |vertex: &str, face: &str, body: &[u8]| {
        let format = "ply\nformat binary_little_endian 1.0\n";
        let corners = "property list uchar uchar vertex_index\n";
        let point = "property char x\nproperty char y\nproperty char z\n";
        let head = format!("{format}element vertex {vertex}{point}element face {face}{corners}");
        [head.as_bytes(), b"end_header\n", body].concat()
    };
    let head = |n: usize| format!("{n}\n");
    check("positions", "ply", &ply(&head(MANY), "0\n", &[0; 3].repeat(MANY)));
    check("faces", "ply", &ply("1\n", &head(MANY), &[&[0; 3], [3, 0, 0, 0].repeat(MANY).as_slice()].concat()));
    let named = format!("{MANY}\nproperty uchar group\nproperty uchar material\n");
    check("groups", "ply", &ply("1\n", &named, &[&[0; 3], [1, 2, 3, 0, 0, 0].repeat(MANY).as_slice()].concat()));
    let channels = format!("{MANY}\nproperty char a\nproperty char b\nproperty char s\nproperty char t\n");
    check("channels", "ply", &ply(&channels, "0\n", &[0; 7].repeat(MANY)));
    let uvs = format!("{MANY}\nproperty list uchar uchar texcoord\n");
    check(
        "uvs",
        "ply",
        &ply("1\n", &uvs, &[&[0; 3], [6, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0].repeat(MANY).as_slice()].concat()),
    );
    let mut stl = [[0; 80].as_slice(), &u32::try_from(MANY).unwrap().to_le_bytes()].concat();
    for i in 0..MANY {
        let numbers = (0..9).flat_map(|k| u16::try_from((i * 9 + k) & 0x7fff).map(f32::from).unwrap().to_le_bytes());
        stl.extend([0; 12].into_iter().chain(numbers).chain([0; 2]));
    }
    check("triangles", "stl", &stl);
}

#[test]
fn c2_numbers_without_bytes_are_refused() {
    let file = |rest: &str| {
        let mesh = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]"#;
        let accessor = format!(r#"{{"componentType":5126,"count":999999,"type":"VEC3"{rest}}}"#);
        format!(r#"{{"asset":{{"version":"2.0"}},"accessors":[{accessor}],{mesh}}}"#)
    };
    let place = "mesh 0, primitive 0: accessor 0: it has 999999 elements and no bufferView: it takes 22.8 MiB to read";
    let sparse = r#","sparse":{"count":1,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0}}"#;
    for rest in ["", sparse] {
        let found = refusal("gltf", &file(rest));
        assert!(found.starts_with(place) && found.ends_with("are taken: send less at once"), "{found}");
        check("zeros", "gltf", file(rest).as_bytes());
    }
    // a few of the indices are the entries that a sparse accessor changes
    let few = file("").replace("999999", "3000");
    assert_eq!(
        (input::named("gltf").unwrap().read)(&few.as_bytes().into(), &ReadLimits::default()).unwrap().positions.len(),
        3000
    );
}

/// Small files that claim to be large: data that is referenced repeatedly is bounded by the weight of the file.
#[test]
fn c2_what_is_used_again_is_bounded_by_the_weight() {
    let zero = r#"{"componentType":5126,"count":300,"type":"VEC3"}"#;
    let document = |primitives: &str, nodes: &str| {
        let meshes = format!(r#"[{{"primitives":[{primitives}]}}]"#);
        format!(r#"{{"asset":{{"version":"2.0"}},"accessors":[{zero}],"meshes":{meshes},"nodes":[{nodes}]}}"#)
    };
    let one = r#"{"attributes":{"POSITION":0}}"#;
    let node = r#"{"mesh":0,"name":"a chair","translation":[1.25,0.5,2.75]}"#;
    let many = |part: &str| vec![part; 400].join(",");
    let nodes = document(one, &many(node));
    assert!(refusal("gltf", &nodes).contains(" to read; a file of "), "{}", refusal("gltf", &nodes));
    check("a mesh at many nodes", "gltf", nodes.as_bytes());
    let colored = r#"{"attributes":{"POSITION":0,"COLOR_0":0,"_A":0},"extras":{"group":"a"},"material":7}"#;
    check("many primitives", "gltf", document(&many(colored), node).as_bytes());
    let few = document(one, &[node; 9].join(","));
    // all of their corners are at one position, and are separate vertices
    assert_eq!(
        (input::named("gltf").unwrap().read)(&few.as_bytes().into(), &ReadLimits::default()).unwrap().faces.len(),
        900
    );
}

/// Reads and checks a job on this thread only, so that all allocations are counted.
fn check_job(name: &str, job: &str) {
    let (mut kept, length) = (None, job.len() as u64);
    let work = || read::<JobRequest>(job.as_bytes()).map(JobRequest::resolve);
    let taken = measure(|| kept = Some(work())).bytes_max;
    let most = planish::wire::read::reading_memory(length);
    // without the constant part of the bound, so that a list that takes too much is found in a short file
    assert!(
        taken <= most - planish::wire::read::reading_memory(0) + 4096,
        "{name}: {length} bytes take {taken}: {kept:?}"
    );
}

#[test]
fn c3_no_request_takes_more_than_its_weight() {
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().unwrap();
    let places = r#""positions":[[0,0,0],[1,0,0],[1,1,0]]"#;
    let triangle = format!(r#"{places},"faces":[[0,1,2]]"#);
    let mesh = |rest: &str| format!(r#""input":{{"mesh":{{{rest}"#);
    let text = |format: &str, data: &str| format!(r#""input":{{"text":{{"format":"{format}","data":"{data}"#);
    let cases = [
        ("positions", mesh(r#""faces":[],"positions":["#), "[0,0,0],", "[0,0,0]]}}"),
        ("faces", mesh(&format!(r#"{places},"faces":["#)), "[],", "[]]}}"),
        ("faces of a vertex", mesh(&format!(r#"{places},"faces":["#)), "[0],", "[]]}}"),
        ("equal faces", mesh(&format!(r#"{places},"faces":["#)), "[0,1,2],", "[0,1,2]]}}"),
        (
            "creases",
            mesh(&format!(r#"{triangle},"creases":["#)),
            r#"{"edge":[0,0],"sharpness":0},"#,
            r#"{"edge":[0,1],"sharpness":0}]}}"#,
        ),
        (
            "corners",
            mesh(&format!(r#"{triangle},"corners":["#)),
            r#"{"vertex":9,"sharpness":0},"#,
            r#"{"vertex":0,"sharpness":0}]}}"#,
        ),
        ("holes", mesh(&format!(r#"{triangle},"holes":["#)), "9,", "9]}}"),
        ("latitude", mesh(&format!(r#"{triangle},"latitude":["#)), "[0,0],", "[0,0]]}}"),
        (
            "groups",
            mesh(&format!(r#"{triangle},"groups":["#)),
            r#"{"name":"","faces":[]},"#,
            r#"{"name":"","faces":[]}]}}"#,
        ),
        ("a group", mesh(&format!(r#"{triangle},"groups":[{{"name":"a","faces":["#)), "9,", "9]}]}}"),
        ("texture coordinates", mesh(&format!(r#"{triangle},"uvs":{{"values":[],"faces":["#)), "[],", "[]]}}}"),
        ("a channel", mesh(&format!(r#"{triangle},"channels":{{"a":["#)), "0,", "0]}}}"),
        ("points", r#""input":{"polygon":{"points":["#.into(), "[],", "[]]}}"),
        ("points of a coordinate", r#""input":{"polygon":{"points":["#.into(), "[0],", "[0]]}}"),
        ("polygons", r#""input":{"polygons":["#.into(), r#"{"points":[]},"#, r#"{"points":[]}]}"#),
        ("polygons of a point", r#""input":{"polygons":["#.into(), r#"{"points":[[0]]},"#, r#"{"points":[]}]}"#),
        ("parameters", r#""plan":{"word":"U","parameters":{"k":["#.into(), "[],", "[]]}}"),
        ("outputs", r#""outputs":["#.into(), "{},", "{}]"),
        (
            "a mesh as text",
            text("json", &format!(r#"{{{places},"faces":["#).replace('"', "\\\"")),
            "[0,1,2],",
            r#"[0,1,2]]}"}}"#,
        ),
        (
            "faces in groups",
            text("obj", r"v 0 0 0\nv 1 0 0\nv 1 1 0\ng a b c d e f g h i j k l m n\n"),
            r"f 1 2 3\n",
            r#""}}"#,
        ),
        ("holes as text", text("obj", r"t hole 65537/0/0 "), "0 ", r#"\n"}}"#),
    ];
    for (name, start, part, end) in cases {
        check_job(name, &String::from_utf8(many(&format!("{{{start}"), part, &format!("{end}}}"))).unwrap());
    }
    let nested = format!("{}0{},", "[".repeat(100), "]".repeat(100)).repeat(8200);
    check_job("nested lists", &format!(r#"{{"plan":{{"word":"U","parameters":{{"k":[{nested}0]}}}}}}"#));
    check_job("pairs", &format!(r#"{{"plan":{{"word":"U","parameters":{{"k":[{}0]}}}}}}"#, "[0,0],".repeat(8200)));
    for turned in [0, 2] {
        check_job("a grid", &grid(182, turned));
    }
}

/// Returns a grid of `n x n` vertices; every `turned`th face is reversed.
fn grid(n: usize, turned: usize) -> String {
    let places: Vec<[usize; 3]> = (0..n * n).map(|i| [i % n, i / n, 0]).collect();
    let corner = |f: usize| f / (n - 1) * n + f % (n - 1);
    let face = |f: usize| {
        let mut face = [0, 1, n + 1, n].map(|step| corner(f) + step);
        if turned > 0 && f.is_multiple_of(turned) {
            face.reverse();
        }
        face
    };
    let faces: Vec<[usize; 4]> = (0..(n - 1) * (n - 1)).map(face).collect();
    let mesh = format!(r#"{{"positions":{places:?},"faces":{faces:?}}}"#);
    format!(r#"{{"input":{{"mesh":{mesh}}},"outputs":[{{"format":"stats"}}]}}"#)
}

/// The memory that an input reports is never less than it holds, and not much more.
#[test]
fn c3_inputs_say_what_they_hold() {
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().unwrap();
    let mixed = |n: usize| grid(n, 0).replacen("\"faces\":[", &format!("\"faces\":[[{}, 0, {n}],", n * n - 1), 1);
    let square =
        r#"{"input":{"polygon":{"points":[[0,0],[1,0],[1,1],[0,1]],"closed":true}},"outputs":[{"format":"stats"}]}"#;
    for job in [grid(2, 0), grid(90, 0), mixed(90), square.to_owned()] {
        let mut kept = None;
        let read = || read::<JobRequest>(job.as_bytes()).unwrap().input.resolve(Purpose::Keep, &ReadLimits::default());
        let held = measure(|| kept = Some(read().unwrap().input)).bytes_current;
        let said = kept.unwrap().bytes();
        let held = u64::try_from(held).unwrap();
        assert!((held..=held + held / 2 + 1024).contains(&said), "{held} are held, {said} said");
    }
}
