//! `planish estimate`: what a job would come to.

use std::path::Path;

use super::error::CliError;
use super::job::{self, MeshOptions};
use crate::job::limits::Limits;
use crate::output::ShapeKind;
use crate::wire::answer::EstimateAnswer;
use crate::wire::output::OutputRequest;

/// Prints the estimate of the job in `path` as JSON.
#[expect(clippy::print_stdout, reason = "the answer of a command goes to standard output")]
pub(super) fn estimate(path: &Path, options: &MeshOptions) -> Result<(), CliError> {
    let mut request = job::load(path, options)?;
    if request.outputs.is_empty() {
        let format = if request.shape_kind() == ShapeKind::Mesh { "glb" } else { "json" };
        request.outputs = vec![OutputRequest::of_format(format)];
    }
    let admitted = job::admit(request, &Limits::default())?;
    let answer = EstimateAnswer::new(admitted.job(), admitted.estimate());
    println!("{}", serde_json::to_string_pretty(&answer).map_err(CliError::new)?);
    Ok(())
}
