//! Keys: equal jobs have equal keys in any notation, and different jobs have different keys.

use std::borrow::Cow;
use std::collections::BTreeMap;

use planish::job::codec::Item;
use planish::job::key::Key;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::{nets, parsed, render};

fn key_of_text(text: &str) -> Key {
    let job = parsed(text.as_bytes()).unwrap_or_else(|faults| panic!("{faults:?} for {text}"));
    job.keys()[0]
}

fn key(job: &Value) -> Key {
    key_of_text(&job.to_string())
}

fn curve_job() -> Value {
    json!({
        "input": { "polygon": { "points": [[0.0, 0.5], [2.0, 1.0], [3.0, -1.0], [1.0, -2.0]] } },
        "plan": { "word": "UCP", "parameters": {
            "alpha": 0.5, "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 0.25,
        } },
        "levels": 2,
        "outputs": [{ "format": "json" }],
    })
}

fn mesh_job() -> Value {
    json!({
        "input": { "mesh": nets::mixed().to_json() },
        "plan": { "word": "UCP", "parameters": { "delta": "(valence-4)/valence", "compensation": 0 } },
        "levels": 1,
        "outputs": [{ "format": "png", "width": 64, "height": 64 }],
    })
}

/// Returns the job with the value at a pointer replaced.
fn with(job: &Value, pointer: &str, value: Value) -> Value {
    let mut changed = job.clone();
    let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
    let parent = changed.pointer_mut(parent).expect("the place exists");
    match name.parse::<usize>() {
        Ok(index) if parent.is_array() => parent[index] = value,
        _ => parent[name] = value,
    }
    changed
}

fn check_distinct(base: &Value, changes: &[(&str, Value)]) {
    let mut known = BTreeMap::from([(key(base), base.clone())]);
    for (pointer, value) in changes {
        let job = with(base, pointer, value.clone());
        if let Some(same) = known.insert(key(&job), job.clone()) {
            panic!("one key for {job} and {same}");
        }
    }
}

/// Checks that both jobs have the same key, and the same bytes.
fn check_equal(a: &str, b: &str) {
    assert_eq!(key_of_text(a), key_of_text(b), "{a} and {b}");
    let [a_bytes, b_bytes] = [a, b].map(|text| {
        let job = serde_json::from_str(text).expect("a job is JSON");
        render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {text}")).0
    });
    assert_eq!(a_bytes, b_bytes, "{a} and {b}");
}

#[test]
fn curves_that_differ_have_keys_that_differ() {
    check_distinct(
        &curve_job(),
        &[
            ("/input/polygon/points/0/0", json!(5e-324)),
            ("/input/polygon/points/3/1", json!(-2.000_000_000_000_000_4)),
            ("/input/polygon/points", json!([[2.0, 1.0], [3.0, -1.0], [1.0, -2.0], [0.0, 0.5]])),
            ("/input/polygon/points", json!([[0.0], [0.5], [2.0], [1.0], [3.0], [-1.0], [1.0], [-2.0]])),
            ("/input/polygon/points", json!([[0.0, 0.5, 2.0, 1.0], [3.0, -1.0, 1.0, -2.0]])),
            ("/input/polygon/closed", json!(true)),
            ("/input/polygon/corners", json!([1])),
            ("/input/polygon/corners", json!([1, 2])),
            ("/plan/word", json!("UC")),
            ("/plan/word", json!("UCCP")),
            ("/plan/word", json!("UCP(UC)")),
            ("/plan/word", json!("UCPUCP")),
            ("/plan/parameters/alpha", json!(0.25)),
            ("/plan/parameters/kernel", json!("cos(alpha/4)")),
            ("/plan/parameters/kernel", json!(["cos(alpha/2)", "cos(alpha/2)"])),
            ("/plan/parameters/kernel", json!("alpha")),
            ("/plan/parameters/kernel", json!(0.5)),
            ("/plan/parameters/compensation", json!("cos(alpha/2)")),
            ("/plan/parameters/delta", json!(0.5)),
            ("/levels", json!(0)),
            ("/levels", json!(1)),
            ("/levels", json!(3)),
            ("/outputs/0/format", json!("obj")),
            ("/outputs/0/format", json!("svg")),
            ("/outputs/0/format", json!("stats")),
        ],
    );
}

