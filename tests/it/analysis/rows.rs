//! The rows of `analysis_masks` and `eig_curve_matrix10` in `tests/vectors`.

use serde_json::{Value, json};

use super::{asked, numbers, texts, word};

fn rows(file: &str) -> Vec<Value> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors").join(file);
    let text = std::fs::read_to_string(path).unwrap();
    serde_json::from_str::<Value>(&text).unwrap()["rows"].as_array().unwrap().clone()
}

#[test]
fn every_row_of_the_reference_is_found_again() {
    let rows = rows("analysis_masks.json");
    assert_eq!(rows.len(), 28);
    for row in rows {
        let parameters = json!({ "arity": row["arity"], "first": row["mask_lo"], "mask": row["mask"] });
        let answer = asked(&json!({ "plan": { "preset": "mask", "parameters": parameters }, "nodes": 30_000 }));
        agrees(row["name"].as_str().unwrap(), &row, &answer);
    }
}

fn agrees(name: &str, row: &Value, answer: &Value) {
    let written: Vec<String> = texts(&row["mask"]).into_iter().filter(|a| a != "0").collect();
    let exact: Vec<String> = texts(&answer["mask"]["exact"]).into_iter().filter(|a| a != "0").collect();
    assert_eq!(exact, written, "{name}");
    assert_eq!(answer["sum_rules"], row["sum_rule_order"], "{name}");
    assert_eq!(answer["residual"]["exact"], row["residual_symbol"], "{name}");
    let support = numbers(&answer["support"]);
    let width = row["support_width"].as_f64().unwrap();
    assert!((support[1] - support[0] - width).abs() < 1e-15, "{name}");
    let smoothness = &answer["smoothness"];
    assert_eq!(smoothness["proved_c"], row["Ck"], "{name}");
    // bounds from other programs overlap with those here, which are not much wider
    for (ours, theirs) in
        [("joint_spectral_radius", ["jsr_lower", "jsr_upper"]), ("holder", ["holder_lower", "holder_upper"])]
    {
        let found = numbers(&smoothness[ours]);
        let [low, high] = theirs.map(|end| row[end].as_f64().unwrap());
        let room = 1e-9 * high.abs().max(1.0);
        assert!(found[0] <= high + room && low <= found[1] + room, "{name}: {ours} {found:?}, [{low}, {high}]");
        assert!(
            found[1] - found[0] <= (high - low).max(2e-3 * high.abs()),
            "{name}: {ours} {found:?}, [{low}, {high}]"
        );
    }
    let found = smoothness["certificates"].as_array().unwrap();
    for wanted in row["norm_certificate"].as_array().unwrap() {
        let same = found.iter().find(|c| c["k"] == wanted["k"]).unwrap_or_else(|| panic!("{name}: no {wanted}"));
        assert_eq!(same["l"], wanted["L"], "{name}");
        assert!((same["norm"].as_f64().unwrap() - wanted["norm"].as_f64().unwrap()).abs() < 1e-12, "{name}: {same}");
    }
}

#[test]
fn the_matrix_of_the_push_back_has_the_eigenvalues_of_theorem_2() {
    let rows = rows("eig_curve_matrix10.json");
    assert_eq!(rows.len(), 4);
    for row in rows {
        let parameters = json!({ "kernel": row["f"], "compensation": row["omega"], "delta": row["delta"] });
        let answer = word("UCP", &parameters);
        let mut wanted: Vec<f64> = row["eigenvalues"].as_array().unwrap().iter().map(|x| numbers(x)[0]).collect();
        let found = numbers(&answer["local_eigenvalues"]);
        assert_eq!(found.len(), 5, "{row}");
        for x in found {
            let place = wanted.iter().position(|y| (x - y).abs() < 1e-10).unwrap_or_else(|| panic!("{x}: {row}"));
            wanted.remove(place);
        }
    }
}
