//! Batches: many jobs sent in one request; the oldest settled batches are removed first.

mod begun;
mod layout;
mod record;
mod standing;
mod table;
mod written;

pub use begun::Begun;
pub use layout::{Axis, Layout, Piece};
pub use record::{Batch, BatchRequest, BatchRun, Ending, Item, NewBatch};
pub use standing::{BatchStanding, Counts};
pub use table::{Batches, ReadLayout};
