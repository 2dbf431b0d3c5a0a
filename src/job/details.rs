//! Levels of detail: results of the same shape at other levels, to which an output refers.

use super::key::Key;
use super::output::Output;

/// A result to which an output refers.
#[derive(Debug, Clone)]
pub(super) struct DetailOutput {
    /// The index of the output that refers to it.
    pub(super) of: usize,
    /// Number of applications of the plan's cycle.
    pub(super) levels: u32,
    /// The result as the output of a separate job.
    pub(super) output: Output,
    /// The key of the result.
    pub(super) key: Key,
}
