//! Opening of the embedded store: finds the artifacts in its folder and removes incomplete ones.

use std::collections::{HashMap, HashSet};
use std::fs::{self, DirEntry, File, Metadata};
use std::io::{self, Read};
use std::path::Path;
use std::time::SystemTime;

use super::disk_files::{at, remove_file};
use super::files::{self, MANIFEST_SUFFIX, StoreFolder};
use super::manifest::{Manifest, PART_BYTES};
use crate::job::key::{Key, RESULTS_VERSION};

/// Maximum size of a manifest file in bytes; enough for the parts of two tebibytes. Larger files are damaged or
/// foreign; half of it would still hold the parts of one tebibyte.
const MAX_MANIFEST_FILE_BYTES: u64 = 64 << 20;

/// The result of cleaning the folder of the store up.
#[derive(Debug, Default)]
pub(super) struct CleanUp {
    /// The complete artifacts, in no order.
    pub(super) found: Vec<WholeArtifact>,
    /// Number of artifacts removed because their manifest or their length was wrong.
    pub(super) damaged: u64,
    /// Number of removed temporary files, incomplete artifacts and artifacts of another results version.
    pub(super) removed: u64,
    /// Keys whose artifact cannot be written, because something that is not a file has the name of one of its files.
    pub(super) occupied: HashSet<Key>,
}

/// A complete artifact.
#[derive(Debug)]
pub(super) struct WholeArtifact {
    /// The manifest of the artifact.
    pub(super) manifest: Manifest,
    /// Time at which the manifest was written.
    pub(super) written: SystemTime,
}

/// Removes incomplete and damaged artifacts, those of another results version, and temporary files; returns the rest.
/// Files whose names the store does not use are left alone.
pub(super) fn clean_up(folder: &StoreFolder) -> io::Result<CleanUp> {
    let mut cleaned = CleanUp::default();
    for entry in entries(&folder.tmp())? {
        if name(&entry).is_some_and(|name| files::is_tmp_name(&name)) && !entry.path().is_dir() {
            remove_file(&entry.path())?;
            cleaned.removed += 1;
        }
    }
    for shard in entries(&folder.artifacts())? {
        if let Some(name) = name(&shard).filter(|_| shard.path().is_dir()) {
            clean_shard(folder, &name, &mut cleaned)?;
        }
    }
    Ok(cleaned)
}

fn clean_shard(folder: &StoreFolder, shard: &str, cleaned: &mut CleanUp) -> io::Result<()> {
    let mut lengths = HashMap::new();
    let mut manifests = Vec::new();
    for entry in entries(&folder.artifacts().join(shard))? {
        let Some(name) = name(&entry) else { continue };
        let record = name.strip_suffix(MANIFEST_SUFFIX);
        let key = Key::parse(record.unwrap_or(&name)).filter(|key| StoreFolder::shard_name(key) == shard);
        let metadata = entry.metadata().ok().filter(Metadata::is_file);
        let (Some(key), Some(metadata)) = (key, metadata) else {
            tracing::warn!(path = %entry.path().display(), "not a file of the store; left alone");
            cleaned.occupied.extend(key);
            continue;
        };
        if record.is_some() {
            manifests.push((key, metadata));
        } else {
            lengths.insert(key, metadata.len());
        }
    }
    for (key, metadata) in manifests {
        let written = metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH);
        match judge(folder, &key, lengths.get(&key).copied()) {
            ArtifactCondition::Whole(manifest) => {
                lengths.remove(&key);
                cleaned.found.push(WholeArtifact { manifest, written });
                continue;
            }
            ArtifactCondition::Damaged => cleaned.damaged += 1,
            ArtifactCondition::LeftOver => cleaned.removed += 1,
        }
        lengths.remove(&key);
        folder.remove(&key)?;
    }
    for key in lengths.into_keys() {
        folder.remove(&key)?;
        cleaned.removed += 1;
    }
    Ok(())
}

enum ArtifactCondition {
    Whole(Manifest),
    Damaged,
    LeftOver,
}

/// Compares a manifest with the length of the bytes beside it. The bytes themselves are verified when they are read.
fn judge(folder: &StoreFolder, key: &Key, length: Option<u64>) -> ArtifactCondition {
    let Some(length) = length else { return ArtifactCondition::LeftOver };
    match read_manifest(&folder.manifest(key)) {
        // An artifact whose key is the hash of its bytes is the same in every results version.
        Some(manifest) if manifest.results_version != RESULTS_VERSION && manifest.content != *key => {
            ArtifactCondition::LeftOver
        }
        Some(manifest) if manifest.key == *key && manifest.length == length => ArtifactCondition::Whole(manifest),
        _ => ArtifactCondition::Damaged,
    }
}

fn read_manifest(path: &Path) -> Option<Manifest> {
    let mut bytes = Vec::with_capacity(1024);
    File::open(path).ok()?.take(MAX_MANIFEST_FILE_BYTES).read_to_end(&mut bytes).ok()?;
    Manifest::decode(&bytes)
}

fn entries(path: &Path) -> io::Result<Vec<DirEntry>> {
    fs::read_dir(path).and_then(Iterator::collect).map_err(at("list", path))
}

fn name(entry: &DirEntry) -> Option<String> {
    entry.file_name().into_string().ok()
}

const _: () = assert!(MAX_MANIFEST_FILE_BYTES / 32 * PART_BYTES as u64 >= 1 << 40, "the parts of a tebibyte fit");
