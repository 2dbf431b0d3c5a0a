//! The disk writer: writes artifacts to disk on a few threads of its own, from a bounded backlog that never blocks and
//! drops artifacts when it is full.

use std::collections::{HashMap, VecDeque};
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use bytes::Bytes;

use super::clock::Clock;
use super::disk_counts::{DiskCounts, count};
use super::lock::lock;
use super::store::{ArtifactDescription, Manifest, Sealed, Store, StoreError};
use crate::job::key::Key;

/// Number of writing threads. One would let small artifacts wait behind a long one; four would share the same disk.
const WRITING_THREADS: usize = 2;
/// Maximum number of waiting artifacts: what two threads write in a minute at a quarter of a second a sync and two
/// syncs each. Half as many would leave artifacts of bursts unwritten sooner; twice as many would wait for two minutes.
const MAX_WAITING_ARTIFACTS: usize = 256;
/// Maximum number of waiting artifacts in temporary files, whose bytes do not count towards the capacity of the disk
/// store. Half as many would leave more artifacts unwritten; twice as many would let twice as much exceed the capacity
/// on the disk.
const MAX_SEALED: usize = 16;
/// Time after which a write that has not ended marks the disk as stuck: at 33 megabytes a second this is a gigabyte.
/// Half of it would call disks stuck that write a gigabyte at less than 67 megabytes a second; twice of it would notice
/// after a minute.
const STUCK_TIME: Duration = Duration::from_secs(30);
/// Time for which a disk counts as failing after its last failure, if nothing more is written: without traffic, which a
/// service that is not ready may not get, no write could show that the disk has recovered. Half of it would send
/// traffic back to a disk that may still fail; twice of it would keep a service out of use for longer.
const FAILING_TIME: Duration = Duration::from_mins(1);
/// How long a dropped writer of artifacts or records waits for its threads: half of the service's own time to end.
/// Twice of it would leave nothing of that time for the rest; half of it would lose more writes.
pub(super) const LAST_WAIT: Duration = Duration::from_secs(10);

/// An artifact that waits to be written to disk.
#[derive(Debug, Clone)]
pub(super) enum UnwrittenArtifact {
    /// An artifact whose bytes are in memory.
    Held(Arc<Manifest>, Bytes),
    /// An artifact whose bytes are in a temporary file.
    Sealed(Arc<dyn Sealed>),
}

impl UnwrittenArtifact {
    pub(super) fn manifest(&self) -> &Arc<Manifest> {
        match self {
            Self::Held(manifest, _) => manifest,
            Self::Sealed(sealed) => sealed.manifest(),
        }
    }

    /// Returns the memory held until the artifact is written, in bytes.
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
                spool.commit(ArtifactDescription::of(manifest)).map(drop)
            }
        }
    }
}

/// A disk that fails or hangs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Trouble {
    /// Duration of the trouble so far.
    pub duration: Duration,
    /// Number of writes that failed in this time.
    pub failures: u64,
    /// The error of the last failed write, or how long a write has been hanging.
    pub reason: String,
}

/// The writer of one store.
#[derive(Debug)]
pub(super) struct StoreWriter(Arc<SharedWriter>);

#[derive(Debug)]
struct SharedWriter {
    store: Arc<dyn Store>,
    max_bytes: u64,
    counts: Arc<DiskCounts>,
    clock: Arc<dyn Clock>,
    /// Locked only briefly, never while the disk works.
    backlog: Mutex<Backlog>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Backlog {
    line: VecDeque<Key>,
    /// All artifacts that wait or are being written.
    waiting: HashMap<Key, UnwrittenArtifact>,
    held_bytes: u64,
    n_sealed: usize,
    /// The start times of the writes under way.
    under_way: HashMap<Key, Duration>,
    /// The last large artifact that could not be written: responses may still be reading it.
    given_up: Option<Arc<dyn Sealed>>,
    failing: Option<Failing>,
    threads: usize,
    closed: bool,
    ended: bool,
}

/// A series of failed writes without a successful one in between.
#[derive(Debug)]
struct Failing {
    since: Duration,
    last: Duration,
    failures: u64,
    reason: String,
}

impl StoreWriter {
    /// Starts the threads. The waiting artifacts hold at most `max_bytes` of memory.
    pub(super) fn new(store: Arc<dyn Store>, max_bytes: u64, counts: Arc<DiskCounts>, clock: Arc<dyn Clock>) -> Self {
        let (backlog, changed) =
            (Mutex::new(Backlog { threads: WRITING_THREADS, ..Backlog::default() }), Condvar::new());
        let shared = Arc::new(SharedWriter { store, max_bytes, counts, clock, backlog, changed });
        for number in 0..WRITING_THREADS {
            let of_thread = Arc::clone(&shared);
            let started = thread::Builder::new().name(format!("disk-{number}")).spawn(move || of_thread.work());
            if let Err(error) = started {
                tracing::error!(%error, "a thread that writes to disk could not be started");
                shared.leave();
            }
        }
        Self(shared)
    }

