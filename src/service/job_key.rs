//! What names a job, and what a client says of its turn.

use crate::job::key::{Key, content};

/// Whose jobs, results, uploads and lists belong together. Computations have no tenant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Tenant(pub u64);

impl Tenant {
    /// All clients that do not say who they are, and those whose keys say that they share.
    pub const ANYONE: Self = Self(0);

    /// The tenant of a name: the first 64 bits of the name's hash.
    pub fn named(name: &str) -> Self {
        let hash = content(format!("tenant\n{name}").as_bytes());
        let number = hash.as_bytes().first_chunk().map_or(0, |first| u64::from_be_bytes(*first));
        // zero is everybody's
        Self(number.max(1))
    }
}

/// A job of a tenant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JobKey {
    /// Whose it is.
    pub tenant: Tenant,
    /// Its id.
    pub id: Key,
}

/// Bytes of a written key.
pub const JOB_KEY_BYTES: usize = 40;

impl JobKey {
    /// The job of clients that do not say who they are.
    pub fn of_anyone(id: Key) -> Self {
        Self { tenant: Tenant::ANYONE, id }
    }

    /// The key as bytes: the tenant's number, big-endian, and the id.
    pub fn to_bytes(self) -> [u8; JOB_KEY_BYTES] {
        let mut bytes = [0; JOB_KEY_BYTES];
        bytes[..8].copy_from_slice(&self.tenant.0.to_be_bytes());
        bytes[8..].copy_from_slice(self.id.as_bytes());
        bytes
    }

    /// Reads [`JobKey::to_bytes`] back.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (tenant, id) = bytes.split_first_chunk::<8>()?;
        Some(Self { tenant: Tenant(u64::from_be_bytes(*tenant)), id: Key::from_bytes(id.try_into().ok()?) })
    }
}

/// Which jobs come first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Priority {
    /// Somebody waits for it.
    #[default]
    Interactive,
    /// It may stand back behind those that somebody waits for.
    Batch,
}

impl Priority {
    /// All of them, the first served first.
    pub const ALL: [Self; 2] = [Self::Interactive, Self::Batch];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Interactive => "interactive",
            Self::Batch => "batch",
        }
    }
}

/// What a client says of the turn of a job; never part of its key.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct JobTerms {
    /// Which jobs it stands behind.
    pub priority: Priority,
    /// Longest time it may wait for its turn, seconds.
    pub queue_timeout_s: Option<u64>,
    /// Longest time from its turn to its end, seconds.
    pub run_timeout_s: Option<u64>,
}
