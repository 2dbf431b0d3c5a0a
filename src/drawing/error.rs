//! The reasons for which a drawing was not made.

use std::io;

use crate::watch::Stopped;

/// The reason for which a drawing was not painted or written.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    /// The job was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The bytes could not be written.
    #[error("writing the drawing failed: {0}")]
    Io(#[from] io::Error),
    /// The drawing cannot be made, with the reason and the remedy.
    #[error("{0}")]
    Unfit(String),
}
