//! Numbers as text, and their lengths.

/// Maximum number of bytes that [`real`] appends.
pub(super) const REAL_BYTES: u128 = 24;

/// Appends the shortest decimal that reads back as `x`, whole numbers without a point, and -0 as 0.
#[inline]
pub(super) fn real(out: &mut Vec<u8>, x: f64) {
    out.extend_from_slice(decimal(x, &mut zmij::Buffer::new()).as_bytes());
}

/// Appends the f32 nearest to `x` as [`real`] does.
pub(super) fn real_f32(out: &mut Vec<u8>, x: f64) {
    let x = rounded(x) + 0.0;
    out.extend_from_slice(without_point(f64::from(x), zmij::Buffer::new().format_finite(x)).as_bytes());
}

/// Returns what [`real`] appends.
#[inline]
pub(super) fn decimal(x: f64, buffer: &mut zmij::Buffer) -> &str {
    let x = x + 0.0;
    without_point(x, buffer.format_finite(x))
}

/// Returns the text of a number other than -0, without the point if it is whole. Texts of other numbers are not looked
/// at: loading what was just stored is slow.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "whole numbers above 2^63 have no point"
)]
#[inline]
fn without_point(x: f64, text: &str) -> &str {
    let is_whole = (x as i64 as f64).to_bits() == x.to_bits();
    if is_whole { text.strip_suffix(".0").unwrap_or(text) } else { text }
}

/// Appends `numbers` with `separator` between them.
pub(super) fn reals(out: &mut Vec<u8>, numbers: &[f64], separator: u8) {
    for (i, &x) in numbers.iter().enumerate() {
        if i > 0 {
            out.push(separator);
        }
        real(out, x);
    }
}

/// Appends a whole number.
pub(super) fn whole(out: &mut Vec<u8>, n: u64) {
    out.extend_from_slice(itoa::Buffer::new().format(n).as_bytes());
}

/// Returns the f32 nearest to `x`.
#[expect(clippy::cast_possible_truncation, reason = "rounding once, to nearest, is what the f32 formats promise")]
#[inline]
pub(super) fn rounded(x: f64) -> f32 {
    x as f32
}

/// Returns a vector as f32, little endian.
#[inline]
pub(super) fn f32_bytes(row: [f64; 3]) -> [u8; 12] {
    let mut bytes = [0; 12];
    bytes.as_chunks_mut().0.iter_mut().zip(row).for_each(|(slot, x)| *slot = rounded(x).to_le_bytes());
    bytes
}

/// Returns a vector as f64, little endian.
#[inline]
pub(super) fn f64_bytes(row: [f64; 3]) -> [u8; 24] {
    let mut bytes = [0; 24];
    bytes.as_chunks_mut().0.iter_mut().zip(row).for_each(|(slot, x)| *slot = x.to_le_bytes());
    bytes
}

/// Returns indices, little endian; `B` is four times `N`.
pub(super) fn index_bytes<const N: usize, const B: usize>(row: [u32; N]) -> [u8; B] {
    let mut bytes = [0; B];
    bytes.as_chunks_mut().0.iter_mut().zip(row).for_each(|(slot, n)| *slot = n.to_le_bytes());
    bytes
}

/// Returns the value of the shortest decimal of an f32, which is close to the f32 but seldom equal.
pub(super) fn as_written(x: f32) -> f64 {
    zmij::Buffer::new().format_finite(x).parse().unwrap_or(f64::from(x))
}

/// Returns the number of decimal digits of `n`.
pub(super) fn digits(n: u128) -> u128 {
    u128::from(n.checked_ilog10().unwrap_or(0)) + 1
}

/// Returns the sum of the products, saturated at the largest number.
pub(super) fn total(products: &[(u128, u128)]) -> u128 {
    products.iter().fold(0, |sum: u128, (a, b)| sum.saturating_add(a.saturating_mul(*b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reals_are_as_short_as_can_be_and_never_longer_than_promised() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1"),
            (-2.5, "-2.5"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1e21, "1e+21"),
            (-2.225_073_858_507_201_4e-308, "-2.2250738585072014e-308"),
        ];
        for (x, expected) in cases {
            let mut out = Vec::new();
            real(&mut out, x);
            assert_eq!(String::from_utf8_lossy(&out), expected);
            assert!(out.len() as u128 <= REAL_BYTES);
        }
    }

    #[test]
    fn digits_count_decimals() {
        assert_eq!([0, 9, 10, 99, 100, u128::MAX].map(digits), [1, 1, 2, 2, 3, 39]);
    }
}
