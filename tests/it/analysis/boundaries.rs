//! Analyses of boundary vertices, and of creases.

use planish::math::functions::{cos, real};
use serde_json::{Value, json};

use super::{asked, refused};

fn rows(plan: &Value, boundaries: &[usize]) -> Vec<Value> {
    let answer = asked(&json!({ "plan": plan, "valences": [], "boundaries": boundaries, "nodes": 100 }));
    assert_eq!(answer["kind"], "surface");
    answer["boundaries"].as_array().unwrap().clone()
}

/// Returns the largest eigenvalues of even, or of odd, eigenvectors.
fn eigenvalues(row: &Value, odd: bool) -> Vec<f64> {
    let all = row["eigenvalues"].as_array().unwrap().iter();
    all.filter(|found| found["odd"] == odd).map(|found| found["value"].as_f64().unwrap()).collect()
}

fn weights(mask: &Value, at: &str) -> Vec<f64> {
    mask[at].as_array().map_or(Vec::new(), |all| all.iter().map(|x| x.as_f64().unwrap()).collect())
}

/// The matching of a child's edges with its parent's does not depend on the weights of the averages.
#[test]
fn sides_of_creases_have_the_rules_of_boundaries_at_every_kernel() {
    for kernel in ["1/100", "1/3", "1", "100"] {
        for word in ["UC", "UCP"] {
            let parameters = json!({ "kernel": kernel, "delta": "1/2" });
            for row in rows(&json!({ "word": word, "parameters": parameters }), &[2, 3, 5]) {
                assert_eq!(row["crease"], true, "{word} at {kernel}: {row}");
            }
        }
    }
}

/// The surroundings of m boundary faces are half of those of 2m faces: eigenvalues across the boundary are those of
/// valence 2m.
#[test]
fn eigenvalues_of_loop_at_the_boundary_are_those_of_the_closed_formula() {
    let faces: Vec<usize> = (2..=12).collect();
    for (m, row) in faces.iter().zip(rows(&json!({ "preset": "loop" }), &faces)) {
        assert_eq!(row["faces"], json!(m));
        assert_eq!(row["crease"], true, "one side of a crease has the rules of a boundary");
        let across = 0.375 + cos(std::f64::consts::PI / real(*m)) / 4.0;
        assert!((eigenvalues(&row, false)[1] - across).abs() < 1e-12, "{m}: {}", row["eigenvalues"]);
        assert!(eigenvalues(&row, true).iter().any(|x| (x - 0.5).abs() < 1e-12), "{m}: {}", row["eigenvalues"]);
        // from six faces on, eigenvalues of frequency 2 are as large as that of the tangent along the boundary
        let expected = if *m < 6 { "supported" } else { "open" };
        assert_eq!(row["evidence"], expected, "{m}: {}", row["criteria"]);
        assert_eq!(row["c1"], "open", "nothing is proved of boundaries");
    }
}

#[test]
fn limits_on_boundaries_are_those_of_the_cubic_b_spline_for_any_number_of_faces() {
    for preset in ["catmull-clark", "loop", "sqrt-3"] {
        for row in rows(&json!({ "preset": preset }), &[2, 3, 4]) {
            let mask = &row["limit_mask"];
            assert!((weights(mask, "center")[0] - 2.0 / 3.0).abs() < 1e-12, "{preset}: {mask}");
            let ray = weights(mask, "1,0");
            let ends = [ray[0], ray[ray.len() - 1]];
            assert!(ends.iter().all(|w| (w - 1.0 / 6.0).abs() < 1e-12), "{preset}: {mask}");
            assert!(ray[1..ray.len() - 1].iter().all(|w| w.abs() < 1e-12), "{preset}: {mask}");
        }
    }
}

/// Halstead, Kass and DeRose; Biermann, Levin and Zorin: along the boundary, the tangent is the difference of both
/// neighbours; on a regular boundary, the tangent across it is that of the tensor product of splines.
#[test]
fn tangents_on_the_regular_boundary_of_catmull_clark_are_those_of_bicubic_splines() {
    let row = &rows(&json!({ "preset": "catmull-clark" }), &[2])[0];
    let [along, across] = [0, 1].map(|k| row["tangent_masks"][k].clone());
    let ray = weights(&along, "1,0");
    assert!((ray[0] - 0.5).abs() < 1e-12 && ray[1].abs() < 1e-12 && (ray[2] + 0.5).abs() < 1e-12, "{along}");
    assert!(weights(&along, "center").is_empty() && weights(&along, "1,1").iter().all(|w| w.abs() < 1e-12));
    // the rows (1, 4, 1)/6 of the first line of points, minus those of the boundary itself
    let at = |name: &str| weights(&across, name);
    let first = [at("1,1")[0], at("1,0")[1], at("1,1")[1]];
    let line = [at("1,0")[0], at("center")[0], at("1,0")[2]];
    for ((inner, outer), wanted) in first.iter().zip(&line).zip([1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0]) {
        assert!((inner - wanted).abs() < 1e-12 && (outer + wanted).abs() < 1e-12, "{across}");
    }
}

