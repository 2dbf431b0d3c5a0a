//! The folder of the embedded store: where each file stands, and how one gets there whole.
//!
//! ```text
//! lock                          held, like the folder itself, by the one process that uses the folder
//! index.redb                    order of use
//! jobs.redb                     records of jobs
//! keys.toml, keys.lock          keys of clients, kept by the commands that change them
//! tmp/<64 hex>.<number>.tmp     being written
//! uploads/                      a folder like this one, with the files that clients sent
//! artifacts/ab/<64 hex>         bytes
//! artifacts/ab/<64 hex>.manifest
//! ```
//!
//! File names come from [`Key`]s and counters only, never from text of a request.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use bytes::Bytes;

use super::disk::Disk;
use super::disk_files::{at, remove_file};
use super::lock::lock;
use super::manifest::Manifest;
use super::parts;
use super::records::{self, RECORDS_FILE};
use crate::fault::shortened;
use crate::job::key::{Key, content};

/// What follows the key in the name of a manifest.
pub(super) const MANIFEST_SUFFIX: &str = ".manifest";
const TMP_SUFFIX: &str = ".tmp";

/// The folder, held by this process alone.
#[derive(Debug)]
pub(super) struct Folder {
    root: PathBuf,
    disk: Arc<dyn Disk>,
    n_tmp: AtomicU64,
    /// Let go by the system when the files are closed, however the process ends.
    locks: Mutex<Vec<File>>,
}

impl Folder {
    /// Makes the folder if need be and takes hold of it.
    pub(super) fn open(root: &Path, disk: Arc<dyn Disk>) -> io::Result<Self> {
        let locks = Mutex::new(take_hold(root)?);
        let make = |path: &Path| fs::create_dir_all(path).map_err(at("make", path));
        make(&root.join("tmp"))?;
        make(&root.join("artifacts"))?;
        let folder = Self { root: root.to_owned(), disk, n_tmp: AtomicU64::new(0), locks };
        folder.sync_folder(root)?;
        Ok(folder)
    }

    /// Lets go of the folder: another process may take it.
    pub(super) fn release(&self) {
        lock(&self.locks).clear();
    }

    pub(super) fn tmp(&self) -> PathBuf {
        self.root.join("tmp")
    }

    pub(super) fn artifacts(&self) -> PathBuf {
        self.root.join("artifacts")
    }

    pub(super) fn index(&self) -> PathBuf {
        self.root.join("index.redb")
    }

    /// Name of the folder of an artifact, one of 256.
    pub(super) fn shard_name(key: &Key) -> String {
        format!("{:02x}", key.as_bytes()[0])
    }

    fn shard(&self, key: &Key) -> PathBuf {
        self.artifacts().join(Self::shard_name(key))
    }

    pub(super) fn bytes(&self, key: &Key) -> PathBuf {
        self.shard(key).join(key.to_string())
    }

    pub(super) fn manifest(&self, key: &Key) -> PathBuf {
        self.shard(key).join(format!("{key}{MANIFEST_SUFFIX}"))
    }

    /// A new, empty file for something of `key`.
    pub(super) fn create_tmp(&self, key: &Key) -> io::Result<Tmp> {
        let folder = self.tmp();
        fs::create_dir_all(&folder).map_err(at("make", &folder))?;
        let path = folder.join(format!("{key}.{}{TMP_SUFFIX}", self.n_tmp.fetch_add(1, Ordering::Relaxed)));
        let file = File::create_new(&path).map_err(at("make", &path))?;
        Ok(Tmp { path, file, disk: Arc::clone(&self.disk), placed: AtomicBool::new(false) })
    }

    /// Makes two written and synced files the artifact of `key`. On failure nothing of it is left under its name.
    ///
    /// One sync of the folder is enough for both names: until it returns nobody was told that the artifact exists, and
    /// of bytes without a manifest, or a manifest without its bytes, the next start sweeps what is there.
    pub(super) fn place(&self, key: &Key, bytes: &Tmp, manifest: &Tmp) -> io::Result<()> {
        let shard = self.shard(key);
        if !shard.is_dir() {
            fs::create_dir_all(&shard).map_err(at("make", &shard))?;
            self.sync_folder(&self.artifacts())?;
            self.sync_folder(&self.root)?;
        }
        let placed = bytes
            .rename(&self.bytes(key))
            .and_then(|()| manifest.rename(&self.manifest(key)))
            .and_then(|()| self.sync_folder(&shard));
        placed.inspect_err(|_| {
            // The first error is the one to tell; the next start sweeps what stays.
            let _ = remove_file(&self.manifest(key));
            bytes.withdraw(&self.bytes(key));
        })
    }

