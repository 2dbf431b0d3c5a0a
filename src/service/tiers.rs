//! The stores in use: a quick one in memory, and behind it, where there is one, a large one on disk.

use std::io::Write;
use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;

use super::clock::{Clock, Monotonic};
use super::disk_counts::DiskCounts;
use super::reads::Reads;
use super::store::{Description, LargeSpool, Manifest, Memory, Pin, Store, StoreError, Usage, part_of};
use super::writer::{Trouble, Waiting, Writer};
use crate::job::key::Key;

/// Artifacts up to this size are brought from disk into memory when they are asked for.
/// Half of it reads more artifacts from the disk each time; twice of it lets one artifact evict twice as many small
/// ones.
const PROMOTED_BYTES: u64 = 4 << 20;
/// How long looking an artifact up may wait for the disk; after it the artifact is computed instead. A disk under load
/// reads four mebibytes in this time.
/// Half of it computes again what a busy disk has; twice of it waits longer than many results take to compute.
const LOOKUP_PATIENCE: Duration = Duration::from_secs(2);
/// How long an answer waits for its next part; after it the answer is cut. Less than most clients wait.
/// Half of it cuts more answers under load; twice of it is longer than some clients wait.
const PART_PATIENCE: Duration = Duration::from_secs(10);

/// Memory before disk.
#[derive(Debug)]
pub struct Tiers {
    memory: Memory,
    /// Results that are expected to be larger than this go to disk at once.
    small_bytes: u64,
    disk: Option<DiskTier>,
    counts: Arc<DiskCounts>,
}

/// A result that was made.
#[derive(Debug)]
pub struct Kept {
    /// What is known of the bytes.
    pub manifest: Arc<Manifest>,
    /// The bytes themselves when no store has them.
    pub loose: Option<Bytes>,
}

/// The disk, its writer and its readers.
#[derive(Debug)]
struct DiskTier {
    store: Arc<dyn Store>,
    writer: Writer,
    reads: Reads,
}

impl Tiers {
    /// The stores of a service.
    pub fn new(memory_bytes: u64, disk: Option<Arc<dyn Store>>) -> Self {
        Self::with_clock(memory_bytes, disk, Arc::new(Monotonic::default()))
    }

    /// The stores of a service, with a clock that times the disk.
    pub fn with_clock(memory_bytes: u64, disk: Option<Arc<dyn Store>>, clock: Arc<dyn Clock>) -> Self {
        let counts = Arc::<DiskCounts>::default();
        let small_bytes = memory_bytes / 8;
        let disk = disk.map(|store| {
            // what waits for the disk may hold an eighth of the memory cache beside it: any one small artifact fits
            let writer = Writer::new(store.clone(), small_bytes, Arc::clone(&counts), clock);
            DiskTier { store, writer, reads: Reads::new(Arc::clone(&counts)) }
        });
        Self { memory: Memory::new(memory_bytes), small_bytes, disk, counts }
    }

    /// The manifest of an artifact that is in memory: never blocks. A use here is a use on disk, too.
    pub fn at_hand(&self, key: &Key) -> Option<Arc<Manifest>> {
        if let Some(manifest) = self.memory.manifest(key).ok().flatten() {
            self.disk.as_ref().and_then(|disk| disk.touch(key));
            return Some(manifest);
        }
        match self.waiting(key)? {
            Waiting::Held(manifest, _) => Some(manifest),
            Waiting::Sealed(_) => None,
        }
    }

    /// All bytes of this very artifact, if it is in memory: never blocks. A use here is a use on disk, too.
    pub fn whole_at_hand(&self, manifest: &Arc<Manifest>) -> Option<Bytes> {
        let bytes = self.memory.take(manifest)?;
        self.disk.as_ref().and_then(|disk| disk.touch(&manifest.key));
        Some(bytes)
    }

    fn waiting(&self, key: &Key) -> Option<Waiting> {
        self.disk.as_ref()?.writer.get(key)
    }

