//! Runs an admitted job: refines its input and writes one output.

use std::io::Write;

use super::composed;
use super::error::RunError;
use super::limits::Admitted;
use super::output::Output;
use super::report::Report;
use super::shown::show;
use super::work::{KeepNothing, KeepWork};
use crate::output::description::Describing;
use crate::output::scene::Scene;
use crate::watch::Watch;

/// Computes one output of a job and writes its bytes to `out`; the result depends on the job only.
///
/// # Errors
/// [`RunError`].
pub fn run(admitted: &Admitted, output: &Output, out: &mut dyn Write, watch: &Watch) -> Result<Report, RunError> {
    run_keeping(admitted, output, &KeepNothing, out, watch)
}

/// Computes one output of a job like [`run`], reusing kept work of earlier computations, and offers its own work to
/// later ones.
///
/// # Errors
/// [`RunError`].
pub fn run_keeping(
    admitted: &Admitted,
    output: &Output,
    kept: &dyn KeepWork,
    out: &mut dyn Write,
    watch: &Watch,
) -> Result<Report, RunError> {
    let Some(text) = &output.description else { return made(admitted, output, kept, out, watch) };
    let mut out = Describing::new(output.format.facts().description, text, out);
    let report = made(admitted, output, kept, &mut out, watch)?;
    out.finish().map_err(RunError::Io)?;
    Ok(report)
}

/// Computes an output without its description.
fn made(
    admitted: &Admitted,
    output: &Output,
    kept: &dyn KeepWork,
    out: &mut dyn Write,
    watch: &Watch,
) -> Result<Report, RunError> {
    let (job, on_demand) = (admitted.job(), admitted.estimate().on_demand);
    if let Some(figure) = &job.figure {
        return composed::run(figure, (job, output), kept, out, watch);
    }
    if let Some(film) = job.film(output) {
        return composed::run_film(film, output, kept, out, watch);
    }
    let mut write = |scene: &Scene<'_>| output.format.write(scene, &output.options, out, watch);
    show((job, on_demand), output, kept, watch, &mut write)
}
