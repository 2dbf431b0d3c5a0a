//! The report of a computation besides its bytes.

/// The report of a run besides the bytes of its result.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Report {
    /// Warnings to the client about the result, as sentences.
    pub warnings: Vec<String>,
}
