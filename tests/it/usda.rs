//! USD as text: what becomes a subdivision surface and what polygons, and the attributes of both.

use serde_json::{Value, json};

use crate::support::nets::{self, Net};
use crate::support::{parsed, render};
use planish::job::limits::Limits;
use planish::output::Size;

/// Returns a job of a preset at level 0, on a net with additional fields.
fn cage(net: &Net, extra: &Value, plan: &Value) -> Value {
    let mut mesh = net.to_json();
    for (name, value) in extra.as_object().expect("fields of a mesh") {
        mesh[name] = value.clone();
    }
    json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 0, "outputs": [{ "format": "usda" }] })
}

fn bytes(job: &Value) -> Vec<u8> {
    render(job).unwrap_or_else(|faults| panic!("{faults:?} for {job}")).0
}

fn text(job: &Value) -> String {
    String::from_utf8(bytes(job)).expect("usda is text")
}

fn key(job: &Value) -> String {
    parsed(job.to_string().as_bytes()).expect("a job").keys()[0].to_string()
}

/// Returns the value of an attribute, up to the end of its line.
fn attribute(text: &str, name: &str) -> Option<String> {
    let line = text.lines().find(|line| line.contains(&format!(" {name} = ")))?;
    Some(line.split_once(" = ")?.1.trim_end_matches(" (").to_owned())
}

fn scheme(job: &Value) -> String {
    attribute(&text(job), "subdivisionScheme").expect("every mesh names its scheme")
}

#[test]
fn a_cage_is_a_subdivision_surface_with_everything_that_is_tagged() {
    let extra = json!({
        "creases": [{ "edge": [0, 1], "sharpness": 2.5 }, { "edge": [1, 3], "sharpness": 99 }],
        "corners": [{ "vertex": 7, "sharpness": 1.5 }, { "vertex": 6, "sharpness": 12 }],
        "holes": [4],
    });
    let found = text(&cage(&nets::cube(), &extra, &json!({ "preset": "catmull-clark" })));
    for (name, value) in [
        ("faceVertexCounts", "[4, 4, 4, 4, 4, 4]"),
        ("subdivisionScheme", "\"catmullClark\""),
        ("interpolateBoundary", "\"edgeAndCorner\""),
        ("cornerIndices", "[6, 7]"),
        ("cornerSharpnesses", "[10, 1.5]"),
        ("creaseLengths", "[2, 2]"),
        ("holeIndices", "[4]"),
        ("metersPerUnit", "1"),
        ("upAxis", "\"Y\""),
    ] {
        assert_eq!(attribute(&found, name).as_deref(), Some(value), "{name} in {found}");
    }
    let list = |name: &str| -> Vec<f64> {
        serde_json::from_str(&attribute(&found, name).expect("it is there")).expect("a list of numbers")
    };
    let edges = list("creaseIndices");
    let mut creases: Vec<_> = edges.chunks(2).map(|edge| edge[0] + edge[1]).zip(list("creaseSharpnesses")).collect();
    creases.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(creases, [(1.0, 2.5), (4.0, 10.0)], "the edges 0-1 and 1-3");
    assert!(!found.contains("triangleSubdivisionRule"), "there is no triangle: {found}");
}

#[test]
fn the_schemes_of_usd_keep_the_cage_and_all_others_are_polygons() {
    for (preset, expected) in [("catmull-clark", "\"catmullClark\""), ("bilinear", "\"bilinear\"")] {
        assert_eq!(scheme(&cage(&nets::cube(), &json!({}), &json!({ "preset": preset }))), expected);
    }
    let loops = cage(&nets::octahedron(), &json!({}), &json!({ "preset": "loop" }));
    assert_eq!(scheme(&loops), "\"loop\"");
    assert_eq!(scheme(&cage(&nets::cube(), &json!({}), &json!({ "word": "U" }))), "\"bilinear\"");
    for plan in [
        json!({ "preset": "doo-sabin" }),
        json!({ "word": "UC" }),
        json!({ "word": "U3" }),
        json!({ "word": "UU" }),
        json!({ "word": "U", "parameters": { "split": "triangle" } }),
    ] {
        let net = if plan["parameters"].is_null() { nets::cube() } else { nets::octahedron() };
        assert_eq!(scheme(&cage(&net, &json!({}), &plan)), "\"none\"", "{plan}");
    }
    let mut without = cage(&nets::cube(), &json!({}), &json!({}));
    without.as_object_mut().expect("a job").retain(|name, _| name != "plan" && name != "levels");
    assert_eq!(scheme(&without), "\"none\"", "nothing is said of a scheme");
}

#[test]
fn what_a_level_normals_or_the_limit_have_made_are_polygons() {
    let job = cage(&nets::cube(), &json!({ "holes": [1] }), &json!({ "preset": "catmull-clark" }));
    let asked = |name: &str, value: &str| {
        let mut job = job.clone();
        job["outputs"][0][name] = json!(value);
        job
    };
    let mut refined = job.clone();
    refined["levels"] = json!(1);
    for job in [refined, asked("positions", "limit"), asked("normals", "area"), asked("normals", "limit")] {
        let found = text(&job);
        assert_eq!(attribute(&found, "subdivisionScheme").as_deref(), Some("\"none\""));
        assert!(!found.contains("holeIndices") && !found.contains("interpolateBoundary"), "{found}");
        assert_eq!(found.contains("primvars:normals"), !job["outputs"][0]["normals"].is_null());
    }
}

