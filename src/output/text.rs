//! Rows of numbers as text.

use crate::output::bytes::Bytes;
use crate::output::numbers::{REAL_BYTES, decimal, whole};
use crate::output::scene::FaceChunk;

/// Bytes that are written at once for a row of indices, of which at most [`RowStyle::MAX_BYTES`] plus four times
/// [`IndexText::MAX_BYTES`] are part of the text: an index writes 16 bytes, whatever its length.
const ROW_BYTES: usize = 64;

/// Maximum number of bytes of a real number and of the byte before it.
const REAL_TEXT_BYTES: usize = 1 + REAL_BYTES as usize;

/// Number of reals that are spelled before they are copied: loading what was just stored is slow. Half as many wait for
/// it; twice as many are more than the rows of most files have.
const REALS_AT_ONCE: usize = 4;

/// The characters around the numbers of a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowStyle {
    /// The start of a row, at most two bytes.
    pub(super) start: &'static [u8],
    /// The byte before the first number.
    pub(super) open: u8,
    /// The byte between two numbers.
    pub(super) between: u8,
    /// The end of a row, at most two bytes.
    pub(super) end: &'static [u8],
}

impl RowStyle {
    /// Maximum number of bytes at the start and the end of a row together.
    const MAX_BYTES: usize = 4;

    /// Appends a row.
    pub(super) fn reals(&self, row: &[f64], out: &mut Vec<u8>) {
        let start = out.len();
        out.resize(start + Self::room(row.len()), 0);
        let len = self.spell(row, &mut out[start..]);
        out.truncate(start + len);
    }

    /// Makes a row for each vector.
    pub(super) fn vectors<R: AsRef<[f64]>>(&self, rows: impl ExactSizeIterator<Item = R> + Clone, out: &mut Bytes) {
        let room = rows.clone().map(|row| Self::room(row.as_ref().len())).sum();
        out.text(room, |text| rows.fold(0, |at, row| at + self.spell(row.as_ref(), &mut text[at..])));
    }

    /// Returns the maximum number of bytes of a row of `n` reals.
    fn room(n: usize) -> usize {
        Self::MAX_BYTES + n * REAL_TEXT_BYTES
    }

    /// Writes a row of reals at the start of `text`, and returns its number of bytes.
    fn spell(&self, row: &[f64], text: &mut [u8]) -> usize {
        let mut at = put(self.start, text);
        let mut before = self.open;
        for reals in row.chunks(REALS_AT_ONCE) {
            let mut buffers = [(); REALS_AT_ONCE].map(|()| zmij::Buffer::new());
            let mut spelled = [""; REALS_AT_ONCE];
            for ((spelled, buffer), &x) in spelled.iter_mut().zip(&mut buffers).zip(reals) {
                *spelled = decimal(x, buffer);
            }
            for digits in &spelled[..reals.len()] {
                text[at] = before;
                at += 1 + put_digits(digits.as_bytes(), &mut text[at + 1..]);
                before = self.between;
            }
        }
        at + put(self.end, &mut text[at..])
    }

    /// Appends a row of whole numbers, counted from `origin`.
    pub(super) fn indices(&self, row: &[u32], origin: u64, out: &mut Vec<u8>) {
        out.extend_from_slice(self.start);
        for (k, &n) in row.iter().enumerate() {
            out.push(if k > 0 { self.between } else { self.open });
            whole(out, u64::from(n) + origin);
        }
        out.extend_from_slice(self.end);
    }

    /// Makes a row for each face, with its indices counted from `origin`.
    pub(super) fn faces(&self, faces: &FaceChunk, origin: u64, out: &mut Bytes) {
        if let Some(quads) = faces.rows::<4>() {
            self.rows_of_indices(quads, origin, out);
        } else if let Some(triangles) = faces.rows::<3>() {
            self.rows_of_indices(triangles, origin, out);
        } else {
            out.append(|out| faces.iter().for_each(|face| self.indices(face, origin, out)));
        }
    }

    fn rows_of_indices<const N: usize>(&self, rows: &[[u32; N]], origin: u64, out: &mut Bytes) {
        let mut columns: [IndexText; N] =
            std::array::from_fn(|k| IndexText::new(if k > 0 { self.between } else { self.open }, origin));
        out.text(rows.len() * (Self::MAX_BYTES + N * IndexText::MAX_BYTES) + ROW_BYTES, |text| {
            let mut at = 0;
            for row in rows {
                let Some(line) = text[at..].first_chunk_mut::<ROW_BYTES>() else { break };
                let mut end = put(self.start, line);
                for (column, &n) in columns.iter_mut().zip(row) {
                    column.show(u64::from(n) + origin);
                    line[end..end + 16].copy_from_slice(&column.text.to_le_bytes());
                    end += column.len;
                }
                at += end + put(self.end, &mut line[end..]);
            }
            at
        });
    }
}

