//! The checks of a request before anything is refined.

use crate::fault::Fault;
use crate::job::limits::{Limits, Refusal};
use crate::job::{Draft, Input};
use crate::scheme::plan::PlanInput;
use crate::watch::Watch;

/// The result of checking a request without refining anything.
#[derive(Debug, Default)]
pub struct Examined {
    /// All faults found.
    pub faults: Vec<Fault>,
    /// The input, if it is valid.
    pub input: Option<Input>,
    /// The plan, unresolved, if the request has one.
    pub plan: Option<PlanInput>,
    /// The draft of the job, if there are no faults.
    pub draft: Option<Draft>,
}

impl Examined {
    /// Combines the result of drafting a request with its input and plan.
    pub(super) fn of(draft: Result<Draft, Vec<Fault>>, input: Option<Input>, plan: Option<PlanInput>) -> Self {
        match draft {
            Ok(draft) => Self { faults: Vec::new(), input, plan, draft: Some(draft) },
            Err(faults) => Self { faults, input, plan, draft: None },
        }
    }

    /// Adds the reasons why the job exceeds the limits, if its level is known.
    #[must_use]
    pub fn bounded(mut self, limits: &Limits, watch: &Watch) -> Self {
        let Some(Draft::Job(job)) = self.draft.take() else { return self };
        self.faults = match limits.estimate_under(&job, watch) {
            Ok(_) => Vec::new(),
            Err(Refusal::TooLarge { detail, faults }) if faults.is_empty() => vec![Fault::new("", detail)],
            Err(Refusal::TooLarge { faults, .. } | Refusal::Impossible(faults)) => faults,
            Err(Refusal::Stopped) => {
                vec![Fault::new("/levels", "the forecast of the job was stopped; ask for fewer levels")]
            }
        };
        self
    }
}
