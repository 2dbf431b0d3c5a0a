//! Repeated averaging: tensor-product B-splines of every degree on regular nets.

use serde_json::json;

use super::{refined, refined_mesh};
use crate::support::nets::{self, distance};

#[test]
fn a_torus_is_the_tensor_product_of_b_splines() {
    let (n, m) = (5, 4);
    let net = nets::torus(n, m);
    for degree in 2..=9 {
        let plan = json!({ "preset": "repeated-averaging", "parameters": { "degree": degree } });
        let curve = json!({ "preset": "b-spline", "parameters": { "degree": degree } });
        let fine = refined_mesh(&net, &plan, 2);
        let row = |points: &[[f64; 3]]| refined(points, true, &curve, 2);
        let rows: Vec<Vec<[f64; 3]>> = net.positions.chunks(n).map(row).collect();
        let expected: Vec<[f64; 3]> =
            (0..4 * n).flat_map(|i| row(&rows.iter().map(|row| row[i]).collect::<Vec<_>>())).collect();
        assert_eq!(fine.positions.len(), expected.len());
        for p in &expected {
            assert!(fine.positions.iter().any(|q| distance(p, q) <= 1e-12), "degree {degree}: {p:?} is missing");
        }
    }
}
