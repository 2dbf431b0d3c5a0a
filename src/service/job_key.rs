//! The identity of a job, and what its client requests about its turn.

use crate::job::key::{Key, content};

/// The owner of jobs, results, uploads and batches, shared by all keys of one name. Computations have no tenant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Tenant(pub u64);

impl Tenant {
    /// The tenant of all clients without a key, and of those whose keys are shared.
    pub const ANYONE: Self = Self(0);

    /// Returns the tenant of a name: the first 64 bits of the hash of the name.
    pub fn named(name: &str) -> Self {
        let hash = content(format!("tenant\n{name}").as_bytes());
        let number = hash.as_bytes().first_chunk().map_or(0, |first| u64::from_be_bytes(*first));
        // zero is `ANYONE`
        Self(number.max(1))
    }
}

/// The identity of a job: the tenant and the id.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JobKey {
    /// The tenant.
    pub tenant: Tenant,
    /// The id.
    pub id: Key,
}

/// Length of a job key in bytes.
const JOB_KEY_BYTES: usize = 40;

impl JobKey {
    /// Returns the key of a job of clients without a key. The service itself does not call this; tests and users of the
    /// library do.
    pub fn of_anyone(id: Key) -> Self {
        Self { tenant: Tenant::ANYONE, id }
    }

    /// Returns the key as bytes: the tenant's number, big-endian, and the id.
    pub fn to_bytes(self) -> [u8; JOB_KEY_BYTES] {
        let mut bytes = [0; JOB_KEY_BYTES];
        bytes[..8].copy_from_slice(&self.tenant.0.to_be_bytes());
        bytes[8..].copy_from_slice(self.id.as_bytes());
        bytes
    }

    /// Reads the bytes of [`JobKey::to_bytes`].
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (tenant, id) = bytes.split_first_chunk::<8>()?;
        Some(Self { tenant: Tenant(u64::from_be_bytes(*tenant)), id: Key::from_bytes(id.try_into().ok()?) })
    }
}

/// The priority of a job in the queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Priority {
    /// Somebody waits for the job.
    #[default]
    Interactive,
    /// The job may wait for interactive ones.
    Batch,
}

impl Priority {
    /// All priorities, the highest first.
    pub const ALL: [Self; 2] = [Self::Interactive, Self::Batch];

    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Interactive => "interactive",
            Self::Batch => "batch",
        }
    }
}

/// The terms on which a client wants a job computed, which are never part of the job's key.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct JobTerms {
    /// The priority.
    pub priority: Priority,
    /// Maximum time in the queue, in seconds.
    pub queue_timeout_s: Option<u64>,
    /// Maximum time from the turn of the job to its end, in seconds.
    pub run_timeout_s: Option<u64>,
}
