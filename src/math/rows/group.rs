//! Sums of points around a centre whose bits do not depend on where the walk around the centre begins.

/// Returns the sum of `n` points around a centre: of 2 as `a + b`, of 4 as `(a0 + a2) + (a1 + a3)`, of 6 as the sum of
/// the three opposite pairs in ascending order of each coordinate, otherwise in order.
///
/// Addition is commutative but not associative in floating point: opposite pairs stay pairs when the walk begins
/// elsewhere or goes the other way around, so that neighbouring faces of a regular net compute a point that they share
/// to the same bits.
#[inline]
pub fn symmetric_sum<const W: usize>(n: usize, point: impl Fn(usize) -> [f64; W]) -> [f64; W] {
    let pair = |i: usize, j: usize| add(point(i), point(j));
    match n {
        2 => pair(0, 1),
        4 => add(pair(0, 2), pair(1, 3)),
        6 => {
            let (a, b, c) = (pair(0, 3), pair(1, 4), pair(2, 5));
            std::array::from_fn(|k| ascending_sum(a[k], b[k], c[k]))
        }
        n => (1..n).fold(point(0), |sum, k| add(sum, point(k))),
    }
}

#[inline]
fn add<const W: usize>(a: [f64; W], b: [f64; W]) -> [f64; W] {
    std::array::from_fn(|c| a[c] + b[c])
}

/// Returns `(least + middle) + greatest`.
#[inline]
pub fn ascending_sum(a: f64, b: f64, c: f64) -> f64 {
    let (low, high) = ordered(a, b);
    let (low, other) = ordered(low, c);
    let (middle, high) = ordered(high, other);
    (low + middle) + high
}

#[inline]
fn ordered(a: f64, b: f64) -> (f64, f64) {
    if b < a { (b, a) } else { (a, b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symmetric_sums_are_the_same_wherever_they_begin() {
        let points = [0.1, 1e16, -1e16, 3.3, 7e-9, -0.7, 1e8, 0.3];
        for n in [2, 4, 6] {
            let sum = |k: usize| symmetric_sum(n, |i| [points[(i + k) % n]])[0].to_bits();
            let back = |k: usize| symmetric_sum(n, |i| [points[(n + k - i) % n]])[0].to_bits();
            assert!((0..n).all(|k| sum(k) == sum(0) && back(k) == sum(0)), "{n} members");
        }
    }
}
