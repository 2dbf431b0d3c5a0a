//! Batches: many jobs sent in one request; the oldest settled batches are removed first.

mod begun;
mod layout;
mod record;
mod standing;
mod table;
mod written;

pub use begun::Begun;
pub use layout::{BatchLayout, GridAxis, TemplatePiece};
pub use record::{Batch, BatchRun, Ending, Item, NewBatch, ParsedBatch};
pub use standing::{BatchStanding, PhaseCounts};
pub use table::{Batches, ReadLayout};
