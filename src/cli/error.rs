//! Why a command failed.

use std::fmt;

use crate::fault::Fault;

/// Why a command failed.
#[derive(Debug)]
pub(super) enum CliError {
    /// One sentence.
    Plain(String),
    /// Faults of a job.
    Faults(Vec<Fault>),
}

impl fmt::Display for CliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Plain(text) => f.write_str(text),
            Self::Faults(faults) => {
                write!(f, "the job cannot be done:")?;
                faults.iter().try_for_each(|fault| write!(f, "\n  {fault}"))
            }
        }
    }
}

impl CliError {
    pub(super) fn new(text: impl fmt::Display) -> Self {
        Self::Plain(text.to_string())
    }
}
