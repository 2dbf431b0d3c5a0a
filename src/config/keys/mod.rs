//! The keys of clients: their secrets, the file in the data directory with their hashes, and the links they sign.

mod entry;
mod file;
mod link;
mod secret;

pub use entry::{KeyEntry, KeyRole, SHARED, tenant_fault};
pub use file::{KEYS_FILE, KeyFile, KeyFileError, MAX_KEYS};
pub use link::{LINKS, Link, LinkFault, MODEL, has_job};
pub use secret::{Random, Token};
