//! Stores: keys and bytes only, content addressed, verified part by part when read.

mod database;
mod disk;
mod disk_files;
mod disk_spool;
mod disk_state;
mod embedded;
mod error;
mod files;
mod index;
mod interface;
mod lock;
mod manifest;
mod memory;
mod parts;
mod pin;
mod records;
mod registry;
mod sealed;
mod shelf;
mod sweep;

pub use disk::{Disk, Local};
pub use embedded::Embedded;
pub use error::StoreError;
pub use interface::{LargeSpool, Sealed, Spool, Store, StoreKind, Usage};
pub use manifest::{Description, Manifest, Owners, PART_BYTES};
pub use memory::Memory;
pub(super) use parts::part_of;
pub use pin::Pin;
pub use records::Records;
pub use registry::STORES;
pub use shelf::MAX_ARTIFACTS;
pub(super) use shelf::{Shelf, admit};
