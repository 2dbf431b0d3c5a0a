//! D twice is C on closed meshes, also before P, and P finds its points if D removes the rim of a neighbourhood.

use serde_json::{Value, json};

use super::limit;
use crate::support::json;
use crate::support::nets::{self, Net, distance};

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

/// On triangles, D twice is C with the weight 1/3, whatever the kernel; with a C between them, no word of C only is
/// equivalent.
#[test]
fn pairs_of_duals_on_triangles_have_limits() {
    let on_triangles = |word: &str, more: Value| -> Value {
        let mut parameters = json!({ "split": "triangle", "mu": 1.0 / 3.0 });
        parameters.as_object_mut().expect("an object").extend(more.as_object().cloned().unwrap_or_default());
        json!({ "word": word, "parameters": parameters })
    };
    let circle = json!({ "alpha": 1, "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 0.3 });
    for net in [nets::tetrahedron(), nets::triangulated(nets::prism(5))] {
        let still = |[(a, an), (b, bn)]: [(Net, Vec<[f64; 3]>); 2], what: &str| {
            for v in 0..net.positions.len() {
                let off = distance(&a.positions[v], &b.positions[v]);
                assert!(off <= 1e-12, "{what}: vertex {v} is off by {off}");
                let off = distance(&an[v], &bn[v]);
                assert!(off <= 1e-8, "{what}: normal {v} is off by {off}");
            }
        };
        for parameters in [json!({ "delta": 0.4 }), circle.clone()] {
            let [dual, average] = ["UDDP", "UCP"].map(|word| on_triangles(word, parameters.clone()));
            still([limit(&net, &dual, 1), limit(&net, &average, 1)], "UDDP");
        }
        for word in ["UDCDP", "UCDDPC", "UDCDCP"] {
            let plan = on_triangles(word, json!({ "delta": 0.4 }));
            let (found, normals) = limit(&net, &plan, 0);
            let deep = Net::of(&json(json!({ "input": net.input(), "plan": plan, "levels": 6 })));
            for v in 0..net.positions.len() {
                let off = distance(&found.positions[v], &deep.positions[v]);
                assert!(off <= 3e-3, "{word}: vertex {v} is {off} from its limit");
            }
            still([(found, normals), limit(&net, &plan, 1)], word);
        }
    }
}
