//! Mutated jobs give results or faults, whatever the mutation.

use planish::job::limits::{Limits, Refusal};
use planish::job::run;
use planish::watch::Watch;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::{nets, parsed};

/// Small limits, so that no mutation takes much work.
const LIMITS: Limits = Limits {
    max_faces: 400,
    max_vertices: 500,
    max_output_bytes: 40_000,
    max_job_bytes: 2_000_000,
    max_held_bytes: u64::MAX,
};

fn valid_jobs() -> Vec<Value> {
    let mut mesh = nets::mixed().to_json();
    mesh["corners"] = json!([{ "vertex": 5, "sharpness": 10 }]);
    mesh["creases"] = json!([{ "edge": [0, 3], "sharpness": 1.5 }, { "edge": [2, 1], "sharpness": 12 }]);
    mesh["holes"] = json!([1]);
    let points = [[0.0, 0.0], [2.0, 1.0], [1.0, 3.0], [-1.0, 2.0]];
    let functions =
        json!({ "alpha": "pi/6", "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 0.5 });
    vec![
        json!({
            "spec": 1, "input": { "mesh": mesh, "orient": "repair" }, "levels": 1,
            "plan": {
                "preset": "catmull-clark", "boundary": "edge-only", "seed": 3,
                "parameters": { "creasing": "chaikin", "triangle_rule": "smooth" },
            },
            "outputs": [{ "name": "a", "format": "obj", "normals": "area" }, { "format": "stats" }],
        }),
        json!({
            "input": { "mesh": nets::cube().to_json() }, "levels": 1,
            "plan": { "word": "UCP", "parameters": functions },
            "outputs": [{ "format": "glb" }, { "format": "ply", "ascii": true }, { "format": "stl" }],
        }),
        json!({
            "input": { "mesh": nets::tetrahedron().to_json() }, "levels": 1,
            "plan": { "preset": "push-back", "parameters": { "delta": "(valence-4)/valence", "k": 2 } },
            "outputs": [{ "format": "png", "width": 40, "height": 30, "camera": { "azimuth_deg": 20 },
                          "show": ["wireframe"], "background": "#fff" }],
        }),
        json!({
            "input": { "polygon": { "points": points, "closed": true, "corners": [1] } }, "levels": 2,
            "plan": { "preset": "four-point", "parameters": { "w": "1/16" } },
            "outputs": [{ "format": "svg", "width": 64, "height": 48 }, { "format": "json" }],
        }),
        json!({
            "input": { "polygons": [{ "points": points }, { "points": points, "closed": true }] }, "levels": 2,
            "plan": { "word": "UUCPD(UC)", "ends": "clamped", "parameters": { "kernel": [1, "2"] } },
            "outputs": [{ "format": "json" }],
        }),
    ]
}

/// Returns values to replace others.
fn strange() -> impl Strategy<Value = Value> {
    prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        prop::sample::select(vec![
            0.0,
            -0.0,
            0.5,
            -1.0,
            1.0,
            2.0,
            3.0,
            4.0,
            63.0,
            65.0,
            4_294_967_295.0,
            4_294_967_296.0,
            1e19,
            1e100,
            1e308,
            -1e308,
            5e-324,
        ])
        .prop_map(Value::from),
        any::<u64>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        prop::sample::select(vec![
            "",
            "U",
            "UCP",
            "U^9999999999",
            "((((U",
            "cos(alpha",
            "1/0",
            "\u{0}",
            "é𝄞",
            "b-spline",
            "catmull-clark",
            "json",
            "png",
            "none",
            "repair",
            "__proto__",
            "a/b~c",
            "transparent",
            "valence",
            "alpha",
        ])
        .prop_map(Value::from),
        Just(json!([])),
        Just(json!({})),
        Just(json!([[], [0], [0, 1, 2], [[[]]]])),
        Just(json!({ "format": "json", "preset": "chaikin" })),
    ]
}

#[derive(Debug, Clone)]
enum Mutation {
    Replace(Value),
    Delete,
    Rename(String),
    Repeat,
    Move(prop::sample::Index),
}

fn mutation() -> impl Strategy<Value = Mutation> {
    let name = prop::sample::select(vec!["mesh", "polygon", "polygons", "points", "preset", "word", "levels", "x", ""]);
    prop_oneof![
        6 => strange().prop_map(Mutation::Replace),
        2 => Just(Mutation::Delete),
        2 => name.prop_map(|name| Mutation::Rename(name.into())),
        2 => Just(Mutation::Repeat),
        1 => any::<prop::sample::Index>().prop_map(Mutation::Move),
    ]
}

/// Collects JSON pointers to all parts of a value.
fn places(value: &Value, here: &str, found: &mut Vec<String>) {
    found.push(here.to_owned());
    match value {
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| places(item, &format!("{here}/{i}"), found));
        }
        Value::Object(fields) => fields.iter().for_each(|(name, item)| places(item, &format!("{here}/{name}"), found)),
        _ => {}
    }
}

