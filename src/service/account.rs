//! The memory account: code that allocates memory for a request first takes the bytes from a share here.
//!
//! The memory budget of the service is divided once, at the start, into independent shares: request bodies while they
//! arrive, requests while they are read, inputs of jobs, records of jobs, responses being sent, the two lanes of
//! computations, and the memory cache. When a share is empty, the caller waits or the request is refused with a time to
//! retry; nothing is allocated before its bytes are taken.

use std::collections::VecDeque;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use tokio::sync::oneshot;

use super::lock::lock;

/// The shares of one service.
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
    /// Responses being sent to clients.
    pub answers: Arc<Share>,
    /// Computations of the short lane.
    pub short: Arc<Share>,
    /// Computations of the long lane.
    pub long: Arc<Share>,
    /// Capacity of the memory cache in bytes.
    pub cache_bytes: u64,
    /// Memory for uploads in bytes, used if nothing is stored on disk.
    pub uploads_bytes: u64,
    /// Memory for intermediate work that later computations reuse, in bytes.
    pub work_bytes: u64,
}

impl Account {
    /// Divides `total` bytes: the cache gets `cache` bytes, but at most a quarter; a sixteenth each goes to reading,
    /// answers, and the short lane; a thirty-second each to bodies and to inputs; a sixty-fourth to [buffers that are
    /// kept](kept_buffers), and half as much each to records and to uploads; a ninety-sixth to kept work; the long lane
    /// gets the rest, which is more than two fifths.
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

    /// Returns all shares, in the order in which a request uses them.
    pub fn shares(&self) -> [&Arc<Share>; 7] {
        [&self.bodies, &self.reading, &self.inputs, &self.short, &self.long, &self.answers, &self.records]
    }
}

/// Returns how many bytes of a total large buffers may take between computations: by default 192 MiB, the points of
/// eight million faces, or a picture of five million triangles. Half of it would make results of more than half as many
/// need fresh pages; with twice of it, results of twice as many would not need any either.
pub const fn kept_buffers(total: u64) -> u64 {
    total / 64
}

/// A part of the memory budget, with a line of tasks that wait for bytes of it.
pub struct Share {
    /// The name, one of a closed set.
    pub name: &'static str,
    /// The size in bytes.
    pub capacity: u64,
    state: Mutex<ShareState>,
    refused: AtomicU64,
}

#[derive(Default)]
struct ShareState {
    taken: u64,
    most: u64,
    waiting: VecDeque<(u64, oneshot::Sender<Reservation>)>,
}

impl ShareState {
    /// Removes waiters that have been dropped.
    fn forget_those_who_left(&mut self) {
        self.waiting.retain(|(_, grant)| !grant.is_closed());
    }
}

/// The usage of a share.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShareUsage {
    /// Bytes taken now.
    pub taken: u64,
    /// The largest number of bytes taken at once so far.
    pub most: u64,
    /// Number of refusals so far.
    pub refused: u64,
}

/// The share has too few bytes left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Full;

/// Bytes taken from a share; dropping the value gives them back.
pub struct Reservation {
    share: Arc<Share>,
    bytes: u64,
}

impl fmt::Debug for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {} bytes, {:?}", self.name, self.capacity, self.usage())
    }
}

impl fmt::Debug for Reservation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} bytes of {}", self.bytes, self.share.name)
    }
}

impl Share {
    /// Creates a share of `capacity` bytes.
    pub fn new(name: &'static str, capacity: u64) -> Self {
        Self { name, capacity, state: Mutex::default(), refused: AtomicU64::new(0) }
    }

    /// Takes bytes without waiting; fails if others wait already, since they come first.
    ///
    /// # Errors
    /// [`Full`], which is counted.
    pub fn try_take(self: &Arc<Self>, bytes: u64) -> Result<Reservation, Full> {
        self.take_if_free(bytes).ok_or_else(|| {
            self.refused.fetch_add(1, Ordering::Relaxed);
            Full
        })
    }

    /// Takes bytes like [`Share::try_take`], for callers that refuse nobody if the bytes are not free, so that a
    /// failure is not counted.
    pub fn take_if_free(self: &Arc<Self>, bytes: u64) -> Option<Reservation> {
        let mut state = lock(&self.state);
        state.forget_those_who_left();
        let is_taken = state.waiting.is_empty() && self.book(&mut state, bytes);
        is_taken.then(|| Reservation { share: Arc::clone(self), bytes })
    }

    /// Takes bytes, waiting in line for them; a request for more than the capacity takes the whole share.
    pub async fn take(self: &Arc<Self>, bytes: u64) -> Reservation {
        let bytes = bytes.min(self.capacity);
        let granted = {
            let mut state = lock(&self.state);
            state.forget_those_who_left();
            if state.waiting.is_empty() && self.book(&mut state, bytes) {
                return Reservation { share: Arc::clone(self), bytes };
            }
            let (grant, granted) = oneshot::channel();
            state.waiting.push_back((bytes, grant));
            granted
        };
        granted.await.expect("a share outlives those who wait for it and drops no one")
    }

    /// Counts bytes as taken and returns true, if that many are left.
    fn book(&self, state: &mut ShareState, bytes: u64) -> bool {
        let taken = state.taken.saturating_add(bytes);
        let fits = taken <= self.capacity;
        if fits {
            state.taken = taken;
            state.most = state.most.max(taken);
        }
        fits
    }

    /// Gives bytes back, and grants them to waiters in the order of arrival.
    fn give_back(self: &Arc<Self>, bytes: u64) {
        let mut state = lock(&self.state);
        state.taken -= bytes;
        let mut granted = Vec::new();
        loop {
            state.forget_those_who_left();
            let Some(&(bytes, _)) = state.waiting.front() else { break };
            if !self.book(&mut state, bytes) {
                break;
            }
            let (bytes, grant) = state.waiting.pop_front().expect("it was just looked at");
            granted.push((grant, Reservation { share: Arc::clone(self), bytes }));
        }
        drop(state);
        // a waiter dropped in the meantime also drops its bytes, which gives them back
        granted.into_iter().for_each(|(grant, held)| drop(grant.send(held)));
    }

    /// Returns the usage.
    pub fn usage(&self) -> ShareUsage {
        let state = lock(&self.state);
        ShareUsage { taken: state.taken, most: state.most, refused: self.refused.load(Ordering::Relaxed) }
    }

    /// Returns whether less than a sixteenth of the share is left, or somebody waits for it.
    pub fn is_full(&self) -> bool {
        let state = lock(&self.state);
        state.taken > self.capacity - self.capacity / 16 || state.waiting.iter().any(|(_, grant)| !grant.is_closed())
    }
}

impl Reservation {
    /// Takes `bytes` more, without waiting.
    ///
    /// # Errors
    /// [`Full`]; the bytes held before are kept.
    pub fn grow(&mut self, bytes: u64) -> Result<(), Full> {
        let mut more = self.share.try_take(bytes)?;
        self.bytes += std::mem::take(&mut more.bytes);
        Ok(())
    }

    /// Gives back all but `bytes` of the bytes held.
    pub fn shrink_to(&mut self, bytes: u64) {
        let over = self.bytes.saturating_sub(bytes);
        self.bytes -= over;
        if over > 0 {
            self.share.give_back(over);
        }
    }

    /// Returns the number of bytes held.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl Drop for Reservation {
    fn drop(&mut self) {
        if self.bytes > 0 {
            self.share.give_back(self.bytes);
        }
    }
}
