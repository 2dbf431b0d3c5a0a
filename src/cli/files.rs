//! Writing of output files: each file is written beside its final path under a name that ends in `.part`, and renamed
//! when the whole output is complete, so that neither a failure nor a signal leaves an incomplete file. Devices and
//! pipes take the bytes as they come.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread;

use tokio::runtime::Builder;

use super::error::CliError;
use super::signals::Signals;

/// Writes a file that appears under its name only when it is complete.
///
/// # Errors
/// The errors of `write`, and when the file cannot be written.
pub(super) fn to_new_file(
    target: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<(), CliError>,
) -> Result<(), CliError> {
    let cannot = |error: io::Error| CliError::files(format!("cannot write {}: {error}", target.display()));
    let mut files = Files::default();
    let mut out = BufWriter::new(files.create(target).map_err(cannot)?);
    write(&mut out)?;
    out.flush().map_err(cannot)?;
    drop(out);
    files.finish().map_err(cannot)
}

/// Paths of files that are not renamed yet. While the lock is held, no file is created or renamed.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
/// Set once the signal handling of this process is installed.
static WATCHED: OnceLock<()> = OnceLock::new();

/// The files of one output: the main file, and those beside it.
#[derive(Debug, Default)]
pub(super) struct Files {
    /// The temporary path and the final path of each file.
    written: Vec<(PathBuf, PathBuf)>,
}

impl Files {
    /// Creates a file of the output, or opens the device or the pipe that the target is.
    pub(super) fn create(&mut self, target: &Path) -> io::Result<File> {
        if fs::metadata(target).is_ok_and(|found| !found.is_file() && !found.is_dir()) {
            return File::options().write(true).open(target);
        }
        if WATCHED.set(()).is_ok() {
            watch()?;
        }
        let mut name = target.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{}.part", std::process::id()));
        let part = target.with_file_name(name);
        let mut unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
        let file = File::create(&part)?;
        unfinished.push(part.clone());
        self.written.push((part, target.to_owned()));
        Ok(file)
    }

    /// Renames all files to their final paths; the main file, which was created first, comes last, because it refers to
    /// the others.
    pub(super) fn finish(mut self) -> io::Result<()> {
        let mut unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
        while let Some((part, target)) = self.written.last() {
            fs::rename(part, target)?;
            unfinished.retain(|known| known != part);
            self.written.pop();
        }
        Ok(())
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        let mut unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
        for (part, _) in &self.written {
            let _ = fs::remove_file(part);
            unfinished.retain(|known| known != part);
        }
    }
}

/// Starts a thread that, at the first signal, removes all unfinished files and ends the process.
fn watch() -> io::Result<()> {
    let runtime = Builder::new_current_thread().enable_all().build()?;
    let signals = {
        let _inside = runtime.enter();
        Signals::new()?
    };
    let wait = move || {
        let code = runtime.block_on(signals.first());
        // The lock is held until the process ends, so that no further file is created.
        let unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
        unfinished.iter().for_each(|part| {
            let _ = fs::remove_file(part);
        });
        std::process::exit(code.into());
    };
    thread::Builder::new().name("signals".to_owned()).spawn(wait).map(drop)
}
