//! The compute threads: lanes, so that short work never waits behind long work, each with its places, its memory, and a
//! line in which peers take turns.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use tokio::sync::{Semaphore, oneshot};

use super::account::{Account, Share};
use super::line::{Line, LinePlace};
use super::peer::Peer;

pub use super::line::{Memory, Waiting};

/// Predicted milliseconds from which on work counts as long.
/// Half of it sends more to the long lane, which may wait behind large jobs; twice of it makes requests in the short
/// lane wait for each other up to twice as long.
const LONG_MS: u128 = 250;

/// How far compute threads stand back: at 10 they get a tenth of the time of others while these have work, and all of
/// it else. At 5 it would be a third; at 19, a seventieth, other processes of the machine would starve them.
#[cfg(target_os = "linux")]
const COMPUTE_NICENESS: i32 = 10;

/// Which line work waits in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lane {
    /// Requests are parsed, checked and forecast.
    Reading,
    /// Computations that are predicted to be quick.
    Short,
    /// All other computations.
    Long,
}

/// The pool was asked for more than it will queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Busy {
    /// When to come back, from the rate at which work was finished lately.
    pub retry_after: Duration,
}

/// Work panicked, with this message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Panicked(pub String);

/// How many may wait.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bounds {
    /// In each line.
    pub queue: usize,
    /// In each line, of one peer.
    pub queue_a_peer: usize,
}

/// Threads and places in line.
#[derive(Debug)]
pub struct Pool {
    reading: LaneState,
    short: LaneState,
    long: LaneState,
    /// Places of streams that compute.
    pub(super) stream_places: Arc<Semaphore>,
    threads: usize,
}

#[derive(Debug)]
struct LaneState {
    threads: Arc<rayon::ThreadPool>,
    line: Arc<Line>,
    places: usize,
    share: Arc<Share>,
    /// Moving average of the time one piece of work takes, microseconds.
    average_us: AtomicU64,
}

/// The right to compute now.
#[derive(Debug)]
pub struct Turn {
    threads: Arc<rayon::ThreadPool>,
    place: LinePlace,
}

impl Turn {
    /// The memory of the turn, whose place others may take.
    pub(super) fn into_memory(mut self) -> Option<Memory> {
        self.place.memory.take()
    }

    /// Runs work on its threads and ends with it, whoever else has lost interest by then.
    pub fn run<T: Send>(self, work: impl FnOnce() -> T + Send) -> T {
        self.threads.install(work)
    }

    /// Runs work on its threads while the caller does something else. What nobody waits for any more is finished all
    /// the same, in its place.
    ///
    /// # Errors
    /// [`Panicked`].
    pub async fn spawn<T: Send + 'static>(self, work: impl FnOnce() -> T + Send + 'static) -> Result<T, Panicked> {
        self.spawn_keeping(work).await.map(|(outcome, _)| outcome)
    }

    /// As [`Turn::spawn`], but the memory stays with the caller when the place is free again.
    ///
    /// # Errors
    /// [`Panicked`].
    pub async fn spawn_keeping<T: Send + 'static>(
        mut self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Result<(T, Option<Memory>), Panicked> {
        let (done, result) = oneshot::channel();
        let threads = Arc::clone(&self.threads);
        threads.spawn(move || {
            let memory = self.place.memory.take();
            let outcome = catch_unwind(AssertUnwindSafe(work));
            drop(self);
            let _ = done.send(outcome.map(|outcome| (outcome, memory)).map_err(|panic| Panicked(panicked(&*panic))));
        });
        result.await.unwrap_or_else(|_| Err(Panicked("the compute threads ended".to_owned())))
    }
}

impl Pool {
    /// A pool of `threads` threads a lane with the memory of `account`.
    ///
    /// # Errors
    /// When the threads cannot be started.
    pub fn new(threads: usize, account: &Account, bounds: Bounds) -> Result<Self, rayon::ThreadPoolBuildError> {
        Ok(Self {
            reading: LaneState::new("reading", threads, threads, &account.reading, bounds)?,
            short: LaneState::new("short", threads, threads, &account.short, bounds)?,
            long: LaneState::new("long", threads, threads.div_ceil(2), &account.long, bounds)?,
            stream_places: Arc::new(Semaphore::new(threads.div_ceil(2))),
            threads,
        })
    }

    fn lane(&self, lane: Lane) -> &LaneState {
        match lane {
            Lane::Reading => &self.reading,
            Lane::Short => &self.short,
            Lane::Long => &self.long,
        }
    }

    /// The lane of a computation that is predicted to take so long and so much memory.
    pub fn lane_of(&self, time_ms: u128, memory_bytes: u128) -> Lane {
        let is_short = time_ms < LONG_MS && memory_bytes <= u128::from(self.short.share.capacity);
        if is_short { Lane::Short } else { Lane::Long }
    }