/// Limits depend on the plan even if none of its levels was applied.
#[test]
fn limits_belong_to_the_plan_at_level_0_too() {
    for output in [json!({ "format": "json", "positions": "limit" }), json!({ "format": "json", "tangents": true })] {
        let mut base = curve_job();
        base["levels"] = json!(0);
        base["plan"] = json!({ "preset": "chaikin" });
        base["outputs"] = json!([output]);
        let others = ["cubic-b-spline", "four-point", "incenter"].map(|name| ("/plan", json!({ "preset": name })));
        check_distinct(&base, &others);
    }
}

/// Limits at level 0 also depend on the decay of sharpness and on the rules beside triangles.
#[test]
fn rules_of_meshes_belong_to_limits_at_level_0_too() {
    let mut mesh = nets::tetrahedron().to_json();
    mesh["creases"] = json!([{ "edge": [0, 1], "sharpness": 1.5 }, { "edge": [1, 2], "sharpness": 0.5 }]);
    let plan = |parameters: Value| json!({ "preset": "catmull-clark", "parameters": parameters });
    let others = [json!({ "triangle_rule": "smooth" }), json!({ "creasing": "chaikin" })].map(plan);
    for output in [json!({ "format": "json", "positions": "limit" }), json!({ "format": "ply", "normals": "limit" })] {
        let base = json!({ "input": { "mesh": mesh }, "plan": plan(json!({})), "levels": 0, "outputs": [output] });
        check_distinct(&base, &others.clone().map(|plan| ("/plan", plan)));
    }
    // solids show the limit, and have no levels
    for format in ["step", "certificate", "usda"] {
        let base = json!({ "input": { "mesh": mesh }, "plan": plan(json!({})), "levels": 0,
            "outputs": [{ "format": format }] });
        check_distinct(&base, &others.clone().map(|plan| ("/plan", plan)));
    }
    // without limits these rules have no effect at level 0
    let base = json!({ "input": { "mesh": mesh }, "plan": plan(json!({})), "levels": 0,
        "outputs": [{ "format": "json" }] });
    for other in others {
        check_equal(&base.to_string(), &with(&base, "/plan", other).to_string());
    }
}

#[test]
fn tangents_belong_to_the_key() {
    let mut base = curve_job();
    base["input"]["polygon"]["closed"] = json!(true);
    base["plan"] = json!({ "preset": "incenter", "parameters": {} });
    let changes = [
        ("/input/polygon/tangents", json!([[1, 0], [1, 1], [0, 1], [-1, 0]])),
        ("/input/polygon/tangents", json!([[1, 0], [1, 1], [0, 1], [1, 0]])),
        ("/input/polygon/pinned", json!([1])),
        ("/input/polygon/pinned", json!([1, 2])),
        ("/plan/parameters/mu", json!(0)),
        ("/plan/parameters/mu", json!(1)),
        ("/plan", json!({ "preset": "four-point" })),
    ];
    check_distinct(&base, &changes);
    let [mut given, mut scaled] = [base.clone(), base.clone()];
    given["input"]["polygon"]["tangents"] = json!([[1, 0], [1, 1], [0, 1], [-1, 0]]);
    scaled["input"]["polygon"]["tangents"] = json!([[3, 0], [1e-300, 1e-300], [0, 1e300], [-5e-324, -0.0]]);
    check_equal(&given.to_string(), &scaled.to_string());
    let [mut unordered, mut plain] = [given.clone(), given];
    unordered["input"]["polygon"]["pinned"] = json!([2, 1, 2]);
    plain["input"]["polygon"]["pinned"] = json!([1, 2]);
    check_equal(&unordered.to_string(), &plain.to_string());
    // at the ends of an open polygon, tangents remain in any case
    base["input"]["polygon"]["closed"] = json!(false);
    check_equal(&base.to_string(), &with(&base, "/input/polygon/pinned", json!([0, 3])).to_string());
    check_equal(&base.to_string(), &with(&base, "/plan/parameters/mu", json!("1/4")).to_string());
}

