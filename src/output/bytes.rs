//! A buffer for the bytes of a block, reused from block to block.

/// A buffer whose memory is kept from block to block. Each method replaces its contents.
#[derive(Debug, Default)]
pub(super) struct Bytes {
    /// The bytes of the block, followed by remains of earlier blocks.
    memory: Vec<u8>,
    len: usize,
}

impl Bytes {
    /// Returns the contents.
    pub(super) fn made(&self) -> &[u8] {
        &self.memory[..self.len]
    }

    /// Empties the contents.
    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Replaces the contents with the bytes that `append` appends.
    pub(super) fn append(&mut self, append: impl FnOnce(&mut Vec<u8>)) {
        self.memory.clear();
        append(&mut self.memory);
        self.len = self.memory.len();
    }

    /// Replaces the contents with `n` rows of `N` bytes, all of which the caller must overwrite: they hold arbitrary
    /// bytes.
    pub(super) fn rows<const N: usize>(&mut self, n: usize) -> &mut [[u8; N]] {
        self.len = N * n;
        self.room(N * n).as_chunks_mut().0
    }

    /// Replaces the contents with the bytes that `write` puts at the start of a slice of `most` bytes; it returns their
    /// number.
    pub(super) fn text(&mut self, most: usize, write: impl FnOnce(&mut [u8]) -> usize) {
        self.len = write(self.room(most));
    }

    /// Removes the first byte.
    pub(super) fn drop_first(&mut self) {
        self.memory.copy_within(1..self.len, 0);
        self.len -= 1;
    }

    fn room(&mut self, n: usize) -> &mut [u8] {
        if self.memory.len() < n {
            // only newly allocated bytes are filled with zeros
            self.memory.resize(n, 0);
        }
        &mut self.memory[..n]
    }
}
