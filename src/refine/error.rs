//! The reasons for which a refinement ends early.

use crate::scheme::plan::Scheduled;
use crate::scheme::step_error::StepError;
use crate::watch::Stopped;

/// The reason for which a refinement ended early.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RefineError {
    /// The watch asked the refinement to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// An operator could not be applied.
    #[error("level {level}: {error}")]
    Step {
        /// The level at which the operator failed.
        level: u32,
        /// The error of the operator.
        error: StepError,
    },
    /// A coordinate overflowed or became NaN.
    #[error("level {level}: a coordinate is no longer finite; choose tamer parameters or fewer levels")]
    NotFinite {
        /// The first level with such a coordinate.
        level: u32,
    },
}

impl RefineError {
    /// Returns a function that turns an operator's error at `step` into a refinement error.
    pub fn at(step: &Scheduled) -> impl Fn(StepError) -> Self + use<> {
        let level = step.level;
        move |error| Self::Step { level, error }
    }
}