/// Returns texture coordinates with a given u, a given value at the last corner of the second face, and an
/// interpolation.
fn uvs(x: f64, corner: usize, interpolation: &str) -> Value {
    let values: Vec<[f64; 2]> = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0].map(|y| [x, y]).into();
    let faces = json!([[0, 1, 2, 3], [3, 4, corner], [1, 5, 6, 7, 2]]);
    json!({ "values": values, "faces": faces, "interpolation": interpolation })
}

#[test]
fn meshes_that_differ_have_keys_that_differ() {
    check_distinct(
        &mesh_job(),
        &[
            ("/input/mesh/positions/4/2", json!(0.5)),
            ("/input/mesh/faces", json!([[1, 2, 3, 0], [3, 4, 0], [1, 5, 6, 7, 2]])),
            ("/input/mesh/faces", json!([[3, 4, 0], [0, 1, 2, 3], [1, 5, 6, 7, 2]])),
            ("/input/mesh/faces", json!([[0, 1, 2, 3], [3, 4, 0], [1, 5, 6, 7], [7, 2, 1]])),
            ("/input/mesh/faces", json!([[0, 1, 2, 3], [3, 4, 0]])),
            ("/input/mesh/corners", json!([{ "vertex": 1, "sharpness": 10 }])),
            ("/input/mesh/corners", json!([{ "vertex": 3, "sharpness": 10 }])),
            ("/input/mesh/creases", json!([{ "edge": [0, 3], "sharpness": 10 }])),
            ("/input/mesh/creases", json!([{ "edge": [1, 2], "sharpness": 10 }])),
            ("/input/mesh/holes", json!([1])),
            ("/input/mesh/holes", json!([2])),
            ("/input/mesh/channels", json!({ "w": [0, 1, 2, 3, 4, 5, 6, 7] })),
            ("/input/mesh/channels", json!({ "v": [0, 1, 2, 3, 4, 5, 6, 7] })),
            ("/input/mesh/channels", json!({ "w": [0, 1, 2, 3, 4, 5, 6, 8] })),
            ("/input/mesh/channels", json!({ "w": (0..8).map(|i| [i, i]).collect::<Vec<_>>() })),
            ("/input/mesh/groups", json!([{ "name": "a", "faces": [0] }])),
            ("/input/mesh/groups", json!([{ "name": "a", "faces": [1] }])),
            ("/input/mesh/groups", json!([{ "name": "b", "faces": [0] }])),
            ("/input/mesh/groups", json!([{ "name": "a", "faces": [0] }, { "name": "b", "faces": [] }])),
            ("/input/mesh/materials", json!([{ "name": "a", "faces": [0] }])),
            ("/input/mesh/uvs", uvs(0.5, 0, "all")),
            ("/input/mesh/uvs", uvs(0.25, 0, "all")),
            ("/input/mesh/uvs", uvs(0.5, 3, "all")),
            ("/input/mesh/uvs", uvs(0.5, 0, "none")),
            ("/input/mesh/uvs", uvs(0.5, 0, "corners-only")),
            ("/input/mesh/uvs", uvs(0.5, 0, "boundaries")),
            ("/input/unit", json!("mm")),
            ("/input/unit", json!("in")),
            ("/input/up", json!("z")),
            ("/plan/boundary", json!("edge-only")),
            ("/plan/boundary", json!("none")),
            ("/plan/parameters/delta", json!("(valence-4)/4")),
            ("/plan/parameters/delta", json!("(valence-4)*valence")),
            ("/plan/parameters/delta", json!("(4-valence)/valence")),
            ("/plan/parameters/compensation", json!(1)),
            ("/plan", json!({ "preset": "catmull-clark" })),
            ("/plan", json!({ "preset": "catmull-clark", "parameters": { "triangle_rule": "smooth" } })),
            ("/plan", json!({ "preset": "bilinear" })),
            ("/levels", json!(2)),
            ("/outputs/0/width", json!(65)),
            ("/outputs/0/height", json!(65)),
            ("/outputs/0/background", json!("#123456")),
            ("/outputs/0/background", json!("transparent")),
            ("/outputs/0", json!({ "format": "obj" })),
            ("/outputs/0", json!({ "format": "obj", "normals": "area" })),
            ("/outputs/0", json!({ "format": "obj", "ids": true })),
            ("/outputs/0", json!({ "format": "ply" })),
            ("/outputs/0", json!({ "format": "ply", "ascii": true })),
            ("/outputs/0", json!({ "format": "glb" })),
            ("/outputs/0", json!({ "format": "gltf" })),
        ],
    );
}

