//! The records of jobs that outlast their request: bounded in number and bytes; settled ones leave first.

mod attempt;
mod record;
mod rows;
mod standing;
mod table;
mod written;

pub use attempt::{New, Placed, Run};
pub use record::{Holder, JobSummary, Made, Predicted, Product, Record, State, Wanted};
pub use standing::{Phase, Standing};
pub use table::Jobs;
pub(super) use written::{output, outputs};
