//! The queue of jobs: keys only, in the order of their turns.
//!
//! It dispatches and is no record of truth: what a job is and how it stands is in its [record](super::jobs), and every
//! record that is not settled is put into the queue again when the service starts.

mod interface;
mod local;

pub use interface::{Item, Later, Lease, Leased, Queue, QueueError};
pub use local::Local;
