//! Errors of formats.

use std::io;

use crate::drawing::DrawError;
use crate::fault::Fault;
use crate::watch::Stopped;

/// The reason why a scene was not written.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The job was stopped.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The bytes could not be written.
    #[error("writing the result failed: {0}")]
    Io(#[from] io::Error),
    /// The scene cannot be written as requested; the fault has a pointer below the output.
    #[error("{0}")]
    Impossible(Fault),
    /// The scene contains something that the format cannot express.
    #[error("{0}")]
    Unfit(String),
}

impl From<DrawError> for FormatError {
    fn from(error: DrawError) -> Self {
        match error {
            DrawError::Stopped(stopped) => Self::Stopped(stopped),
            DrawError::Io(error) => Self::Io(error),
            DrawError::Unfit(reason) => Self::Unfit(reason),
        }
    }
}
