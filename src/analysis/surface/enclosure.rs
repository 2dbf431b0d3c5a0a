//! Eigenvalues with proved error bounds, which include the roundings of the weights and of all computations with them.
//!
//! For approximate eigenvectors `l` (left) and `r` (right) of a value v, with `l r = 1`, let `B = A - v r l`. If all
//! eigenvalues of B are below theta, the eigenvalues of A beyond theta are the zeros of `1 - v l (z - B)^-1 r`, and
//! `(z - B)^-1 r = r / z + (z - B)^-1 B r / z`. With `|(z - B)^-1| <= g` and `|B r| <= e` there is exactly one such
//! eigenvalue, simple and real, within `v |l| g e` of v (Rouche), and its eigenvector differs from r by at most `g e`.

use crate::math::dense::{Dense, dot};

/// Bound of the relative error of weights against the exact weights of the scheme. A weight is made in some ten
/// operations with errors of 1e-16 each, and multiplied through some ten actions. Half of it leaves no room for longer
/// words; twice of it changes bounds by as much.
const WEIGHT_ERROR: f64 = 2e-14;
/// What is added to the radius of an eigenvalue below 1 for the rounding of the value itself: 45 units in the last
/// place of 1. Half of it still covers sums of some dozen terms; twice of it widens the radius by as much.
const VALUE_ROUNDING: f64 = 1e-14;

/// A simple real eigenvalue that is larger than all others, with error bounds of the eigenvalue and its eigenvector.
#[derive(Debug, Clone)]
pub(super) struct Enclosure {
    /// The approximate eigenvalue.
    pub(super) value: f64,
    /// Bound of the error of `value`.
    pub(super) radius: f64,
    /// Bound of the error of a component of the eigenvector that [`Dense::eigenvector`] returns with size 1.
    pub(super) error: f64,
}

/// Returns a bound of the error of a matrix, in the norm of row sums.
fn unknown(matrix: &Dense) -> f64 {
    // a row of a block is a sum of at most four rows of weights
    4.0 * WEIGHT_ERROR * (1.0 + matrix.norm())
}

/// Returns whether the absolute values of all eigenvalues are proved to be below a radius.
pub(super) fn is_below(matrix: &Dense, radius: f64) -> bool {
    matrix.n == 0 || matrix.resolvent_beyond(radius, unknown(matrix)).is_some()
}

/// Returns `A - 1 l`, which lacks the eigenvalue 1 of the constant vector, for a row l with the sum 1.
pub(super) fn without_one(matrix: &Dense, ones: &[f64], left: &[f64]) -> Dense {
    let mut rest = matrix.clone();
    for (i, one) in ones.iter().enumerate() {
        left.iter().enumerate().for_each(|(j, l)| *rest.at_mut(i, j) -= one * l);
    }
    rest
}

impl Enclosure {
    /// Encloses the eigenvalue near a value if it is proved to be the only one not below `theta`.
    pub(super) fn of(matrix: &Dense, near: f64, theta: f64) -> Option<Self> {
        let right = matrix.eigenvector(near);
        let left = matrix.transposed().eigenvector(near);
        let product = dot(&left, &right);
        let left: Vec<f64> = left.iter().map(|l| l / product).collect();
        let image = matrix.times_column(&right);
        let value = dot(&left, &image);
        let mut rest = matrix.clone();
        for (i, r) in right.iter().enumerate() {
            left.iter().enumerate().for_each(|(j, l)| *rest.at_mut(i, j) -= value * r * l);
        }
        let size: f64 = left.iter().map(|l| l.abs()).sum();
        let unknown = unknown(matrix) + 8.0 * f64::EPSILON * value.abs() * size;
        let bound = rest.resolvent_beyond(theta, unknown)?;
        let left_over = rest.times_column(&right).iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let error = bound * (left_over + 2.0 * unknown);
        let radius = value.abs() * size * error + VALUE_ROUNDING;
        // also false if a value is not a number
        (value.abs() - radius > theta).then_some(Self { value, radius, error })
    }
}