#[test]
fn sharpness_is_part_of_the_key() {
    let mut job = mesh_job();
    job["plan"] = json!({ "preset": "catmull-clark" });
    job["input"]["mesh"]["creases"] = json!([{ "edge": [0, 3], "sharpness": 2 }]);
    check_distinct(
        &job,
        &[
            ("/input/mesh/creases/0/sharpness", json!(2.5)),
            ("/input/mesh/creases/0/sharpness", json!(10)),
            ("/input/mesh/creases/0/edge", json!([1, 2])),
            ("/input/mesh/creases", json!([])),
            ("/input/mesh/corners", json!([{ "vertex": 3, "sharpness": 2 }])),
            ("/input/mesh/corners", json!([{ "vertex": 3, "sharpness": 3 }])),
            ("/input/mesh/corners", json!([{ "vertex": 3, "sharpness": 10 }])),
            ("/plan/parameters", json!({ "creasing": "chaikin" })),
            ("/plan/parameters", json!({ "triangle_rule": "smooth" })),
        ],
    );
}

const SHORT: &str = r#"{"input":{"polygon":{"points":[[0,0],[4,0],[4,4],[0,0.25]],"closed":true}},"levels":2,
    "plan":{"preset":"four-point"},"outputs":[{"format":"json"}]}"#;

#[test]
fn the_split_is_part_of_the_key() {
    let mut job = mesh_job();
    job["input"] = nets::octahedron().input();
    check_distinct(
        &job,
        &[
            ("/plan/parameters/split", json!("triangle")),
            ("/plan/parameters", json!({ "delta": 0.5, "split": "triangle" })),
            ("/plan/parameters", json!({ "delta": 0.5, "split": "triangle", "mu": 0.5 })),
            ("/plan", json!({ "preset": "loop" })),
            ("/plan", json!({ "word": "U" })),
            ("/plan", json!({ "word": "U3" })),
            ("/plan", json!({ "word": "U", "parameters": { "split": "triangle" } })),
            ("/plan", json!({ "word": "U3", "parameters": { "split": "triangle" } })),
        ],
    );
    // unused parameters make no difference
    let same = |a: Value, b: Value| assert_eq!(key(&with(&job, "/plan", a)), key(&with(&job, "/plan", b)));
    same(json!({ "word": "UC" }), json!({ "word": "UC", "parameters": { "split": "quad", "mu": 0.5 } }));
    let on_triangles = |mu: f64| json!({ "word": "UP", "parameters": { "split": "triangle", "mu": mu } });
    same(on_triangles(0.25), on_triangles(0.5));
    let curve = curve_job();
    assert_eq!(key(&curve), key(&with(&curve, "/plan/parameters/split", json!("triangle"))));
}

