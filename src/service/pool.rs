//! The compute threads, in lanes, so that short work never waits behind long work; each lane has its threads, places,
//! memory, and a line in which peers take turns.

use std::any::Any;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use tokio::sync::{Semaphore, oneshot};

use super::account::{Account, Share};
use super::line::{LinePlace, WaitingLine};
use super::peer::Peer;

pub use super::line::{LaneMemory, WaitingRequest};

/// Predicted milliseconds from which work counts as long. Half of it would send more work to the long lane, where it
/// may wait behind large jobs; twice of it would make requests in the short lane wait for each other up to twice as
/// long.
const LONG_MS: u128 = 250;

/// Niceness of compute threads: at 10 they get a tenth of the CPU time of other threads while these have work, and all
/// of it otherwise. At 5 it would be a third; at 19, a seventieth, so that other processes of the machine would starve
/// them.
#[cfg(target_os = "linux")]
const COMPUTE_NICENESS: i32 = 10;

/// A set of compute threads with its own line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lane {
    /// Parsing, checking and forecasting of requests.
    Reading,
    /// Computations that are predicted to be quick.
    Short,
    /// All other computations.
    Long,
}

/// A resource of which there is too little for more work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lack {
    /// Places in the line of a lane.
    Places,
    /// Places of requests that wait for computations.
    Waiting,
    /// Places of jobs that continue without their request.
    Jobs,
    /// Places of batches.
    Batches,
    /// Places of event streams, or memory for what they send.
    Streams,
    /// Memory for request bodies.
    Bodies,
    /// Memory for inputs of jobs.
    Inputs,
    /// Memory for answers.
    Answers,
    /// Memory for records of jobs.
    Records,
    /// Time: the first bytes of a result that is not kept did not come before the client's patience ended.
    Patience,
}

impl fmt::Display for Lack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Places => "as many requests wait in line as may (`max-queue`; `max-queue-per-peer` of one client)",
            Self::Waiting => {
                "as many requests wait for computations as may (3/4 of `max-connections`; `max-queue-per-peer` of one \
                 client)"
            }
            Self::Jobs => "as many jobs wait as may (`max-queue`; `max-queue-per-peer` of one client)",
            Self::Batches => {
                "as many batches are active as may (`max-queue`; a quarter of `max-queue-per-peer` of one client)"
            }
            Self::Streams => {
                "as many event streams are open as may (1/4 of `max-connections`, half of it by one client at most)"
            }
            Self::Bodies => "the memory for request bodies is taken (half of it by one client at most)",
            Self::Inputs => "the memory for inputs of jobs is taken (half of it by one client at most)",
            Self::Answers => "the memory for answers is taken (half of it by one client at most)",
            Self::Records => "the memory for records of jobs is taken (half of it by one client at most)",
            Self::Patience => "the first bytes of the result, which is not kept, did not come in time",
        })
    }
}

/// Refusal of work, since there is no room for it now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Busy {
    /// The resource of which there is too little.
    pub lack: Lack,
    /// Time after which to retry, from the rate at which work was finished recently.
    pub retry_after: Duration,
}

/// A panic of the work, with its message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Panicked(pub String);

/// Maximum numbers of waiting requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QueueBounds {
    /// Maximum number of requests in each line.
    pub queue: usize,
    /// Maximum number of requests of one peer in each line.
    pub queue_a_peer: usize,
}

/// The lanes, with their threads and lines.
#[derive(Debug)]
pub struct Pool {
    reading: LaneState,
    short: LaneState,
    long: LaneState,
    /// The places of streams that compute.
    pub(super) stream_places: Arc<Semaphore>,
    threads: usize,
}

#[derive(Debug)]
struct LaneState {
    threads: Arc<rayon::ThreadPool>,
    line: Arc<WaitingLine>,
    places: usize,
    share: Arc<Share>,
    /// Moving average of the time of one piece of work, in microseconds.
    average_us: AtomicU64,
}

/// A place among the compute threads of a lane: the right to compute now.
#[derive(Debug)]
pub struct ComputePlace {
    threads: Arc<rayon::ThreadPool>,
    place: LinePlace,
}

impl ComputePlace {
    /// Takes the memory out of the place, which is given back.
    pub(super) fn into_memory(mut self) -> Option<LaneMemory> {
        self.place.memory.take()
    }

    /// Runs work on the compute threads and waits for its end, even if nobody else needs the result by then.
    pub fn run<T: Send>(self, work: impl FnOnce() -> T + Send) -> T {
        self.threads.install(work)
    }

