//! Polygons: 1,000 points in the plane refined to 16 million, next to plain loops for the same masks.

use std::hint::black_box;

use planish::refine::refine_polygon;
use planish::shape::polygon::Polygon;
use planish::watch::Watch;

use crate::nets;
use crate::table::{Aim, Table, best, millions_a_second, ms};

const POINTS: u32 = 1_000;
const LEVELS: u32 = 14;

/// Weights of a new point, and how far before its old one they begin.
type Weights = (&'static [f64], usize);

/// Presets with the weights of their even and their odd points.
const MASKS: &[(&str, [Weights; 2])] = &[
    ("two-n-point", [(&[1.0], 0), (&[-0.0625, 0.5625, 0.5625, -0.0625], 1)]),
    ("cubic-b-spline", [(&[0.125, 0.75, 0.125], 1), (&[0.5, 0.5], 0)]),
    ("chaikin", [(&[0.75, 0.25], 0), (&[0.25, 0.75], 0)]),
];

pub(crate) fn measure(table: &mut Table) {
    let points: Vec<[f64; 2]> = (0..POINTS).map(|i| [f64::from(i * i % 97), f64::from(i * 31 % 89)]).collect();
    let lists: Vec<Vec<f64>> = points.iter().map(|p| p.to_vec()).collect();
    let polygon = Polygon::new(&lists, true, &[]).expect("a closed polygon");
    for (preset, masks) in MASKS {
        let (plan, steps) = nets::curve_plan(preset, &[], LEVELS);
        let watch = Watch::new();
        let mut ours = Vec::new();
        let all = best(|| ours = refine_polygon(&polygon, &plan, &steps, &watch).expect("nobody stops it").points);
        let mut theirs = Vec::new();
        let plain = best(|| theirs = black_box(by_hand(&points, masks)));
        let far = ours.iter().zip(theirs.as_flattened()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(far < 1e-9 && ours.len() == 2 * theirs.len(), "{preset}: the two results are {far} apart");
        let ratio = format!("{:.2} of a plain loop (aim 1.5)", all.as_secs_f64() / plain.as_secs_f64());
        let detail = format!("{} points in {:.0} ms; the loop takes {:.0} ms", theirs.len(), ms(all), ms(plain));
        let rate = (millions_a_second(theirs.len(), all), "M points/s");
        table.add(&format!("refine {preset}, level {LEVELS}"), rate, &ratio, Aim::None, &detail);
    }
}

/// The same by a loop that knows the mask, a new array for each level.
fn by_hand(points: &[[f64; 2]], masks: &[Weights; 2]) -> Vec<[f64; 2]> {
    let mut now = points.to_vec();
    for _ in 0..LEVELS {
        let n = now.len();
        let mut next = vec![[0.0; 2]; 2 * n];
        for i in 0..n {
            for (odd, (weights, before)) in masks.iter().enumerate() {
                let mut sum = [0.0; 2];
                for (k, weight) in weights.iter().enumerate() {
                    let mut at = i + k + n - before;
                    while at >= n {
                        at -= n;
                    }
                    sum[0] += weight * now[at][0];
                    sum[1] += weight * now[at][1];
                }
                next[2 * i + odd] = sum;
            }
        }
        now = next;
    }
    now
}
