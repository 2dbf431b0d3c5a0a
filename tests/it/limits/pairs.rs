//! D twice is C on closed meshes, before P too.

use serde_json::{Value, json};

use super::limit;
use crate::support::nets::{self, distance};

#[test]
fn pairs_of_duals_have_the_limits_of_averages() {
    let circle = json!({ "alpha": 1, "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 0.3 });
    let kernels = json!({ "kernel": [1.5, 0.8], "delta": 0.2 });
    for (dual, average, parameters) in [
        ("UDDP", "UCP", json!({ "delta": 0.5 })),
        ("UDDP", "UCP", circle.clone()),
        ("UDDP", "UCP", kernels),
        ("UDDCP", "UCCP", json!({ "delta": 0.5 })),
        ("UCDDP", "UCCP", circle.clone()),
        ("UDDDDP", "UCCP", json!({ "delta": 0.5 })),
        ("UDCDP", "UCCP", json!({ "delta": 0.5 })),
        ("UDCDP", "UCCP", circle),
        ("UDCDP", "UCCP", json!({ "kernel": [1.5, 1], "delta": 0.2 })),
        ("UDCDCP", "UCCCP", json!({ "delta": 0.5 })),
        ("UDCCDP", "UCCCP", json!({ "delta": 0.5 })),
        ("UDCDDCDP", "UCCCCP", json!({ "delta": 0.5 })),
        ("U3DCDP", "U3CCP", json!({ "delta": 0.5 })),
        ("UCUDDP", "UCUCP", json!({ "delta": 0.5 })),
        ("U3DDP", "U3CP", json!({ "delta": 0.5 })),
    ] {
        for net in [nets::cube(), nets::torus(4, 3), nets::tetrahedron()] {
            let plan = |word: &str| -> Value { json!({ "word": word, "parameters": parameters }) };
            for levels in [0, 1] {
                let (found, normals) = limit(&net, &plan(dual), levels);
                let (expected, expected_normals) = limit(&net, &plan(average), levels);
                for v in 0..net.positions.len() {
                    let off = distance(&found.positions[v], &expected.positions[v]);
                    assert!(off <= 1e-12, "{dual} {parameters}: vertex {v} is off by {off} at level {levels}");
                    let off = distance(&normals[v], &expected_normals[v]);
                    assert!(off <= 1e-8, "{dual} {parameters}: normal {v} is off by {off} at level {levels}");
                }
            }
        }
    }
}
