//! Batches: many jobs sent in one request; the oldest settled batches are removed first.

mod begun;
mod layout;
mod record;
mod standing;
mod table;
mod written;

pub use begun::Begun;
pub use layout::{BatchLayout, GridAxis, TemplatePiece};
pub use record::{Batch, BatchItem, BatchRun, Ending, NewBatch, ParsedBatch};
pub use standing::{BatchStanding, PhaseCounts};
pub use table::{Batches, ReadLayout};
