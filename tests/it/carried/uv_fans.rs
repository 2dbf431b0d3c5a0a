//! Texture coordinates with one value in several fans of faces around a vertex: parts that share no edge.

use serde_json::{Value, json};

use super::uvs::Unfolded;
use super::{job, told};
use crate::support::nets::{self, Net, distance};

/// The value at the middle of the lower left and the upper right face.
const FIRST: [f64; 2] = [1.1, 1.2];
/// The value at the middle of the two other faces.
const SECOND: [f64; 2] = [0.9, 1.4];

/// Returns the values on a sheet of 2 x 2 quads after one level. Opposite faces have the same value in the middle, the
/// faces come in `order`, and `split` lists the second value twice, once for each of its faces.
fn sheet(order: [usize; 4], interpolation: &str, split: bool) -> Vec<[f64; 2]> {
    let square = nets::grid(2, 2);
    let mut values: Vec<[f64; 2]> = (0..3u8).flat_map(|y| (0..3u8).map(move |x| [x.into(), y.into()])).collect();
    values[4] = FIRST;
    values.extend([SECOND; 2]);
    let last = if split { 10 } else { 9 };
    let of_faces = [[0, 1, 4, 3], [1, 2, 5, 9], [3, last, 7, 6], [4, 5, 8, 7]];
    let faces = order.map(|f| square.faces[f].clone()).to_vec();
    let net = Net { faces, ..square };
    let uvs = json!({ "values": values, "faces": order.map(|f| of_faces[f]), "interpolation": interpolation });
    let plan = json!({ "preset": "catmull-clark", "boundary": "edge-only" });
    Unfolded::of(&told(job(&net, &json!({ "uvs": uvs }), &plan, 1))).values
}

fn has(values: &[[f64; 2]], value: [f64; 2]) -> bool {
    values.iter().any(|p| distance(p, &value) < 1e-15)
}

/// Returns all orders of four faces.
fn orders() -> Vec<[usize; 4]> {
    let all = (0..256).map(|n| [n / 64, n / 16 % 4, n / 4 % 4, n % 4]);
    all.filter(|order| (0..4).all(|f| order.contains(&f))).collect()
}

/// A value in two fans keeps its place, as do all such values around a vertex, in any order of the faces.
#[test]
fn values_in_two_fans_stay_in_any_order_of_the_faces() {
    assert_eq!(orders().len(), 24);
    for interpolation in ["none", "corners-only", "corners-plus1", "corners-plus2", "boundaries", "all"] {
        let mut first: Option<Vec<[f64; 2]>> = None;
        for order in orders() {
            let mut values = sheet(order, interpolation, false);
            assert!(has(&values, FIRST) && has(&values, SECOND), "{interpolation} {order:?}");
            values.sort_by(|p, q| p.partial_cmp(q).expect("finite"));
            let before = first.get_or_insert_with(|| values.clone());
            assert!(values.iter().zip(&*before).all(|(p, q)| distance(p, q) < 1e-15), "{interpolation} {order:?}");
        }
    }
}

/// If two values alternate around a vertex, OpenSubdiv 3.5 treats the second one as new when it occurs again, counted
/// from the first face of the vertex. Its numbers, on this sheet (1.05, 1.175) and (0.8, 1.425) for the faces in their
/// order and (1.2, 1.275) and (0.95, 1.025) if the second face comes first, agree with ours if that value is listed
/// twice.
#[test]
fn opensubdiv_parts_the_second_of_two_values_that_take_turns() {
    let parted = [[1.05, 1.175], [0.8, 1.425]];
    let values = sheet([0, 1, 2, 3], "none", true);
    assert!(has(&values, FIRST) && !has(&values, SECOND) && parted.iter().all(|&p| has(&values, p)), "{values:?}");
    let values = sheet([0, 1, 2, 3], "none", false);
    assert!(parted.iter().all(|&p| !has(&values, p)), "{values:?}");
}

/// The same value at another vertex is another place.
#[test]
fn values_of_several_vertices_are_refined_at_each_of_them() {
    let square = nets::grid(2, 2);
    let values: Vec<[f64; 2]> = (0..3u8).flat_map(|y| (0..3u8).map(move |x| [x.into(), y.into()])).collect();
    let refined = |faces: Value, values: &[[f64; 2]]| {
        let uvs = json!({ "values": values, "faces": faces, "interpolation": "corners-only" });
        let plan = json!({ "preset": "catmull-clark", "boundary": "edge-only" });
        told(job(&square, &json!({ "uvs": uvs }), &plan, 2))["uvs"].clone()
    };
    // the values of the vertices 0 and 8, and of 1 and 5, are shared, then listed twice
    let shared = refined(json!([[8, 5, 4, 3], [5, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]]), &values);
    let mut twice = values.clone();
    (twice[0], twice[1]) = (values[8], values[5]);
    assert_eq!(shared, refined(json!(square.faces), &twice));
}
