//! Why a refinement ends early.

use crate::scheme::plan::Scheduled;
use crate::scheme::step_error::StepError;
use crate::watch::Stopped;

/// Why a refinement ended early.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RefineError {
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// An operator could not be applied.
    #[error("level {level}: {error}")]
    Step {
        /// Where.
        level: u32,
        /// Why.
        error: StepError,
    },
    /// A coordinate grew beyond all bounds.
    #[error("level {level}: a coordinate is no longer finite; choose tamer parameters or fewer levels")]
    NotFinite {
        /// The first such level.
        level: u32,
    },
}

impl RefineError {
    /// The error of an operator at a step of a plan.
    pub fn at(step: &Scheduled) -> impl Fn(StepError) -> Self + use<> {
        let level = step.level;
        move |error| Self::Step { level, error }
    }
}
