//! An independent implementation of docs/stencils.md: reading tables from answers, and applying them.

use serde_json::{Value, json};

use super::asking;
use crate::support::render;

/// A table of an answer.
#[derive(Debug, PartialEq)]
pub(super) struct Table {
    pub(super) columns: usize,
    pub(super) vertices: usize,
    pub(super) rational: bool,
    pub(super) normals: Option<Value>,
    pub(super) starts: Vec<u64>,
    pub(super) indices: Vec<u64>,
    pub(super) weights: Vec<f64>,
    pub(super) terms: Vec<i64>,
}

fn list<T>(value: &Value, each: impl Fn(&Value) -> Option<T>) -> Vec<T> {
    let all = value.as_array().map(Vec::as_slice).unwrap_or_default();
    all.iter().map(|x| each(x).expect("a number of the right kind")).collect()
}

fn count(head: &Value, name: &str) -> usize {
    usize::try_from(head[name].as_u64().expect("a count")).expect("a small one")
}

impl Table {
    fn of(head: &Value, [starts, indices]: [Vec<u64>; 2], weights: Vec<f64>, terms: Vec<i64>) -> Self {
        let table = Self {
            columns: count(head, "columns"),
            vertices: count(head, "vertices"),
            rational: head["rational"] == true,
            normals: head.get("normals").cloned(),
            starts,
            indices,
            weights,
            terms,
        };
        assert_eq!(table.starts.len(), count(head, "rows") + 1);
        assert!(head["order"].as_str().is_some_and(|order| order.contains("symmetric")));
        table
    }

    /// Reads the JSON form.
    pub(super) fn of_text(text: &[u8]) -> Self {
        let all: Value = serde_json::from_slice(text).expect("stencils are JSON");
        let whole = |name: &str| list(&all[name], Value::as_u64);
        let terms = all.get("terms").map(|terms| list(terms, Value::as_i64)).unwrap_or_default();
        Self::of(&all, [whole("starts"), whole("indices")], list(&all["weights"], Value::as_f64), terms)
    }

    /// Reads the binary form.
    pub(super) fn of_arrays(bytes: &[u8]) -> Self {
        let end = bytes.iter().position(|&byte| byte == b'\n').expect("a line of JSON");
        let head: Value = serde_json::from_slice(&bytes[..end]).expect("the first line is JSON");
        let mut rest = &bytes[end + 1..];
        assert_eq!((end + 1) % 8, 0, "the arrays are aligned");
        let mut take = |name: &str, kind: &str, size: usize| {
            let found = head["arrays"].as_array().and_then(|all| all.iter().find(|array| array[0] == name));
            let array = found.expect("it is among the arrays");
            assert_eq!(array[1], kind);
            let length = usize::try_from(array[2].as_u64().expect("a length")).expect("a small one");
            let (own, others) = rest.split_at(length * size);
            rest = others;
            own.chunks_exact(size).map(<[u8]>::to_vec).collect::<Vec<_>>()
        };
        let weights =
            take("weights", "f64", 8).iter().map(|x| f64::from_le_bytes(x[..].try_into().expect("8"))).collect();
        let [starts, indices] = ["starts", "indices"].map(|name| {
            let all = take(name, "u32", 4);
            all.iter().map(|x| u32::from_le_bytes(x[..].try_into().expect("4")).into()).collect()
        });
        let terms = take("terms", "i32", 4);
        let terms = terms.iter().map(|x| i32::from_le_bytes(x[..].try_into().expect("4")).into()).collect();
        assert!(rest.is_empty(), "nothing follows");
        Self::of(&head, [starts, indices], weights, terms)
    }

    /// Returns all values of one coordinate from those of the input.
    fn coordinate(&self, points: Vec<f64>) -> Vec<f64> {
        assert_eq!(points.len(), self.columns);
        let mut values = points;
        let mut terms = self.terms.iter();
        for pair in self.starts.windows(2) {
            let [mut at, end] = [pair[0], pair[1]].map(|x| usize::try_from(x).expect("small"));
            let mut sum = 0.0;
            while at < end {
                let k = if self.terms.is_empty() { 1 } else { *terms.next().expect("a term") };
                let n = usize::try_from(k.abs()).expect("small");
                let value = |j: usize| values[usize::try_from(self.indices[at + j]).expect("small")];
                let weighed = |j: usize| self.weights[at + j] * value(j);
                sum += match k {
                    1 => weighed(0),
                    2.. => self.weights[at] * symmetric(n, value),
                    _ => symmetric(n, weighed),
                };
                at += n;
            }
            values.push(sum);
        }
        values
    }