    /// The manifest of an artifact wherever it is, another server's included where servers share a store; small ones
    /// are brought into memory. A disk that fails or does not answer in time has nothing.
    pub async fn find(&self, key: &Key) -> Option<Arc<Manifest>> {
        if let Some(manifest) = self.at_hand(key) {
            return Some(manifest);
        }
        if let Some(waiting) = self.waiting(key) {
            return Some(Arc::clone(waiting.manifest()));
        }
        let disk = self.disk.as_ref()?;
        let manifest = disk.look_up(key).await?;
        if manifest.length > PROMOTED_BYTES.min(self.small_bytes) {
            return Some(manifest);
        }
        let (memory, store, of) = (self.memory.clone(), disk.store.clone(), Arc::clone(&manifest));
        let promoted = disk.reads.read(LOOKUP_PATIENCE, move || promote(&memory, &*store, &of)).await?;
        promoted.then_some(manifest)
    }

    /// A verified part of an artifact that is in memory: never blocks.
    pub fn part_at_hand(&self, manifest: &Manifest, index: usize) -> Option<Bytes> {
        if let Some(part) = self.memory.part(manifest, index).ok().flatten() {
            return Some(part);
        }
        match self.waiting(&manifest.key)? {
            Waiting::Held(held, bytes) if held.content == manifest.content => part_of(&held, &bytes, index),
            _ => None,
        }
    }

    /// A verified part of an artifact; `None` when it is gone or was damaged, or the disk does not answer in time.
    pub async fn part(&self, manifest: &Arc<Manifest>, index: usize) -> Option<Bytes> {
        match self.part_at_hand(manifest, index) {
            Some(part) => Some(part),
            None => self.part_on_disk(manifest, index).await,
        }
    }

    /// Keeps an artifact on disk, where it is there, for as long as somebody reads it.
    pub fn pin(&self, key: &Key) -> Option<Pin> {
        Pin::new(&self.disk.as_ref()?.store, *key)
    }

    /// Whether an artifact is on disk, or is about to be without memory of its own.
    pub fn is_on_disk(&self, key: &Key) -> bool {
        let stored = self.disk.as_ref().is_some_and(|disk| disk.touch(key).is_some());
        stored || matches!(self.waiting(key), Some(Waiting::Sealed(_)))
    }

    /// A verified part of an artifact as it stands on disk; `None` when it is not there or was damaged, or the disk
    /// does not answer in time.
    pub async fn part_on_disk(&self, manifest: &Arc<Manifest>, index: usize) -> Option<Bytes> {
        let disk = self.disk.as_ref()?;
        let (store, waiting, of) = (disk.store.clone(), self.waiting(&manifest.key), Arc::clone(manifest));
        let read = disk.reads.read(PART_PATIENCE, move || {
            if let Some(Waiting::Sealed(sealed)) = waiting.filter(|waiting| waiting.manifest().content == of.content)
                && let Some(part) = sealed.part(index)?
            {
                return Ok(Some(part));
            }
            store.part(&of, index)
        });
        read.await.flatten()
    }

    /// A place on the disk for a new artifact of about this size, where it does not fit into memory well.
    pub(super) fn spool(&self, key: Key, about_bytes: u128) -> Option<Box<dyn LargeSpool>> {
        let large = about_bytes > u128::from(self.small_bytes);
        let disk = self.disk.as_ref().filter(|disk| large && disk.takes(&key))?;
        disk.store.large_spool(key)
    }

    /// Keeps an artifact whose bytes are all there: in memory where it fits, else loose, and perhaps on disk later.
    pub(super) fn keep(&self, manifest: Arc<Manifest>, bytes: Bytes) -> Kept {
        if let Ok(manifest) = self.memory.keep(Arc::clone(&manifest), bytes.clone()) {
            return Kept { manifest, loose: None };
        }
        self.offer(&Waiting::Held(Arc::clone(&manifest), bytes.clone()));
        Kept { manifest, loose: Some(bytes) }
    }

