//! "Should I stop?": one atomic flag, asked between pieces of work.

use std::fmt;
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// Handle of one computation, shared by whoever runs it and whoever may stop it.
///
/// Long loops call [`Watch::check`] at least every 65,536 rows or once a tile, and [`Watch::advance`] by the work they
/// finished, in the units of the forecast (rows). Clones share the state.
#[derive(Debug, Clone, Default)]
pub struct Watch(Arc<State>);

#[derive(Default)]
struct State {
    /// Zero while it may go on, else [`STOPPED`] and [`SET_ASIDE`] as far as they hold.
    halted: AtomicU8,
    done: AtomicU64,
    observer: OnceLock<Box<dyn Fn(Stage) + Send + Sync>>,
}

/// It is to end.
const STOPPED: u8 = 1;
/// It is to make room, and will be begun again.
const SET_ASIDE: u8 = 2;

impl fmt::Debug for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "halted: {:?}, done: {:?}", self.halted, self.done)
    }
}

/// What a computation is about to do; whoever watches it keeps the time, as jobs have no clock.
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
        self.0.halted.fetch_or(STOPPED, Ordering::Relaxed);
    }

    /// Asks every loop under this watch to end for now; see [`Watch::begin_again`].
    pub fn set_aside(&self) {
        self.0.halted.fetch_or(SET_ASIDE, Ordering::Relaxed);
    }

    /// Whether the work was set aside and not stopped.
    pub fn is_set_aside(&self) -> bool {
        self.0.halted.load(Ordering::Relaxed) == SET_ASIDE
    }

    /// Lets work that was set aside be begun again from nothing; what was stopped stays stopped.
    pub fn begin_again(&self) {
        self.0.halted.fetch_and(!SET_ASIDE, Ordering::Relaxed);
        self.0.done.store(0, Ordering::Relaxed);
    }

    /// Answers "go on" or [`Stopped`].
    ///
    /// # Errors
    /// [`Stopped`] after [`Watch::stop`] or [`Watch::set_aside`].
    pub fn check(&self) -> Result<(), Stopped> {
        if self.0.halted.load(Ordering::Relaxed) == 0 { Ok(()) } else { Err(Stopped) }
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
