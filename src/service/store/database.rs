//! Set-up of the databases of the embedded store: a small page cache, and a guard against their panics.

use std::panic::{self, AssertUnwindSafe};

use redb::{Builder, Database};

/// Size of the database's page cache in bytes; the default would be a gigabyte. Half of it would read pages from the
/// disk more often; twice of it would take 4 MiB more from results.
const CACHE_BYTES: usize = 4 << 20;

/// Runs a database operation and turns a panic into an error: a damaged file may make the database panic, which must
/// not stop the service. The closure must not drop the database while a panic unwinds, because a second panic during
/// unwinding would abort the process.
pub(super) fn guarded<T>(work: impl FnOnce() -> Result<T, redb::Error>) -> Result<T, String> {
    match panic::catch_unwind(AssertUnwindSafe(work)) {
        Ok(done) => done.map_err(|error| error.to_string()),
        Err(_) => Err("the database panicked".to_owned()),
    }
}

/// Closes a database; dropping it may panic as well.
pub(super) fn close<T>(database: T) -> Result<(), String> {
    guarded(|| {
        drop(database);
        Ok(())
    })
}

/// Returns the settings with which databases are opened.
pub(super) fn builder() -> Builder {
    let mut builder = Database::builder();
    builder.set_cache_size(CACHE_BYTES);
    builder
}
