//! The records of jobs that outlast their request: bounded in number and bytes; settled ones leave first.

mod attempt;
mod journal;
mod record;
mod standing;
mod table;
mod written;

pub use attempt::{New, Placed, Run};
pub use record::{JobSummary, Made, Predicted, Product, Record, State};
pub use standing::{Phase, Standing};
pub use table::Jobs;
