//! Why a format did not write a scene.

use std::io;

use crate::drawing::DrawError;
use crate::fault::Fault;
use crate::watch::Stopped;

/// Why a scene was not written.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The job was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The bytes could not be taken.
    #[error("writing the result failed: {0}")]
    Io(#[from] io::Error),
    /// It cannot be written as it is asked for: where below the output, and why.
    #[error("{0}")]
    Impossible(Fault),
    /// The scene holds something the format cannot express.
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
