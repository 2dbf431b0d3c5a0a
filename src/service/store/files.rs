//! The folder of the embedded store: where each file stands, and how one gets there whole.
//!
//! ```text
//! lock                          held by the one process that uses the folder
//! index.redb                    order of use
//! tmp/<64 hex>.<number>.tmp     being written
//! artifacts/ab/<64 hex>         bytes
//! artifacts/ab/<64 hex>.manifest
//! ```
//!
//! File names come from [`Key`]s and counters only, never from text of a request.

use std::fs::{self, File, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use bytes::Bytes;

use super::{Manifest, parts};
use crate::job::key::Key;

/// What follows the key in the name of a manifest.
pub(super) const MANIFEST_SUFFIX: &str = ".manifest";
const TMP_SUFFIX: &str = ".tmp";

/// The folder, held by this process alone.
#[derive(Debug)]
pub(super) struct Folder {
    root: PathBuf,
    n_tmp: AtomicU64,
    /// Let go by the system when the file is closed, however the process ends.
    _lock: File,
}

impl Folder {
    /// Makes the folder if need be and takes hold of it.
    pub(super) fn open(root: &Path) -> io::Result<Self> {
        let make = |path: &Path| fs::create_dir_all(path).map_err(at("make", path));
        make(&root.join("tmp"))?;
        make(&root.join("artifacts"))?;
        let path = root.join("lock");
        let lock = File::options().create(true).truncate(false).write(true).open(&path).map_err(at("open", &path))?;
        lock.try_lock().map_err(|error| match error {
            TryLockError::WouldBlock => io::Error::new(io::ErrorKind::ResourceBusy, in_use(root)),
            TryLockError::Error(error) => at("lock", &path)(error),
        })?;
        sync_folder(root)?;
        Ok(Self { root: root.to_owned(), n_tmp: AtomicU64::new(0), _lock: lock })
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
        Ok(Tmp { path, file, placed: false })
    }

    /// Makes two written and synced files the artifact of `key`. On failure nothing of it is left.
    ///
    /// One sync of the folder is enough for both names: until it returns nobody was told that the artifact exists, and
    /// of bytes without a manifest, or a manifest without its bytes, the next start sweeps what is there.
    pub(super) fn place(&self, key: &Key, bytes: &mut Tmp, manifest: &mut Tmp) -> io::Result<()> {
        let shard = self.shard(key);
        if !shard.is_dir() {
            fs::create_dir_all(&shard).map_err(at("make", &shard))?;
            sync_folder(&self.artifacts())?;
            sync_folder(&self.root)?;
        }
        let placed = bytes
            .rename(&self.bytes(key))
            .and_then(|()| manifest.rename(&self.manifest(key)))
            .and_then(|()| sync_folder(&shard));
        placed.inspect_err(|_| {
            // The first error is the one to tell; the next start sweeps what stays.
            let _ = self.remove(key);
        })
    }

    /// Removes an artifact, its manifest first: without it the artifact does not exist.
    pub(super) fn remove(&self, key: &Key) -> io::Result<()> {
        remove_file(&self.manifest(key))?;
        remove_file(&self.bytes(key))
    }

    /// Makes removals from the folder of `key` last.
    pub(super) fn sync(&self, key: &Key) -> io::Result<()> {
        match sync_folder(&self.shard(key)) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            synced => synced,
        }
    }

    /// Reads a part; `None` unless its bytes have the hash in the manifest.
    pub(super) fn read_part(&self, manifest: &Manifest, index: usize) -> io::Result<Option<Bytes>> {
        let Some((start, length)) = parts::span(manifest, index) else { return Ok(None) };
        let path = self.bytes(&manifest.key);
        let mut file = match File::open(&path) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(at("open", &path)(error)),
        };
        let mut bytes = Vec::with_capacity(length);
        file.seek(SeekFrom::Start(start)).map_err(at("read", &path))?;
        file.take(length as u64).read_to_end(&mut bytes).map_err(at("read", &path))?;
        let sound = manifest.parts.get(index) == Some(&parts::hash(&bytes));
        Ok(sound.then(|| Bytes::from(bytes)))
    }
}

/// A file being written; removed again when it is dropped before it got its final name.
#[derive(Debug)]
pub(super) struct Tmp {
    path: PathBuf,
    file: File,
    placed: bool,
}

impl Tmp {
    pub(super) fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes).map_err(at("write", &self.path))
    }

    pub(super) fn sync(&self) -> io::Result<()> {
        self.file.sync_all().map_err(at("sync", &self.path))
    }

    fn rename(&mut self, to: &Path) -> io::Result<()> {
        fs::rename(&self.path, to).map_err(at("place", to))?;
        self.placed = true;
        Ok(())
    }
}

impl Drop for Tmp {
    fn drop(&mut self) {
        if !self.placed {
            // Nothing to do about a failure here: the next start sweeps the file.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Whether a file in `tmp/` has a name that this store gives.
pub(super) fn is_tmp_name(name: &str) -> bool {
    name.ends_with(TMP_SUFFIX) && name.get(..64).and_then(Key::parse).is_some()
}

/// Removes a file, if it is there.
pub(super) fn remove_file(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(at("remove", path)(error)),
        _ => Ok(()),
    }
}

/// Makes the names in a folder last.
fn sync_folder(path: &Path) -> io::Result<()> {
    if cfg!(unix) {
        File::open(path).and_then(|folder| folder.sync_all()).map_err(at("sync", path))?;
    }
    Ok(())
}

fn in_use(root: &Path) -> String {
    format!("{} is in use by another process; stop that one", root.display())
}

/// Says what was being done and where when `error` came.
pub(super) fn at(doing: &str, path: &Path) -> impl FnOnce(io::Error) -> io::Error {
    move |error| io::Error::new(error.kind(), format!("cannot {doing} {}: {error}", path.display()))
}
