//! Matrices of one step: those of the lecture, and their common properties.

use serde_json::{Value, json};

use super::{asked, numbers, refused, texts};

fn matrices(plan: &Value, points: u32) -> Value {
    asked(&json!({ "plan": plan, "nodes": 100, "matrices": { "points": points } }))["matrices"].clone()
}

fn exact(matrix: &Value) -> Vec<Vec<String>> {
    matrix["exact"].as_array().unwrap().iter().map(texts).collect()
}

fn rows(matrix: &Value) -> Vec<Vec<f64>> {
    matrix["rows"].as_array().unwrap().iter().map(numbers).collect()
}

/// The lecture's splitting and averaging matrices of corner cutting, and their product (3 1 / 1 3)/4.
#[test]
fn corner_cutting_is_a_splitting_and_an_averaging_as_the_lecture_shows_them() {
    let found = matrices(&json!({ "preset": "chaikin" }), 3);
    let steps = found["steps"].as_array().unwrap();
    assert_eq!((&steps[0]["role"], &steps[1]["role"]), (&json!("splitting"), &json!("averaging")));
    let splitting = exact(&steps[0]["matrix"]);
    assert_eq!(splitting[0], ["1", "0", "0"]);
    assert_eq!(splitting[1], ["1/2", "1/2", "0"]);
    assert_eq!(splitting[5], ["1/2", "0", "1/2"], "the last edge leads back to the first point");
    let averaging = exact(&steps[1]["matrix"]);
    assert_eq!((averaging.len(), averaging[0].len()), (6, 6));
    assert_eq!(averaging[0], ["1/2", "1/2", "0", "0", "0", "0"]);
    let product = exact(&found["product"]);
    assert_eq!(
        (&product[0], &product[1]),
        (&vec!["3/4".into(), "1/4".into(), "0".into()], &vec!["1/4".into(), "3/4".into(), "0".into()])
    );
}

#[test]
fn powers_of_the_local_matrix_come_close_to_the_limit_mask_in_every_row() {
    let plan = json!({ "preset": "cubic-b-spline" });
    let answer = asked(&json!({ "plan": plan, "matrices": { "powers": 8 } }))["matrices"].clone();
    assert_eq!(answer["points"], 5);
    let local = &answer["local"];
    assert_eq!(exact(&local["powers"][0]), [["1/2", "1/2", "0"], ["1/8", "3/4", "1/8"], ["0", "1/2", "1/2"]]);
    let limit = rows(&local["limit"]);
    assert_eq!(exact(&local["limit"])[2], ["1/6", "2/3", "1/6"]);
    let far = |power: usize| {
        let found = rows(&local["powers"][power]);
        let off = found.iter().flatten().zip(limit.iter().flatten()).map(|(a, b)| (a - b).abs());
        off.fold(0.0, f64::max)
    };
    // the second eigenvalue is 1/2
    assert!(far(7) < 0.51 * far(6) && far(7) < 1.0 / 200.0, "{} {}", far(6), far(7));
}

