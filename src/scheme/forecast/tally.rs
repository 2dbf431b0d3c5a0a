//! A forecast, collected step by step.

use super::count::Count;
use crate::scheme::operator::Children;
use crate::scheme::plan::Scheduled;
use crate::scheme::step_error::StepError;
use crate::watch::Stopped;

/// Counts of every level of a job: entry 0 after the prefix, then one a level.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Forecast {
    /// One entry a level.
    pub levels: Vec<Count>,
    /// The largest net met between operators.
    pub peak: Count,
    /// Rows of weights to be made in all: the unit of progress.
    pub work: u128,
    /// Bytes of the topologies that a scheme of its own connectivity, or D, makes in its largest step.
    pub topology_bytes: u128,
}

/// Why there is no forecast.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ForecastError {
    /// An operator cannot be applied.
    #[error("level {level}: {error}")]
    Step {
        /// Where.
        level: u32,
        /// Why.
        error: StepError,
    },
    /// A net with duals passes the cap.
    #[error("level {level} would have more than {cap} vertices")]
    Cap {
        /// The first such level.
        level: u32,
        /// The cap.
        cap: u128,
    },
    /// What has to be made of a net to count it takes too many bytes.
    #[error(
        "level {level}: to count what D leaves along the boundary takes {bytes} bytes; at most {bound} are allowed"
    )]
    Bytes {
        /// The first such level.
        level: u32,
        /// The bytes.
        bytes: u128,
        /// The bound.
        bound: u128,
    },
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// Bytes for each corner of a net whose dual is made: 13 of its topology, 5 of its faces and 5 of a copy of them, and
/// 33 of the dual and its sides before they are sorted; a third of them are held with the points anyway.
/// Half of it promises less than such steps take; twice of it refuses nets that would fit.
const DUAL_CORNER_BYTES: u128 = 40;

impl Forecast {
    /// The forecast of no steps; levels that have no operator repeat the one before.
    pub(super) fn new(start: Count) -> Self {
        Self { levels: vec![start], peak: start, work: 0, topology_bytes: 0 }
    }

    /// The count after the last step.
    pub(super) fn last(&self) -> Count {
        self.levels.last().copied().unwrap_or_default()
    }

    /// Adds a step after which there is so much.
    pub(super) fn step(&mut self, step: &Scheduled, count: Count) {
        self.work = self.work.saturating_add(count.vertices);
        if step.letter.facts().children == Children::Dual {
            let bytes = self.last().corners.saturating_mul(DUAL_CORNER_BYTES);
            self.topology_bytes = self.topology_bytes.max(bytes);
        }
        if count.vertices > self.peak.vertices {
            self.peak = count;
        }
        let level = step.level as usize;
        while self.levels.len() <= level {
            self.levels.push(count);
        }
        self.levels[level] = count;
    }
}
