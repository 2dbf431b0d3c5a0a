//! The memory budget of a reader, in proportion to the length of its files.

use crate::math::amounts::in_bytes;

/// Bytes that may be taken whatever the length of the file: an accessor, a few nodes and primitives take more than
/// their text is long. Less would refuse small scenes of a few hundred nodes; more would let a thousand tiny requests
/// take gigabytes.
const ROOM_BASE_BYTES: u64 = 1 << 20;

/// Bytes that may be taken per byte of a file. Lists double their capacity when they are full, so that an entry takes
/// three times its size at worst. Measured on that basis, per byte: words of a long line 24, vertices of binary PLY
/// with one-byte coordinates 24, names of groups of OBJ 31, faces in sixteen groups 24; most others are below 12. Less
/// would refuse files that are read today; glTF, whose entries take up to 300, is counted and refused beyond.
const ROOM_BYTES_A_BYTE: u64 = 32;

/// The peak capacity of a growing list as a multiple of its size: the old half while it is copied into the new whole.
pub(super) const GROWN: usize = 3;

/// Returns an upper bound of the memory in bytes for reading a mesh file of `length` bytes, without the file itself.
pub const fn reading_memory(length: u64) -> u64 {
    ROOM_BASE_BYTES.saturating_add(ROOM_BYTES_A_BYTE.saturating_mul(length))
}

/// The remaining memory budget of a file.
#[derive(Debug, Clone, Copy)]
pub(super) struct MemoryBudget {
    length: u64,
    /// Bytes granted beyond [`reading_memory`].
    spare: u64,
    left: u64,
}

impl MemoryBudget {
    /// Creates the full budget of a file of `length` bytes.
    pub(super) fn new(length: usize) -> Self {
        Self { length: length as u64, spare: 0, left: reading_memory(length as u64) }
    }

    /// Takes bytes from the budget.
    ///
    /// # Errors
    /// Fewer bytes are left; the message says what the file may take, and how to stay below it.
    pub(super) fn take(&mut self, bytes: usize) -> Result<(), String> {
        self.left = self.left.checked_sub(bytes as u64).ok_or_else(|| {
            let all = reading_memory(self.length).saturating_add(self.spare);
            let [bytes, length, all, taken] =
                [bytes as u64, self.length, all, all - self.left].map(|n| in_bytes(n.into()));
            format!(
                "it takes {bytes} to read; a file of {length} may take {all} in all, of which {taken} are taken: send \
                 less at once"
            )
        })?;
        Ok(())
    }

    /// Returns the budget with additional bytes.
    #[must_use]
    pub(super) fn with_spare(self, bytes: u64) -> Self {
        Self { left: self.left.saturating_add(bytes), spare: self.spare.saturating_add(bytes), ..self }
    }

    /// Adds the allowance of a companion file of `length` bytes.
    pub(super) fn widen(&mut self, length: usize) {
        self.length += length as u64;
        self.left += ROOM_BYTES_A_BYTE.saturating_mul(length as u64);
    }

    /// Returns bytes to the budget after they are freed.
    pub(super) fn give(&mut self, bytes: usize) {
        self.left += bytes as u64;
    }

    /// Whether at least `bytes` are left.
    pub(super) fn has(&self, bytes: usize) -> bool {
        self.left >= bytes as u64
    }
}