#[test]
fn a_rule_that_usd_has_no_word_for_makes_polygons() {
    let creased = |sharpness: f64| {
        let extra = json!({ "creases": [{ "edge": [0, 1], "sharpness": sharpness }] });
        let plan = json!({ "preset": "catmull-clark", "parameters": { "creasing": "chaikin" } });
        scheme(&cage(&nets::cube(), &extra, &plan))
    };
    assert_eq!(creased(2.0), "\"none\"");
    assert_eq!(creased(10.0), "\"catmullClark\"", "creases that never fade do so under no rule");
    let plan = json!({ "preset": "catmull-clark", "parameters": { "triangle_rule": "smooth" } });
    let found = text(&cage(&nets::octahedron(), &json!({}), &plan));
    assert_eq!(attribute(&found, "triangleSubdivisionRule").as_deref(), Some("\"smooth\""));
}

#[test]
fn boundaries_and_values_of_corners_keep_their_rules() {
    let grid = nets::grid(2, 2);
    for (rule, token) in [("edge-and-corner", "edgeAndCorner"), ("edge-only", "edgeOnly"), ("none", "none")] {
        let plan = json!({ "preset": "catmull-clark", "boundary": rule });
        let found = text(&cage(&grid, &json!({}), &plan));
        assert_eq!(attribute(&found, "interpolateBoundary"), Some(format!("\"{token}\"")));
        assert!(!found.contains("holeIndices"), "faces at the boundary are hidden by the rule, not one by one");
    }
    // two values at the middle, so that every interpolation gives another result
    let faces = json!([[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [9, 10, 12, 11]]);
    let values: Vec<[usize; 2]> = (0..13).map(|i| [i, i * i]).collect();
    for (word, token) in [
        ("all", "all"),
        ("boundaries", "boundaries"),
        ("corners-only", "cornersOnly"),
        ("corners-plus1", "cornersPlus1"),
        ("none", "none"),
    ] {
        let uvs = json!({ "uvs": { "values": values, "faces": faces, "interpolation": word } });
        let found = text(&cage(&grid, &uvs, &json!({ "preset": "catmull-clark" })));
        assert_eq!(attribute(&found, "faceVaryingLinearInterpolation"), Some(format!("\"{token}\"")));
    }
}

#[test]
fn jobs_with_other_bytes_have_other_keys_and_those_with_the_same_bytes_one() {
    let job = |plan: &Value| cage(&nets::octahedron(), &json!({}), plan);
    let plans = [
        json!({ "preset": "catmull-clark" }),
        json!({ "preset": "catmull-clark", "parameters": { "triangle_rule": "smooth" } }),
        json!({ "preset": "loop" }),
        json!({ "preset": "bilinear" }),
    ];
    for (i, first) in plans.iter().enumerate() {
        for second in &plans[..i] {
            assert_ne!(bytes(&job(first)), bytes(&job(second)), "{first} {second}");
            assert_ne!(key(&job(first)), key(&job(second)), "{first} {second}");
        }
    }
    let [first, second] =
        ["edge-only", "edge-and-corner"].map(|rule| job(&json!({ "preset": "catmull-clark", "boundary": rule })));
    assert_eq!((bytes(&first), key(&first)), (bytes(&second), key(&second)), "a closed mesh has no boundary");
}

#[test]
fn the_forecast_bounds_the_length() {
    let example = include_str!("../../api/examples/jobs/cube-cage-usda.json");
    let mut job: Value = serde_json::from_str(example).expect("JSON");
    for levels in 0..4 {
        for normals in ["none", "area"] {
            job["levels"] = json!(levels);
            job["outputs"][0]["normals"] = json!(normals);
            let job = parsed(job.to_string().as_bytes()).expect("a job");
            let most = match Limits::default().estimate(&job).expect("within limits").outputs[0].1 {
                Size::AtMost(n) | Size::Exact(n) => n,
            };
            let mut found = Vec::new();
            let admitted = Limits::default().admit(job).expect("within limits");
            let output = &admitted.job().outputs[0];
            planish::job::run(&admitted, output, &mut found, &planish::watch::Watch::new()).expect("it is written");
            let length = found.len() as u128;
            assert!(length <= most && most < 8 * length + 20_000, "{length} and {most}");
        }
    }
}

#[test]
fn what_has_no_place_in_usd_is_said() {
    let pixel = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";
    let extra = json!({
        "uvs": { "values": [[0, 0]], "faces": vec![vec![0; 4]; 6] },
        "materials": [{ "name": "a", "faces": [0], "texture": { "image": format!("data:image/png;base64,{pixel}") } }],
        "channels": { "heat": { "values": [0, 1], "faces": [[0, 0, 0, 0], [1, 1, 1, 1], [0, 0, 0, 0], [0, 0, 0, 0],
            [0, 0, 0, 0], [0, 0, 0, 0]], "interpolation": "none" } },
    });
    let job = cage(&nets::cube(), &extra, &json!({ "preset": "catmull-clark" }));
    let warnings = render(&job).expect("it is written").1.warnings;
    for start in ["textures are left out", "the channel \"heat\" has another interpolation"] {
        assert!(warnings.iter().any(|warning| warning.starts_with(start)), "{start}: {warnings:?}");
    }
}

#[test]
fn curves_are_refused() {
    let job = json!({
        "input": { "polygon": { "points": [[0, 0], [1, 0], [0, 1]], "closed": true } },
        "outputs": [{ "format": "usda" }],
    });
    let faults = render(&job).expect_err("usda holds no curves");
    assert_eq!(faults[0].pointer, "/outputs/0/format");
    assert!(faults[0].detail.contains("ask for json or obj"), "{faults:?}");
}
