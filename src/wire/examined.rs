//! What is found of a request before anything is refined.

use crate::fault::Fault;
use crate::job::limits::{Limits, Refusal};
use crate::job::{Draft, Input};
use crate::scheme::plan::PlanInput;
use crate::watch::Watch;

/// What a request is found to be without refining anything.
#[derive(Debug, Default)]
pub struct Examined {
    /// Everything that is wrong.
    pub faults: Vec<Fault>,
    /// The input, where that is right.
    pub input: Option<Input>,
    /// The plan, unresolved, where there is one.
    pub plan: Option<PlanInput>,
    /// What reading the request leads to, where nothing is wrong.
    pub draft: Option<Draft>,
}

impl Examined {
    /// What drafting a request with these parts has led to.
    pub(super) fn of(draft: Result<Draft, Vec<Fault>>, input: Option<Input>, plan: Option<PlanInput>) -> Self {
        match draft {
            Ok(draft) => Self { faults: Vec::new(), input, plan, draft: Some(draft) },
            Err(faults) => Self { faults, input, plan, draft: None },
        }
    }

    /// Adds why the job is not taken on within limits, where its level is known.
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
