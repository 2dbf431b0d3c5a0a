//! Jobs from files.

use std::io::Read;
use std::path::Path;

use super::CliError;
use crate::job::limits::{Admitted, Limits, Refusal};
use crate::wire::JobRequest;
use crate::wire::read::{ReadError, read};

/// Reads a job; `-` is standard input.
pub(super) fn load(path: &Path) -> Result<JobRequest, CliError> {
    let bytes = if path == Path::new("-") {
        let mut bytes = Vec::new();
        std::io::stdin().read_to_end(&mut bytes).map(|_| bytes)
    } else {
        std::fs::read(path)
    };
    let bytes = bytes.map_err(|error| CliError::new(format!("cannot read {}: {error}", path.display())))?;
    read(&bytes).map_err(|error| match error {
        ReadError::NotJson(detail) => CliError::Plain(detail),
        ReadError::Unfit(faults) => CliError::Faults(faults),
    })
}

/// Checks and admits a job.
pub(super) fn admit(request: JobRequest, limits: &Limits) -> Result<Admitted, CliError> {
    let job = request.resolve().map_err(CliError::Faults)?;
    limits.admit(job).map_err(|refusal| match refusal {
        Refusal::Impossible(faults) => CliError::Faults(faults),
        Refusal::TooLarge { detail, .. } => CliError::Plain(detail),
    })
}