    /// Gives an artifact that is there another manifest, written and synced.
    pub(super) fn describe(&self, key: &Key, manifest: &Tmp) -> io::Result<()> {
        manifest.rename(&self.manifest(key))?;
        self.sync_folder(&self.shard(key))
    }

    /// Whether something that is no file has the name of an artifact or of its manifest: neither can be written then.
    pub(super) fn is_occupied(&self, key: &Key) -> bool {
        self.bytes(key).is_dir() || self.manifest(key).is_dir()
    }

    /// Removes an artifact, its manifest first: without it the artifact does not exist.
    pub(super) fn remove(&self, key: &Key) -> io::Result<()> {
        remove_file(&self.manifest(key))?;
        remove_file(&self.bytes(key))
    }

    /// Makes removals from the folder of `key` last.
    pub(super) fn sync(&self, key: &Key) -> io::Result<()> {
        match self.sync_folder(&self.shard(key)) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            synced => synced,
        }
    }

    /// Makes the names in a folder last.
    fn sync_folder(&self, path: &Path) -> io::Result<()> {
        if cfg!(unix) {
            File::open(path).and_then(|folder| self.disk.sync(&folder)).map_err(at("sync", path))?;
        }
        Ok(())
    }

    /// Reads a part; `None` unless its bytes have the hash in the manifest.
    pub(super) fn read_part(&self, manifest: &Manifest, index: usize) -> io::Result<Option<Bytes>> {
        read_part(&*self.disk, &self.bytes(&manifest.key), manifest, index)
    }
}

/// Reads a part of an artifact from the file that has its bytes; `None` unless they have the hash in the manifest. What
/// is there but is no file counts as damaged.
fn read_part(disk: &dyn Disk, path: &Path, manifest: &Manifest, index: usize) -> io::Result<Option<Bytes>> {
    let Some((start, length)) = parts::span(manifest, index) else { return Ok(None) };
    let bytes = match disk.read(path, start, length) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == io::ErrorKind::NotFound || path.is_dir() => return Ok(None),
        Err(error) => return Err(at("read", path)(error)),
    };
    let sound = manifest.parts.get(index) == Some(&content(&bytes));
    Ok(sound.then(|| Bytes::from(bytes)))
}

/// What a folder of this store has in it; what a system puts into the root of a disk may stand beside it.
const OWN: [&str; 9] =
    ["lock", "index.redb", RECORDS_FILE, "tmp", "artifacts", "uploads", "keys.toml", "keys.lock", "keys.new"];
const OF_SYSTEMS: [&str; 3] = ["lost+found", ".snapshot", ".DS_Store"];

/// Refuses a folder that holds something else, or records that are damaged, before anything in it is touched.
fn refuse_foreign(root: &Path) -> io::Result<()> {
    let entries = match fs::read_dir(root) {
        Ok(entries) => entries.collect::<Result<Vec<_>, _>>().map_err(at("list", root))?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(at("list", root)(error)),
    };
    let names: Vec<String> = entries.iter().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    let is = |known: &[&str], name: &String| known.contains(&name.as_str());
    let foreign = names.iter().find(|name| !is(&OWN, name) && !is(&OF_SYSTEMS, name));
    if let Some(foreign) = foreign.filter(|_| !names.iter().any(|name| is(&OWN, name))) {
        let detail = format!(
            "{} is no data directory of planish, it holds \"{}\"; name a folder that is empty or does not exist",
            root.display(),
            shortened(foreign)
        );
        return Err(io::Error::new(io::ErrorKind::InvalidInput, detail));
    }
    records::refuse_damaged(&root.join(RECORDS_FILE))
}

