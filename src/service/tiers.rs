//! The stores in use: a quick one in memory and, if the service has one, a large one on disk.

use std::io::Write;
use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;

use super::clock::{Clock, Monotonic};
use super::disk_counts::DiskCounts;
use super::reads::{PART_PATIENCE, Reads};
use super::store::{ArtifactDescription, LargeSpool, Manifest, MemoryStore, Pin, Store, StoreError, Usage, part_of};
use super::writer::{StoreWriter, Trouble, UnwrittenArtifact};
use crate::job::key::Key;

/// Artifacts up to this size are copied from disk into memory when they are requested. Half of it would read more
/// artifacts from the disk each time; twice of it would let one artifact evict twice as many small ones.
const PROMOTED_BYTES: u64 = 4 << 20;
/// Maximum time that a lookup waits for the disk; after it the artifact is computed instead. A disk under load reads
/// four mebibytes in this time. Half of it would compute again what a busy disk has; twice of it would wait longer than
/// many results take to compute.
const LOOKUP_PATIENCE: Duration = Duration::from_secs(2);

/// The memory store with the disk store behind it.
#[derive(Debug)]
pub struct Tiers {
    memory: MemoryStore,
    /// Results that are expected to be larger than this go to disk directly.
    small_bytes: u64,
    disk: Option<DiskTier>,
    counts: Arc<DiskCounts>,
}

/// A result that was made and stored.
#[derive(Debug)]
pub struct Stored {
    /// The manifest of the bytes.
    pub manifest: Arc<Manifest>,
    /// The bytes themselves, if no store has them.
    pub loose: Option<Bytes>,
}

/// The disk store with its writer and its readers.
#[derive(Debug)]
struct DiskTier {
    store: Arc<dyn Store>,
    writer: StoreWriter,
    reads: Reads,
}

impl Tiers {
    /// Creates the stores of a service.
    pub fn new(memory_bytes: u64, disk: Option<Arc<dyn Store>>) -> Self {
        Self::with_clock(memory_bytes, disk, Arc::new(Monotonic::default()))
    }

    /// Creates the stores of a service, with a clock that times the disk.
    pub fn with_clock(memory_bytes: u64, disk: Option<Arc<dyn Store>>, clock: Arc<dyn Clock>) -> Self {
        let counts = Arc::<DiskCounts>::default();
        let small_bytes = memory_bytes / 8;
        let disk = disk.map(|store| {
            // the backlog may hold an eighth of the memory cache in addition to it, so that any one small artifact fits
            let writer = StoreWriter::new(store.clone(), small_bytes, Arc::clone(&counts), clock);
            DiskTier { store, writer, reads: Reads::new(Arc::clone(&counts)) }
        });
        Self { memory: MemoryStore::new(memory_bytes), small_bytes, disk, counts }
    }

    /// Returns the manifest of an artifact that is in memory; never blocks. Counts as a use on disk, too.
    pub fn at_hand(&self, key: &Key) -> Option<Arc<Manifest>> {
        if let Some(manifest) = self.memory.manifest(key).ok().flatten() {
            self.disk.as_ref().and_then(|disk| disk.touch(key));
            return Some(manifest);
        }
        match self.waiting(key)? {
            UnwrittenArtifact::Held(manifest, _) => Some(manifest),
            UnwrittenArtifact::Sealed(_) => None,
        }
    }

    /// Returns all bytes of this very artifact, if it is in memory; never blocks. Counts as a use on disk, too.
    pub fn whole_at_hand(&self, manifest: &Arc<Manifest>) -> Option<Bytes> {
        let bytes = self.memory.take(manifest)?;
        self.disk.as_ref().and_then(|disk| disk.touch(&manifest.key));
        Some(bytes)
    }

    fn waiting(&self, key: &Key) -> Option<UnwrittenArtifact> {
        self.disk.as_ref()?.writer.get(key)
    }

    /// Returns the manifest of an artifact from any store, including artifacts that another server put into a shared
    /// store. Small artifacts are copied into memory. If the disk fails or does not answer in time, the artifact counts
    /// as missing.
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

    /// Returns a verified part of an artifact that is in memory; never blocks.
    pub fn part_at_hand(&self, manifest: &Manifest, index: usize) -> Option<Bytes> {
        if let Some(part) = self.memory.part(manifest, index).ok().flatten() {
            return Some(part);
        }
        match self.waiting(&manifest.key)? {
            UnwrittenArtifact::Held(held, bytes) if held.content == manifest.content => part_of(&held, &bytes, index),
            _ => None,
        }
    }

    /// Returns a verified part of an artifact; `None` if it is gone or damaged, or if the disk does not answer in time.
    pub async fn part(&self, manifest: &Arc<Manifest>, index: usize) -> Option<Bytes> {
        match self.part_at_hand(manifest, index) {
            Some(part) => Some(part),
            None => self.part_on_disk(manifest, index).await,
        }
    }

    /// Keeps an artifact on disk, if it is there, until the pin is dropped.
    pub fn pin(&self, key: &Key) -> Option<Pin> {
        Pin::new(&self.disk.as_ref()?.store, *key)
    }

    /// Returns whether an artifact is on disk, or waits in a temporary file to be stored there.
    pub fn is_on_disk(&self, key: &Key) -> bool {
        let stored = self.disk.as_ref().is_some_and(|disk| disk.touch(key).is_some());
        stored || matches!(self.waiting(key), Some(UnwrittenArtifact::Sealed(_)))
    }

