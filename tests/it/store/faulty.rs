//! A disk that can hang, be full, and fail on request.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};

use planish::service::store::{Disk, Embedded, LocalDisk};

/// A door for operations, which wait while it is closed.
#[derive(Debug, Default)]
pub(crate) struct Door {
    state: Mutex<Behind>,
    opened: Condvar,
}

#[derive(Debug, Default)]
struct Behind {
    closed: bool,
    waiting: usize,
    most: usize,
}

impl Door {
    pub(crate) fn close(&self) {
        self.state.lock().unwrap().closed = true;
    }

    pub(crate) fn open(&self) {
        self.state.lock().unwrap().closed = false;
        self.opened.notify_all();
    }

    /// Returns the number of waiting operations.
    pub(crate) fn waiting(&self) -> usize {
        self.state.lock().unwrap().waiting
    }

    /// Returns the largest number of operations that waited at the same time.
    pub(crate) fn most(&self) -> usize {
        self.state.lock().unwrap().most
    }

    fn pass(&self) {
        let mut behind = self.state.lock().unwrap();
        behind.waiting += 1;
        behind.most = behind.most.max(behind.waiting);
        let mut behind = self.opened.wait_while(behind, |behind| behind.closed).unwrap_or_else(PoisonError::into_inner);
        behind.waiting -= 1;
    }
}

/// A disk with switchable faults; without any it is the disk of the machine.
#[derive(Debug, Default)]
pub(crate) struct Faulty {
    pub(crate) syncs: Door,
    pub(crate) reads: Door,
    /// Number of writes so far.
    pub(crate) writes: AtomicUsize,
    /// The number of following syncs that find the disk full.
    pub(crate) full_syncs: AtomicUsize,
    /// Whether reads fail, 0 or 1.
    pub(crate) broken_reads: AtomicUsize,
    /// A folder, and the maximum total size of its files in bytes.
    room: Mutex<Option<(PathBuf, u64)>>,
}

impl Faulty {
    pub(crate) fn new() -> Arc<Self> {
        Arc::default()
    }

    /// Limits the total size of the files in `folder` from now on.
    pub(crate) fn limit(&self, folder: &Path, bytes: u64) {
        *self.room.lock().unwrap() = Some((folder.to_owned(), bytes));
    }

    pub(crate) fn store(self: &Arc<Self>, folder: &Path, capacity: u64) -> Embedded {
        Embedded::open_on(Arc::clone(self) as Arc<dyn Disk>, folder, capacity).unwrap()
    }
}

/// Returns the bytes of the artifacts in a store, and of those being written.
fn used(folder: &Path) -> u64 {
    let of = |path: &Path| -> u64 {
        let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
        entries
            .filter_map(|entry| entry.metadata().ok())
            .filter(std::fs::Metadata::is_file)
            .map(|about| about.len())
            .sum()
    };
    let shards = std::fs::read_dir(folder.join("artifacts")).into_iter().flatten().flatten();
    of(&folder.join("tmp")) + shards.map(|shard| of(&shard.path())).sum::<u64>()
}

impl Disk for Faulty {
    fn write(&self, file: &mut File, offset: u64, bytes: &[u8]) -> io::Result<()> {
        self.writes.fetch_add(1, Ordering::Relaxed);
        let room = self.room.lock().unwrap().clone();
        if let Some((folder, room)) = room
            && used(&folder) + bytes.len() as u64 > room
        {
            // as on a real disk, a part of the bytes may be written
            LocalDisk.write(file, offset, &bytes[..bytes.len() / 3])?;
            file.set_len(offset)?;
            return Err(io::ErrorKind::StorageFull.into());
        }
        LocalDisk.write(file, offset, bytes)
    }

    fn sync(&self, file: &File) -> io::Result<()> {
        self.syncs.pass();
        let fewer = |n: usize| n.checked_sub(1);
        if self.full_syncs.fetch_update(Ordering::Relaxed, Ordering::Relaxed, fewer).is_ok() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        LocalDisk.sync(file)
    }

    fn read(&self, path: &Path, offset: u64, length: usize) -> io::Result<Vec<u8>> {
        self.reads.pass();
        if self.broken_reads.load(Ordering::Relaxed) > 0 {
            return Err(io::Error::other("the platter is scratched"));
        }
        LocalDisk.read(path, offset, length)
    }
}
