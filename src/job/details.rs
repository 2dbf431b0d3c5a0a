//! Levels of detail: results of the same shape at other levels, to which an output refers.

use super::key::Key;
use super::output::Output;

/// A result to which an output refers.
#[derive(Debug, Clone)]
pub(super) struct DetailOutput {
    /// The index of the output that refers to it.
    pub(super) of: usize,
    /// How often the plan's cycle is applied.
    pub(super) levels: u32,
    /// The result as the output of a job of its own.
    pub(super) output: Output,
    /// Its key.
    pub(super) key: Key,
}
