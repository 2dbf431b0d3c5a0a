//! The records of jobs, which outlast their requests: bounded in number and bytes; the oldest settled ones are removed
//! first.

mod attempt;
mod record;
mod revived;
mod rows;
mod standing;
mod table;
mod written;

pub use attempt::{Admission, Attempt, New};
pub use record::{Holder, JobState, JobSummary, OutputResult, Predicted, Product, Record, Requesters};
pub use standing::{JobPhase, Standing};
pub(super) use standing::{PROGRESS_PARTS, STEPS_PER_ATTEMPT};
pub use table::Jobs;
pub(super) use written::{NO_NUMBER, counted, given, numbered, numbers_of, output, outputs, state_of, terms};
