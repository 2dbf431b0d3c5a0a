//! The budget of a search: it ends when the watch says stop, or when its work is used up.

use super::bounds::MAX_WORK;
use crate::analysis::no_level::NoLevel;
use crate::watch::Watch;

/// A watch, and the work that it counts at most.
///
/// Once either says no, distances that are asked for are not found any more, and whoever asked finds that out before
/// using them. What was counted by then is more than the most in any case, so that it makes no difference which thread
/// came first.
#[derive(Debug, Clone)]
pub(super) struct Budget {
    pub(super) watch: Watch,
    /// What the watch counts at most.
    most: u64,
}

impl Budget {
    /// So much work from now on.
    pub(super) fn of(watch: &Watch, work: u64) -> Self {
        Self { watch: watch.clone(), most: watch.done().saturating_add(work) }
    }

    /// Whether nothing more is to be done.
    pub(super) fn is_over(&self) -> bool {
        self.watch.check().is_err() || self.watch.done() > self.most
    }

    /// Goes on, or says why not.
    ///
    /// # Errors
    /// [`NoLevel`].
    pub(super) fn check(&self) -> Result<(), NoLevel> {
        self.watch.check()?;
        if self.watch.done() <= self.most {
            return Ok(());
        }
        Err(NoLevel::Refused(format!(
            "the search for a level this close to the limit has taken more than {MAX_WORK} steps, which is the most \
             that is done; ask for a coarser tolerance, or give \"levels\" as a number"
        )))
    }

    /// Counts work as done.
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
