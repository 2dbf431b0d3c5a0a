//! The errors of stores.

use std::io;

use super::disk;

/// An error of the store itself.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The artifact is larger than the store accepts.
    #[error("the artifact is too large for the store: more than {capacity} bytes; raise --cache-bytes")]
    TooLarge {
        /// Maximum size of one artifact in bytes: half of the capacity of the store.
        capacity: u64,
    },
    /// Something that is not a file has the name of the artifact.
    #[error("a folder stands where the artifact would: {path}; remove it")]
    Occupied {
        /// Path of what has the name of the artifact.
        path: String,
    },
    /// There is no room, and everything stored is pinned by jobs or downloads.
    #[error("the store is full of what jobs and downloads need now; try again later, or give it more room")]
    InUse,
    /// A store over a network does not answer, or refuses access.
    #[error("the shared store is away: {reason}; it is asked again in some seconds")]
    Away {
        /// The reason why the last call failed.
        reason: String,
        /// Whether the store answered and refused access.
        refuses: bool,
    },
    /// The disk or the index failed.
    #[error("the store failed: {0}")]
    Io(#[source] io::Error),
}

impl StoreError {
    /// Returns whether the disk was full, so that removing files may help.
    pub fn is_full(&self) -> bool {
        matches!(self, Self::Io(error) if disk::is_full(error))
    }

    /// Copies an error, so that it can be returned a second time.
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
