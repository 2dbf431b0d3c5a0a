//! Vectors of a fixed number of coordinates. Sums run from the first coordinate to the last, so the bits are always the
//! same.

use multiversion::multiversion;

use super::functions::sqrt;

/// A point or a vector of space.
pub type Vector = [f64; 3];
/// A complex number: its real and its imaginary part.
pub type Complex = [f64; 2];

/// Returns the product of two complex numbers.
#[must_use]
pub fn complex_product([a, b]: Complex, [c, d]: Complex) -> Complex {
    [a * c - b * d, a * d + b * c]
}

/// Returns whether all coordinates are zero.
#[must_use]
#[inline]
pub fn is_zero<const N: usize>(a: &[f64; N]) -> bool {
    a.iter().all(|&x| x == 0.0)
}

/// Returns the sum of two vectors.
#[must_use]
pub fn plus<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| a[k] + b[k])
}

/// Returns the difference of two vectors.
#[must_use]
pub fn minus<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// Returns a vector multiplied by a number.
#[must_use]
pub fn times<const N: usize>(k: f64, a: [f64; N]) -> [f64; N] {
    a.map(|x| k * x)
}

/// Returns the dot product of two vectors.
#[must_use]
pub fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    (1..N).fold(a[0] * b[0], |sum, k| sum + a[k] * b[k])
}

/// Returns the cross product of two vectors.
#[must_use]
#[inline]
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns the length of a vector whose square neither overflows nor underflows.
#[must_use]
pub fn length<const N: usize>(a: [f64; N]) -> f64 {
    sqrt(dot(a, a))
}

/// Returns the mean of some vectors; zero if there are none.
pub fn mean(all: impl Iterator<Item = Vector>) -> Vector {
    let (sum, n) = all.fold(([0.0; 3], 0.0), |(sum, n), x| (plus(sum, x), n + 1.0));
    times(1.0 / f64::max(n, 1.0), sum)
}

/// Returns the squared distance of a point from a segment.
#[must_use]
pub fn square_from_segment(p: Vector, [a, b]: [Vector; 2]) -> f64 {
    let along = minus(b, a);
    let square = dot(along, along);
    let at = if square > 0.0 { (dot(minus(p, a), along) / square).clamp(0.0, 1.0) } else { 0.0 };
    let apart = minus(p, plus(a, times(at, along)));
    dot(apart, apart)
}

/// Triangles whose height is less than this fraction of their longest side are replaced by their sides. At this value
/// the normal of a triangle still has about 12 digits. Half of it leaves slightly fewer digits; twice of it replaces
/// more triangles by their sides, which are never nearer, so that bounds still hold.
const THIN_SHARE: f64 = 1e-4;

/// Returns the squared distance of a point from a triangle; thin triangles are replaced by their sides.
#[must_use]
pub fn square_from_triangle(p: Vector, [a, b, c]: [Vector; 3]) -> f64 {
    let (ab, bc, ca) = (minus(b, a), minus(c, b), minus(a, c));
    let n = cross(ab, bc);
    let (square, longest) = (dot(n, n), dot(ab, ab).max(dot(bc, bc)).max(dot(ca, ca)));
    if square > THIN_SHARE * THIN_SHARE * longest * longest {
        let left = |side: Vector, from: Vector| dot(n, cross(side, minus(p, from))) >= 0.0;
        if left(ab, a) && left(bc, b) && left(ca, c) {
            let height = dot(n, minus(p, a));
            return height * height / square;
        }
    }
    [[a, b], [b, c], [c, a]].map(|side| square_from_segment(p, side)).into_iter().fold(f64::INFINITY, f64::min)
}

/// Returns the distance of a point from a segment.
#[must_use]
pub fn from_segment(p: Vector, segment: [Vector; 2]) -> f64 {
    sqrt(square_from_segment(p, segment))
}

/// Divides a vector by its largest absolute coordinate and returns the remaining length, whose square neither overflows
/// nor underflows; `None`, without a change, if all coordinates are 0 or one is infinite.
pub fn reduce(v: &mut [f64]) -> Option<f64> {
    let largest = v.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return None;
    }
    v.iter_mut().for_each(|x| *x /= largest);
    Some(sqrt(v.iter().map(|x| x * x).sum()))
}

/// Returns a vector scaled to length 1; `None` if it has no direction.
#[must_use]
pub fn direction<const N: usize>(mut v: [f64; N]) -> Option<[f64; N]> {
    let length = reduce(&mut v)?;
    Some(v.map(|x| x / length))
}

/// Squared lengths for which no larger term has overflowed or lost digits to underflow.
const SAFE_SQUARES: std::ops::RangeInclusive<f64> = 1e-200..=1e200;

/// Returns a vector scaled to length 1; zero if it has no direction.
#[must_use]
#[inline]
pub fn unit<const N: usize>(v: [f64; N]) -> [f64; N] {
    let square = dot(v, v);
    if SAFE_SQUARES.contains(&square) {
        let length = sqrt(square);
        return v.map(|x| x / length);
    }
    direction(v).unwrap_or([0.0; N])
}

/// Fills `out` with the [`unit()`] vectors of some vectors, whose coordinates along each axis lie side by side.
///
/// # Panics
/// If there are fewer coordinates along an axis than vectors in `out`.
pub fn units([x, y, z]: [&[f64]; 3], out: &mut [Vector]) {
    if divide_by_lengths(x, y, z, out) {
        return;
    }
    for (((out, &x), &y), &z) in out.iter_mut().zip(x).zip(y).zip(z) {
        *out = unit([x, y, z]);
    }
}

/// Divides vectors by their lengths, and returns whether all squared lengths are among the [`SAFE_SQUARES`]; if not,
/// `out` means nothing.
#[multiversion(targets("x86_64+avx512f", "x86_64+avx2"))]
fn divide_by_lengths(x: &[f64], y: &[f64], z: &[f64], out: &mut [Vector]) -> bool {
    let n = out.len();
    let (x, y, z) = (&x[..n], &y[..n], &z[..n]);
    let mut n_unsafe = 0;
    for k in 0..n {
        let square = x[k] * x[k] + y[k] * y[k] + z[k] * z[k];
        n_unsafe += usize::from(!SAFE_SQUARES.contains(&square));
        let length = sqrt(square);
        out[k] = [x[k] / length, y[k] / length, z[k] / length];
    }
    n_unsafe == 0
}
