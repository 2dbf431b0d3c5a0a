//! Normals from tangents, as in docs/stencils.md.

use serde_json::Value;

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Normalises a vector: divided by its largest coordinate, then by the remaining length; 0 for isolated vertices.
fn direction(v: Vector) -> Vector {
    let largest = v.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    if largest == 0.0 {
        return v;
    }
    let v = v.map(|x| x / largest);
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

/// Returns the normals of all vertices, from the head of a table and the tangents.
pub(super) fn all(head: &Value, vertices: usize, tangents: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let vectors: Vec<Vector> = tangents.iter().map(|t| [t[0], t[1], t[2]]).collect();
    let of = |pair: usize| {
        let (t, u) = (vectors[2 * pair], vectors[2 * pair + 1]);
        if head["product"] == "of directions" {
            return direction(cross(direction(t), direction(u)));
        }
        let product = cross(t, u);
        let length = dot(product, product).sqrt();
        product.map(|x| if length > 0.0 { x / length } else { 0.0 })
    };
    let sectors: Vec<usize> = serde_json::from_value(head["sectors"].clone()).expect("a list of vertices");
    let normal = |v: usize| {
        let beside: Vec<usize> = (0..sectors.len()).filter(|&i| sectors[i] == v).map(|i| vertices + i).collect();
        if beside.is_empty() {
            return of(v);
        }
        let all = std::iter::once(v).chain(beside).map(of);
        direction(all.fold([0.0; 3], |sum, n| [sum[0] + n[0], sum[1] + n[1], sum[2] + n[2]]))
    };
    (0..vertices).map(|v| normal(v).to_vec()).collect()
}
