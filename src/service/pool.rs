//! The compute threads: two lanes, so that short work never waits behind long work, and a budget of memory.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Predicted milliseconds from which on work counts as long.
const LONG_MS: u128 = 250;
/// Bytes of one unit of the memory budget.
const UNIT_BYTES: u128 = 1 << 20;

/// Which queue a computation waits in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lane {
    /// Predicted to be quick.
    Short,
    /// Anything else.
    Long,
}

impl Lane {
    /// The lane of work that is predicted to take so long.
    pub fn of(time_ms: u128) -> Self {
        if time_ms < LONG_MS { Self::Short } else { Self::Long }
    }
}

/// The pool was asked for more than it will queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Busy {
    /// When to come back, from the rate at which work was finished lately.
    pub retry_after: Duration,
}

/// Threads and places in line.
#[derive(Debug)]
pub struct Pool {
    short: LaneState,
    long: LaneState,
    budget: Arc<Semaphore>,
    budget_units: u32,
    max_queue: usize,
    /// Moving average of the time one computation takes, microseconds.
    average_us: AtomicU64,
}

#[derive(Debug)]
struct LaneState {
    threads: Arc<rayon::ThreadPool>,
    places: Arc<Semaphore>,
    waiting: Arc<AtomicUsize>,
}

/// A place in line: counts as waiting until it is dropped.
#[derive(Debug)]
pub struct Waiting(Arc<AtomicUsize>);

impl Drop for Waiting {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// The right to compute now.
#[derive(Debug)]
pub struct Turn {
    threads: Arc<rayon::ThreadPool>,
    _place: OwnedSemaphorePermit,
    _memory: OwnedSemaphorePermit,
}

impl Turn {
    /// Runs work on its threads and ends with it, whoever else has lost interest by then.
    pub fn run<T: Send>(self, work: impl FnOnce() -> T + Send) -> T {
        self.threads.install(work)
    }
}

impl Pool {
    /// A pool of `threads` threads a lane, `memory_bytes` for all computations at once, `max_queue` waiting a lane.
    ///
    /// # Errors
    /// When the threads cannot be started.
    pub fn new(threads: usize, memory_bytes: u64, max_queue: usize) -> Result<Self, rayon::ThreadPoolBuildError> {
        let budget_units = u32::try_from(u128::from(memory_bytes) / UNIT_BYTES).unwrap_or(u32::MAX >> 3).max(1);
        Ok(Self {
            short: LaneState::new("short", threads, threads)?,
            long: LaneState::new("long", threads, threads.div_ceil(2))?,
            budget: Arc::new(Semaphore::new(budget_units as usize)),
            budget_units,
            max_queue,
            average_us: AtomicU64::new(100_000),
        })
    }

    fn lane(&self, lane: Lane) -> &LaneState {
        match lane {
            Lane::Short => &self.short,
            Lane::Long => &self.long,
        }
    }

    /// A place in line.
    ///
    /// # Errors
    /// [`Busy`] when the line is full.
    pub fn line_up(&self, lane: Lane) -> Result<Waiting, Busy> {
        let waiting = &self.lane(lane).waiting;
        if waiting.fetch_add(1, Ordering::Relaxed) >= self.max_queue {
            waiting.fetch_sub(1, Ordering::Relaxed);
            return Err(Busy { retry_after: self.drain_time(lane) });
        }
        Ok(Waiting(waiting.clone()))
    }

    /// How long the line of a lane will take, at least a second.
    fn drain_time(&self, lane: Lane) -> Duration {
        let state = self.lane(lane);
        let line = state.waiting.load(Ordering::Relaxed) as u64;
        let threads = state.threads.current_num_threads() as u64;
        let us = self.average_us.load(Ordering::Relaxed).saturating_mul(line) / threads.max(1);
        Duration::from_micros(us).max(Duration::from_secs(1))
    }

    /// Waits for a turn with so much memory.
    pub async fn turn(&self, lane: Lane, memory_bytes: u128) -> Turn {
        let state = self.lane(lane);
        let units = u32::try_from(memory_bytes.div_ceil(UNIT_BYTES)).unwrap_or(u32::MAX).clamp(1, self.budget_units);
        let place = state.places.clone().acquire_owned().await.expect("the lane's semaphore is never closed");
        let memory =
            self.budget.clone().acquire_many_owned(units).await.expect("the budget's semaphore is never closed");
        Turn { threads: state.threads.clone(), _place: place, _memory: memory }
    }

    /// Runs something small on the short lane's threads without standing in line.
    pub fn aside<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.short.threads.install(work)
    }

    /// Remembers how long a computation took.
    pub fn finished(&self, took: Duration) {
        let us = u64::try_from(took.as_micros()).unwrap_or(u64::MAX);
        let average = self.average_us.load(Ordering::Relaxed);
        self.average_us.store(average - average / 8 + us / 8, Ordering::Relaxed);
    }

    /// Computations waiting in the short and in the long lane.
    pub fn waiting(&self) -> [usize; 2] {
        [&self.short, &self.long].map(|lane| lane.waiting.load(Ordering::Relaxed))
    }
}

impl LaneState {
    fn new(name: &'static str, threads: usize, places: usize) -> Result<Self, rayon::ThreadPoolBuildError> {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let threads = builder.thread_name(move |i| format!("{name}-{i}")).build()?;
        Ok(Self {
            threads: Arc::new(threads),
            places: Arc::new(Semaphore::new(places.max(1))),
            waiting: Arc::default(),
        })
    }
}
