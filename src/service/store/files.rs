//! The folder of the embedded store: the paths of its files, and how a file gets to its path complete.
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
//! File names are made of [`Key`]s and counters only, never of text from a request.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use bytes::Bytes;

use super::disk::Disk;
use super::disk_files::{at, remove_file};
use super::manifest::Manifest;
use super::parts;
use super::records::{self, RECORDS_FILE};
use crate::fault::shortened;
use crate::job::key::{Key, content};
use crate::service::lock::lock;

/// Suffix of the name of a manifest file, after the key.
pub(super) const MANIFEST_SUFFIX: &str = ".manifest";
const TMP_SUFFIX: &str = ".tmp";

/// The folder of a store, locked by this process.
#[derive(Debug)]
pub(super) struct StoreFolder {
    root: PathBuf,
    disk: Arc<dyn Disk>,
    n_tmp: AtomicU64,
    /// The locked files. The operating system releases the locks when the files are closed, however the process ends.
    locks: Mutex<Vec<File>>,
}

impl StoreFolder {
    /// Creates the folder if necessary and locks it.
    pub(super) fn open(root: &Path, disk: Arc<dyn Disk>) -> io::Result<Self> {
        let locks = Mutex::new(take_hold(root)?);
        let make = |path: &Path| fs::create_dir_all(path).map_err(at("make", path));
        make(&root.join("tmp"))?;
        make(&root.join("artifacts"))?;
        let folder = Self { root: root.to_owned(), disk, n_tmp: AtomicU64::new(0), locks };
        folder.sync_folder(root)?;
        Ok(folder)
    }

    /// Releases the locks, so that another process can use the folder.
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

    /// Returns the name of the subfolder of an artifact, one of 256.
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

    /// Creates an empty temporary file for bytes of `key`.
    pub(super) fn create_tmp(&self, key: &Key) -> io::Result<Tmp> {
        let folder = self.tmp();
        fs::create_dir_all(&folder).map_err(at("make", &folder))?;
        let path = folder.join(format!("{key}.{}{TMP_SUFFIX}", self.n_tmp.fetch_add(1, Ordering::Relaxed)));
        let file = File::create_new(&path).map_err(at("make", &path))?;
        Ok(Tmp { path, file, disk: Arc::clone(&self.disk), placed: AtomicBool::new(false) })
    }

    /// Renames two written and synced files to the names of the artifact `key`. On failure neither name is left in
    /// place.
    ///
    /// One sync of the folder suffices for both names: before it returns, nobody has been told that the artifact
    /// exists, and bytes without a manifest, or a manifest without its bytes, are removed at the next start.
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
            // A failure of this clean-up is ignored: the first error is returned, and the next start removes the rest.
            let _ = remove_file(&self.manifest(key));
            bytes.withdraw(&self.bytes(key));
        })
    }

    /// Replaces the manifest of a stored artifact by another file, which is written and synced.
    pub(super) fn describe(&self, key: &Key, manifest: &Tmp) -> io::Result<()> {
        manifest.rename(&self.manifest(key))?;
        self.sync_folder(&self.shard(key))
    }

    /// Returns whether a directory has the name of an artifact or of its manifest, so that the artifact cannot be
    /// written.
    pub(super) fn is_occupied(&self, key: &Key) -> bool {
        self.bytes(key).is_dir() || self.manifest(key).is_dir()
    }

    /// Removes an artifact, its manifest first: without a manifest the artifact does not exist.
    pub(super) fn remove(&self, key: &Key) -> io::Result<()> {
        remove_file(&self.manifest(key))?;
        remove_file(&self.bytes(key))
    }

    /// Makes removals from the subfolder of `key` durable.
    pub(super) fn sync(&self, key: &Key) -> io::Result<()> {
        match self.sync_folder(&self.shard(key)) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            synced => synced,
        }
    }

    /// Makes the entries of a directory durable (on Unix; elsewhere it does nothing).
    fn sync_folder(&self, path: &Path) -> io::Result<()> {
        if cfg!(unix) {
            File::open(path).and_then(|folder| self.disk.sync(&folder)).map_err(at("sync", path))?;
        }
        Ok(())
    }

    /// Reads a part; returns `None` if its bytes do not have the hash in the manifest.
    pub(super) fn read_part(&self, manifest: &Manifest, index: usize) -> io::Result<Option<Bytes>> {
        read_part(&*self.disk, &self.bytes(&manifest.key), manifest, index)
    }
}

/// Reads a part of an artifact from the file with its bytes; returns `None` if they do not have the hash in the
/// manifest, if there is no such part or file, or if a directory has the name of the file.
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

/// Names of the files and folders of the embedded store, and names that operating systems put into the root of a disk,
/// which may exist beside them.
const OWN_NAMES: [&str; 9] =
    ["lock", "index.redb", RECORDS_FILE, "tmp", "artifacts", "uploads", "keys.toml", "keys.lock", "keys.new"];