    /// Adds an artifact to the backlog, unless there is no room for it or the store cannot take it; returns whether it
    /// will be written. An artifact with the same bytes that waits already counts as added. Never waits for the disk.
    pub(super) fn offer(&self, waiting: &UnwrittenArtifact) -> bool {
        let SharedWriter { store, counts, .. } = &*self.0;
        let manifest = waiting.manifest();
        if let Err(error) = store.admit(&manifest.key, manifest.length) {
            count(&counts.dropped_unfit);
            tracing::debug!(key = %manifest.key, %error, "the artifact is not brought to disk");
            return false;
        }
        let mut backlog = lock(&self.0.backlog);
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

    /// Returns an artifact that waits, or the last large one that could not be written.
    pub(super) fn get(&self, key: &Key) -> Option<UnwrittenArtifact> {
        let backlog = lock(&self.0.backlog);
        let given_up = || backlog.given_up.as_ref().filter(|sealed| sealed.manifest().key == *key);
        backlog.waiting.get(key).cloned().or_else(|| given_up().cloned().map(UnwrittenArtifact::Sealed))
    }

    /// Returns the number of waiting artifacts, and the memory they hold in bytes.
    pub(super) fn backlog(&self) -> (usize, u64) {
        let backlog = lock(&self.0.backlog);
        (backlog.waiting.len(), backlog.held_bytes)
    }

    /// Records the failure of a write outside the writer's threads.
    pub(super) fn failed(&self, error: &StoreError) {
        self.0.note(&mut lock(&self.0.backlog), error);
    }

    /// Reports failing or hanging writes; `None` after a successful write, and when the last failure is older than
    /// [`FAILING_TIME`].
    pub(super) fn trouble(&self) -> Option<Trouble> {
        let (backlog, now) = (lock(&self.0.backlog), self.0.clock.now());
        if let Some(Failing { since, last, failures, reason }) = &backlog.failing
            && now.saturating_sub(*last) < FAILING_TIME
        {
            let duration = now.saturating_sub(*since);
            return Some(Trouble { duration, failures: *failures, reason: reason.clone() });
        }
        let duration = now.saturating_sub(*backlog.under_way.values().min()?);
        let reason = format!("a write has not ended for {} s", duration.as_secs());
        (duration >= STUCK_TIME).then_some(Trouble { duration, failures: 0, reason })
    }

    /// Returns whether a write hangs.
    pub(super) fn is_stuck(&self) -> bool {
        let (backlog, now) = (lock(&self.0.backlog), self.0.clock.now());
        backlog.under_way.values().any(|&since| now.saturating_sub(since) >= STUCK_TIME)
    }

    /// Closes the backlog, waits for at most `patience` until it is written and the store is closed, and returns
    /// whether it was. Artifacts left then are dropped, except for writes under way.
    pub(super) fn close(&self, patience: Duration) -> bool {
        let mut backlog = lock(&self.0.backlog);
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

impl Drop for StoreWriter {
    fn drop(&mut self) {
        let closed = lock(&self.0.backlog).closed;
        if !closed {
            self.close(LAST_WAIT);
        }
    }
}

impl Backlog {
    fn has_room(&self, waiting: &UnwrittenArtifact, max_bytes: u64) -> bool {
        let sealed = matches!(waiting, UnwrittenArtifact::Sealed(_));
        self.waiting.len() < MAX_WAITING_ARTIFACTS
            && self.held_bytes.saturating_add(waiting.held_bytes()) <= max_bytes
            && !(sealed && self.n_sealed >= MAX_SEALED)
    }

    fn put(&mut self, waiting: UnwrittenArtifact) {
        let key = waiting.manifest().key;
        self.held_bytes += waiting.held_bytes();
        self.n_sealed += usize::from(matches!(waiting, UnwrittenArtifact::Sealed(_)));
        self.line.push_back(key);
        self.waiting.insert(key, waiting);
    }

    fn take(&mut self, key: &Key) -> Option<UnwrittenArtifact> {
        let waiting = self.waiting.remove(key)?;
        self.held_bytes -= waiting.held_bytes();
        self.n_sealed -= usize::from(matches!(waiting, UnwrittenArtifact::Sealed(_)));
        Some(waiting)
    }
}

impl SharedWriter {
    /// Writes artifacts until the writer is closed and its backlog is empty.
    fn work(&self) {
        while let Some((key, waiting)) = self.next() {
            let written = catch_unwind(AssertUnwindSafe(|| waiting.write(&*self.store)));
            let written = written.unwrap_or_else(|_| Err(std::io::Error::other("writing panicked").into()));
            self.finish(&key, waiting, written);
        }
        self.leave();
    }

    fn next(&self) -> Option<(Key, UnwrittenArtifact)> {
        let idle = |backlog: &mut Backlog| backlog.line.is_empty() && !backlog.closed;
        let waited = self.changed.wait_while(lock(&self.backlog), idle);
        let mut backlog = waited.unwrap_or_else(PoisonError::into_inner);
        let key = backlog.line.pop_front()?;
        let waiting = backlog.waiting.get(&key).cloned()?;
        backlog.under_way.insert(key, self.clock.now());
        Some((key, waiting))
    }

    fn finish(&self, key: &Key, waiting: UnwrittenArtifact, written: Result<(), StoreError>) {
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
        let mut backlog = lock(&self.backlog);
        backlog.under_way.remove(key);
        let mut left = (backlog.take(key), None); // dropped after the lock: a drop may remove files
        match (written, waiting) {
            (Ok(()), _) => backlog.failing = None,
            (Err(error), waiting) => {
                self.note(&mut backlog, &error);
                if let UnwrittenArtifact::Sealed(sealed) = waiting {
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
        let mut backlog = lock(&self.backlog);
        backlog.threads -= 1;
        if backlog.threads > 0 {
            return;
        }
        backlog.closed = true;
        let given_up = backlog.given_up.take();
        drop(backlog);
        drop(given_up);
        self.store.close();
        lock(&self.backlog).ended = true;
        self.changed.notify_all();
    }
}