#[test]
fn tangents_on_boundaries_are_dual_to_the_characteristic_net() {
    for (preset, m) in [("catmull-clark", 3), ("loop", 4), ("butterfly", 3), ("kobbelt", 2)] {
        let row = &rows(&json!({ "preset": preset }), &[m])[0];
        let net = row["characteristic_net"]["points"].as_array().unwrap();
        let known = |i: usize, k: usize| net[i][k].as_f64().unwrap();
        assert!(known(0, 0).abs() < 1e-12 && known(0, 1).abs() < 1e-12, "{preset}: the vertex lies at 0");
        for mask in row["tangent_masks"].as_array().unwrap() {
            let sum: f64 = mask
                .as_object()
                .unwrap()
                .values()
                .flat_map(|w| w.as_array().unwrap())
                .map(|w| w.as_f64().unwrap())
                .sum();
            assert!(sum.abs() < 1e-12, "{preset}: {sum}");
        }
        assert!(row["characteristic_map_min_sine"].as_f64().unwrap() > 0.1, "{preset}");
    }
}

/// The corner of a mesh keeps its position and has a tangent plane; as a smooth boundary it has none.
#[test]
fn the_boundary_rule_of_the_plan_decides_about_vertices_with_one_face() {
    let one = |boundary: &str| rows(&json!({ "preset": "catmull-clark", "boundary": boundary }), &[1])[0].clone();
    let (corner, smooth) = (one("edge-and-corner"), one("edge-only"));
    assert_eq!((&corner["evidence"], &smooth["evidence"]), (&json!("supported"), &json!("open")));
    assert_eq!(weights(&corner["limit_mask"], "center"), [1.0]);
    assert!((weights(&smooth["limit_mask"], "center")[0] - 2.0 / 3.0).abs() < 1e-12);
    assert_eq!(corner["crease"], false, "on a crease nothing stays");
}

#[test]
fn words_have_boundaries_and_creases_and_dual_schemes_say_why_they_have_none() {
    for (word, parameters) in [("UC", json!({})), ("UCC", json!({})), ("UCP", json!({ "delta": 1 }))] {
        for row in rows(&json!({ "word": word, "parameters": parameters }), &[2, 3]) {
            assert_eq!((&row["evidence"], &row["crease"]), (&json!("supported"), &json!(true)), "{word}: {row}");
        }
    }
    let doo_sabin = &rows(&json!({ "preset": "doo-sabin" }), &[2])[0];
    assert!(doo_sabin["refused"].as_str().unwrap().contains("faces take the place of vertices"), "{doo_sabin}");
    let butterfly = &rows(&json!({ "preset": "butterfly" }), &[3])[0];
    assert_eq!(butterfly["crease"], false, "it has no rules for creases");
    let question = json!({ "plan": { "preset": "loop" }, "boundaries": [2, 0, 25] });
    let places: Vec<String> = refused(&question).into_iter().map(|fault| fault.pointer).collect();
    assert_eq!(places, ["/boundaries/1", "/boundaries/2"]);
}

#[test]
fn an_open_mesh_is_told_its_boundary_vertices() {
    let positions: Vec<[usize; 3]> = (0..9).map(|v| [v % 3, v / 3, 0]).collect();
    let mesh = json!({
        "positions": positions,
        "faces": [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]]
    });
    let answer = asked(&json!({ "plan": { "preset": "catmull-clark" }, "input": { "mesh": mesh }, "nodes": 100 }));
    let found = answer["input"]["boundary"].as_array().unwrap();
    assert_eq!(found.len(), 2);
    assert_eq!((&found[0]["faces"], &found[0]["vertices"]), (&json!(1), &json!([0, 2, 6, 8])));
    assert_eq!((&found[1]["faces"], &found[1]["vertices"]), (&json!(2), &json!([1, 3, 5, 7])));
    assert!(found.iter().all(|row| row["evidence"] == "supported"));
    assert_eq!(answer["boundaries"].as_array().unwrap().len(), 2, "those that the mesh has");
}
