//! The reasons for which the computation of a job ends without a result.

use super::entry::{JobFault, JobPart};
use crate::analysis::limit::LimitError;
use crate::fault::Fault;
use crate::output::FormatError;
use crate::refine::RefineError;
use crate::scheme::step_error::{About, StepError};
use crate::shape::attributes::Attributes;
use crate::watch::Stopped;

/// The reason for which a run ended without a result.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The watch asked the run to stop.
    #[error(transparent)]
    Stopped(Stopped),
    /// The job turned out to be impossible.
    #[error("{0}")]
    Impossible(JobFault),
    /// The result could not be written.
    #[error("writing the result failed: {0}")]
    Io(std::io::Error),
}

impl RunError {
    /// Creates the error of a fault that points into the request.
    pub(super) fn of_request(fault: Fault) -> Self {
        Self::Impossible(JobFault { part: JobPart::Request, fault })
    }

    /// Returns the error for a job that was admitted to be refined while it is written, but cannot be.
    pub(super) fn too_large() -> Self {
        let detail = "the faces around some vertex cannot be refined on their own, so that this level is too large; \
                      ask for fewer levels";
        Self::Impossible(JobFault::new(JobPart::Plan, "", detail))
    }

    /// Returns the error for a mesh whose limit an output needs because of the option `wanted`.
    pub(super) fn of_limit(error: LimitError, attributes: Option<&Attributes>, wanted: &str) -> Self {
        match error {
            LimitError::Refine(error) => Self::of_shape(error, attributes, 0),
            error @ LimitError::Unlimited(_) => Self::Impossible(JobFault::new(JobPart::Output, wanted, error)),
        }
    }

    /// Returns the error of the refinement of a shape. A kernel without an average, or a compensation beyond its bound,
    /// is reported at its source: the kernels or compensations of the points of the shape, else their alphas, else the
    /// plan's function.
    pub(super) fn of_shape(error: RefineError, attributes: Option<&Attributes>, shape: usize) -> Self {
        let name = match &error {
            RefineError::Stopped(stopped) => return Self::Stopped(*stopped),
            RefineError::Step { error: StepError { about: About::Point { name, .. }, .. }, .. } => *name,
            _ => return Self::Impossible(JobFault::new(JobPart::Plan, "", error)),
        };
        let arrays = attributes.map(Attributes::arrays).unwrap_or_default();
        let given = |wanted: &str| arrays.iter().any(|(name, array)| *name == wanted && array.is_some());
        // along longitude lines, points have a kernel, too
        let carried = if name == "compensation" { name } else { "kernel" };
        let (part, name) = match [carried, "alpha"].into_iter().find(|name| given(name)) {
            Some(carried) => (JobPart::Shape(shape), carried),
            None => (JobPart::Plan, name),
        };
        Self::Impossible(JobFault::new(part, format!("/parameters/{name}"), error))
    }
}

impl From<FormatError> for RunError {
    fn from(error: FormatError) -> Self {
        match error {
            FormatError::Stopped(stopped) => Self::Stopped(stopped),
            FormatError::Io(error) => Self::Io(error),
            FormatError::Impossible(fault) => Self::Impossible(JobFault { part: JobPart::Output, fault }),
            FormatError::Unfit(detail) => Self::Impossible(JobFault::new(JobPart::Output, "", detail)),
        }
    }
}