#[test]
fn spelling_does_not_matter() {
    for same in [
        // other order of fields, defaults written out, other name of the output
        r#"{"outputs":[{"name":"mine","format":"json"}],"plan":{"seed":7,"ends":"clamped","parameters":{"w":0.0625},
            "boundary":"edge-and-corner","preset":"four-point"},"spec":1,"levels":2,
            "input":{"polygon":{"corners":[],"closed":true,"points":[[0,0],[4,0],[4,4],[0,0.25]]}}}"#,
        // numbers as fractions, exponents, minus zero
        r#"{"input":{"polygon":{"points":[[-0,-0.0],[4e0,0.0],[40e-1,4.00],[0,25e-2]],"closed":true}},"levels":2,
            "plan":{"preset":"four-point","parameters":{"w":"1/16"}},"outputs":[{"format":"json"}]}"#,
        r#"{"input":{"polygon":{"points":[[0,0],[4,0],[4,4],[0,0.25]],"closed":true}},"levels":2,
            "plan":{"preset":"four-point","parameters":{"w":" (2 - 1) / 2^4 "}},"outputs":[{"format":"json"}]}"#,
        // the word of the preset
        r#"{"input":{"polygon":{"points":[[0,0],[4,0],[4,4],[0,0.25]],"closed":true}},"levels":2,
            "plan":{"word":"UCP"},"outputs":[{"format":"json"}]}"#,
        r#"{"input":{"polygon":{"points":[[0,0],[4,0],[4,4],[0,0.25]],"closed":true}},"levels":2,
            "plan":{"word":"(UCP)","parameters":{"delta":"3-2","compensation":1,"kernel":[1]}},
            "outputs":[{"format":"json"}]}"#,
        r#"{"input":{"polygon":{"points":[[0,0],[4,0],[4,4],[0,0.25]],"closed":true}},"levels":2,
            "plan":{"word":"UD^2P"},"outputs":[{"format":"json"}]}"#,
        // one polygon in a list
        r#"{"input":{"polygons":[{"points":[[0,0],[4,0],[4,4],[0,0.25]],"closed":true}]},"levels":2,
            "plan":{"preset":"four-point"},"outputs":[{"format":"json"}]}"#,
    ] {
        check_equal(SHORT, same);
    }
}

/// A parameter that no operator of the plan uses, or data that the input does not have, is not part of the key.
#[test]
fn what_has_no_effect_does_not_matter() {
    let equal = |base: &Value, pointer: &str, value: Value| {
        check_equal(&base.to_string(), &with(base, pointer, value).to_string());
    };
    let mut smooth = curve_job();
    smooth["plan"] = json!({ "word": "UC", "parameters": { "kernel": 2 } });
    equal(&smooth, "/plan/parameters/delta", json!(0.125));
    equal(&smooth, "/plan/parameters/compensation", json!("cos(alpha)"));
    equal(&smooth, "/plan/parameters/alpha", json!(3));
    equal(&smooth, "/plan/boundary", json!("none"));
    let mut closed = smooth.clone();
    closed["input"]["polygon"]["closed"] = json!(true);
    equal(&closed, "/plan/ends", json!("natural"));
    let mut cube = mesh_job();
    cube["input"]["mesh"] = nets::cube().to_json();
    equal(&cube, "/plan/boundary", json!("edge-only"));
    equal(&cube, "/plan/boundary", json!("none"));
    equal(&cube, "/plan/ends", json!("natural"));
    equal(&cube, "/input/mesh/corners", json!([{ "vertex": 3, "sharpness": 0 }]));
    equal(&cube, "/input/mesh/creases", json!([{ "edge": [0, 1], "sharpness": 0 }]));
    cube["plan"] = json!({ "preset": "catmull-clark" });
    equal(&cube, "/plan/parameters", json!({ "triangle_rule": "smooth" }));
    equal(&cube, "/plan/parameters", json!({ "creasing": "chaikin" }));
    cube["input"]["mesh"]["creases"] = json!([{ "edge": [0, 1], "sharpness": 10 }]);
    equal(&cube, "/plan/parameters", json!({ "creasing": "chaikin" }));
    equal(&cube, "/input/mesh/creases/0/sharpness", json!(11));
    equal(&cube, "/input/mesh/creases/0/edge", json!([1, 0]));
    // boundary edges are infinitely sharp by themselves
    let mut open = mesh_job();
    open["plan"] = json!({ "preset": "catmull-clark" });
    equal(&open, "/input/mesh/creases", json!([{ "edge": [0, 1], "sharpness": 3 }]));
    // 0 levels of a word without a prefix are equivalent to no plan
    let mut as_it_is = curve_job();
    as_it_is["levels"] = json!(0);
    equal(&as_it_is, "/plan/word", json!("UD"));
    let mut unplanned = as_it_is.clone();
    unplanned.as_object_mut().expect("an object").shift_remove("plan");
    check_equal(&as_it_is.to_string(), &unplanned.to_string());
}

