//! The reasons why a search finds no level for a tolerance.

use crate::refine::RefineError;
use crate::watch::Stopped;

/// The reason why a search finds no level for a tolerance.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoLevel {
    /// No proved distance to the limit is small enough; the text says why, and what helps.
    #[error("{0}")]
    Refused(String),
    /// The search was stopped.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl From<RefineError> for NoLevel {
    fn from(error: RefineError) -> Self {
        if let RefineError::Stopped(stopped) = error {
            Self::Stopped(stopped)
        } else {
            Self::Refused(error.to_string())
        }
    }
}
