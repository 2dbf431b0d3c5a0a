//! Reader of the values of binary OFF: 32 bits each, in big-endian order.

/// A cursor over the values of a file.
#[derive(Debug)]
pub(super) struct OffNumbers<'a> {
    bytes: &'a [u8],
    /// The offset of the next value in bytes.
    at: usize,
}

impl<'a> OffNumbers<'a> {
    /// Creates a cursor that begins at byte `at` of the file.
    pub(super) fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    /// Reads the four bytes of the next value; `what` names the value in messages.
    ///
    /// # Errors
    /// The file has ended.
    fn next(&mut self, what: &str) -> Result<[u8; 4], String> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let word = rest.first_chunk::<4>().copied();
        let word =
            word.ok_or_else(|| self.at_offset(format!("the file ends where {what} should follow; send it whole")))?;
        self.at += word.len();
        Ok(word)
    }

    /// Reads a count or an index.
    ///
    /// # Errors
    /// The file has ended.
    pub(super) fn count(&mut self, what: &str) -> Result<u64, String> {
        self.next(what).map(u32::from_be_bytes).map(u64::from)
    }

    /// Reads a coordinate or a colour component.
    ///
    /// # Errors
    /// The file has ended, or the number is not finite.
    pub(super) fn number(&mut self, what: &str) -> Result<f64, String> {
        let at = self.at;
        let number = f32::from_be_bytes(self.next(what)?);
        let is_wrong = || format!("byte {at}: {what} has {number}, which is not finite");
        if number.is_finite() { Ok(number.into()) } else { Err(is_wrong()) }
    }

    /// Prefixes a message with the current byte offset.
    pub(super) fn at_offset(&self, detail: impl std::fmt::Display) -> String {
        format!("byte {}: {detail}", self.at)
    }

    /// Whether nothing follows except the line break that some programs write.
    pub(super) fn is_at_end(&self) -> bool {
        self.bytes.get(self.at..).unwrap_or_default().trim_ascii().is_empty()
    }
}