#[test]
fn corners_and_holes_are_sets() {
    let mut job = mesh_job();
    job["input"]["mesh"]["corners"] = json!([{ "vertex": 1, "sharpness": 10 }, { "vertex": 4, "sharpness": 12.5 }]);
    job["input"]["mesh"]["holes"] = json!([0, 2]);
    let mut same = job.clone();
    same["input"]["mesh"]["corners"] = json!([
        { "vertex": 4, "sharpness": 1e300 }, { "vertex": 1, "sharpness": 10 }, { "vertex": 4, "sharpness": 10 },
    ]);
    same["input"]["mesh"]["holes"] = json!([2, 0, 2]);
    check_equal(&job.to_string(), &same.to_string());
}

#[test]
fn what_travels_is_told_in_any_order_and_may_be_empty() {
    let plain = mesh_job();
    for (pointer, nothing) in [
        ("/input/mesh/channels", json!({})),
        ("/input/mesh/groups", json!([])),
        ("/input/mesh/materials", json!([])),
        ("/input/unit", json!("m")),
        ("/input/up", json!("y")),
    ] {
        assert_eq!(key(&with(&plain, pointer, nothing)), key(&plain), "{pointer}");
    }
    let [one, other] =
        [r#"{"a":[0,1,2,3,4,5,6,7],"b":[7,6,5,4,3,2,1,0]}"#, r#"{"b":[7,6,5,4,3,2,1,0],"a":[0,1,2,3,4,5,6,7]}"#]
            .map(|channels| with(&plain, "/input/mesh/channels", serde_json::from_str(channels).expect("JSON")));
    assert_ne!(one.to_string(), other.to_string());
    assert_eq!(key(&one), key(&other));
    let [one, other] = [json!([2, 0, 2]), json!([0, 2])]
        .map(|faces| with(&plain, "/input/mesh/groups", json!([{ "name": "a", "faces": faces }])));
    assert_eq!(key(&one), key(&other));
}

#[test]
fn names_are_part_of_the_job_but_not_of_its_artifacts() {
    let job = |outputs: Value| {
        let text = with(&curve_job(), "/outputs", outputs).to_string();
        parsed(text.as_bytes()).expect("a job")
    };
    let plain = job(json!([{ "format": "json" }, { "format": "obj" }]));
    let named = job(json!([{ "format": "json", "name": "a" }, { "format": "obj" }]));
    let turned = job(json!([{ "format": "obj" }, { "format": "json" }]));
    assert_eq!(plain.keys()[0], named.keys()[0]);
    assert_eq!(plain.keys()[0], turned.keys()[1]);
    assert_ne!(plain.id(), named.id());
    assert_ne!(plain.id(), turned.id());
    assert_eq!(plain.id(), job(json!([{ "format": "json", "name": "json" }, { "format": "obj" }])).id());
}

#[test]
fn keys_are_written_as_64_lowercase_hexadecimal_digits() {
    let key = key(&curve_job());
    let text = key.to_string();
    assert_eq!(text.len(), 64);
    assert_eq!(Key::parse(&text), Some(key));
    assert_eq!(Key::parse(&"0f".repeat(32)), Some(Key::from_bytes([15; 32])));
    let upper = text.to_uppercase();
    assert_ne!(upper, text);
    for wrong in [&text[1..], &upper, &format!("{text}0"), "", &" ".repeat(64), &"g".repeat(64), &"é".repeat(32)] {
        assert_eq!(Key::parse(wrong), None, "{wrong}");
    }
}

fn item() -> impl Strategy<Value = Item<'static>> {
    let number = || any::<f64>().prop_filter("equal to itself", |x| !x.is_nan());
    let leaf = prop_oneof![
        any::<u64>().prop_map(Item::Integer),
        number().prop_map(Item::Number),
        ".{0,12}".prop_map(|text| Item::Text(Cow::Owned(text))),
        proptest::collection::vec(number(), 0..6).prop_map(|xs| Item::Numbers(Cow::Owned(xs))),
        proptest::collection::vec(any::<u32>(), 0..6).prop_map(|xs| Item::Indices(Cow::Owned(xs))),
    ];
    leaf.prop_recursive(6, 40, 6, |inner| proptest::collection::vec(inner, 0..6).prop_map(Item::List))
}

