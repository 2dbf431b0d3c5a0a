//! What a job will come to, and why it is not taken on.

use super::key::Key;
use crate::fault::{Fault, under};
use crate::output::Size;
use crate::scheme::forecast::Forecast;

/// Why a job is not taken on.
#[derive(Debug, Clone, PartialEq)]
pub enum Refusal {
    /// It cannot be done.
    Impossible(Vec<Fault>),
    /// It can be done, but not here.
    TooLarge {
        /// The whole story: place, value, bound, remedy.
        detail: String,
        /// The fault at its place in the request.
        faults: Vec<Fault>,
    },
    /// The forecast of the job was stopped.
    Stopped,
}

/// What a job will come to.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Counts of every level.
    pub forecast: Forecast,
    /// Key and size of each output, in their order.
    pub outputs: Vec<(Key, Size)>,
    /// Bytes of memory while it runs; where it is refined while its result is written, those of the result excluded.
    pub memory_bytes: u128,
    /// Whether it is refined while its result is written.
    pub on_demand: bool,
    /// Milliseconds on one core, roughly.
    pub time_ms: u128,
}

impl Estimate {
    /// Bytes of memory while it runs and its result is kept.
    pub fn kept_memory_bytes(&self) -> u128 {
        let result = self.outputs.iter().map(|(_, size)| size.bytes()).max().unwrap_or(0);
        self.memory_bytes.saturating_add(if self.on_demand { result } else { 0 })
    }
}

impl Refusal {
    /// The same of a panel of a figure.
    pub(super) fn of_panel(self, n: usize) -> Self {
        self.within(&panel_place(n), &format!("panel {n} of the figure"))
    }

    /// The same of the job from whose surface distances are measured.
    pub(super) fn of_other(self) -> Self {
        self.within("/distance_to", "the surface from which distances are measured")
    }

    /// The same of a part of a job that is a job itself.
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

/// Where a figure has the job of a panel.
pub fn panel_place(n: usize) -> String {
    format!("/figure/panels/{n}/job")
}
