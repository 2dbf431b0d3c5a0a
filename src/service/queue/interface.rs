//! What every queue can do.

use std::fmt::Debug;
use std::future::Future;
use std::pin::Pin;

use crate::service::job_key::{JobKey, Priority};
use crate::service::peer::Peer;
use crate::service::pool::Lane;

/// What comes later.
pub type Later<'a, T> = Pin<Box<dyn Future<Output = T> + Send + 'a>>;

/// A job in line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Item {
    /// The job.
    pub job: JobKey,
    /// The lane of its longest computation: short or long.
    pub lane: Lane,
    /// Which jobs it stands behind.
    pub priority: Priority,
    /// Whose turn it takes.
    pub peer: Peer,
}

/// The queue does not take a job, for a reason of its own.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the queue of jobs failed: {0}")]
pub struct QueueError(pub String);

/// Jobs that wait for their turns. Peers take turns within a priority; of eight turns the batch has at least one.
pub trait Queue: Debug + Send + Sync {
    /// Puts a job in line; one that is in line stays where it is.
    fn push(&self, item: Item) -> Later<'_, Result<(), QueueError>>;

    /// The next job of a lane, when there is one.
    fn take(&self, lane: Lane) -> Later<'_, Leased>;

    /// Takes a job out of the line, if it is there. One that was taken stays with whoever has it.
    fn withdraw(&self, job: &JobKey);

    /// How many jobs of its lane come before a job in line.
    fn ahead(&self, job: &JobKey) -> Option<usize>;

    /// How many wait in a lane.
    fn waiting(&self, lane: Lane) -> usize;
}

/// A job that was taken out of the queue. Dropped before it is [done](Leased::done), it is in line again, as the first.
#[derive(Debug)]
pub struct Leased {
    /// The job.
    pub item: Item,
    /// The way back.
    pub lease: Box<dyn Lease>,
}

impl Leased {
    /// Says that the job needs no turn any more.
    pub fn done(self) {
        self.lease.done();
    }
}

/// The way back of a job into its queue.
pub trait Lease: Debug + Send {
    /// Gives it up.
    fn done(self: Box<Self>);
}
