//! What reading takes of memory is bounded by the bytes that came in, whatever they claim to be.

use allocation_counter::measure;
use planish::input::{self, ReadLimits};

/// Bytes that a reader takes at most while it reads.
fn peak(format: &str, file: &[u8]) -> u64 {
    let reader = input::named(format).expect("a reader");
    measure(|| drop(reader.read(file, &ReadLimits::default()))).bytes_max
}

fn times(start: &str, part: &str, end: &str) -> String {
    let n = (1 << 20) / part.len();
    [start, &part.repeat(n), end].concat()
}

#[test]
fn explore() {
    let gltf = |s: &str, p: &str, e: &str| times(&format!(r#"{{"asset":{{"version":"2.0"}},{s}"#), p, e);
    let cases: Vec<(&str, &str, String)> = vec![
        ("nodes", "gltf", gltf(r#""nodes":["#, "{},", "{}]}")),
        (
            "accessors",
            "gltf",
            gltf(
                r#""accessors":["#,
                r#"{"componentType":5126,"count":9,"type":"VEC3"},"#,
                r#"{"componentType":5126,"count":9,"type":"VEC3"}]}"#,
            ),
        ),
        ("min", "gltf", gltf(r#""accessors":[{"componentType":5126,"count":9,"type":"VEC3","min":["#, "0,", "0]}]}")),
        ("materials", "gltf", gltf(r#""materials":["#, "{},", "{}]}")),
        (
            "prims",
            "gltf",
            gltf(
                r#""meshes":[{"primitives":["#,
                r#"{"attributes":{"POSITION":0}},"#,
                r#"{"attributes":{"POSITION":0}}]}]}"#,
            ),
        ),
        ("unknown", "gltf", gltf(r#""x":["#, "0,", "0]}")),
        ("v", "obj", times("", "v 0 0 0\n", "f 1 2 3\n")),
        ("v1", "obj", times("v ", "0 ", "")),
        ("vc", "obj", times("", "v 0 0 0 1 1 1\n", "f 1 2 3\n")),
        ("vt", "obj", times("v 0 0 0\n", "vt 0\n", "f 1/1 1/1 1/1\n")),
        ("f", "obj", times("v 0 0 0\n", "f 1 1 1\n", "")),
        ("fl", "obj", times("v 0 0 0\nf ", "1 ", "1\n")),
        ("fg", "obj", times("v 0 0 0\ng a b c d e f g h i j k l m n o p\n", "f 1 1 1\n", "")),
        ("hole", "obj", times("v 0 0 0\nf 1 1 1\nt hole 524288/0/0 ", "0 ", "\n")),
        ("corner", "obj", times("v 0 0 0\nf 1 1 1\nt corner 524288/1/0 ", "0 ", "1\n")),
        ("holes", "obj", times("v 0 0 0\nf 1 1 1\n", "t hole 1/0/0 0\n", "")),
        ("g", "obj", (0..150_000).map(|i| format!("g {i}\n")).collect()),
        (
            "gf",
            "obj",
            std::iter::once("v 0 0 0\n".to_owned()).chain((0..60_000).map(|i| format!("g {i}\nf 1 1 1\n"))).collect(),
        ),
        ("bad", "obj", String::from_utf8_lossy(&[]).into_owned() + &times("# ", "x", "")),
        (
            "plyv",
            "ply",
            times(
                "ply\nformat ascii 1.0\nelement vertex 174762\nproperty char x\nproperty char y\nproperty char z\nelement face 0\nproperty list char char vertex_index\nend_header\n",
                "0 0 0\n",
                "",
            ),
        ),
        (
            "plyf",
            "ply",
            times(
                "ply\nformat ascii 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char z\nelement face 131072\nproperty list char char vertex_index\nend_header\n0 0 0\n",
                "3 0 0 0\n",
                "",
            ),
        ),
        (
            "plyfl",
            "ply",
            times(
                "ply\nformat ascii 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char z\nelement face 1\nproperty list char char vertex_index\nend_header\n0 0 0\n524288 ",
                "0 ",
                "",
            ),
        ),
        (
            "plybv",
            "ply",
            times(
                "ply\nformat binary_little_endian 1.0\nelement vertex 349525\nproperty char x\nproperty char y\nproperty char z\nelement face 0\nproperty list char char vertex_index\nend_header\n",
                "\0\0\0",
                "",
            ),
        ),
        (
            "plybvm",
            "ply",
            times(
                "ply\nformat binary_little_endian 1.0\nelement vertex 149796\nproperty char x\nproperty char y\nproperty char z\nproperty char a\nproperty char b\nproperty char s\nproperty char t\nelement face 0\nproperty list char char vertex_index\nend_header\n",
                "\0\0\0\0\0\0\0",
                "",
            ),
        ),
        (
            "plybf",
            "ply",
            times(
                "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char z\nelement face 262144\nproperty list char char vertex_index\nend_header\n\0\0\0",
                "\x03\0\0\0",
                "",
            ),
        ),
        (
            "plybfg",
            "ply",
            times(
                "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char z\nelement face 174762\nproperty list char char vertex_index\nproperty char group\nproperty char material\nend_header\n\0\0\0",
                "\x03\0\0\0\x01\x02",
                "",
            ),
        ),
        (
            "plybft",
            "ply",
            times(
                "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char z\nelement face 95325\nproperty list char char vertex_index\nproperty list char char texcoord\nend_header\n\0\0\0",
                "\x03\0\0\0\x06\0\0\0\0\0\0",
                "",
            ),
        ),
        (
            "plybl",
            "ply",
            times(
                "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char z\nelement face 1\nproperty list int char vertex_index\nend_header\n\0\0\0\0\0\x10\0",
                "\0",
                "",
            ),
        ),
        (
            "plybt",
            "ply",
            times(
                "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char z\nelement face 1\nproperty list char char vertex_index\nproperty list int char texcoord\nend_header\n\0\0\0\0\0\0\x10\0",
                "\0",
                "",
            ),
        ),
        (
            "plyc",
            "ply",
            (0..40_000)
                .fold("ply\n".to_owned(), |t, i| if i < 9_000 { t + &format!("comment group {i} a\n") } else { t }),
        ),
        (
            "stlt",
            "stl",
            times(
                "solid\n",
                "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\n",
                "endsolid",
            ),
        ),
        ("stls", "stl", times("", "solid endsolid\n", "")),
        ("stln", "stl", times("solid ", "a ", "\nendsolid")),
        ("offv", "off", times("OFF\n174762 1 0\n", "0 0 0\n", "3 0 1 2\n")),
        ("offf", "off", times("OFF\n1 131072 0\n0 0 0\n", "3 0 0 0\n", "")),
        ("offc", "off", times("STCOFF\n65536 1 0\n", "0 0 0 0 0 0 0 0\n", "3 0 1 2\n")),
        ("offl", "off", times("OFF\n1 1 0\n0 0 0\n524288 ", "0 ", "\n")),
        ("offh", "off", times("OFF ", "0 ", "\n")),
        ("offw", "off", times("OFF\n1 1 0\n0 0 0 ", "0 ", "\n")),
    ];
    for (name, format, file) in cases {
        let result = input::named(format).unwrap().read(file.as_bytes(), &ReadLimits::default());
        let why =
            result.map_or_else(|f| f[0].detail.clone(), |m| format!("ok {} {}", m.positions.len(), m.faces.len()));
        println!("{name:8} {:8.2}  {why:.90}", peak(format, file.as_bytes()) as f64 / file.len() as f64);
    }
    let mut stl = vec![0_u8; 84];
    stl[80..84].copy_from_slice(&20_000_u32.to_le_bytes());
    for i in 0..20_000_u32 {
        let mut t = [0_u8; 50];
        for k in 0..9 {
            t[12 + 4 * k..16 + 4 * k].copy_from_slice(&((i * 9 + k as u32) as f32).to_le_bytes());
        }
        stl.extend(t);
    }
    println!("stlb {:8.2}", peak("stl", &stl) as f64 / stl.len() as f64);
    let bad: Vec<u8> = [0xff_u8, b'\r'].repeat(1 << 19);
    println!("lossy {:8.2}", peak("obj", &bad) as f64 / bad.len() as f64);
    let jobs: Vec<(&str, String)> = vec![
        (
            "positions",
            times(
                r#"{"input":{"mesh":{"positions":["#,
                "[0,0,0],",
                r#"[0,0,0]],"faces":[]}},"outputs":[{"format":"stats"}]}"#,
            ),
        ),
        (
            "faces",
            times(r#"{"input":{"mesh":{"positions":[],"faces":["#, "[],", r#"[]]}},"outputs":[{"format":"stats"}]}"#),
        ),
        (
            "faces3",
            times(
                r#"{"input":{"mesh":{"positions":[[0,0,0]],"faces":["#,
                "[0,0,0],",
                r#"[]]}},"outputs":[{"format":"stats"}]}"#,
            ),
        ),
        (
            "faces1",
            times(
                r#"{"input":{"mesh":{"positions":[[0,0,0]],"faces":["#,
                "[0],",
                r#"[]]}},"outputs":[{"format":"stats"}]}"#,
            ),
        ),
        (
            "holes",
            times(
                r#"{"input":{"mesh":{"positions":[],"faces":[],"holes":["#,
                "0,",
                r#"0]}},"outputs":[{"format":"stats"}]}"#,
            ),
        ),
        ("points", times(r#"{"input":{"polygon":{"points":["#, "[],", r#"[]]}},"outputs":[{"format":"stats"}]}"#)),
        (
            "points1",
            times(
                r#"{"input":{"polygon":{"points":["#,
                "[0],",
                r#"[0]]}},"plan":{"preset":"chaikin"},"levels":1,"outputs":[{"format":"stats"}]}"#,
            ),
        ),
        (
            "polygons",
            times(
                r#"{"input":{"polygons":["#,
                r#"{"points":[]},"#,
                r#"{"points":[]}]},"outputs":[{"format":"stats"}]}"#,
            ),
        ),
        (
            "creases",
            times(
                r#"{"input":{"mesh":{"positions":[],"faces":[],"creases":["#,
                r#"{"edge":[0,0],"sharpness":0},"#,
                r#"{"edge":[0,0],"sharpness":0}]}},"outputs":[{"format":"stats"}]}"#,
            ),
        ),
        (
            "groups",
            times(
                r#"{"input":{"mesh":{"positions":[],"faces":[],"groups":["#,
                r#"{"name":"","faces":[]},"#,
                r#"{"name":"","faces":[]}]}},"outputs":[{"format":"stats"}]}"#,
            ),
        ),
        (
            "channel",
            times(
                r#"{"input":{"mesh":{"positions":[],"faces":[],"channels":{"a":["#,
                "0,",
                r#"0]}}},"outputs":[{"format":"stats"}]}"#,
            ),
        ),
        ("outputs", times(r#"{"input":{"mesh":{"positions":[],"faces":[]}},"outputs":["#, "{},", "{}]}")),
        ("lists", times(r#"{"plan":{"word":"U","parameters":{"k":["#, "[],", "[]]}}}")),
        ("lists2", times(r#"{"plan":{"word":"U","parameters":{"k":["#, "[[[[[0]]]]],", "[]]}}}")),
        ("maps", times(r#"{"plan":{"word":"U","parameters":{"k":["#, r#"{"":0},"#, "[]]}}}")),
        ("grid", {
            let n = 180;
            let p: Vec<String> = (0..n * n).map(|i| format!("[{},{},0]", i % n, i / n)).collect();
            let f: Vec<String> = (0..(n - 1) * (n - 1))
                .map(|i| {
                    let a = i / (n - 1) * n + i % (n - 1);
                    format!("[{},{},{},{}]", a, a + 1, a + n + 1, a + n)
                })
                .collect();
            format!(
                r#"{{"input":{{"mesh":{{"positions":[{}],"faces":[{}]}}}},"outputs":[{{"format":"stats"}}]}}"#,
                p.join(","),
                f.join(",")
            )
        }),
        ("tris", {
            let p: Vec<String> = (0..100).map(|_| "[0,0,0]".to_string()).collect();
            let f: Vec<String> =
                (0..100_000).map(|i| format!("[{},{},{}]", i % 10, i / 10 % 10 + 20, i / 100 % 10 + 30)).collect();
            format!(
                r#"{{"input":{{"mesh":{{"positions":[{}],"faces":[{}]}}}},"outputs":[{{"format":"stats"}}]}}"#,
                p.join(","),
                f.join(",")
            )
        }),
    ];
    for (name, job) in jobs {
        let read = measure(|| drop(planish::wire::read::read::<planish::wire::JobRequest>(job.as_bytes()))).bytes_max;
        let all = measure(|| {
            drop(planish::wire::read::read::<planish::wire::JobRequest>(job.as_bytes()).map(|r| r.resolve()))
        })
        .bytes_max;
        let why = match planish::wire::read::read::<planish::wire::JobRequest>(job.as_bytes()) {
            Ok(r) => r.resolve().map_or_else(|f| f[0].detail.clone(), |_| "ok".into()),
            Err(e) => format!("{e:?}"),
        };
        println!("{name:8} {:8.2} {:8.2} {why:.90}", read as f64 / job.len() as f64, all as f64 / job.len() as f64);
    }
}
