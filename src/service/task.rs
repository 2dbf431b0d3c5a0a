//! Tasks of the desk: anything that makes bytes under a key, at a cost known beforehand.

use std::fmt;
use std::io::Write;
use std::sync::Arc;

use super::peer::Paid;
use crate::fault::Fault;
use crate::job::key::Key;
use crate::job::limits::Admitted;
use crate::job::{JobFault, KeepWork, Report, RunError, run_keeping};
use crate::watch::Watch;

/// The predicted cost of a computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cost {
    /// Bytes of memory while the computation runs.
    pub memory_bytes: u128,
    /// Approximate milliseconds on one core.
    pub time_ms: u128,
    /// Units of work, as the watch counts them.
    pub work: u128,
    /// Upper bound of the length of the result in bytes.
    pub result_bytes: u128,
}

/// A computation that makes bytes: a pure function of the task.
pub trait Task: fmt::Debug + Send + Sync {
    /// Returns the key of the bytes.
    fn key(&self) -> Key;

    /// Returns the predicted cost.
    fn cost(&self) -> Cost;

    /// Returns the media type of the bytes.
    fn media_type(&self) -> &str;

    /// Makes the bytes.
    ///
    /// # Errors
    /// [`RunError`].
    fn run(&self, out: &mut dyn Write, kept: &dyn KeepWork, watch: &Watch) -> Result<Report, RunError>;

    /// Converts a fault of the job into one that points into the request.
    fn fault(&self, fault: JobFault) -> Fault {
        fault.fault
    }
}

/// The task that makes one output of a job.
#[derive(Debug)]
pub struct Render {
    admitted: Arc<Admitted>,
    output: usize,
    /// The memory of the job's input.
    _input: Option<Arc<Paid>>,
}

impl Render {
    /// Creates the task for output number `output` of a job; `input` is the memory of the job's input.
    pub fn new(admitted: Arc<Admitted>, output: usize, input: Option<Arc<Paid>>) -> Self {
        Self { admitted, output, _input: input }
    }
}

impl Task for Render {
    fn key(&self) -> Key {
        self.admitted.estimate().outputs[self.output].0
    }

    fn cost(&self) -> Cost {
        let estimate = self.admitted.estimate();
        Cost {
            memory_bytes: estimate.kept_memory_bytes(),
            time_ms: estimate.time_ms,
            work: estimate.forecast.work,
            result_bytes: estimate.outputs[self.output].1.bytes(),
        }
    }

    fn media_type(&self) -> &str {
        self.admitted.job().outputs[self.output].format.media_type()
    }

    fn run(&self, out: &mut dyn Write, kept: &dyn KeepWork, watch: &Watch) -> Result<Report, RunError> {
        run_keeping(&self.admitted, &self.admitted.job().outputs[self.output], kept, out, watch)
    }

    fn fault(&self, fault: JobFault) -> Fault {
        let job = self.admitted.job();
        job.entries(&job.outputs[self.output]).fault(fault)
    }
}