/// The matrices map the unit vectors of a closed polygon as a step does.
#[test]
fn products_have_the_sub_masks_as_their_rows() {
    for (plan, n) in [
        (json!({ "preset": "four-point", "parameters": { "w": "1/16" } }), 7_usize),
        (json!({ "word": "UCP", "parameters": { "kernel": 3, "compensation": "1/2", "delta": "1/3" } }), 7),
        (json!({ "preset": "ternary-c4" }), 6),
        (json!({ "word": "UCPUD", "parameters": { "delta": "1/3" } }), 16),
        (json!({ "preset": "d-ary-b-spline", "parameters": { "arity": 4, "degree": 3 } }), 4),
        (json!({ "preset": "d-ary-circle", "parameters": { "alpha": 0, "averages": 2, "delta": "1/2" } }), 7),
        (json!({ "word": "UCP", "parameters": { "kernel": "cos(1)", "delta": 1 } }), 7),
    ] {
        let points = u32::try_from(n).unwrap();
        let answer = asked(&json!({ "plan": plan, "nodes": 100, "matrices": { "points": points } }));
        let product = rows(&answer["matrices"]["product"]);
        assert_eq!(product.len(), n * usize::try_from(answer["arity"].as_u64().unwrap()).unwrap(), "{plan}");
        let steps = answer["matrices"]["steps"].as_array().unwrap();
        assert_eq!(
            steps.iter().any(|step| step["coarse"].is_object()),
            steps.iter().any(|step| step["role"] == "push-back")
        );
        for (r, sub) in answer["sub_masks"].as_array().unwrap().iter().enumerate() {
            let mut wanted = vec![0.0; n];
            let first = sub["first"].as_i64().unwrap();
            for (i, weight) in (first..).zip(numbers(&sub["values"])) {
                wanted[usize::try_from(i.rem_euclid(i64::from(points))).unwrap()] += weight;
            }
            let off = product[r].iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 4e-15, "{plan}: row {r} is {:?}, not {wanted:?}", product[r]);
        }
        let known = answer["mask"]["exact"].is_array();
        assert_eq!(answer["matrices"]["product"]["exact"].is_array(), known, "{plan}");
        assert_eq!(answer["matrices"]["local"]["powers"][0]["exact"].is_array(), known, "{plan}");
    }
}

#[test]
fn levels_that_follow_alpha_show_the_first_one_rounded_and_its_static_limit_locally() {
    let plan = json!({ "preset": "c-b-spline", "parameters": { "degree": 3, "alpha": "2*pi/5" } });
    let answer = asked(&json!({ "plan": plan, "matrices": true, "nodes": 100 }));
    let found = &answer["static_limit"]["matrices"];
    let first = &numbers(&answer["levels"][0]["mask"]["values"]);
    assert!(found["product"].get("exact").is_none());
    let vertex = &rows(&found["product"])[0];
    assert!((vertex[0] - first[2]).abs() < 1e-15 && (vertex[1] - first[0]).abs() < 1e-15, "{vertex:?} {first:?}");
    assert_eq!(exact(&found["local"]["powers"][0])[1], ["1/8", "3/4", "1/8"]);
}

#[test]
fn matrices_that_nobody_could_read_are_refused() {
    for (matrices, pointer) in [
        (json!({ "points": 17 }), "/matrices/points"),
        (json!({ "points": 0 }), "/matrices/points"),
        (json!({ "powers": 9 }), "/matrices/powers"),
    ] {
        let faults = refused(&json!({ "plan": { "preset": "chaikin" }, "matrices": matrices }));
        assert!(faults.iter().any(|fault| fault.pointer == pointer), "{faults:?}");
    }
    let faults = refused(&json!({ "plan": { "word": "U8U4" }, "matrices": { "points": 16 } }));
    assert!(faults[0].detail.contains("fewer points"), "{faults:?}");
}

/// For an open polygon, the matrices are those of its refinement: its ends are fixed, and rows sum to 1.
#[test]
fn open_polygons_have_matrices_with_their_ends() {
    let ask = |word: &str, ends: &str| {
        let plan = json!({ "word": word, "ends": ends });
        let matrices = json!({ "points": 4, "closed": false });
        asked(&json!({ "plan": plan, "matrices": matrices, "nodes": 100 }))["matrices"].clone()
    };
    let cubic = ask("UC", "clamped");
    assert_eq!(cubic["closed"], false);
    let product = rows(&cubic["product"]);
    assert_eq!((product.len(), product[0].len()), (7, 4));
    assert_eq!(product[0], [1.0, 0.0, 0.0, 0.0]);
    assert_eq!(product[1], [0.5, 0.5, 0.0, 0.0]);
    assert_eq!(product[2], [0.125, 0.75, 0.125, 0.0]);
    assert_eq!(product[6], [0.0, 0.0, 0.0, 1.0]);
    assert_eq!(rows(&ask("UC", "natural")["product"]).len(), 5, "two points without all of their neighbours are lost");
    assert!(product.iter().all(|row| (row.iter().sum::<f64>() - 1.0).abs() < 1e-15));
}
