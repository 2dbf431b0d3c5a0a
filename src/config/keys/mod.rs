//! The keys that clients show: their secrets, the file in the data directory that has their hashes, and the links that
//! they sign.

mod entry;
mod file;
mod link;
mod secret;

pub use entry::{KeyEntry, Role, SHARED, tenant_fault};
pub use file::{KEYS_FILE, KeyFile, KeyFileError, MOST_KEYS};
pub use link::{LINKS, Link, LinkFault, MODEL, has_job};
pub use secret::{Random, Token};