/// Makes a folder of the service if need be, and takes hold of it for as long as the files that it gives are open.
pub(super) fn take_hold(root: &Path) -> io::Result<Vec<File>> {
    refuse_foreign(root)?;
    fs::create_dir_all(root).map_err(at("make", root))?;
    let held = hold(root)?;
    records::read_through(&root.join(RECORDS_FILE))?;
    Ok(held)
}

/// Takes hold of a folder: locks the file `lock` in it and, where folders can be locked, the folder itself, so that
/// removing the file does not let a second process in.
fn hold(root: &Path) -> io::Result<Vec<File>> {
    let path = root.join("lock");
    let file = File::options().create(true).truncate(false).write(true).open(&path).map_err(at("open", &path))?;
    let busy = || io::Error::new(io::ErrorKind::ResourceBusy, in_use(root));
    file.try_lock().map_err(|error| match error {
        TryLockError::WouldBlock => busy(),
        TryLockError::Error(error) => at("lock", &path)(error),
    })?;
    let mut held = vec![file];
    if cfg!(unix) {
        let folder = File::open(root).map_err(at("open", root))?;
        match folder.try_lock() {
            Ok(()) => held.push(folder),
            Err(TryLockError::WouldBlock) => return Err(busy()),
            // some network file systems lock files only
            Err(TryLockError::Error(error)) => {
                tracing::warn!(dir = %root.display(), %error, "the folder cannot be locked; only its lock file \
                    protects it");
            }
        }
    }
    Ok(held)
}

/// A file being written; removed again when it is dropped before it got its final name.
#[derive(Debug)]
pub(super) struct Tmp {
    path: PathBuf,
    file: File,
    disk: Arc<dyn Disk>,
    placed: AtomicBool,
}

impl Tmp {
    /// Writes `bytes`, `offset` bytes after the start.
    pub(super) fn write(&mut self, offset: u64, bytes: &[u8]) -> io::Result<()> {
        self.disk.write(&mut self.file, offset, bytes).map_err(at("write", &self.path))
    }

    pub(super) fn sync(&self) -> io::Result<()> {
        self.disk.sync(&self.file).map_err(at("sync", &self.path))
    }

    /// Reads `length` bytes back, from `offset` bytes after the start.
    pub(super) fn read(&self, offset: u64, length: usize) -> io::Result<Vec<u8>> {
        self.disk.read(&self.path, offset, length).map_err(at("read", &self.path))
    }

    /// Reads a part of the artifact whose bytes these are, as long as the file has not got its final name.
    pub(super) fn read_part(&self, manifest: &Manifest, index: usize) -> io::Result<Option<Bytes>> {
        read_part(&*self.disk, &self.path, manifest, index)
    }

    fn rename(&self, to: &Path) -> io::Result<()> {
        self.disk.rename(&self.path, to).map_err(at("place", to))?;
        self.placed.store(true, Ordering::Release);
        Ok(())
    }

    /// Takes a final name back.
    fn withdraw(&self, from: &Path) {
        if self.placed.swap(false, Ordering::AcqRel) && fs::rename(from, &self.path).is_err() {
            let _ = remove_file(from);
        }
    }
}

impl Drop for Tmp {
    fn drop(&mut self) {
        if !*self.placed.get_mut() {
            // Nothing to do about a failure here: the next start sweeps the file.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Whether a file in `tmp/` has a name that this store gives.
pub(super) fn is_tmp_name(name: &str) -> bool {
    name.ends_with(TMP_SUFFIX) && name.get(..64).and_then(Key::parse).is_some()
}

fn in_use(root: &Path) -> String {
    format!("{} is in use by another process; stop that one", root.display())
}

/// Bytes of a block; each file costs whole blocks.
/// Where a file system has other blocks, usage is told wrong by at most one of them a file.
const BLOCK_BYTES: u64 = 4096;

/// Bytes that an artifact of this length takes on the disk, with a record of this length.
pub(super) fn cost(length: u64, record: usize) -> u64 {
    let blocks = |bytes: u64| bytes.max(1).div_ceil(BLOCK_BYTES).saturating_mul(BLOCK_BYTES);
    blocks(length).saturating_add(blocks(record as u64))
}
