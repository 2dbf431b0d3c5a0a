//! Why there is no solid.

use crate::fault::Fault;
use crate::watch::Stopped;

/// Why a mesh gives no solid.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SolidError {
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The mesh and what is asked for do not go together; the pointer leads below the output.
    #[error("{0}")]
    Unfit(Fault),
}

impl SolidError {
    /// A refusal where nothing of the surface is shown.
    pub(super) fn empty() -> Self {
        Self::at("", "every face of the mesh is a hole, or at a boundary that boundary \"none\" leaves out; leave some")
    }

    /// A refusal at an option of the output; empty for the output as a whole.
    pub(super) fn at(option: &str, detail: impl Into<String>) -> Self {
        let pointer = if option.is_empty() { String::new() } else { format!("/{option}") };
        Self::Unfit(Fault::new(pointer, detail))
    }
}
