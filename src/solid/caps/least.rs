//! Least squares for equations with rotational symmetry around a vertex, one frequency at a time.

use super::characteristic::{turn_cos, turn_sin};
use crate::math::functions::{real, sqrt};
use crate::math::vector::{Complex, complex_product};

/// Columns whose part orthogonal to the columns before them is less than this fraction of the greatest length are
/// dropped. Dependent columns keep about 1e-15, the least independent one of all valences 9e-3. Twice or half of it
/// changes nothing.
const DEPENDENT_SHARE: f64 = 1e-9;

/// Returns the least-squares solution x of `sum over t and a of A[s - t][k][a] x[t][a][q] = b[s][k][q]`, for all s of n
/// sectors and k of `b.len() / n` samples: A and b are `n x samples`, x is by sectors.
pub(super) fn least_squares<const A: usize, const Q: usize>(
    n: usize,
    a: &[[f64; A]],
    b: &[[f64; Q]],
) -> Vec<[[f64; Q]; A]> {
    let mut x = vec![[[0.0; Q]; A]; n];
    for m in 0..=n / 2 {
        let best: [[Complex; Q]; A] = best(&waves(n, m, a), &waves(n, m, b));
        // frequencies other than 0 and n / 2 occur in conjugate pairs
        let share = if m == 0 || 2 * m == n { 1.0 } else { 2.0 } / real(n);
        for (s, x) in x.iter_mut().enumerate() {
            let wave = [turn_cos(m * s, n), turn_sin(m * s, n)];
            for (x, best) in x.iter_mut().flatten().zip(best.iter().flatten()) {
                *x += share * complex_product(wave, *best)[0];
            }
        }
    }
    x
}

/// Returns columns with the amplitudes of frequency m of values that are given for all sectors.
fn waves<const D: usize>(n: usize, m: usize, values: &[[f64; D]]) -> Vec<Vec<Complex>> {
    let n_samples = values.len() / n;
    let waves: Vec<Complex> = (0..n).map(|s| [turn_cos(m * s, n), -turn_sin(m * s, n)]).collect();
    let amplitude = |k: usize, d: usize| {
        waves.iter().enumerate().fold([0.0; 2], |sum, (s, wave)| {
            let value = values[s * n_samples + k][d];
            [sum[0] + wave[0] * value, sum[1] + wave[1] * value]
        })
    };
    (0..D).map(|d| (0..n_samples).map(|k| amplitude(k, d)).collect()).collect()
}

/// Returns the inner product, the sum of `conjugate(a_k) b_k`.
fn product(a: &[Complex], b: &[Complex]) -> Complex {
    a.iter().zip(b).fold([0.0; 2], |sum, (a, b)| {
        [sum[0] + a[0] * b[0] + a[1] * b[1], sum[1] + a[0] * b[1] - a[1] * b[0]] //
    })
}

fn without(column: &mut [Complex], factor: Complex, other: &[Complex]) {
    for (x, y) in column.iter_mut().zip(other) {
        let part = complex_product(factor, *y);
        *x = [x[0] - part[0], x[1] - part[1]];
    }
}

/// Returns the least-squares solution x of `sum of columns a times x = column q of b`, by Gram-Schmidt with
/// reorthogonalization.
fn best<const A: usize, const Q: usize>(a: &[Vec<Complex>], b: &[Vec<Complex>]) -> [[Complex; Q]; A] {
    let mut units: Vec<Vec<Complex>> = Vec::with_capacity(A);
    let mut upper = [[[0.0; 2]; A]; A];
    let mut lengths = [0.0; A];
    let longest = a.iter().map(|column| sqrt(product(column, column)[0])).fold(0.0, f64::max);
    for (i, column) in a.iter().enumerate() {
        let mut column = column.clone();
        for _ in 0..2 {
            for (h, unit) in units.iter().enumerate() {
                let part = product(unit, &column);
                upper[h][i] = [upper[h][i][0] + part[0], upper[h][i][1] + part[1]];
                without(&mut column, part, unit);
            }
        }
        let length = sqrt(product(&column, &column)[0]);
        lengths[i] = if length > DEPENDENT_SHARE * longest { length } else { 0.0 };
        let scale = if lengths[i] > 0.0 { 1.0 / length } else { 0.0 };
        units.push(column.iter().map(|x| x.map(|x| scale * x)).collect());
    }
    let mut x = [[[0.0; 2]; Q]; A];
    for (q, column) in b.iter().enumerate() {
        let mut parts: Vec<Complex> = units.iter().map(|unit| product(unit, column)).collect();
        for i in (0..A).rev().filter(|i| lengths[*i] > 0.0) {
            x[i][q] = parts[i].map(|part| part / lengths[i]);
            for (part, row) in parts.iter_mut().zip(&upper).take(i) {
                let known = complex_product(row[i], x[i][q]);
                *part = [part[0] - known[0], part[1] - known[1]];
            }
        }
    }
    x
}