    /// Runs work on the compute threads without blocking the caller. If the future is dropped, the work still runs to
    /// its end and keeps its place until then.
    ///
    /// # Errors
    /// [`Panicked`].
    pub async fn spawn<T: Send + 'static>(self, work: impl FnOnce() -> T + Send + 'static) -> Result<T, Panicked> {
        self.spawn_keeping(work).await.map(|(outcome, _)| outcome)
    }

    /// Runs work like [`ComputePlace::spawn`], and also returns the memory of the place, which outlives it.
    ///
    /// # Errors
    /// [`Panicked`].
    pub async fn spawn_keeping<T: Send + 'static>(
        mut self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Result<(T, Option<LaneMemory>), Panicked> {
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
    /// Creates a pool with `threads` threads per lane and the memory of `account`.
    ///
    /// # Errors
    /// When the threads cannot be started.
    pub fn new(threads: usize, account: &Account, bounds: QueueBounds) -> Result<Self, rayon::ThreadPoolBuildError> {
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

    /// Returns the lane of a computation with this predicted time and memory.
    pub fn lane_of(&self, time_ms: u128, memory_bytes: u128) -> Lane {
        let is_short = time_ms < LONG_MS && memory_bytes <= u128::from(self.short.share.capacity);
        if is_short { Lane::Short } else { Lane::Long }
    }

    /// Joins the line of a lane for a place with `memory_bytes` of memory.
    ///
    /// # Errors
    /// [`Busy`] when the line, or this peer's part of it, is full.
    pub fn line_up(&self, lane: Lane, peer: Peer, memory_bytes: u128) -> Result<WaitingRequest, Busy> {
        self.lane(lane).line.join(peer, bytes(memory_bytes)).map_err(|_| self.busy(lane, Lack::Places))
    }

    /// Lines up like [`Pool::line_up`], for work that was admitted earlier and that more peers than the first may wait
    /// for: the number of requests that the peer has in line is no limit.
    ///
    /// # Errors
    /// [`Busy`] when the line is full.
    pub fn line_up_again(&self, lane: Lane, peer: Peer, memory_bytes: u128) -> Result<WaitingRequest, Busy> {
        self.lane(lane).line.join_again(peer, bytes(memory_bytes)).map_err(|_| self.busy(lane, Lack::Places))
    }

    /// Waits for a place among the compute threads of a lane.
    pub async fn compute_place(&self, lane: Lane, waiting: WaitingRequest) -> ComputePlace {
        ComputePlace { threads: Arc::clone(&self.lane(lane).threads), place: waiting.place().await }
    }

    /// Returns a refusal, with the time until the line of this lane will have passed, at least a second.
    pub fn busy(&self, lane: Lane, lack: Lack) -> Busy {
        self.busy_behind(lane, lack, 0)
    }

    /// Returns the refusal of [`Pool::busy`], if `more` pieces of work wait before the line.
    pub fn busy_behind(&self, lane: Lane, lack: Lack, more: usize) -> Busy {
        let state = self.lane(lane);
        let waiting = state.line.waiting().saturating_add(more) as u64;
        let us = state.average_us.load(Ordering::Relaxed).saturating_mul(waiting);
        let us = us / (state.places as u64).max(1);
        Busy { lack, retry_after: Duration::from_micros(us).max(Duration::from_secs(1)) }
    }

    /// Returns the number of places of a lane.
    pub fn places(&self, lane: Lane) -> usize {
        self.lane(lane).places
    }

    /// Runs a small piece of work on the threads of the short lane without waiting in line.
    pub fn aside<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.short.threads.install(work)
    }

    /// Runs work on a new set of threads, as many as a lane has; such work may block.
    ///
    /// # Errors
    /// When the threads cannot be started.
    pub(super) fn spawn_apart(&self, work: impl FnOnce() + Send + 'static) -> Result<(), rayon::ThreadPoolBuildError> {
        // the threads end with the work spawned on them
        threads("stream", self.threads).map(|threads| threads.spawn(work))
    }

    /// Records how long a piece of work in a lane took.
    pub fn finished(&self, lane: Lane, took: Duration) {
        let us = u64::try_from(took.as_micros()).unwrap_or(u64::MAX);
        let average = &self.lane(lane).average_us;
        let before = average.load(Ordering::Relaxed);
        average.store(before - before / 8 + us / 8, Ordering::Relaxed);
    }

    /// Returns how many more streams may compute now. The service itself does not call this; tests and users of the
    /// library do.
    pub fn free_stream_places(&self) -> usize {
        self.stream_places.available_permits()
    }

    /// Returns the numbers of computations that wait in the short and in the long lane.
    pub fn waiting(&self) -> [usize; 2] {
        [&self.short, &self.long].map(|lane| lane.line.waiting())
    }

    /// Returns the number of requests that wait to be read.
    pub fn waiting_to_be_read(&self) -> usize {
        self.reading.line.waiting()
    }

    /// Returns the names of the lanes whose lines are full.
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
        bounds: QueueBounds,
    ) -> Result<Self, rayon::ThreadPoolBuildError> {
        let threads = self::threads(name, threads)?;
        Ok(Self {
            threads: Arc::new(threads),
            line: WaitingLine::new(places, Arc::clone(share), bounds.queue, bounds.queue_a_peer),
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

/// Returns the message of a panic.
pub(super) fn panicked(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "no message".to_owned())
}

fn bytes(memory_bytes: u128) -> u64 {
    u64::try_from(memory_bytes).unwrap_or(u64::MAX)
}

/// Lowers the priority of this thread below those that answer requests: there may be more threads than cores, and a
/// cached response or a health check takes microseconds.
fn stand_back() {
    // only Linux has a niceness per thread
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::process::nice(COMPUTE_NICENESS) {
        tracing::debug!(%error, "compute threads run at the usual priority");
    }
}
