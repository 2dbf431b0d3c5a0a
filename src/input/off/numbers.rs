//! The numbers of binary OFF: 32 bits each, the most significant byte first.

/// The numbers of a file, one after the other.
#[derive(Debug)]
pub(super) struct Numbers<'a> {
    bytes: &'a [u8],
    /// The byte at which the next number begins.
    at: usize,
}

impl<'a> Numbers<'a> {
    /// Those from a byte of a file on.
    pub(super) fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    /// The bytes of the next number of something.
    ///
    /// # Errors
    /// The file has ended.
    fn next(&mut self, what: &str) -> Result<[u8; 4], String> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let word = rest.first_chunk::<4>().copied();
        let word = word.ok_or_else(|| self.said(format!("the file ends where {what} should follow; send it whole")))?;
        self.at += word.len();
        Ok(word)
    }

    /// A count or an index.
    ///
    /// # Errors
    /// The file has ended.
    pub(super) fn count(&mut self, what: &str) -> Result<u64, String> {
        self.next(what).map(u32::from_be_bytes).map(u64::from)
    }

    /// A coordinate or a component of a colour.
    ///
    /// # Errors
    /// The file has ended, or it is not finite.
    pub(super) fn number(&mut self, what: &str) -> Result<f64, String> {
        let at = self.at;
        let number = f32::from_be_bytes(self.next(what)?);
        let is_wrong = || format!("byte {at}: {what} has {number}, which is not finite");
        if number.is_finite() { Ok(number.into()) } else { Err(is_wrong()) }
    }

    /// A sentence with the byte that was reached.
    pub(super) fn said(&self, detail: impl std::fmt::Display) -> String {
        format!("byte {}: {detail}", self.at)
    }

    /// Whether nothing follows but the line break that some programs write.
    pub(super) fn is_at_end(&self) -> bool {
        self.bytes.get(self.at..).unwrap_or_default().trim_ascii().is_empty()
    }
}