    /// A place in line for a turn with so much memory.
    ///
    /// # Errors
    /// [`Busy`] when the line is full, or this peer's part of it.
    pub fn line_up(&self, lane: Lane, peer: Peer, memory_bytes: u128) -> Result<Waiting, Busy> {
        self.lane(lane).line.join(peer, bytes(memory_bytes)).map_err(|_| self.busy(lane))
    }

    /// As [`Pool::line_up`], for work that was let in before and may be waited for by others than its first peer.
    ///
    /// # Errors
    /// [`Busy`] when the line is full.
    pub fn line_up_again(&self, lane: Lane, peer: Peer, memory_bytes: u128) -> Result<Waiting, Busy> {
        self.lane(lane).line.join_again(peer, bytes(memory_bytes)).map_err(|_| self.busy(lane))
    }

    /// Waits for the turn.
    pub async fn turn(&self, lane: Lane, waiting: Waiting) -> Turn {
        Turn { threads: Arc::clone(&self.lane(lane).threads), place: waiting.place().await }
    }

    /// A refusal: come back when the line of this lane will have passed, at least a second from now.
    pub fn busy(&self, lane: Lane) -> Busy {
        self.busy_behind(lane, 0)
    }

    /// As [`Pool::busy`], where so many more wait for the line.
    pub fn busy_behind(&self, lane: Lane, more: usize) -> Busy {
        let state = self.lane(lane);
        let waiting = state.line.waiting().saturating_add(more) as u64;
        let us = state.average_us.load(Ordering::Relaxed).saturating_mul(waiting);
        let us = us / (state.places as u64).max(1);
        Busy { retry_after: Duration::from_micros(us).max(Duration::from_secs(1)) }
    }

    /// How many computations a lane has places for.
    pub fn places(&self, lane: Lane) -> usize {
        self.lane(lane).places
    }

    /// Runs something small on the short lane's threads without standing in line.
    pub fn aside<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.short.threads.install(work)
    }

    /// Runs work on threads of its own, as many as a lane has, which may wait for others.
    ///
    /// # Errors
    /// When the threads cannot be started.
    pub(super) fn spawn_apart(&self, work: impl FnOnce() + Send + 'static) -> Result<(), rayon::ThreadPoolBuildError> {
        // threads end with what was spawned on them
        threads("stream", self.threads).map(|threads| threads.spawn(work))
    }

    /// Remembers how long work in a lane took.
    pub fn finished(&self, lane: Lane, took: Duration) {
        let us = u64::try_from(took.as_micros()).unwrap_or(u64::MAX);
        let average = &self.lane(lane).average_us;
        let before = average.load(Ordering::Relaxed);
        average.store(before - before / 8 + us / 8, Ordering::Relaxed);
    }

    /// How many streams more may compute now.
    pub fn free_stream_places(&self) -> usize {
        self.stream_places.available_permits()
    }

    /// Computations waiting in the short and in the long lane.
    pub fn waiting(&self) -> [usize; 2] {
        [&self.short, &self.long].map(|lane| lane.line.waiting())
    }

    /// Requests that wait to be read.
    pub fn waiting_to_be_read(&self) -> usize {
        self.reading.line.waiting()
    }

    /// The lanes whose lines let nobody more in.
    pub fn full_lanes(&self) -> Vec<&'static str> {
        let lanes = [("reading", &self.reading), ("short-lane", &self.short), ("long-lane", &self.long)];
        lanes.into_iter().filter(|(_, lane)| lane.line.is_full()).map(|(name, _)| name).collect()
    }
}

impl LaneState {
    fn new(
        name: &'static str,
        threads: usize,
        places: usize,
        share: &Arc<Share>,
        bounds: Bounds,
    ) -> Result<Self, rayon::ThreadPoolBuildError> {
        let threads = self::threads(name, threads)?;
        Ok(Self {
            threads: Arc::new(threads),
            line: Line::new(places, Arc::clone(share), bounds.queue, bounds.queue_a_peer),
            places,
            share: Arc::clone(share),
            average_us: AtomicU64::new(100_000),
        })
    }
}

fn threads(name: &'static str, n: usize) -> Result<rayon::ThreadPool, rayon::ThreadPoolBuildError> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(n);
    builder.thread_name(move |i| format!("{name}-{i}")).start_handler(|_| stand_back()).build()
}

/// What a panic said.
pub(super) fn panicked(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "no message".to_owned())
}

fn bytes(memory_bytes: u128) -> u64 {
    u64::try_from(memory_bytes).unwrap_or(u64::MAX)
}

/// Lets this thread compute only where those that answer requests leave time: the system may run more threads than it
/// has cores, and a cached answer or a health check is a matter of microseconds.
fn stand_back() {
    // the niceness of a thread is its own on Linux alone
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::process::nice(COMPUTE_NICENESS) {
        tracing::debug!(%error, "compute threads run at the usual priority");
    }
}
