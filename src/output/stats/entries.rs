//! Entries of the report that curves and meshes share.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::moments::Moments;
use crate::output::bounds::CoordinateBounds;

pub(super) fn add_moments<const D: usize>(found: &mut Value, of: &str, moments: &Moments<D>, origin: [f64; D]) {
    let centered = moments.centered();
    found["moments_of"] = json!(centered.map(|_| of));
    found["centroid"] = json!(centered.map(|c| list(&std::array::from_fn::<f64, D, _>(|k| c.centroid[k] + origin[k]))));
    found["second_moments"] = json!(centered.map(|c| c.second.iter().map(list).collect::<Vec<_>>()));
}

pub(super) fn bounding_box<const D: usize>(bounds: &CoordinateBounds<D>) -> Value {
    if bounds.is_empty() { Value::Null } else { json!({ "min": list(&bounds.min), "max": list(&bounds.max) }) }
}

/// Returns the numbers, with 0 in place of -0.
fn list<const D: usize>(numbers: &[f64; D]) -> Vec<f64> {
    numbers.iter().map(|x| x + 0.0).collect()
}

pub(super) fn histogram(counts: &BTreeMap<u32, u64>) -> Value {
    counts.iter().map(|(key, count)| (key.to_string(), Value::from(*count))).collect()
}

pub(super) fn euler([vertices, edges, faces]: [usize; 3]) -> i128 {
    vertices as i128 - edges as i128 + faces as i128
}
