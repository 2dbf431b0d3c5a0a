//! The account of memory: whoever holds bytes on behalf of a request takes them here before it allocates them.
//!
//! The budget of the service is divided once, at the start, into shares that cannot eat each other: bodies while they
//! arrive, requests while they are read, inputs of jobs that wait, records of jobs, answers on their way, the two lanes
//! of computations, and the cache in memory. Whoever finds a share empty waits, or is told to come back; nobody
//! allocates first.

use std::collections::VecDeque;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::oneshot;

/// All shares of one service.
#[derive(Debug)]
pub struct Account {
    /// Bodies of requests while they arrive and until they are read.
    pub bodies: Arc<Share>,
    /// Requests while they are parsed, checked, and forecast.
    pub reading: Arc<Share>,
    /// Inputs of jobs that wait or run.
    pub inputs: Arc<Share>,
    /// Records of jobs that outlasted their request.
    pub records: Arc<Share>,
    /// Answers on their way to clients.
    pub answers: Arc<Share>,
    /// Computations of the short lane.
    pub short: Arc<Share>,
    /// Computations of the long lane.
    pub long: Arc<Share>,
    /// What the cache in memory may hold, bytes.
    pub cache_bytes: u64,
    /// What uploads may hold in memory, where nothing is kept on disk, bytes.
    pub uploads_bytes: u64,
    /// What work that is kept for later computations may hold, bytes.
    pub work_bytes: u64,
}

impl Account {
    /// Divides `total` bytes: the cache gets `cache` bytes, but at most a quarter; a sixteenth each goes to reading,
    /// answers, and the short lane; a thirty-second each to bodies and to inputs; a sixty-fourth to
    /// [buffers that are kept](kept_buffers), and half as much each to records and to uploads; a ninety-sixth to kept
    /// work; the long lane gets the rest, which is more than two fifths.
    ///
    /// The parts are chosen so that the default of 12 GiB holds a job of 8 GiB, and reads a body of the default length,
    /// whose parsing may take 36 times its bytes.
    pub fn new(total: u64, cache: u64) -> Self {
        let share = |name, part: u64| Arc::new(Share::new(name, total / part));
        let cache_bytes = cache.min(total / 4);
        let (bodies, reading, inputs) = (share("bodies", 32), share("reading", 16), share("inputs", 32));
        let (records, answers, short) = (share("records", 128), share("answers", 16), share("short-lane", 16));
        let given: u64 =
            [&bodies, &reading, &inputs, &records, &answers, &short].iter().map(|share| share.capacity).sum();
        let (uploads_bytes, work_bytes) = (total / 128, total / 96);
        let kept = cache_bytes + uploads_bytes + work_bytes + kept_buffers(total);
        let long = Arc::new(Share::new("long-lane", total.saturating_sub(given + kept)));
        Self { bodies, reading, inputs, records, answers, short, long, cache_bytes, uploads_bytes, work_bytes }
    }

    /// All shares, in the order of a request's way.
    pub fn shares(&self) -> [&Arc<Share>; 7] {
        [&self.bodies, &self.reading, &self.inputs, &self.short, &self.long, &self.answers, &self.records]
    }
}

/// Bytes of a total that large buffers may take between computations: by default 192 MiB, the points of eight million
/// faces. With half of it results of 16 million faces need no fresh pages either; with twice of it those of more than
/// four million do.
pub const fn kept_buffers(total: u64) -> u64 {
    total / 64
}

/// A part of the budget, with those who wait for it.
pub struct Share {
    /// Its name, one of a closed set.
    pub name: &'static str,
    /// Bytes it has in all.
    pub capacity: u64,
    state: Mutex<State>,
    refused: AtomicU64,
}

#[derive(Default)]
struct State {
    taken: u64,
    most: u64,
    waiting: VecDeque<(u64, oneshot::Sender<Held>)>,
}

impl State {
    /// Takes those out of the line who wait no longer.
    fn forget_those_who_left(&mut self) {
        self.waiting.retain(|(_, grant)| !grant.is_closed());
    }
}