    /// Has an artifact that is in memory brought to disk, where there is one, so that it outlasts the process: later,
    /// on the writer's threads, and unless these have too much to do.
    pub fn persist(&self, manifest: &Arc<Manifest>) {
        if self.disk.is_some()
            && let Some(bytes) = self.memory.whole(manifest)
        {
            self.offer(&Waiting::Held(Arc::clone(manifest), bytes));
        }
    }

    /// Has an artifact written; says whether it will be.
    pub(super) fn offer(&self, waiting: &Waiting) -> bool {
        self.disk.as_ref().is_some_and(|disk| disk.writer.offer(waiting))
    }

    /// Notes that the disk did not take the bytes of a computation.
    pub(super) fn failed(&self, error: &StoreError) {
        if let Some(disk) = &self.disk {
            disk.writer.failed(error);
        }
    }

    /// Removes an artifact everywhere. Blocks.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn remove(&self, key: &Key) -> Result<(), StoreError> {
        self.memory.remove(key)?;
        self.disk.as_ref().map_or(Ok(()), |disk| disk.store.remove(key))
    }

    /// What each store holds: its name and usage.
    pub fn usage(&self) -> Vec<(&'static str, Usage)> {
        let disk = self.disk.as_ref().map(|disk| ("disk", disk.store.usage()));
        [Some(("memory", self.memory.usage())), disk].into_iter().flatten().collect()
    }

    /// What happened on the way to and from the disk.
    pub fn disk_counts(&self) -> &DiskCounts {
        &self.counts
    }

    /// Artifacts that wait for the disk, and the memory that they hold.
    pub fn disk_backlog(&self) -> (usize, u64) {
        self.disk.as_ref().map_or((0, 0), |disk| disk.writer.backlog())
    }

    /// Whether writes to disk fail, or one of them does not end; `None` when the last one succeeded, or failed more
    /// than a minute ago. Never of a store that servers share: none of them would be ready then.
    pub fn disk_trouble(&self) -> Option<Trouble> {
        self.disk.as_ref().filter(|disk| !disk.store.is_shared())?.writer.trouble()
    }

    /// Ends the writing to disk: waits until all that waits is written, at most so long. Says whether it was. Nothing
    /// is written afterwards but what a disk that hangs has begun; what drops the stores need not wait then.
    pub fn close(&self, patience: Duration) -> bool {
        self.disk.as_ref().is_none_or(|disk| disk.writer.close(patience))
    }
}

impl DiskTier {
    /// The manifest of an artifact, if it is there; counts as a use and never waits.
    fn touch(&self, key: &Key) -> Option<Arc<Manifest>> {
        self.store.manifest(key).ok().flatten()
    }

    /// The manifest of an artifact, if it is there; asks a store that others share, where it is not known here.
    async fn look_up(&self, key: &Key) -> Option<Arc<Manifest>> {
        let known = self.touch(key);
        if known.is_some() || !self.store.is_shared() {
            return known;
        }
        let (store, key) = (self.store.clone(), *key);
        self.reads.read(LOOKUP_PATIENCE, move || store.look_up(&key)).await.flatten()
    }

    /// Whether a computation may write to it.
    fn takes(&self, key: &Key) -> bool {
        self.store.admit(key, 0).is_ok() && !self.writer.is_stuck()
    }
}

/// Copies an artifact into memory; false when its bytes turned out to be damaged.
fn promote(memory: &Memory, disk: &dyn Store, manifest: &Manifest) -> Result<bool, StoreError> {
    let mut spool = memory.spool(manifest.key)?;
    for index in 0..manifest.parts.len() {
        let Some(part) = disk.part(manifest, index)? else { return Ok(false) };
        spool.write_all(&part)?;
    }
    spool.commit(Description::of(manifest))?;
    Ok(true)
}
