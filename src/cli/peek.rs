//! The outputs that a job names, without reading the rest of it.

use serde::Deserialize;

/// An output of a job, as far as the name of its file depends on it.
#[derive(Debug, Deserialize)]
pub(super) struct NamedOutput {
    /// Name of the format, which may be unknown.
    pub(super) format: String,
    /// Name of the output, if it has one.
    pub(super) name: Option<String>,
}

/// Returns the outputs that a job names, in order; `None` if the text is no job.
pub(super) fn outputs(job: &[u8]) -> Option<Vec<NamedOutput>> {
    #[derive(Deserialize)]
    struct PeekOutputs {
        #[serde(default)]
        outputs: Vec<NamedOutput>,
    }
    serde_json::from_slice(job).ok().map(|peek: PeekOutputs| peek.outputs)
}
