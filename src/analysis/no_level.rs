//! The reasons for which no level is known for a tolerance.

use crate::refine::RefineError;
use crate::watch::Stopped;

/// The reason for which no level is known for a tolerance.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoLevel {
    /// No distance to the limit is known that is small enough: why, and what helps.
    #[error("{0}")]
    Refused(String),
    /// The search was asked to stop.
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
