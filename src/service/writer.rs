//! The disk writer: brings artifacts to disk on few threads of its own, from a bounded backlog that drops when it is
//! full and never blocks.

use std::collections::{HashMap, VecDeque};
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use bytes::Bytes;

use super::clock::Clock;
use super::disk_counts::{DiskCounts, count};
use super::store::{Description, Manifest, Sealed, Store, StoreError};
use crate::job::key::Key;

/// Threads that write. Two, so that one long artifact does not hold up all small ones.
/// One would let small artifacts wait behind a long one; four would share the same disk.
const THREADS: usize = 2;
/// Most artifacts waiting: what two threads write in a minute at a quarter of a second a sync and two syncs each.
/// Half of it leaves artifacts of bursts unwritten sooner; twice of it lets them wait for two minutes.
const MAX_WAITING: usize = 256;
/// Most of them in temporary files, whose bytes do not count towards the capacity of the disk store.
/// Half of it leaves more artifacts unwritten; twice of it lets twice as much stand on the disk beyond the capacity.
const MAX_SEALED: usize = 16;
/// A disk that works for so long on one artifact counts as stuck: at 33 megabytes a second this is a gigabyte.
/// Half of it calls disks stuck that write a gigabyte at less than 67 megabytes a second; twice of it notices after a
/// minute.
const STUCK: Duration = Duration::from_secs(30);
/// How long after its last failure a disk counts as failing when nothing more is written: without traffic, which a
/// service that is not ready may not get, no write could show that it has recovered.
/// Half of it sends traffic back to a disk that may still fail; twice of it keeps a service out of use for longer.
const MEMORY: Duration = Duration::from_mins(1);
/// How long a writer that is dropped lets its threads go on: half of the service's own time to end.
/// Twice of it leaves nothing of that time for the rest; half of it loses more writes.
const LAST_WAIT: Duration = Duration::from_secs(10);

/// An artifact on its way to the disk.
#[derive(Debug, Clone)]
pub(super) enum Waiting {
    /// Its bytes are in memory.
    Held(Arc<Manifest>, Bytes),
    /// Its bytes are in a temporary file.
    Sealed(Arc<dyn Sealed>),
}

impl Waiting {
    pub(super) fn manifest(&self) -> &Arc<Manifest> {
        match self {
            Self::Held(manifest, _) => manifest,
            Self::Sealed(sealed) => sealed.manifest(),
        }
    }

    /// Bytes of memory that are held until it is written.
    fn held_bytes(&self) -> u64 {
        match self {
            Self::Held(_, bytes) => bytes.len() as u64,
            Self::Sealed(_) => 0,
        }
    }

    fn write(&self, store: &dyn Store) -> Result<(), StoreError> {
        match self {
            Self::Sealed(sealed) => sealed.settle().map(drop),
            Self::Held(manifest, bytes) => {
                let mut spool = store.spool(manifest.key)?;
                spool.write_all(bytes)?;
                spool.commit(Description::of(manifest)).map(drop)
            }
        }
    }
}

/// The disk does not do its work.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Trouble {
    /// How long this has been so.
    pub lasts: Duration,
    /// Writes that failed since then.
    pub failures: u64,
    /// What the last one failed of.
    pub reason: String,
}