fn encoded(item: &Item<'_>) -> Vec<u8> {
    let mut bytes = Vec::new();
    item.encode(&mut bytes);
    bytes
}

/// Takes `n` bytes off the front of an encoding.
fn take<'a>(bytes: &mut &'a [u8], n: usize) -> &'a [u8] {
    bytes.split_off(..n).expect("an encoding is whole")
}

fn eight(bytes: &mut &[u8]) -> [u8; 8] {
    take(bytes, 8).try_into().expect("there are eight")
}

/// Takes the first item off an encoding.
fn decoded(bytes: &mut &[u8]) -> Item<'static> {
    let length = |bytes: &mut &[u8]| usize::try_from(u64::from_le_bytes(eight(bytes))).expect("it is short");
    match take(bytes, 1)[0] {
        1 => Item::Integer(u64::from_le_bytes(eight(bytes))),
        2 => Item::Number(f64::from_le_bytes(eight(bytes))),
        3 => {
            let n = length(bytes);
            Item::Text(String::from_utf8(take(bytes, n).to_vec()).expect("it was a text").into())
        }
        4 => Item::Numbers((0..length(bytes)).map(|_| f64::from_le_bytes(eight(bytes))).collect()),
        5 => {
            let n = length(bytes);
            Item::Indices(take(bytes, 4 * n).as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect())
        }
        6 => Item::List((0..length(bytes)).map(|_| decoded(bytes)).collect()),
        tag => panic!("{tag} is no tag"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_was_encoded_can_be_decoded(item in item(), more in any::<[u8; 3]>()) {
        let bytes = [&encoded(&item)[..], &more].concat();
        let mut rest = &bytes[..];
        prop_assert_eq!(decoded(&mut rest), item);
        prop_assert_eq!(rest, more);
    }

    #[test]
    fn different_items_have_different_encodings(a in item(), b in item()) {
        prop_assert_eq!(a == b, encoded(&a) == encoded(&b));
    }

    #[test]
    fn jobs_with_different_points_have_different_keys(
        a in proptest::collection::vec(proptest::array::uniform2(-4..4_i32), 2..5),
        b in proptest::collection::vec(proptest::array::uniform2(-4..4_i32), 2..5),
    ) {
        let of = |points: &[[i32; 2]]| key(&with(&curve_job(), "/input/polygon/points", json!(points)));
        prop_assert_eq!(a == b, of(&a) == of(&b));
    }
}

#[test]
fn minus_zero_is_zero() {
    assert_eq!(encoded(&Item::Number(-0.0)), encoded(&Item::Number(0.0)));
    assert_eq!(encoded(&Item::Numbers(vec![-0.0].into())), encoded(&Item::Numbers(vec![0.0].into())));
}
