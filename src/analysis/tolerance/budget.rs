//! The budget of a search, which ends when its watch says stop or its work is used up.

use super::bounds::MAX_MESH_WORK;
use crate::analysis::no_level::NoLevel;
use crate::watch::Watch;

/// A watch, and the maximum of the work that it counts.
///
/// Once the budget is over, distances are no longer computed but reported as infinite or unknown; callers have to call
/// [`Budget::check`] before they use any. The count never decreases, so that the outcome does not depend on which
/// thread exceeds the maximum.
#[derive(Debug, Clone)]
pub(super) struct Budget {
    pub(super) watch: Watch,
    /// Maximum of the watch's count.
    most: u64,
}

impl Budget {
    /// Creates a budget of `work` units from now on.
    pub(super) fn of(watch: &Watch, work: u64) -> Self {
        Self { watch: watch.clone(), most: watch.done().saturating_add(work) }
    }

    /// Returns whether the watch says stop or the work is used up.
    pub(super) fn is_over(&self) -> bool {
        self.watch.check().is_err() || self.watch.done() > self.most
    }

    /// Checks that the budget is not over.
    ///
    /// # Errors
    /// [`NoLevel`] if it is over, with the reason.
    pub(super) fn check(&self) -> Result<(), NoLevel> {
        self.watch.check()?;
        if self.watch.done() <= self.most {
            return Ok(());
        }
        Err(NoLevel::Refused(format!(
            "the search for a level this close to the limit has taken more than {MAX_MESH_WORK} steps, which is the \
             most that is done; ask for a coarser tolerance, or give \"levels\" as a number"
        )))
    }

    /// Counts `work` more units as done.
    pub(super) fn advance(&self, work: u64) {
        self.watch.advance(work);
    }
}

#[cfg(test)]
mod tests {
    use super::{Budget, NoLevel, Watch};
    use crate::watch::Stopped;

    #[test]
    fn a_budget_is_over_when_its_work_is_done_or_its_watch_says_stop() {
        let watch = Watch::new();
        watch.advance(5);
        let budget = Budget::of(&watch, 10);
        budget.advance(10);
        assert!(budget.check().is_ok() && !budget.is_over());
        budget.advance(1);
        assert!(matches!(budget.check(), Err(NoLevel::Refused(_))) && budget.is_over());
        watch.stop();
        assert!(budget.check() == Err(NoLevel::Stopped(Stopped)) && budget.is_over());
    }
}
