//! Repeating rows are applied without being built, several tables to a block in turn: the bits are those of rows built
//! one by one.

use planish::math::rows::{MAX_RUN, RowSource, Rows, RowsBy, blend, blend_run};
use planish::watch::Watch;
use proptest::prelude::*;
use serde_json::{Value, json};

use super::{refined, word};

/// Returns rows on a ring of `n` points: `stride` old points give as many new points as there are weights.
fn rows(n: usize, stride: usize, weights: &[Vec<f64>]) -> RowsBy<impl Fn(usize, &mut Rows) + use<>> {
    let (weights, d) = (weights.to_vec(), weights.len());
    RowsBy::new(n / stride * d, n, move |row, out: &mut Rows| {
        for (k, &weight) in weights[row % d].iter().enumerate() {
            let index = (row / d * stride + row % d * stride / d + k + n - 1) % n;
            out.add(u32::try_from(index).expect("a small ring"), weight);
        }
    })
}

/// Returns `n` pseudorandom points of `width` coordinates.
fn points(n: usize, width: usize, seed: u32) -> Vec<f64> {
    let next = |x: &mut f64, _| Some(std::mem::replace(x, (*x + 0.37 * f64::from(seed)).fract()));
    (0..n * width).scan(0.0, next).collect()
}

fn same_bits(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(x, y)| x.to_bits() == y.to_bits())
}

fn weights() -> impl Strategy<Value = Vec<Vec<f64>>> {
    prop::collection::vec(prop::collection::vec(-2.0..2.0_f64, 1..9), 1..5)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn repeated_rows_give_the_same_bits(
        weights in weights(),
        stride in 1..4_usize,
        periods in 150..4000_usize,
        seed in 1..1000_u32,
        width in 1..=4_usize,
    ) {
        let (n, d) = (periods * stride, weights.len());
        let points = points(n, width, seed);
        let single = rows(n, stride, &weights);
        let repeated = rows(n, stride, &weights).repeating(d, 10 * d);
        prop_assert!(single.pattern().is_none());
        prop_assert!(repeated.pattern().is_some());
        let [a, b] = [&single as &dyn RowSource, &repeated].map(|rows| blend(rows, &points, width, &Watch::new()));
        prop_assert!(same_bits(&a.expect("not stopped"), &b.expect("not stopped")));
    }

    #[test]
    fn a_run_of_tables_gives_the_bits_of_one_after_another(
        tables in prop::collection::vec(weights(), 1..=MAX_RUN),
        n in 200..700_usize,
        seed in 1..1000_u32,
        width in 1..=4_usize,
    ) {
        let points = points(n, width, seed);
        let tables: Vec<_> = tables.iter().scan(n, |n, weights| {
            let table = rows(*n, 1, weights).repeating(weights.len(), 10 * weights.len());
            *n = table.n_rows();
            Some(table)
        }).collect();
        let run: Vec<&dyn RowSource> = tables.iter().map(|table| table as &dyn RowSource).collect();
        let watch = Watch::new();
        let together = blend_run(&run, &points, width, &watch).expect("not stopped");
        let counted = watch.done();
        let one_by_one = tables
            .iter()
            .fold(points, |points, table| blend(table, &points, width, &watch).expect("not stopped"));
        prop_assert!(same_bits(&together.points, &one_by_one));
        prop_assert!(together.finite);
        prop_assert_eq!(watch.done(), 2 * counted, "both count each row");
    }
}

/// With a corner, averages and push-backs have no pattern; far from it the points are the same.
#[test]
fn a_corner_far_away_changes_no_bit() {
    let ring: Vec<[f64; 2]> =
        (0..400_u32).map(|i| [f64::from(i * i % 97) / 7.0, f64::from(i * 31 % 89) / 3.0]).collect();
    let semi = json!({ "alpha": "pi/200", "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 0.5 });
    for (letters, parameters) in [("UC", &semi), ("UCP", &semi), ("UCCCCC", &semi), ("U3C", &semi), ("UPC", &semi)] {
        let mut plan = word(letters);
        plan["parameters"] = parameters.clone();
        let whole = refined(&ring, true, &plan, 2);
        let cornered = refined_with_corner(&ring, &plan);
        let far = whole.len() / 8;
        assert_eq!(whole.len(), cornered.len());
        let same = whole.iter().zip(&cornered).skip(far).take(whole.len() - 2 * far).all(|(a, b)| same_bits(a, b));
        assert!(same, "{letters}");
        assert!(!same_bits(&whole[0], &cornered[0]), "{letters}: the corner does nothing");
    }
}

/// Refines a ring by two levels whose first point is a corner, so that its rows are built one by one.
fn refined_with_corner(ring: &[[f64; 2]], plan: &Value) -> Vec<[f64; 2]> {
    let input = json!({ "polygon": { "points": ring, "closed": true, "corners": [0] } });
    let answer = crate::support::json(json!({ "input": input, "plan": plan, "levels": 2 }));
    serde_json::from_value(answer["points"].clone()).expect("points of the plane")
}

#[test]
fn overflow_in_the_middle_of_a_run_is_told() {
    let points = vec![f64::MAX; 400];
    let grow = rows(400, 1, &[vec![1.5, 1.5]]).repeating(1, 10);
    let shrink = rows(400, 1, &[vec![0.1]]).repeating(1, 10);
    let run: [&dyn RowSource; 2] = [&grow, &shrink];
    assert!(!blend_run(&run, &points, 1, &Watch::new()).expect("not stopped").finite);
}

#[test]
fn rows_that_do_not_repeat_are_made_one_by_one() {
    let odd = RowsBy::new(1000, 1000, |row, out: &mut Rows| {
        out.add(u32::try_from(row).expect("a small table"), if row > 900 { 2.0 } else { 1.0 });
    });
    assert!(odd.repeating(1, 5).pattern().is_none());
}
