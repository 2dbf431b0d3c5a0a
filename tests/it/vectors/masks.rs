//! Limit masks around vertices of any valence.

use serde_json::{Value, json};

use super::{points, tolerance};
use crate::support::json_with;
use crate::support::nets::sectors_of_quads;

/// Compares limit masks, from the limits of impulses on a vertex with sectors of quads.
pub(super) fn limits(vector: &Value) -> usize {
    let mut compared = 0;
    for (name, valences) in vector["schemes"].as_object().expect("schemes by name") {
        let word = |word: &str, kernel: f64, compensation: f64, delta: f64| {
            json!({
                "word": word, "parameters": { "kernel": kernel, "compensation": compensation, "delta": delta }
            })
        };
        let plan = match name.split(' ').next() {
            Some("catmull_clark") => json!({ "preset": "catmull-clark" }),
            Some("CU") => word("UC", 1.0, 1.0, 0.0),
            Some("CCU") => word("UCC", 1.0, 1.0, 0.0),
            Some("table") if name.contains("b/d") => word("UCP", 1.0, 1.0, 1.0),
            Some("table") if name.contains(" c ") => word("UCP", 1.0, 1.0, -0.1),
            Some("table") if name.contains(" e ") => word("UCP", 10.0, 1.0, 0.8),
            _ => panic!("no plan is known for {name}"),
        };
        for (valence, row) in valences.as_object().expect("valences by number") {
            let sectors = valence.parse().expect("valences are numbers");
            check_limit_mask(&plan, sectors, &row["limit"], tolerance(vector));
            compared += 1;
        }
    }
    compared
}

/// Checks a limit mask; `expected` holds the weight of the centre and of the vertices `"i,j"` of each sector.
fn check_limit_mask(plan: &Value, sectors: usize, expected: &Value, tolerance: f64) {
    let (mut net, places) = sectors_of_quads(sectors, 4);
    let weight = |place: Option<[usize; 2]>| match place {
        None => expected["center"].as_f64().expect("the centre has a weight"),
        Some([i, j]) => expected[format!("{i},{j}")].as_f64().unwrap_or(0.0),
    };
    // one coordinate per place: the first sector, and the sum of each place over all sectors
    let first: Vec<usize> = (0..places.len()).take(1 + 4 * 5).collect();
    for three in first.chunks(3) {
        for (v, position) in net.positions.iter_mut().enumerate() {
            *position = [0, 1, 2].map(|k| f64::from(u8::from(three.get(k) == Some(&v))));
        }
        let job = json!({ "input": net.input(), "plan": plan, "levels": 0 });
        let found: Vec<[f64; 3]> = points(&json_with(job, &json!({ "positions": "limit" }))["positions"]);
        for (k, &v) in three.iter().enumerate() {
            let (found, expected) = (found[0][k], weight(places[v]));
            assert!((found - expected).abs() <= tolerance, "{plan} {sectors} {:?}: {found} not {expected}", places[v]);
        }
    }
}
