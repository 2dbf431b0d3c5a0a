//! Examples of request bodies in the OpenAPI document.

use std::collections::BTreeMap;

use serde_json::{Value, json};
use utoipa::openapi::RefOr;
use utoipa::openapi::example::{Example, ExampleBuilder};

use crate::wire::catalogue::presets;

/// Examples by their names.
type Examples = BTreeMap<String, RefOr<Example>>;

/// Creates examples, each with a name and a summary.
fn named<const N: usize>(examples: [(&str, &str, Value); N]) -> Examples {
    let example = |(name, summary, value): (&str, &str, Value)| {
        (name.to_owned(), ExampleBuilder::new().summary(summary).value(Some(value)).build().into())
    };
    examples.into_iter().map(example).collect()
}

/// Returns jobs with each kind of input, by name.
pub(super) fn jobs() -> Examples {
    let tetrahedron = json!({ "positions": [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]],
        "faces": [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]] });
    let square = json!({ "points": [[0, 0], [1, 0], [1, 1], [0, 1]], "closed": true });
    let triangle = json!({ "format": "obj", "data": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" });
    let jobs = [
        (
            "polygon",
            "A curve as SVG",
            json!({ "input": { "polygon": square }, "plan": { "preset": presets()[0].name },
            "levels": 4, "outputs": [{ "format": "svg" }] }),
        ),
        (
            "mesh",
            "A surface as GLB",
            json!({ "input": { "mesh": tetrahedron }, "levels": 3,
            "plan": { "preset": "push-back", "parameters": { "delta": "1/2" } },
            "outputs": [{ "format": "glb", "normals": "limit" }] }),
        ),
        (
            "file",
            "A mesh file as PNG, as it is",
            json!({ "input": { "text": triangle },
            "outputs": [{ "format": "png", "width": 64, "height": 64, "camera": { "azimuth_deg": 0 } }] }),
        ),
    ];
    named(jobs)
}

/// Returns batches of both kinds, by name.
pub(super) fn batches() -> Examples {
    let square = json!({ "polygon": { "points": [[0, 0], [1, 0], [1, 1], [0, 1]], "closed": true } });
    let job = |levels| {
        json!({ "input": square, "plan": { "preset": "four-point" }, "levels": levels,
            "outputs": [{ "format": "svg" }] })
    };
    let grid = json!([{ "pointer": "/levels", "values": [2, 4] },
        { "pointer": "/plan/parameters", "values": [{ "w": "1/16" }, { "w": "1/32" }] }]);
    let batches = [
        ("list", "Two jobs", json!({ "jobs": [job(1), job(2)] })),
        ("grid", "Four jobs of a template and a grid", json!({ "template": job(1), "grid": grid })),
    ];
    named(batches)
}

/// Returns requests for analyses, by name.
pub(super) fn analyses() -> Examples {
    let preset = "four-point";
    let scan = json!({ "parameter": "w", "from": 0, "to": "1/4", "steps": 10 });
    let questions = [
        (
            "curve",
            "A scheme for curves",
            json!({ "plan": { "preset": preset, "parameters": { "w": "1/16" } }, "grid": 3 }),
        ),
        ("matrices", "One step as matrices", json!({ "plan": { "word": "UD" }, "matrices": { "points": 4 } })),
        ("scan", "What is proved along a parameter", json!({ "plan": { "preset": preset }, "scan": scan })),
    ];
    named(questions)
}

/// Returns a comparison of two levels of one curve.
pub(super) fn comparisons() -> Examples {
    let square = json!({ "points": [[0, 0], [1, 0], [1, 1], [0, 1]], "closed": true });
    let job = |levels: u32| {
        json!({ "input": { "polygon": square }, "plan": { "preset": presets()[0].name },
            "levels": levels })
    };
    let asked = json!({ "a": job(2), "b": job(6), "tolerance": 0.05 });
    named([("levels", "Two levels of a curve", asked)])
}

/// Returns an evaluation at places on the limit surface of a cube.
pub(super) fn evaluations() -> Examples {
    let asked = json!({ "input": { "mesh": cube() }, "plan": { "preset": "catmull-clark" },
        "at": [[0, 0, 0], [0, 0.5, 0.25]], "values": ["position", "normal", "curvatures"] });
    named([("places", "Two places on a face", asked)])
}

fn cube() -> Value {
    json!({ "positions": [[-1, -1, -1], [-1, -1, 1], [-1, 1, -1], [-1, 1, 1], [1, -1, -1], [1, -1, 1], [1, 1, -1],
            [1, 1, 1]],
        "faces": [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]] })
}
