//! The queue of jobs: keys only, in the order of their turns.
//!
//! The queue only dispatches. The state of a job is in its [record](super::jobs), and every job whose record is not
//! settled is queued again when the service starts.

mod interface;
mod local;

pub use interface::{Later, Lease, Leased, Queue, QueueError, QueuedJob};
pub use local::LocalQueue;
