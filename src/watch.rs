//! Cancellation and progress of a computation: one atomic flag that is checked between pieces of work.

use std::fmt;
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// A handle to one computation, shared by the code that runs it and the code that may stop it.
///
/// Long loops call [`Watch::check`] at least every 65,536 rows or once a tile, and [`Watch::advance`] by the work they
/// finished, in the units of the forecast (rows). Clones share the state.
#[derive(Debug, Clone, Default)]
pub struct Watch(Arc<WatchState>);

#[derive(Default)]
struct WatchState {
    /// Zero while the work may continue, otherwise a combination of [`STOPPED`] and [`SET_ASIDE`].
    halted: AtomicU8,
    done: AtomicU64,
    observer: OnceLock<Box<dyn Fn(Stage) + Send + Sync>>,
}

/// Flag of work that is to end for good.
const STOPPED: u8 = 1;
/// Flag of work that is to end for now and will start again later.
const SET_ASIDE: u8 = 2;

impl fmt::Debug for WatchState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "halted: {:?}, done: {:?}", self.halted, self.done)
    }
}

/// A stage of a computation. The observer of a watch measures the time, since jobs have no clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Applying operators.
    Refine,
    /// Applying operators patch by patch.
    Sweep,
    /// Drawing pixels.
    Render,
    /// Writing bytes.
    Encode,
}

/// The computation was stopped or set aside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the computation was stopped")]
pub struct Stopped;

impl Watch {
    /// Creates a watch: not stopped, no work done.
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks every loop under this watch to end.
    pub fn stop(&self) {
        self.0.halted.fetch_or(STOPPED, Ordering::Relaxed);
    }

    /// Asks every loop under this watch to end for now; see [`Watch::begin_again`].
    pub fn set_aside(&self) {
        self.0.halted.fetch_or(SET_ASIDE, Ordering::Relaxed);
    }

    /// Returns whether the work was set aside and not stopped.
    pub fn is_set_aside(&self) -> bool {
        self.0.halted.load(Ordering::Relaxed) == SET_ASIDE
    }

    /// Lets work that was set aside start again from the beginning; stopped work remains stopped.
    pub fn begin_again(&self) {
        self.0.halted.fetch_and(!SET_ASIDE, Ordering::Relaxed);
        self.0.done.store(0, Ordering::Relaxed);
    }

    /// Checks whether the work may continue.
    ///
    /// # Errors
    /// [`Stopped`] after [`Watch::stop`] or [`Watch::set_aside`].
    pub fn check(&self) -> Result<(), Stopped> {
        if self.0.halted.load(Ordering::Relaxed) == 0 { Ok(()) } else { Err(Stopped) }
    }

    /// Sets a function to be called at the start of every stage; only the first call has an effect.
    pub fn observe(&self, observer: impl Fn(Stage) + Send + Sync + 'static) {
        let _ = self.0.observer.set(Box::new(observer));
    }

    /// Reports that `stage` begins.
    pub fn enter(&self, stage: Stage) {
        if let Some(observer) = self.0.observer.get() {
            observer(stage);
        }
    }

    /// Counts `work` more units as done.
    pub fn advance(&self, work: u64) {
        self.0.done.fetch_add(work, Ordering::Relaxed);
    }

    /// Returns the units of work done so far.
    pub fn done(&self) -> u64 {
        self.0.done.load(Ordering::Relaxed)
    }
}
