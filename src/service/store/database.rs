//! The databases of the embedded store: small, and kept from taking the service with them.

use std::panic::{self, AssertUnwindSafe};

use redb::{Builder, Database};

/// Page cache of the database; its default would be a gigabyte.
/// Half of it reads pages from the disk more often; twice of it takes 4 MiB more from results.
const CACHE_BYTES: usize = 4 << 20;

/// Over a damaged file the database may panic. That must not stop the service, so it counts as a failure of the index.
/// The database itself is never dropped by such a panic: a second one on the way would end the process.
pub(super) fn guarded<T>(work: impl FnOnce() -> Result<T, redb::Error>) -> Result<T, String> {
    match panic::catch_unwind(AssertUnwindSafe(work)) {
        Ok(done) => done.map_err(|error| error.to_string()),
        Err(_) => Err("the database panicked".to_owned()),
    }
}

pub(super) fn builder() -> Builder {
    let mut builder = Database::builder();
    builder.set_cache_size(CACHE_BYTES);
    builder
}
