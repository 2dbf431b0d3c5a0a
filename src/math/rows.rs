//! Weights as rows: the old points from which each new point is computed, and their weights. No coordinates are seen
//! here.

mod blend;
mod group;
mod pattern;
mod source;
mod table;

pub use blend::{Blended, MAX_RUN, blend, blend_run};
pub use group::{ascending_sum, symmetric_sum};
pub use pattern::PeriodicRows;
pub use source::{RowSource, RowsBy, collect};
pub use table::{Rows, Term};
