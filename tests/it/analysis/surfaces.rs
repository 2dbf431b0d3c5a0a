//! What is said of schemes for surfaces.

use serde_json::{Value, json};

use super::{asked, numbers};

fn surface(plan: &Value, valences: &[usize]) -> Value {
    let answer = asked(&json!({ "plan": plan, "valences": valences, "nodes": 1000 }));
    assert_eq!(answer["kind"], "surface");
    answer
}

fn schemes(file: &str) -> serde_json::Map<String, Value> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors").join(file);
    let text = std::fs::read_to_string(path).unwrap();
    serde_json::from_str::<Value>(&text).unwrap()["schemes"].as_object().unwrap().clone()
}

#[test]
fn zz() {
    for plan in [
        json!({"preset": "catmull-clark"}),
        json!({"preset": "loop"}),
        json!({"preset": "butterfly"}),
        json!({"preset": "kobbelt"}),
        json!({"preset": "doo-sabin"}),
        json!({"preset": "sqrt-3"}),
        json!({"word": "UCP", "parameters": {"delta": 1}}),
        json!({"word":"UD"}),
        json!({"word":"UCC"}),
        json!({"preset": "bilinear"}),
        json!({"preset":"repeated-averaging","parameters":{"degree":9}}),
    ] {
        let answer = surface(&plan, &[3, 4, 5, 6, 7]);
        eprintln!("{plan}: {} {} {}", answer["arity"], answer["applications"], answer["regular"]["smoothness"]);
        eprintln!("  {} {}", answer["regular"]["factors"], answer["regular"]["mask"]["first"]);
        for v in answer["valences"].as_array().unwrap() {
            let e: Vec<String> = v["eigenvalues"]
                .as_array()
                .unwrap()
                .iter()
                .take(7)
                .map(|e| format!("{:.6}[{}]", e["value"].as_f64().unwrap(), e["fourier"]))
                .collect();
            eprintln!(
                "  {} {} {} {} sine {}\n     {:?}\n {:?} {}",
                v["valence"],
                v["c1"],
                v["evidence"],
                v["criteria"].as_array().unwrap().iter().map(|c| c["status"].to_string()).collect::<Vec<_>>().join(" "),
                v["characteristic_map_min_sine"],
                e,
                v["limit_mask"],
                v["refused"]
            );
        }
    }
    let _ = schemes("eig_surfaces_quad.json");
    let _ = numbers(&json!([1.0]));
}
