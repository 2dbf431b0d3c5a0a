//! The files that a command writes: each is written beside its place under a name that ends in `.part` and put in place
//! when all of its output is there, so that neither a failure nor a signal leaves a broken file.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread;

use tokio::runtime::Builder;

use super::error::CliError;
use super::signals::Signals;

/// Writes a file that is put in its place when it is whole.
///
/// # Errors
/// Those of `write`, and where the file cannot be written.
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

/// Files that are written and not yet in place. Whoever holds the lock may be sure that none is made or put in place.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
/// Whether signals are waited for.
static WATCHED: OnceLock<()> = OnceLock::new();

/// The files of one output: the main one, and those that go beside it.
#[derive(Debug, Default)]
pub(super) struct Files {
    /// Where each is written, and where it goes.
    written: Vec<(PathBuf, PathBuf)>,
}

impl Files {
    /// Begins a file of the output.
    pub(super) fn create(&mut self, target: &Path) -> io::Result<File> {
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

    /// Puts all files in their places, the main one, which was begun first, last: it refers to the others.
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

/// Has unfinished files removed at a signal, which then ends the process.
fn watch() -> io::Result<()> {
    let runtime = Builder::new_current_thread().enable_all().build()?;
    let signals = {
        let _inside = runtime.enter();
        Signals::new()?
    };
    let wait = move || {
        let code = runtime.block_on(signals.first());
        // held to the end, so that no file is begun any more
        let unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
        unfinished.iter().for_each(|part| {
            let _ = fs::remove_file(part);
        });
        std::process::exit(code.into());
    };
    thread::Builder::new().name("signals".to_owned()).spawn(wait).map(drop)
}