const SYSTEM_NAMES: [&str; 3] = ["lost+found", ".snapshot", ".DS_Store"];

/// Refuses a folder with foreign contents, or with damaged records, before anything in it is changed.
fn refuse_foreign(root: &Path) -> io::Result<()> {
    let entries = match fs::read_dir(root) {
        Ok(entries) => entries.collect::<Result<Vec<_>, _>>().map_err(at("list", root))?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(at("list", root)(error)),
    };
    let names: Vec<String> = entries.iter().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    let is = |known: &[&str], name: &String| known.contains(&name.as_str());
    let foreign = names.iter().find(|name| !is(&OWN_NAMES, name) && !is(&SYSTEM_NAMES, name));
    if let Some(foreign) = foreign.filter(|_| !names.iter().any(|name| is(&OWN_NAMES, name))) {
        let detail = format!(
            "{} is no data directory of planish, it holds \"{}\"; name a folder that is empty or does not exist",
            root.display(),
            shortened(foreign)
        );
        return Err(io::Error::new(io::ErrorKind::InvalidInput, detail));
    }
    records::refuse_damaged(&root.join(RECORDS_FILE))
}

/// Creates a folder of the service if necessary and locks it for as long as the returned files are open.
pub(super) fn take_hold(root: &Path) -> io::Result<Vec<File>> {
    refuse_foreign(root)?;
    fs::create_dir_all(root).map_err(at("make", root))?;
    let held = hold(root)?;
    records::read_through(&root.join(RECORDS_FILE))?;
    Ok(held)
}

/// Locks the file `lock` in a folder and, on systems that can lock folders, the folder itself, so that removing the
/// lock file does not let a second process in.
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
            // Some network file systems can lock files only.
            Err(TryLockError::Error(error)) => {
                tracing::warn!(dir = %root.display(), %error, "the folder cannot be locked; only its lock file \
                    protects it");
            }
        }
    }
    Ok(held)
}

/// A temporary file; it is removed when it is dropped before it was renamed to its final name.
#[derive(Debug)]
pub(super) struct Tmp {
    path: PathBuf,
    file: File,
    disk: Arc<dyn Disk>,
    placed: AtomicBool,
}

impl Tmp {
    /// Writes `bytes` at `offset` bytes from the start.
    pub(super) fn write(&mut self, offset: u64, bytes: &[u8]) -> io::Result<()> {
        self.disk.write(&mut self.file, offset, bytes).map_err(at("write", &self.path))
    }

    pub(super) fn sync(&self) -> io::Result<()> {
        self.disk.sync(&self.file).map_err(at("sync", &self.path))
    }

    /// Reads up to `length` bytes at `offset` bytes from the start.
    pub(super) fn read(&self, offset: u64, length: usize) -> io::Result<Vec<u8>> {
        self.disk.read(&self.path, offset, length).map_err(at("read", &self.path))
    }

    /// Reads a part of the artifact from this file, which must not have been renamed yet.
    pub(super) fn read_part(&self, manifest: &Manifest, index: usize) -> io::Result<Option<Bytes>> {
        read_part(&*self.disk, &self.path, manifest, index)
    }

    fn rename(&self, to: &Path) -> io::Result<()> {
        self.disk.rename(&self.path, to).map_err(at("place", to))?;
        self.placed.store(true, Ordering::Release);
        Ok(())
    }

    /// Takes back a rename to the final name `from`.
    fn withdraw(&self, from: &Path) {
        if self.placed.swap(false, Ordering::AcqRel) && fs::rename(from, &self.path).is_err() {
            let _ = remove_file(from);
        }
    }
}

impl Drop for Tmp {
    fn drop(&mut self) {
        if !*self.placed.get_mut() {
            // A failure can be ignored here: the next start removes the file.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Returns whether a name in `tmp/` has the form of the names that this store gives.
pub(super) fn is_tmp_name(name: &str) -> bool {
    name.ends_with(TMP_SUFFIX) && name.get(..64).and_then(Key::parse).is_some()
}

fn in_use(root: &Path) -> String {
    format!("{} is in use by another process; stop that one", root.display())
}

/// Assumed block size of the file system in bytes; each file takes whole blocks. On a file system with other blocks the
/// reported usage is off by at most one block per file.
const BLOCK_BYTES: u64 = 4096;

/// Returns the number of bytes on disk of an artifact of `length` bytes with a manifest of `record` bytes.
pub(super) fn cost(length: u64, record: usize) -> u64 {
    let blocks = |bytes: u64| bytes.max(1).div_ceil(BLOCK_BYTES).saturating_mul(BLOCK_BYTES);
    blocks(length).saturating_add(blocks(record as u64))
}