/// How a share stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShareUsage {
    /// Bytes taken now.
    pub taken: u64,
    /// Most bytes that were ever taken at once.
    pub most: u64,
    /// How often somebody was refused.
    pub refused: u64,
}

/// The share has not so many bytes left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Full;

/// Bytes taken from a share; dropping them gives them back.
pub struct Held {
    share: Arc<Share>,
    bytes: u64,
}

impl fmt::Debug for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {} bytes, {:?}", self.name, self.capacity, self.usage())
    }
}

impl fmt::Debug for Held {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} bytes of {}", self.bytes, self.share.name)
    }
}

impl Share {
    /// A share of so many bytes.
    pub fn new(name: &'static str, capacity: u64) -> Self {
        Self { name, capacity, state: Mutex::default(), refused: AtomicU64::new(0) }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes bytes at once; those who wait already come first.
    ///
    /// # Errors
    /// [`Full`], which is counted.
    pub fn try_take(self: &Arc<Self>, bytes: u64) -> Result<Held, Full> {
        let mut state = self.state();
        state.forget_those_who_left();
        if state.waiting.is_empty() && self.book(&mut state, bytes) {
            return Ok(Held { share: Arc::clone(self), bytes });
        }
        drop(state);
        self.refused.fetch_add(1, Ordering::Relaxed);
        Err(Full)
    }

    /// Takes bytes, waiting in line for them; more than the share has in all means all of it.
    pub async fn take(self: &Arc<Self>, bytes: u64) -> Held {
        let bytes = bytes.min(self.capacity);
        let granted = {
            let mut state = self.state();
            state.forget_those_who_left();
            if state.waiting.is_empty() && self.book(&mut state, bytes) {
                return Held { share: Arc::clone(self), bytes };
            }
            let (grant, granted) = oneshot::channel();
            state.waiting.push_back((bytes, grant));
            granted
        };
        granted.await.expect("a share outlives those who wait for it and drops no one")
    }

    /// Counts bytes as taken where they are there.
    fn book(&self, state: &mut State, bytes: u64) -> bool {
        let taken = state.taken.saturating_add(bytes);
        let fits = taken <= self.capacity;
        if fits {
            state.taken = taken;
            state.most = state.most.max(taken);
        }
        fits
    }

    /// Gives bytes back, and gives them to whoever waits first.
    fn give_back(self: &Arc<Self>, bytes: u64) {
        let mut state = self.state();
        state.taken -= bytes;
        let mut granted = Vec::new();
        loop {
            state.forget_those_who_left();
            let Some(&(bytes, _)) = state.waiting.front() else { break };
            if !self.book(&mut state, bytes) {
                break;
            }
            let (bytes, grant) = state.waiting.pop_front().expect("it was just looked at");
            granted.push((grant, Held { share: Arc::clone(self), bytes }));
        }
        drop(state);
        // whoever left in this moment drops what it was given, which comes back here
        granted.into_iter().for_each(|(grant, held)| drop(grant.send(held)));
    }

    /// How it stands.
    pub fn usage(&self) -> ShareUsage {
        let state = self.state();
        ShareUsage { taken: state.taken, most: state.most, refused: self.refused.load(Ordering::Relaxed) }
    }

    /// Whether less than a sixteenth of it is left, or somebody waits for it.
    pub fn is_full(&self) -> bool {
        let state = self.state();
        state.taken > self.capacity - self.capacity / 16 || state.waiting.iter().any(|(_, grant)| !grant.is_closed())
    }
}

impl Held {
    /// Takes so many bytes more at once.
    ///
    /// # Errors
    /// [`Full`]; what was held stays.
    pub fn grow(&mut self, bytes: u64) -> Result<(), Full> {
        let mut more = self.share.try_take(bytes)?;
        self.bytes += std::mem::take(&mut more.bytes);
        Ok(())
    }

    /// Gives back what is held beyond so many bytes.
    pub fn shrink_to(&mut self, bytes: u64) {
        let over = self.bytes.saturating_sub(bytes);
        self.bytes -= over;
        if over > 0 {
            self.share.give_back(over);
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        if self.bytes > 0 {
            self.share.give_back(self.bytes);
        }
    }
}
