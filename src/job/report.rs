//! What a computation says besides its bytes.

/// What a run has to say besides the bytes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Report {
    /// What the client should know about the result, in sentences.
    pub warnings: Vec<String>,
}
