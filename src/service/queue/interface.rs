//! The interface of queues of jobs.

use std::fmt::Debug;
use std::future::Future;
use std::pin::Pin;

use crate::service::job_key::{JobKey, Priority};
use crate::service::peer::Peer;
use crate::service::pool::Lane;

/// A boxed future.
pub type Later<'a, T> = Pin<Box<dyn Future<Output = T> + Send + 'a>>;

/// A job in a queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QueuedJob {
    /// The job.
    pub job: JobKey,
    /// The lane of the job's longest computation: short or long.
    pub lane: Lane,
    /// The priority of the job.
    pub priority: Priority,
    /// The client whose turn the job takes.
    pub peer: Peer,
}

/// The queue did not accept a job, for the given reason.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the queue of jobs failed: {0}")]
pub struct QueueError(pub String);

/// Jobs that wait for their turns. Within a priority, clients take turns; while batch jobs wait, they get at least one
/// turn in eight.
pub trait Queue: Debug + Send + Sync {
    /// Adds a job to the queue; a job that is in the queue already keeps its place.
    fn push(&self, item: QueuedJob) -> Later<'_, Result<(), QueueError>>;

    /// Takes the next job of a lane, waiting until there is one.
    fn take(&self, lane: Lane) -> Later<'_, Leased>;

    /// Removes a job from the queue, if it is there. A job that was taken out of the queue is not affected.
    fn withdraw(&self, job: &JobKey);

    /// Returns how many jobs of the same lane come before a job; `None` if the job is not in the queue.
    fn ahead(&self, job: &JobKey) -> Option<usize>;

    /// Returns how many jobs wait in a lane.
    fn waiting(&self, lane: Lane) -> usize;
}

/// A job that was taken out of the queue. If it is dropped before [`done`](Leased::done), the job returns to the front
/// of the queue.
#[derive(Debug)]
pub struct Leased {
    /// The job and its place.
    pub item: QueuedJob,
    /// The handle that returns the job to the queue.
    pub lease: Box<dyn Lease>,
}

impl Leased {
    /// Declares that the job needs no further turn.
    pub fn done(self) {
        self.lease.done();
    }
}

/// The handle of a taken job; dropping it returns the job to its queue.
pub trait Lease: Debug + Send {
    /// Ends the lease without returning the job to the queue.
    fn done(self: Box<Self>);
}