/// The writer of one store.
#[derive(Debug)]
pub(super) struct Writer(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    store: Arc<dyn Store>,
    max_bytes: u64,
    counts: Arc<DiskCounts>,
    clock: Arc<dyn Clock>,
    /// Held for moments only, never while the disk works.
    backlog: Mutex<Backlog>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Backlog {
    line: VecDeque<Key>,
    /// All that is in line or being written.
    waiting: HashMap<Key, Waiting>,
    held_bytes: u64,
    n_sealed: usize,
    /// Since when each artifact is being written.
    under_way: HashMap<Key, Duration>,
    /// The last large artifact that could not be written: answers may still be reading it.
    given_up: Option<Arc<dyn Sealed>>,
    failing: Option<Failing>,
    threads: usize,
    closed: bool,
    ended: bool,
}

/// Writes that failed, without one between that succeeded.
#[derive(Debug)]
struct Failing {
    since: Duration,
    last: Duration,
    failures: u64,
    reason: String,
}

impl Writer {
    /// Starts the threads. No more than `max_bytes` of memory wait for the disk.
    pub(super) fn new(store: Arc<dyn Store>, max_bytes: u64, counts: Arc<DiskCounts>, clock: Arc<dyn Clock>) -> Self {
        let (backlog, changed) = (Mutex::new(Backlog { threads: THREADS, ..Backlog::default() }), Condvar::new());
        let shared = Arc::new(Shared { store, max_bytes, counts, clock, backlog, changed });
        for number in 0..THREADS {
            let of_thread = Arc::clone(&shared);
            let started = thread::Builder::new().name(format!("disk-{number}")).spawn(move || of_thread.work());
            if let Err(error) = started {
                tracing::error!(%error, "a thread that writes to disk could not be started");
                shared.leave();
            }
        }
        Self(shared)
    }

    /// Takes an artifact on, unless there is no room for it or the store cannot take it; says whether it did. An
    /// artifact with the same bytes that waits already counts as taken. Never waits for the disk.
    pub(super) fn offer(&self, waiting: &Waiting) -> bool {
        let Shared { store, counts, .. } = &*self.0;
        let manifest = waiting.manifest();
        if let Err(error) = store.admit(&manifest.key, manifest.length) {
            count(&counts.dropped_unfit);
            tracing::debug!(key = %manifest.key, %error, "the artifact is not brought to disk");
            return false;
        }
        let mut backlog = self.0.backlog();
        if let Some(present) = backlog.waiting.get(&manifest.key) {
            return present.manifest().content == manifest.content;
        }
        if backlog.closed || !backlog.has_room(waiting, self.0.max_bytes) {
            count(if backlog.closed { &counts.dropped_at_end } else { &counts.dropped_full });
            return false;
        }
        backlog.put(waiting.clone());
        self.0.changed.notify_all();
        true
    }

    /// What is known of an artifact that waits, or of the last large one that could not be written.
    pub(super) fn get(&self, key: &Key) -> Option<Waiting> {
        let backlog = self.0.backlog();
        let given_up = || backlog.given_up.as_ref().filter(|sealed| sealed.manifest().key == *key);
        backlog.waiting.get(key).cloned().or_else(|| given_up().cloned().map(Waiting::Sealed))
    }

    /// Artifacts that wait, and the memory that they hold.
    pub(super) fn backlog(&self) -> (usize, u64) {
        let backlog = self.0.backlog();
        (backlog.waiting.len(), backlog.held_bytes)
    }

    /// Notes that a write outside of the writer's threads failed.
    pub(super) fn failed(&self, error: &StoreError) {
        self.0.note(&mut self.0.backlog(), error);
    }

    /// Whether writes fail, or one of them does not end; `None` after a write that succeeded, and some time after the
    /// last one that failed.
    pub(super) fn trouble(&self) -> Option<Trouble> {
        let (backlog, now) = (self.0.backlog(), self.0.clock.now());
        if let Some(Failing { since, last, failures, reason }) = &backlog.failing
            && now.saturating_sub(*last) < MEMORY
        {
            let lasts = now.saturating_sub(*since);
            return Some(Trouble { lasts, failures: *failures, reason: reason.clone() });
        }
        let lasts = now.saturating_sub(*backlog.under_way.values().min()?);
        let reason = format!("a write has not ended for {} s", lasts.as_secs());
        (lasts >= STUCK).then_some(Trouble { lasts, failures: 0, reason })
    }

    /// Whether a write does not end.
    pub(super) fn is_stuck(&self) -> bool {
        let (backlog, now) = (self.0.backlog(), self.0.clock.now());
        backlog.under_way.values().any(|&since| now.saturating_sub(since) >= STUCK)
    }

    /// Takes nothing more on, and waits until all that waits is written and the store closed, at most so long; says
    /// whether it was. What is left then is dropped, except for writes that are under way.
    pub(super) fn close(&self, patience: Duration) -> bool {
        let mut backlog = self.0.backlog();
        backlog.closed = true;
        self.0.changed.notify_all();
        let waited = self.0.changed.wait_timeout_while(backlog, patience, |backlog| !backlog.ended);
        let (mut backlog, _) = waited.unwrap_or_else(PoisonError::into_inner);
        let left = std::mem::take(&mut backlog.line);
        let left: Vec<_> = left.iter().filter_map(|key| backlog.take(key)).collect();
        let ended = backlog.ended;
        drop(backlog);
        if !left.is_empty() {
            tracing::warn!(artifacts = left.len(), "the disk did not take all artifacts in time; they are dropped");
        }
        left.iter().for_each(|_| count(&self.0.counts.dropped_at_end));
        ended
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        let closed = self.0.backlog().closed;
        if !closed {
            self.close(LAST_WAIT);
        }
    }
}

impl Backlog {
    fn has_room(&self, waiting: &Waiting, max_bytes: u64) -> bool {
        let sealed = matches!(waiting, Waiting::Sealed(_));
        self.waiting.len() < MAX_WAITING
            && self.held_bytes.saturating_add(waiting.held_bytes()) <= max_bytes
            && !(sealed && self.n_sealed >= MAX_SEALED)
    }

    fn put(&mut self, waiting: Waiting) {
        let key = waiting.manifest().key;
        self.held_bytes += waiting.held_bytes();
        self.n_sealed += usize::from(matches!(waiting, Waiting::Sealed(_)));
        self.line.push_back(key);
        self.waiting.insert(key, waiting);
    }

    fn take(&mut self, key: &Key) -> Option<Waiting> {
        let waiting = self.waiting.remove(key)?;
        self.held_bytes -= waiting.held_bytes();
        self.n_sealed -= usize::from(matches!(waiting, Waiting::Sealed(_)));
        Some(waiting)
    }
}

impl Shared {
    /// Every change under this lock is complete before anything can panic, so a poisoned lock guards sound values.
    fn backlog(&self) -> MutexGuard<'_, Backlog> {
        self.backlog.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes what comes until the writer is closed.
    fn work(&self) {
        while let Some((key, waiting)) = self.next() {
            let written = catch_unwind(AssertUnwindSafe(|| waiting.write(&*self.store)));
            let written = written.unwrap_or_else(|_| Err(std::io::Error::other("writing panicked").into()));
            self.finish(&key, waiting, written);
        }
        self.leave();
    }

    fn next(&self) -> Option<(Key, Waiting)> {
        let idle = |backlog: &mut Backlog| backlog.line.is_empty() && !backlog.closed;
        let waited = self.changed.wait_while(self.backlog(), idle);
        let mut backlog = waited.unwrap_or_else(PoisonError::into_inner);
        let key = backlog.line.pop_front()?;
        let waiting = backlog.waiting.get(&key).cloned()?;
        backlog.under_way.insert(key, self.clock.now());
        Some((key, waiting))
    }

    fn finish(&self, key: &Key, waiting: Waiting, written: Result<(), StoreError>) {
        if let Err(error) = &written
            && !matches!(error, StoreError::Away { .. })
        {
            tracing::warn!(%key, %error, "the artifact could not be brought to disk");
        }
        count(match &written {
            Ok(()) => &self.counts.written,
            Err(StoreError::Io(_)) => &self.counts.dropped_failed,
            Err(StoreError::Away { .. }) => &self.counts.dropped_away,
            Err(StoreError::TooLarge { .. } | StoreError::Occupied { .. } | StoreError::InUse) => {
                &self.counts.dropped_unfit
            }
        });
        let mut backlog = self.backlog();
        backlog.under_way.remove(key);
        let mut left = (backlog.take(key), None); // files are removed after the lock
        match (written, waiting) {
            (Ok(()), _) => backlog.failing = None,
            (Err(error), waiting) => {
                self.note(&mut backlog, &error);
                if let Waiting::Sealed(sealed) = waiting {
                    left.1 = backlog.given_up.replace(sealed);
                }
            }
        }
        drop(backlog);
    }

    fn note(&self, backlog: &mut Backlog, error: &StoreError) {
        let StoreError::Io(error) = error else { return };
        let (last, reason) = (self.clock.now(), error.to_string());
        let (since, failures) = backlog.failing.as_ref().map_or((last, 0), |failing| (failing.since, failing.failures));
        backlog.failing = Some(Failing { since, last, failures: failures + 1, reason });
    }

    /// Ends a thread; the last one closes the store.
    fn leave(&self) {
        let mut backlog = self.backlog();
        backlog.threads -= 1;
        if backlog.threads > 0 {
            return;
        }
        backlog.closed = true;
        let given_up = backlog.given_up.take();
        drop(backlog);
        drop(given_up);
        self.store.close();
        self.backlog().ended = true;
        self.changed.notify_all();
    }
}
