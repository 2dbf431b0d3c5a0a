//! "Should I stop?": one atomic flag, asked between pieces of work.

use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// Handle of one computation, shared by whoever runs it and whoever may stop it.
///
/// Long loops call [`Watch::check`] at least every 65,536 rows or once a tile, and [`Watch::advance`] by the work they
/// finished, in the units of the forecast (rows). Clones share the state.
#[derive(Debug, Clone, Default)]
pub struct Watch(Arc<State>);

#[derive(Default)]
struct State {
    stopped: AtomicBool,
    done: AtomicU64,
    observer: OnceLock<Box<dyn Fn(Stage) + Send + Sync>>,
}

impl fmt::Debug for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "stopped: {:?}, done: {:?}", self.stopped, self.done)
    }
}

/// What a computation is about to do; whoever watches it keeps the time, as jobs have no clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Applying operators.
    Refine,
    /// Drawing pixels.
    Render,
    /// Writing bytes.
    Encode,
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

    /// Has `observer` called at the start of every stage; the first observer stays.
    pub fn observe(&self, observer: impl Fn(Stage) + Send + Sync + 'static) {
        let _ = self.0.observer.set(Box::new(observer));
    }

    /// Says that `stage` begins.
    pub fn enter(&self, stage: Stage) {
        if let Some(observer) = self.0.observer.get() {
            observer(stage);
        }
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
