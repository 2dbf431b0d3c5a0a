//! Limits of plans that change from level to level, compared with thirty levels of the neighbourhood of a vertex.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::limit;
use crate::support::json;
use crate::support::nets::{self, Net, distance};

/// Number of rings of faces that are kept around the vertex. The boundary of the cut affects less than half of them in
/// a level.
const RINGS: usize = 5;
const LEVELS: u32 = 30;

/// Returns the faces within some rings of vertex `v`, which becomes vertex 0.
fn around(net: &Net, v: usize) -> Net {
    let mut kept = vec![v];
    for _ in 0..RINGS {
        let near = |face: &&Vec<usize>| face.iter().any(|u| kept.contains(u));
        let mut more: Vec<usize> = net.faces.iter().filter(near).flatten().copied().collect();
        more.retain(|u| !kept.contains(u));
        more.sort_unstable();
        more.dedup();
        kept.extend(more);
    }
    let number: BTreeMap<usize, usize> = kept.iter().enumerate().map(|(i, &u)| (u, i)).collect();
    let inside = |face: &&Vec<usize>| face.iter().all(|u| number.contains_key(u));
    let faces = net.faces.iter().filter(inside).map(|face| face.iter().map(|u| number[u]).collect()).collect();
    Net { positions: kept.iter().map(|&u| net.positions[u]).collect(), faces }
}

/// Returns the position of vertex `v` after all levels, each a separate job with its own alpha.
fn led_to(net: &Net, v: usize, plan: &Value) -> [f64; 3] {
    let alpha = plan["parameters"]["alpha"].as_f64().expect("a number");
    let mut net = around(net, v);
    for level in 0..LEVELS {
        let mut plan = plan.clone();
        plan["parameters"]["alpha"] = json!(alpha / f64::from(1_u32 << level));
        let finer = Net::of(&json(json!({ "input": net.input(), "plan": plan, "levels": 1 })));
        net = around(&finer, 0);
    }
    net.positions[0]
}

#[test]
fn limits_of_changing_plans_are_where_thirty_levels_lead() {
    let circles =
        |delta: f64| json!({ "alpha": 1, "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": delta });
    let plans = [
        ("UCP", circles(0.5)),
        ("UCP", circles(1.0)),
        ("UCCP", circles(-0.1)),
        ("UC", json!({ "alpha": 1.5, "kernel": "1 + alpha" })),
        ("UCP", json!({ "alpha": 1.2, "kernel": "1.5*cos(alpha/2)", "compensation": "cos(alpha)", "delta": 0.4 })),
    ];
    for (net, v) in [(nets::tetrahedron(), 0), (nets::prism(5), 2), (nets::torus(4, 5), 7), (nets::grid(3, 3), 1)] {
        for (word, parameters) in &plans {
            let plan = json!({ "word": word, "parameters": parameters, "boundary": "edge-only" });
            let (found, _) = limit(&net, &plan, 0);
            let off = distance(&found.positions[v], &led_to(&net, v, &plan));
            assert!(off <= 1e-13, "{plan}: vertex {v} is off by {off}");
        }
    }
}
