//! A forecast that is collected step by step.

use super::count::Count;
use crate::scheme::operator::Children;
use crate::scheme::plan::Scheduled;
use crate::scheme::step_error::StepError;
use crate::watch::Stopped;

/// The counts of every level of a job: entry 0 is that after the prefix, followed by one entry per level.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Forecast {
    /// One entry per level.
    pub levels: Vec<Count>,
    /// The largest net between any two operators.
    pub peak: Count,
    /// Total number of weight rows to compute, the unit of progress.
    pub work: u128,
    /// Memory in bytes of the topologies in the largest step of D or of a scheme that rebuilds the connectivity.
    pub topology_bytes: u128,
}

/// The reason for which there is no forecast.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ForecastError {
    /// An operator cannot be applied.
    #[error("level {level}: {error}")]
    Step {
        /// The level.
        level: u32,
        /// The error of the operator.
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
    /// Too many bytes are needed to count a net.
    #[error(
        "level {level}: to count what D leaves along the boundary takes {bytes} bytes; at most {bound} are allowed"
    )]
    Bytes {
        /// The first such level.
        level: u32,
        /// The bytes needed.
        bytes: u128,
        /// The greatest number of bytes allowed.
        bound: u128,
    },
    /// The watch asked it to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// Bytes for each corner of a net whose dual is made: 13 of its topology, 5 of its faces and 5 of a copy of them, and
/// 33 of the dual and its sides before they are sorted; a third of them are held with the points anyway.
/// Half of it promises less than such steps take; twice of it refuses nets that would fit.
const DUAL_CORNER_BYTES: u128 = 40;

impl Forecast {
    /// Creates the forecast of no steps, which has one level.
    pub(super) fn new(start: Count) -> Self {
        Self { levels: vec![start], peak: start, work: 0, topology_bytes: 0 }
    }

    /// Returns the counts after the last step.
    pub(super) fn last(&self) -> Count {
        self.levels.last().copied().unwrap_or_default()
    }

    /// Adds a step, with the counts after it.
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
