//! How a store fails.

use std::io;

use super::disk;

/// The store itself failed.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// More bytes than the store keeps of any one artifact.
    #[error("the artifact is too large for the store: more than {capacity} bytes; raise --cache-bytes")]
    TooLarge {
        /// Most bytes one artifact may have: half of what may be held.
        capacity: u64,
    },
    /// Something that is no file has the name of the artifact.
    #[error("a folder stands where the artifact would: {path}; remove it")]
    Occupied {
        /// Where.
        path: String,
    },
    /// There is no room, and all that is kept is needed by jobs or downloads.
    #[error("the store is full of what jobs and downloads need now; try again later, or give it more room")]
    InUse,
    /// A store across a network does not answer, or refuses to.
    #[error("the shared store is away: {reason}; it is asked again in some seconds")]
    Away {
        /// Why the last call failed.
        reason: String,
        /// Whether it answered, and refused.
        refuses: bool,
    },
    /// The disk or the index failed.
    #[error("the store failed: {0}")]
    Io(#[source] io::Error),
}

impl StoreError {
    /// Whether there was no room on the disk: removing something may help.
    pub fn is_full(&self) -> bool {
        matches!(self, Self::Io(error) if disk::is_full(error))
    }

    /// Copies a failure, so that it can be told once more.
    pub(super) fn again(&self) -> Self {
        match self {
            Self::TooLarge { capacity } => Self::TooLarge { capacity: *capacity },
            Self::Occupied { path } => Self::Occupied { path: path.clone() },
            Self::InUse => Self::InUse,
            Self::Away { reason, refuses } => Self::Away { reason: reason.clone(), refuses: *refuses },
            Self::Io(error) => Self::Io(io::Error::new(error.kind(), error.to_string())),
        }
    }
}

impl From<io::Error> for StoreError {
    fn from(error: io::Error) -> Self {
        error.downcast().unwrap_or_else(Self::Io)
    }
}

impl From<StoreError> for io::Error {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::Io(error) => error,
            StoreError::TooLarge { .. } => Self::new(io::ErrorKind::FileTooLarge, error),
            StoreError::Occupied { .. } => Self::new(io::ErrorKind::IsADirectory, error),
            StoreError::InUse => Self::new(io::ErrorKind::QuotaExceeded, error),
            StoreError::Away { .. } => Self::new(io::ErrorKind::NotConnected, error),
        }
    }
}
