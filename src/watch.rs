//! "Should I stop?": one atomic flag, asked between pieces of work.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Handle of one computation, shared by whoever runs it and whoever may stop it.
///
/// Long loops call [`Watch::check`] at least every 65,536 rows or once a tile, and [`Watch::advance`] by the work they
/// finished, in the units of the forecast (rows). Clones share the state.
#[derive(Debug, Clone, Default)]
pub struct Watch(Arc<State>);

#[derive(Debug, Default)]
struct State {
    stopped: AtomicBool,
    done: AtomicU64,
}

/// The computation was asked to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the computation was stopped")]
pub struct Stopped;

impl Watch {
    /// A fresh watch: not stopped, no work done.
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks every loop under this watch to end.
    pub fn stop(&self) {
        self.0.stopped.store(true, Ordering::Relaxed);
    }

    /// Answers "go on" or [`Stopped`].
    ///
    /// # Errors
    /// [`Stopped`] after [`Watch::stop`].
    pub fn check(&self) -> Result<(), Stopped> {
        if self.0.stopped.load(Ordering::Relaxed) { Err(Stopped) } else { Ok(()) }
    }

    /// Counts `work` more units as done.
    pub fn advance(&self, work: u64) {
        self.0.done.fetch_add(work, Ordering::Relaxed);
    }

    /// Units of work done so far.
    pub fn done(&self) -> u64 {
        self.0.done.load(Ordering::Relaxed)
    }
}
