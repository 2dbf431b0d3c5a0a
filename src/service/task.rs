//! What the desk has made: anything that becomes bytes under a key, with its cost known beforehand.

use std::fmt;
use std::io::Write;
use std::sync::Arc;

use super::peer::Paid;
use crate::fault::Fault;
use crate::job::key::Key;
use crate::job::limits::Admitted;
use crate::job::{JobFault, KeepWork, Report, RunError, run_keeping};
use crate::watch::Watch;

/// What a computation will come to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cost {
    /// Bytes of memory while it runs.
    pub memory_bytes: u128,
    /// Milliseconds on one core, roughly.
    pub time_ms: u128,
    /// Units of work, as the watch counts them.
    pub work: u128,
    /// Bytes of the result, at most.
    pub result_bytes: u128,
}

/// A computation that can be made: a pure function from itself to bytes.
pub trait Task: fmt::Debug + Send + Sync {
    /// Key of the bytes.
    fn key(&self) -> Key;

    /// What it will come to.
    fn cost(&self) -> Cost;

    /// Media type of the bytes.
    fn media_type(&self) -> &str;

    /// Makes the bytes.
    ///
    /// # Errors
    /// [`RunError`].
    fn run(&self, out: &mut dyn Write, kept: &dyn KeepWork, watch: &Watch) -> Result<Report, RunError>;

    /// Where the request has what is at fault.
    fn fault(&self, fault: JobFault) -> Fault {
        fault.fault
    }
}

/// One output of a job.
#[derive(Debug)]
pub struct Render {
    admitted: Arc<Admitted>,
    output: usize,
    /// The memory of the job's input.
    _input: Option<Arc<Paid>>,
}

impl Render {
    /// The task that makes an output of a job, whose input takes so much memory.
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
