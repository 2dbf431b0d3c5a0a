//! The predicted cost of a job, and the refusals of jobs.

use super::key::Key;
use crate::fault::{Fault, under};
use crate::output::Size;
use crate::scheme::forecast::Forecast;

/// The reason for which a job is refused.
#[derive(Debug, Clone, PartialEq)]
pub enum Refusal {
    /// The job is impossible.
    Impossible(Vec<Fault>),
    /// The job exceeds the limits of this server.
    TooLarge {
        /// The full message: place, value, bound, remedy.
        detail: String,
        /// The faults at their places in the request.
        faults: Vec<Fault>,
    },
    /// The forecast of the job was stopped.
    Stopped,
}

/// The predicted cost of a job.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// The counts of every level.
    pub forecast: Forecast,
    /// Key and size of each output, in order.
    pub outputs: Vec<(Key, Size)>,
    /// Memory in bytes during the run; without the result if the job is refined while it is written.
    pub memory_bytes: u128,
    /// Whether the job is refined while its result is written.
    pub on_demand: bool,
    /// Approximate time in milliseconds on one core.
    pub time_ms: u128,
}

impl Estimate {
    /// Returns the memory in bytes while the job runs and its result is kept.
    pub fn kept_memory_bytes(&self) -> u128 {
        let result = self.outputs.iter().map(|(_, size)| size.bytes()).max().unwrap_or(0);
        self.memory_bytes.saturating_add(if self.on_demand { result } else { 0 })
    }
}

impl Refusal {
    /// Returns the refusal with the place of a figure's panel.
    pub(super) fn of_panel(self, n: usize) -> Self {
        self.within(&panel_place(n), &format!("panel {n} of the figure"))
    }

    /// Returns the refusal with the place of the job from whose surface distances are measured.
    pub(super) fn of_other(self) -> Self {
        self.within("/distance_to", "the surface from which distances are measured")
    }

    /// Returns the refusal with the place and the name of a part of a job that is a job itself.
    fn within(self, place: &str, name: &str) -> Self {
        match self {
            Self::Impossible(faults) => Self::Impossible(under(place, faults)),
            Self::TooLarge { detail, faults } => {
                Self::TooLarge { detail: format!("{name}: {detail}"), faults: under(place, faults) }
            }
            Self::Stopped => Self::Stopped,
        }
    }
}

/// Returns the pointer to the job of panel `n` of a figure.
pub fn panel_place(n: usize) -> String {
    format!("/figure/panels/{n}/job")
}
