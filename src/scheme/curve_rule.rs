//! What curve operators do to a polygon between its ends, as data and formulas that hold for numbers of any kind: the
//! operators make their rows of them in f64, the analysis of a scheme makes its mask of them without rounding.

use crate::math::number::Number;

/// What an operator does to polygons.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurveRule {
    /// Points between two old ones, by [`between`].
    Interpolate,
    /// The mean of two neighbours, by [`pair`].
    Pair,
    /// The mean of the means of two pairs, by [`triple`].
    Triple,
    /// The mean of as many neighbours as the arity says, by [`Number::ratio`].
    Mean,
    /// The push-back: displacements of vertices, of which points between them have the shares of [`between`], times the
    /// compensation where there is one.
    PushBack {
        /// Whether the compensation of the plan applies.
        compensated: bool,
    },
    /// A mask.
    Mask,
    /// The mask of [`spread`], with the weights `1, 2, ..., d, ..., 2, 1` at alpha 0.
    Circle,
}

/// The shares of two neighbours in the point `j` of `d` steps from the first to the second: `(d - j) / d` and `j / d`.
pub fn between<T: Number>(j: i64, d: i64) -> [T; 2] {
    [T::ratio(d - j, d), T::ratio(j, d)]
}

/// The mean of two points of these weights.
pub fn pair<T: Number>(a: &T, b: &T) -> [T; 2] {
    [a, b].map(|x| x.clone() / (a.clone() + b.clone()))
}

/// The mean of the means of a point with the one before and with the one after, with these weights.
pub fn triple<T: Number>([a, b, c]: &[T; 3]) -> [T; 3] {
    let before = T::whole(2) * (a.clone() + b.clone());
    let after = T::whole(2) * (b.clone() + c.clone());
    [a.clone() / before.clone(), b.clone() / before + b.clone() / after.clone(), c.clone() / after]
}

/// The mask `d sigma^m E / (sigma(1)^m E(1))` with `sigma = 1 + z + ... + z^(d-1)` and m averages, E having the
/// coefficients `term(1), ..., term(d), ..., term(1)`.
pub fn spread<T: Number>(arity: u32, averages: u32, term: impl Fn(u32) -> T) -> Vec<T> {
    let d = arity as usize;
    let mut values: Vec<T> = (1..=arity).chain((1..arity).rev()).map(term).collect();
    for _ in 0..averages {
        let n = values.len() + d - 1;
        let sum = |j: usize| sum(&values[(j + 1).saturating_sub(d)..values.len().min(j + 1)]);
        values = (0..n).map(sum).collect();
    }
    let all = sum(&values);
    values.iter().map(|a| T::whole(arity.into()) * a.clone() / all.clone()).collect()
}

fn sum<T: Number>(values: &[T]) -> T {
    values.iter().cloned().reduce(|sum, x| sum + x).unwrap_or_else(|| T::whole(0))
}
