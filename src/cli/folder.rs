//! Reading of the files beside a mesh file on the command line: only from its folder and subfolders.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::fault::shortened;
use crate::input::Beside;
use crate::math::amounts::in_bytes;

/// Maximum number of bytes read beside one file, and of memory that reading it may take beyond its size. Scenes with
/// pictures reach some hundred megabytes; half of it would refuse some of them, twice of it would fill the memory of
/// small machines.
const MAX_COMPANION_BYTES: u64 = 2 << 30;

/// The folder of an input file.
#[derive(Debug)]
pub(super) struct InputFolder {
    path: PathBuf,
    /// Number of bytes that may still be read.
    left: AtomicU64,
}

impl InputFolder {
    /// Returns the folder of the file at a path.
    pub(super) fn of(file: &Path) -> Self {
        let parent = file.parent().filter(|parent| !parent.as_os_str().is_empty());
        Self { path: parent.unwrap_or(Path::new(".")).to_owned(), left: AtomicU64::new(MAX_COMPANION_BYTES) }
    }

    /// Opens a file by its relative name. Links may lead to other files in the folder, but not out of it.
    fn open(&self, name: &str) -> Result<(File, u64), String> {
        let is_inside = !name.is_empty()
            && !name.starts_with('/')
            && !name.contains([':', '\0'])
            && name.split('/').all(|part| part != "..");
        if !is_inside {
            return Err("only files in the folder of the first one and below are read".to_owned());
        }
        let folder = self.path.canonicalize().map_err(|error| error.to_string())?;
        let path = folder.join(name).canonicalize().map_err(|error| error.to_string())?;
        if !path.starts_with(&folder) {
            return Err("it is a link that leads out of the folder, and is not followed".to_owned());
        }
        if !path.is_file() {
            return Err("it is no file".to_owned());
        }
        let file = File::open(path).map_err(|error| error.to_string())?;
        let length = file.metadata().map_err(|error| error.to_string())?.len();
        Ok((file, length))
    }
}

impl Beside for InputFolder {
    fn spare(&self) -> u64 {
        MAX_COMPANION_BYTES
    }

    fn read(&self, name: &str, most: u64) -> Result<Vec<u8>, String> {
        // Some programs write names with the separators of Windows.
        let name = name.replace('\\', "/");
        let wrong = |detail: String| format!("\"{}\" beside the file cannot be read: {detail}", shortened(&name));
        let (file, length) = self.open(&name).map_err(wrong)?;
        let taken = self.left.try_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(length));
        if length > most || taken.is_err() {
            let most = most.min(taken.map_or_else(|left| left, |_| most));
            return Err(wrong(format!("it has {}; {} may be read", in_bytes(length.into()), in_bytes(most.into()))));
        }
        let mut bytes = Vec::new();
        file.take(length).read_to_end(&mut bytes).map_err(|error| wrong(error.to_string()))?;
        Ok(bytes)
    }
}
