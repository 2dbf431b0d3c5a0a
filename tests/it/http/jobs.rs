//! Small jobs for tests.

use planish::output::{FORMATS, Format, ShapeKind};
use serde_json::{Value, json};

/// Returns a cube of eight vertices and six quads as an input.
pub(crate) fn cube() -> Value {
    json!({ "mesh": {
        "positions": [[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1],[-1,-1,1],[1,-1,1],[1,1,1],[-1,1,1]],
        "faces": [[0,3,2,1],[4,5,6,7],[0,1,5,4],[1,2,6,5],[2,3,7,6],[3,0,4,7]] } })
}

/// Returns a closed square as an input.
pub(crate) fn square() -> Value {
    json!({ "polygon": { "points": [[0,0],[1,0],[1,1],[0,1]], "closed": true } })
}

/// Returns a cube refined `levels` times: 6 x 4^levels faces.
pub(crate) fn mesh(levels: u32) -> Value {
    json!({ "input": cube(), "plan": { "preset": "catmull-clark" }, "levels": levels })
}

/// Returns a square refined `levels` times: 4 x 2^levels points.
pub(crate) fn polygon(levels: u32) -> Value {
    json!({ "input": square(), "plan": { "preset": "chaikin" }, "levels": levels })
}

/// Returns the job with one output.
pub(crate) fn with(mut job: Value, format: &str) -> Value {
    job["outputs"] = json!([{ "format": format }]);
    job
}

/// Returns the formats that hold a mesh, or a plane polygon.
pub(crate) fn formats(mesh: bool) -> Vec<&'static dyn Format> {
    let kind = if mesh { ShapeKind::Mesh } else { ShapeKind::Curves { dimension: 2 } };
    FORMATS.iter().copied().filter(|format| format.holds(kind).is_ok()).collect()
}

/// Returns a job that would take minutes, in little memory: four points halved 18 times, then averaged 2560 times.
pub(crate) fn endless() -> Value {
    json!({ "input": square(), "plan": { "word": "U^18(C^40)" }, "levels": 64 })
}

/// Returns the cube with levels of detail, whose buffers are separate results.
pub(crate) fn detailed() -> Value {
    let mut job = mesh(2);
    job["outputs"] = json!([{ "format": "gltf", "lod": [1, 2] }]);
    job
}
