//! The reasons for which there is no solid.

use crate::fault::Fault;
use crate::watch::Stopped;

/// The reason for which a mesh gives no solid.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SolidError {
    /// The watch asked the computation to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The mesh does not fit the request; the fault points below the output.
    #[error("{0}")]
    Unfit(Fault),
}

impl SolidError {
    /// Returns the error for a surface without shown faces.
    pub(super) fn empty() -> Self {
        Self::at("", "every face of the mesh is a hole, or at a boundary that boundary \"none\" leaves out; leave some")
    }

    /// Returns an error at an option of the output, or at the output as a whole if `option` is empty.
    pub(super) fn at(option: &str, detail: impl Into<String>) -> Self {
        let pointer = if option.is_empty() { String::new() } else { format!("/{option}") };
        Self::Unfit(Fault::new(pointer, detail))
    }
}
