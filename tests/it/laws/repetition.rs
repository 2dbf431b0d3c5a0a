//! Rows that repeat themselves are applied without being made: the bits are those of rows made one by one.

use planish::math::rows::{RowSource, Rows, RowsBy, blend};
use planish::watch::Watch;
use proptest::prelude::*;

/// Rows of a mask of `weights` on a ring of `n` points, `d` new points for each.
fn rows(n: usize, d: usize, weights: &[Vec<f64>]) -> RowsBy<impl Fn(usize, &mut Rows) + use<>> {
    let weights = weights.to_vec();
    RowsBy::new(n * d, n, move |row, out: &mut Rows| {
        for (k, &weight) in weights[row % d].iter().enumerate() {
            out.add(u32::try_from((row / d + k + n - 1) % n).expect("a small ring"), weight);
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn repeated_rows_give_the_same_bits(
        weights in prop::collection::vec(prop::collection::vec(-2.0..2.0_f64, 1..9), 1..5),
        n in 150..6000_usize,
        seed in 1..1000_u32,
        width in 1..=4_usize,
    ) {
        let d = weights.len();
        let points: Vec<f64> = (0..n * width).scan(0.0, |x: &mut f64, _| Some(std::mem::replace(x, (*x + 0.37 * f64::from(seed)).fract()))).collect();
        let single = rows(n, d, &weights);
        let repeated = rows(n, d, &weights).repeating(d, 10 * d);
        prop_assert!(single.pattern().is_none());
        prop_assert_eq!(repeated.pattern().is_some(), n - 20 >= 64);
        let [a, b] = [&single as &dyn RowSource, &repeated].map(|rows| blend(rows, &points, width, &Watch::new()));
        let (a, b) = (a.expect("not stopped"), b.expect("not stopped"));
        prop_assert!(a.iter().zip(&b).all(|(x, y)| x.to_bits() == y.to_bits()));
    }
}

#[test]
fn rows_that_do_not_repeat_are_made_one_by_one() {
    let odd = RowsBy::new(1000, 1000, |row, out: &mut Rows| {
        out.add(u32::try_from(row).expect("a small table"), if row > 900 { 2.0 } else { 1.0 });
    });
    assert!(odd.repeating(1, 5).pattern().is_none());
}