    /// Returns a verified part of an artifact on disk; `None` if it is missing or damaged, or if the disk does not
    /// answer in time.
    pub async fn part_on_disk(&self, manifest: &Arc<Manifest>, index: usize) -> Option<Bytes> {
        let disk = self.disk.as_ref()?;
        let (store, waiting, of) = (disk.store.clone(), self.waiting(&manifest.key), Arc::clone(manifest));
        let read = disk.reads.read(PART_PATIENCE, move || {
            if let Some(UnwrittenArtifact::Sealed(sealed)) =
                waiting.filter(|waiting| waiting.manifest().content == of.content)
                && let Some(part) = sealed.part(index)?
            {
                return Ok(Some(part));
            }
            store.part(&of, index)
        });
        read.await.flatten()
    }

    /// Opens a spool on the disk for a new artifact of about this size, if it is too large for memory and the disk
    /// takes it.
    pub(super) fn spool(&self, key: Key, about_bytes: u128) -> Option<Box<dyn LargeSpool>> {
        let large = about_bytes > u128::from(self.small_bytes);
        let disk = self.disk.as_ref().filter(|disk| large && disk.takes(&key))?;
        disk.store.large_spool(key)
    }

    /// Stores an artifact whose bytes are complete: in memory if it fits; otherwise returns the bytes as loose, and
    /// offers them to the disk writer.
    pub(super) fn keep(&self, manifest: Arc<Manifest>, bytes: Bytes) -> Stored {
        if let Ok(manifest) = self.memory.keep(Arc::clone(&manifest), bytes.clone()) {
            return Stored { manifest, loose: None };
        }
        self.offer(&UnwrittenArtifact::Held(Arc::clone(&manifest), bytes.clone()));
        Stored { manifest, loose: Some(bytes) }
    }

    /// Offers an artifact in memory to the disk writer, if there is a disk, so that the artifact outlasts the process.
    /// The writer works in the background, and drops the artifact if its backlog is full.
    pub fn persist(&self, manifest: &Arc<Manifest>) {
        if self.disk.is_some()
            && let Some(bytes) = self.memory.whole(manifest)
        {
            self.offer(&UnwrittenArtifact::Held(Arc::clone(manifest), bytes));
        }
    }

    /// Offers an artifact to the disk writer; returns whether it will be written.
    pub(super) fn offer(&self, waiting: &UnwrittenArtifact) -> bool {
        self.disk.as_ref().is_some_and(|disk| disk.writer.offer(waiting))
    }

    /// Records that the disk did not take the bytes of a computation.
    pub(super) fn failed(&self, error: &StoreError) {
        if let Some(disk) = &self.disk {
            disk.writer.failed(error);
        }
    }

    /// Removes an artifact from all stores. Blocks.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn remove(&self, key: &Key) -> Result<(), StoreError> {
        self.memory.remove(key)?;
        self.disk.as_ref().map_or(Ok(()), |disk| disk.store.remove(key))
    }

    /// Returns the name and the usage of each store.
    pub fn usage(&self) -> Vec<(&'static str, Usage)> {
        let disk = self.disk.as_ref().map(|disk| ("disk", disk.store.usage()));
        [Some(("memory", self.memory.usage())), disk].into_iter().flatten().collect()
    }

    /// Returns the counters of the disk.
    pub fn disk_counts(&self) -> &DiskCounts {
        &self.counts
    }

    /// Returns the number of artifacts that wait for the disk, and the memory they hold in bytes. The service itself
    /// does not call this; tests and users of the library do.
    pub fn disk_backlog(&self) -> (usize, u64) {
        self.disk.as_ref().map_or((0, 0), |disk| disk.writer.backlog())
    }

    /// Reports failing or hanging writes to disk; `None` if the last write succeeded, or failed more than a minute ago.
    /// Never reports a store that servers share, since none of them would be ready then.
    pub fn disk_trouble(&self) -> Option<Trouble> {
        self.disk.as_ref().filter(|disk| !disk.store.is_shared())?.writer.trouble()
    }

    /// Stops the disk writer: waits for its backlog to be written, for at most `patience`, and returns whether it was.
    /// Afterwards nothing is written except writes that hang in the disk, and dropping the stores does not wait.
    pub fn close(&self, patience: Duration) -> bool {
        self.disk.as_ref().is_none_or(|disk| disk.writer.close(patience))
    }
}

impl DiskTier {
    /// Returns the manifest of an artifact, if this process knows that the disk has it; counts as a use and never
    /// waits.
    fn touch(&self, key: &Key) -> Option<Arc<Manifest>> {
        self.store.manifest(key).ok().flatten()
    }

    /// Returns the manifest of an artifact, if the disk has it; queries a shared store if the artifact is not known
    /// here.
    async fn look_up(&self, key: &Key) -> Option<Arc<Manifest>> {
        let known = self.touch(key);
        if known.is_some() || !self.store.is_shared() {
            return known;
        }
        let (store, key) = (self.store.clone(), *key);
        self.reads.read(LOOKUP_PATIENCE, move || store.look_up(&key)).await.flatten()
    }

    /// Returns whether a computation may write to the disk.
    fn takes(&self, key: &Key) -> bool {
        self.store.admit(key, 0).is_ok() && !self.writer.is_stuck()
    }
}

/// Copies an artifact into memory; returns false if its bytes are missing or damaged.
fn promote(memory: &MemoryStore, disk: &dyn Store, manifest: &Manifest) -> Result<bool, StoreError> {
    let mut spool = memory.spool(manifest.key)?;
    for index in 0..manifest.parts.len() {
        let Some(part) = disk.part(manifest, index)? else { return Ok(false) };
        spool.write_all(&part)?;
    }
    spool.commit(ArtifactDescription::of(manifest))?;
    Ok(true)
}
