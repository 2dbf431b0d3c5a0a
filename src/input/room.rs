//! What a reader may take of memory: in proportion to the bytes that came in.

use crate::math::amounts::in_bytes;

/// Bytes that may be taken whatever the length: an accessor, a few nodes and primitives need more than their text is
/// long. With less, small scenes of a few hundred nodes would be refused; more would let a thousand tiny requests take
/// gigabytes.
const LEAST: u64 = 1 << 20;

/// Bytes that may be taken for each byte of a file. Lists double their room when they are full, so that an entry takes
/// three times its size at worst. So measured, by byte: words of a long line 24, vertices of binary PLY with
/// coordinates of a byte 24, names of groups of OBJ 31, faces in sixteen groups 24; most else is below 12. With less,
/// files that are read today would be refused; glTF, whose entries take up to 300, is counted and refused beyond.
const EACH: u64 = 32;

/// Times the size of its entries that a growing list holds at worst: the old half while it is copied to the new whole.
pub(super) const GROWN: usize = 3;

/// Bytes that reading a mesh file of so many bytes takes at most, the file itself left out.
pub const fn weight(length: u64) -> u64 {
    LEAST.saturating_add(EACH.saturating_mul(length))
}

/// What is left of the weight of a file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Room {
    length: u64,
    /// Bytes beyond the weight.
    spare: u64,
    left: u64,
}

impl Room {
    /// All that a file of so many bytes may take.
    pub(super) fn new(length: usize) -> Self {
        Self { length: length as u64, spare: 0, left: weight(length as u64) }
    }

    /// Takes so many bytes.
    ///
    /// # Errors
    /// There are not so many left: what the file may take, and how to stay below.
    pub(super) fn take(&mut self, bytes: usize) -> Result<(), String> {
        self.left = self.left.checked_sub(bytes as u64).ok_or_else(|| {
            let all = weight(self.length).saturating_add(self.spare);
            let [bytes, length, all, taken] =
                [bytes as u64, self.length, all, all - self.left].map(|n| in_bytes(n.into()));
            format!(
                "it takes {bytes} to read; a file of {length} may take {all} in all, of which {taken} are taken: send \
                 less at once"
            )
        })?;
        Ok(())
    }

    /// The same with so many bytes more.
    #[must_use]
    pub(super) fn with_spare(self, bytes: u64) -> Self {
        Self { left: self.left.saturating_add(bytes), spare: self.spare.saturating_add(bytes), ..self }
    }

    /// Takes in what a file of so many bytes beside the first one may take.
    pub(super) fn widen(&mut self, length: usize) {
        self.length += length as u64;
        self.left += EACH.saturating_mul(length as u64);
    }

    /// Gives back what was taken and is dropped.
    pub(super) fn give(&mut self, bytes: usize) {
        self.left += bytes as u64;
    }

    /// Whether so many bytes are left.
    pub(super) fn has(&self, bytes: usize) -> bool {
        self.left >= bytes as u64
    }
}
