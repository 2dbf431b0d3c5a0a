//! The bytes of a block in the making.

/// Bytes whose memory is kept from block to block. Each method replaces what was made before.
#[derive(Debug, Default)]
pub(super) struct Bytes {
    /// Those of the block, then what an earlier one left.
    memory: Vec<u8>,
    len: usize,
}

impl Bytes {
    /// What was made.
    pub(super) fn made(&self) -> &[u8] {
        &self.memory[..self.len]
    }

    /// Makes nothing.
    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Makes what `append` appends.
    pub(super) fn append(&mut self, append: impl FnOnce(&mut Vec<u8>)) {
        self.memory.clear();
        append(&mut self.memory);
        self.len = self.memory.len();
    }

    /// Makes `n` rows of `N` bytes, all of which are to be written: what stands there is of no meaning.
    pub(super) fn rows<const N: usize>(&mut self, n: usize) -> &mut [[u8; N]] {
        self.len = N * n;
        self.room(N * n).as_chunks_mut().0
    }

    /// Makes what `write` puts at the start of so many places at most; it says how many it took.
    pub(super) fn text(&mut self, most: usize, write: impl FnOnce(&mut [u8]) -> usize) {
        self.len = write(self.room(most));
    }

    /// Takes the first byte away.
    pub(super) fn drop_first(&mut self) {
        self.memory.copy_within(1..self.len, 0);
        self.len -= 1;
    }

    fn room(&mut self, n: usize) -> &mut [u8] {
        if self.memory.len() < n {
            // only what was never there is filled with zeros
            self.memory.resize(n, 0);
        }
        &mut self.memory[..n]
    }
}