fn apply(job: &mut Value, place: prop::sample::Index, mutation: &Mutation) {
    let mut all = Vec::new();
    places(job, "", &mut all);
    let at = all[place.index(all.len())].clone();
    let Some((parent, name)) = at.rsplit_once('/') else { return };
    let elsewhere =
        if let Mutation::Move(index) = mutation { job.pointer(&all[index.index(all.len())]).cloned() } else { None };
    let index = name.parse::<usize>();
    match (job.pointer_mut(parent), mutation) {
        (Some(Value::Array(items)), Mutation::Delete | Mutation::Rename(_)) => {
            items.remove(index.expect("a place in a list"));
        }
        (Some(Value::Array(items)), Mutation::Repeat) => {
            let copy = items[index.expect("a place in a list")].clone();
            items.push(copy);
        }
        (Some(Value::Object(fields)), Mutation::Delete) => {
            fields.shift_remove(name);
        }
        (Some(Value::Object(fields)), Mutation::Rename(new)) => {
            let value = fields.shift_remove(name).unwrap_or(Value::Null);
            fields.insert(new.clone(), value);
        }
        (Some(Value::Object(fields)), Mutation::Repeat) => {
            let value = fields[name].clone();
            fields.insert(format!("{name}s"), value);
        }
        (Some(_), Mutation::Replace(value)) => *job.pointer_mut(&at).expect("it is there") = value.clone(),
        (Some(_), Mutation::Move(_)) => *job.pointer_mut(&at).expect("it is there") = elsewhere.unwrap_or(Value::Null),
        _ => {}
    }
}

/// Runs any text; returns whether it gave a result.
fn survives(text: &[u8]) -> bool {
    let job = match parsed(text) {
        Ok(job) => job,
        Err(faults) => {
            assert!(!faults.is_empty() && faults.iter().all(|fault| !fault.detail.is_empty()), "{faults:?}");
            return false;
        }
    };
    let admitted = match LIMITS.admit(job) {
        Ok(admitted) => admitted,
        Err(Refusal::Impossible(faults) | Refusal::TooLarge { faults, .. }) => {
            assert!(!faults.is_empty(), "{}", String::from_utf8_lossy(text));
            return false;
        }
        Err(Refusal::Stopped) => unreachable!("nothing stops it"),
    };
    let results = admitted.job().outputs.iter().map(|output| {
        let mut bytes = Vec::new();
        run(&admitted, output, &mut bytes, &Watch::new()).map(|_| bytes)
    });
    results.filter_map(Result::ok).filter(|bytes| !bytes.is_empty()).count() == admitted.job().outputs.len()
}