    /// Returns the results for points of the input of any number of coordinates.
    pub(super) fn apply(&self, points: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let width = points.first().map_or(3, Vec::len);
        let n = self.starts.len() - 1 + self.columns;
        let pairs = self.normals.as_ref().map_or(0, |normals| count(normals, "pairs"));
        let first = n - self.vertices - 2 * pairs;
        let all: Vec<Vec<f64>> =
            (0..width).map(|c| self.coordinate(points.iter().map(|point| point[c]).collect())).collect();
        (first..n).map(|i| all.iter().map(|values| values[i]).collect()).collect()
    }

    /// Returns for each result the sum of its weights over the points of the input.
    pub(super) fn sums(&self) -> Vec<f64> {
        self.apply(&vec![vec![1.0]; self.columns]).into_iter().flatten().collect()
    }
}

fn symmetric(n: usize, value: impl Fn(usize) -> f64) -> f64 {
    match n {
        2 => value(0) + value(1),
        4 => (value(0) + value(2)) + (value(1) + value(3)),
        6 => {
            let mut pairs = [value(0) + value(3), value(1) + value(4), value(2) + value(5)];
            pairs.sort_by(f64::total_cmp);
            (pairs[0] + pairs[1]) + pairs[2]
        }
        n => (1..n).fold(value(0), |sum, k| sum + value(k)),
    }
}

fn points_of(value: &Value) -> Vec<Vec<f64>> {
    list(value, |point| Some(list(point, Value::as_f64)))
}

/// Returns the points of the input of a job as the server numbers them.
pub(super) fn control(job: &Value, columns: usize) -> Vec<Vec<f64>> {
    let input = &job["input"];
    let polygons = input["polygons"].as_array().cloned().unwrap_or_default();
    let curves = input.get("polygon").into_iter().chain(&polygons);
    let mut points: Vec<Vec<f64>> = curves.flat_map(|curve| points_of(&curve["points"])).collect();
    if points.is_empty() {
        points = points_of(&input["mesh"]["positions"]);
    }
    if points.len() != columns {
        // vertices were welded or split
        let mut job = asking(job, &json!({"format": "json"}));
        job["levels"] = 0.into();
        let (bytes, _) = render(&job).expect("the input itself can be written");
        let all: Value = serde_json::from_slice(&bytes).expect("json is JSON");
        points = points_of(&all["positions"]);
    }
    assert_eq!(points.len(), columns);
    points
}

/// Number of vertices of which at most one may have tangents without a product, as at the pole of the vase.
const FEW: usize = 10;

/// Checks that the results have the bits of a JSON output, and the normals, if there are any.
pub(super) fn same_bits(name: &str, table: &Table, points: &[Vec<f64>], expected: &Value) {
    let mut results = table.apply(points);
    let tangents = results.split_off(table.vertices);
    if table.rational {
        for point in &mut results {
            let last = point.pop().expect("a weight");
            point.iter_mut().for_each(|x| *x /= last);
        }
    }
    let polygons = expected["polygons"].as_array().cloned().unwrap_or_else(|| vec![expected.clone()]);
    let wanted: Vec<Vec<f64>> = match expected.get("positions") {
        Some(positions) => points_of(positions),
        None => polygons.iter().flat_map(|polygon| points_of(&polygon["points"])).collect(),
    };
    compare(name, "point", &results, &wanted);
    if let Some(normals) = &table.normals {
        let found = super::normals::all(normals, table.vertices, &tangents);
        let mut wanted = points_of(&expected["normals"]);
        // if tangents have no product, the service uses the area-weighted normals of faces
        let none = (0..found.len()).filter(|&v| found[v].iter().all(|x| *x == 0.0)).collect::<Vec<_>>();
        assert!(FEW * none.len() <= found.len(), "{name}: {none:?} have no normals");
        none.into_iter().for_each(|v| wanted[v] = vec![0.0; 3]);
        compare(name, "normal", &found, &wanted);
    }
}

fn compare(name: &str, what: &str, found: &[Vec<f64>], wanted: &[Vec<f64>]) {
    assert_eq!(found.len(), wanted.len(), "{name}: {what}s");
    for (i, (a, b)) in found.iter().zip(wanted).enumerate() {
        let same = a.iter().zip(b).all(|(x, y)| x.to_bits() == y.to_bits()) && a.len() == b.len();
        assert!(same, "{name}: {what} {i} is {a:?} instead of {b:?}");
    }
}
