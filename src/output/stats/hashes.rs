//! Hashes of a result: one of its positions in order, one of its shape in any order.

/// BLAKE3 over all coordinates in order, each an f64 in little-endian bytes, -0 as +0.
#[derive(Debug, Default)]
pub(super) struct PositionsHash(blake3::Hasher, Vec<u8>);

impl PositionsHash {
    /// Appends coordinates.
    pub(super) fn add(&mut self, coordinates: &[f64]) {
        self.1.clear();
        self.1.extend(coordinates.iter().flat_map(|x| (x + 0.0).to_le_bytes()));
        self.0.update(&self.1);
    }

    /// Returns 64 hexadecimal digits.
    pub(super) fn hex(&self) -> String {
        self.0.finalize().to_hex().to_string()
    }
}

/// The sum of the hashes of all parts (faces, isolated vertices, polygons), which does not depend on the order of
/// vertices or parts.
///
/// A part is hashed with BLAKE3 over one byte for its kind and then its points in order, each coordinate an f64 in
/// little-endian bytes, -0 as +0. Cyclic parts (faces, closed polygons) start where the sequence of points, compared
/// byte by byte, is smallest; their direction matters. The 32 bytes of a hash are four little-endian 64-bit numbers;
/// each of the four sums wraps around.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ShapeHash([u64; 4]);

/// The kind of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum HashedItem {
    /// A vertex without faces.
    Vertex = 0,
    /// A face.
    Face = 1,
    /// An open polygon.
    Open = 2,
    /// A closed polygon.
    Closed = 3,
}

impl ShapeHash {
    /// The hash of a shape without parts.
    pub(super) const ZERO: Self = Self([0; 4]);

    /// Adds a part with these points; `bytes` is scratch memory.
    pub(super) fn add<'a>(&mut self, part: HashedItem, points: impl Iterator<Item = &'a [f64]>, bytes: &mut Vec<u8>) {
        bytes.clear();
        let mut size = 0;
        for point in points {
            bytes.extend(point.iter().flat_map(|x| (x + 0.0).to_le_bytes()));
            size = size_of_val(point);
        }
        let start = match part {
            HashedItem::Face | HashedItem::Closed if size > 0 => size * least_rotation(bytes, size),
            _ => 0,
        };
        let mut hasher = blake3::Hasher::new();
        hasher.update(&[part as u8]).update(&bytes[start..]).update(&bytes[..start]);
        let digest = hasher.finalize();
        let numbers = digest.as_bytes().as_chunks::<8>().0;
        *self = self.plus(&Self(std::array::from_fn(|i| u64::from_le_bytes(numbers[i]))));
    }

    /// Returns the sum of both.
    pub(super) fn plus(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i].wrapping_add(other.0[i])))
    }

    /// Returns 64 hexadecimal digits, the bytes of the four numbers in their order.
    pub(super) fn hex(&self) -> String {
        let bytes: [u8; 32] = std::array::from_fn(|i| self.0[i / 8].to_le_bytes()[i % 8]);
        blake3::Hash::from_bytes(bytes).to_hex().to_string()
    }
}

/// Returns the start of the lexicographically smallest rotation of a cycle of records of `size` bytes, in linear time.
///
/// Two starts race; the loser and all starts that its mismatch rules out are skipped. Source: Y. Shiloach, J.
/// Algorithms 2 (1981), 107-121.
fn least_rotation(bytes: &[u8], size: usize) -> usize {
    let n = bytes.len() / size;
    let record = |i: usize| &bytes[i % n * size..][..size];
    let (mut a, mut b, mut equal) = (0, 1, 0);
    while a < n && b < n && equal < n {
        match record(a + equal).cmp(record(b + equal)) {
            std::cmp::Ordering::Equal => {
                equal += 1;
                continue;
            }
            std::cmp::Ordering::Less => b += equal + 1,
            std::cmp::Ordering::Greater => a += equal + 1,
        }
        if a == b {
            b += 1;
        }
        equal = 0;
    }
    a.min(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_rotation_is_the_smallest_of_all() {
        for cycle in [&b"a"[..], b"ba", b"abab", b"babc", b"cabcab", b"aabaaab", b"zzzz", b"bbabba"] {
            let rotated = |start: usize| [&cycle[start..], &cycle[..start]].concat();
            let smallest = (0..cycle.len()).map(rotated).min().expect("it has rotations");
            assert_eq!(rotated(least_rotation(cycle, 1)), smallest);
        }
    }
}