#[test]
fn the_jobs_are_good_before_anything_is_changed() {
    for job in valid_jobs() {
        assert!(survives(job.to_string().as_bytes()), "{job}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn changed_jobs_are_refined_or_refused(
        job in prop::sample::select(valid_jobs()),
        changes in proptest::collection::vec((any::<prop::sample::Index>(), mutation()), 1..4),
    ) {
        let mut job = job;
        changes.iter().for_each(|(place, change)| apply(&mut job, *place, change));
        survives(job.to_string().as_bytes());
    }

    #[test]
    fn changed_text_is_refined_or_refused(
        job in prop::sample::select(valid_jobs()),
        cuts in proptest::collection::vec((any::<prop::sample::Index>(), 0..9_usize, "[ -~]{0,4}"), 1..5),
    ) {
        let mut text = job.to_string().into_bytes();
        for (place, length, patch) in cuts {
            let from = place.index(text.len());
            let to = (from + length).min(text.len());
            text.splice(from..to, patch.into_bytes());
        }
        survives(&text);
    }

    #[test]
    fn repeated_text_is_refined_or_refused(
        job in prop::sample::select(valid_jobs()), from in any::<prop::sample::Index>(), length in 1..60_usize,
    ) {
        let text = job.to_string();
        let from = from.index(text.len());
        let piece = text.as_bytes()[from..(from + length).min(text.len())].to_vec();
        let mut twice = text.into_bytes();
        twice.splice(from..from, piece);
        survives(&twice);
    }

    #[test]
    fn random_bytes_are_refused(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(!survives(&bytes));
    }
}

#[test]
fn duplicate_and_unknown_fields_are_refused_at_their_place() {
    let check = |text: &str, pointer: &str, detail: &str| {
        let found = parsed(text.as_bytes()).expect_err("it is refused");
        assert_eq!(found[0].pointer, pointer, "{text}: {found:?}");
        assert!(found[0].detail.contains(detail), "{text}: {found:?}");
    };
    check(r#"{"input":{},"input":{}}"#, "/input", "duplicate field");
    check("{}", "/input", "\"input\" is missing");
    check(r#"{"input":{"mesh":{"positions":[]}}}"#, "/input/mesh/faces", "\"faces\" is missing");
    check(r#"{"inptu":{}}"#, "/inptu", "unknown field \"inptu\"; did you mean \"input\"? expected one of");
    check(r#"{"input":{"up":"Z"}}"#, "/input/up", "did you mean \"z\"? expected one of \"y\", \"z\"");
    check(r#"{"input":{"mesh":{"vertices":[]}}}"#, "/input/mesh/vertices", "unknown field \"vertices\"");
    check(r#"{"input":{"polygon":{"points":[[0],["x"]]}}}"#, "/input/polygon/points/1/0", "expected a number");
    check(r#"{"input":{"mesh":{"positions":[[0,0]],"faces":[]}}}"#, "/input/mesh/positions/0", "three numbers");
    check(r#"{"input":{"mesh":{"positions":[],"faces":[[-1]]}}}"#, "/input/mesh/faces/0/0", "whole number");
    check(r#"{"input":{"mesh":{"positions":[],"faces":[[0.5]]}}}"#, "/input/mesh/faces/0/0", "whole number");
    let job = |plan: &str| {
        let input = r#"{"polygon":{"points":[[0],[1]]}}"#;
        format!(r#"{{"input":{input},"levels":1,"outputs":[{{"format":"json"}}],"plan":{plan}}}"#)
    };
    check(&job(r#"{"word":"UC","parameters":{"delta":1,"delta":2}}"#), "/plan/parameters/delta", "duplicate field");
    check(&job(r#"{"word":"UC","parameters":{"dleta":1}}"#), "/plan/parameters/dleta", "did you mean \"delta\"?");
    check(&job(r#"{"word":"UC","preset":"chaikin"}"#), "/plan/word", "leave one of them out");
    check(&job(r#"{"preset":"chakin"}"#), "/plan/preset", "did you mean \"chaikin\"? known are chaikin");
    check(&job("{}"), "/plan", "a \"preset\" or a \"word\"");
    check(&job("7"), "/plan", "expected an object");
}

#[test]
fn levels_are_whole_and_bounded() {
    let check = |levels: &str, pointer: &str, detail: &str| {
        let input = r#"{"polygon":{"points":[[0],[1]]}}"#;
        let text =
            format!(r#"{{"input":{input},"plan":{{"word":"U"}},"outputs":[{{"format":"json"}}],"levels":{levels}}}"#);
        let found = parsed(text.as_bytes()).expect_err("it is refused");
        assert_eq!(found[0].pointer, pointer, "{levels}: {found:?}");
        assert!(found[0].detail.contains(detail), "{levels}: {found:?}");
    };
    check("65", "/levels", "at most 64 are allowed");
    check("4294967295", "/levels", "at most 64 are allowed");
    check("18446744073709551615", "/levels", "at most 64 are allowed");
    check("-1", "/levels", "whole number");
    check("1.5", "/levels", "whole number");
    check("\"2\"", "/levels", "whole number");
}

#[test]
fn deep_nesting_ends_without_a_stack_overflow() {
    for open in ["[", "{\"a\":", "{\"input\":{\"mesh\":", "{\"outputs\":[{\"camera\":"] {
        let found = parsed(open.repeat(300_000).as_bytes()).expect_err("that is no job");
        assert_eq!(found.len(), 1);
    }
    let deep = format!(r#"{{"plan":{{"word":"U","parameters":{{"kernel":{}"#, "[".repeat(300_000));
    assert_eq!(parsed(deep.as_bytes()).expect_err("that is no job").len(), 1);
}