/// Writes at most two bytes at the start of `text`, and returns their number; a copy of any length would be a call.
#[inline]
fn put(bytes: &[u8], text: &mut [u8]) -> usize {
    match *bytes {
        [] => 0,
        [a] => {
            text[0] = a;
            1
        }
        [a, b, ..] => {
            text[..2].copy_from_slice(&[a, b]);
            2
        }
    }
}

/// Writes the digits of a number at the start of `text`, and returns their number. Most numbers have 16 to 24, which
/// are two copies of fixed length.
#[inline]
fn put_digits(digits: &[u8], text: &mut [u8]) -> usize {
    let n = digits.len();
    if let (Some(head), Some(tail)) = (digits.first_chunk::<16>(), digits.last_chunk::<8>()) {
        text[..16].copy_from_slice(head);
        text[n - 8..n].copy_from_slice(tail);
    } else {
        text[..n].copy_from_slice(digits);
    }
    n
}

/// A number in a column of indices as text, after one byte. In most rows it is the number of the row before plus one,
/// so only its last digit changes. The bytes are kept as one integer, as loading what was just stored byte by byte is
/// slow.
struct IndexText {
    n: u64,
    text: u128,
    len: usize,
}

impl IndexText {
    /// Maximum number of bytes: the byte before, and ten digits of a number up to 2^32.
    const MAX_BYTES: usize = 11;

    /// Returns the text of a number after the byte `before`.
    fn new(before: u8, n: u64) -> Self {
        let mut index = Self { n, text: before.into(), len: 1 };
        index.spell(n);
        index
    }

    fn spell(&mut self, n: u64) {
        let mut digits = itoa::Buffer::new();
        let digits = digits.format(n).bytes();
        (self.n, self.text, self.len) = (n, self.text & 0xff, 1);
        for digit in digits {
            self.text |= u128::from(digit) << (8 * self.len);
            self.len += 1;
        }
    }

    #[inline]
    fn show(&mut self, n: u64) {
        let last = 8 * (self.len - 1);
        if self.n + 1 == n && self.text >> last != u128::from(b'9') {
            self.text += 1 << last;
            self.n = n;
        } else if self.n != n {
            self.spell(n);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::numbers::real;

    #[test]
    fn rows_of_reals_are_their_numbers_one_by_one() {
        let style = RowStyle { start: b"vn", open: b' ', between: b',', end: b"\n" };
        let numbers = [
            0.0,
            -0.0,
            1.0,
            -2.5,
            0.1,
            -1.0 / 3.0,
            1e15,
            1e16,
            9_223_372_036_854_775_808.0,
            5e-324,
            f64::MIN,
            1e-7,
            42.0,
        ];
        for row in numbers.windows(3).chain([&numbers[..], &[], &numbers[..4], &numbers[..5]]) {
            let mut expected = b"vn".to_vec();
            for (k, &x) in row.iter().enumerate() {
                expected.push(if k > 0 { b',' } else { b' ' });
                real(&mut expected, x);
            }
            expected.push(b'\n');
            let mut appended = b"before".to_vec();
            style.reals(row, &mut appended);
            assert_eq!(appended, [b"before", &expected[..]].concat(), "{row:?}");
            let mut made = Bytes::default();
            style.vectors([row, row].into_iter(), &mut made);
            assert_eq!(made.made(), expected.repeat(2), "{row:?}");
        }
    }

    #[test]
    fn indices_are_written_alike_whether_they_follow_each_other_or_not() {
        let style = RowStyle { start: b"f", open: b' ', between: b' ', end: b"\n" };
        let rows = [[0, 8, 9, 7], [1, 9, 10, 7], [2, 10, 11, 99], [u32::MAX, 11, 12, 100], [0, 0, 0, 101]];
        let mut faces = FaceChunk::default();
        rows.iter().for_each(|row| faces.push(row));
        let expected = "f 1 9 10 8\nf 2 10 11 8\nf 3 11 12 100\nf 4294967296 12 13 101\nf 1 1 1 102\n";
        let mut out = Bytes::default();
        style.faces(&faces, 1, &mut out);
        assert_eq!(String::from_utf8_lossy(out.made()), expected);
        // a larger face takes the other code path
        faces.push(&[0, 1, 2, 3, 4]);
        style.faces(&faces, 1, &mut out);
        assert_eq!(String::from_utf8_lossy(out.made()), format!("{expected}f 1 2 3 4 5\n"));
    }
}
