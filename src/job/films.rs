//! The frames of moving pictures whose plan changes; each frame is a job of its own.

use super::complete::{CheckedJob, FilmJobs, Job};
use super::fit::{faults_of, resolved};
use crate::fault::Fault;
use crate::math::parameter::Literal;
use crate::output::ParameterRange;
use crate::scheme::plan::PlanInput;

use super::output::Output;

/// Returns the outputs whose plan changes, by index, or `None` if there are none.
pub(super) fn film_outputs(outputs: &[Output]) -> Option<Vec<(usize, ParameterRange)>> {
    let range = |(i, output): (usize, &Output)| Some((i, output.format.parameter_range(&output.options)?));
    let found: Vec<_> = outputs.iter().enumerate().filter_map(range).collect();
    (!found.is_empty()).then_some(found)
}

/// Returns the frames of these outputs.
///
/// # Errors
/// A fault of each output that cannot have all its frames.
pub(super) fn of(
    asked: &[(usize, ParameterRange)],
    checked: &CheckedJob,
    plan: Option<&PlanInput>,
    levels: u32,
) -> Result<Vec<FilmJobs>, Vec<Fault>> {
    let (mut films, mut faults) = (Vec::new(), Vec::new());
    for (of, range) in asked {
        let output = &checked.outputs[*of];
        match frames((output, range), checked, plan, levels) {
            Ok(frames) => films.push(FilmJobs { of: *of, frames }),
            Err(fault) => faults.push(output.fault(fault)),
        }
    }
    if faults.is_empty() { Ok(films) } else { Err(faults) }
}

/// Returns the frames of one output.
///
/// # Errors
/// A fault below the output.
fn frames(
    (output, range): (&Output, &ParameterRange),
    checked: &CheckedJob,
    plan: Option<&PlanInput>,
    levels: u32,
) -> Result<Vec<Job>, Fault> {
    let name = range.pointer.strip_prefix("/plan/parameters/").filter(|name| !name.contains('/'));
    let (Some(plan), Some(name)) = (plan, name) else {
        let detail = "it leads to no parameter of the plan; give one such as /plan/parameters/delta";
        return Err(Fault::new("/sweep/pointer", detail));
    };
    let at = |value: &f64| {
        let mut plan = plan.clone();
        plan.parameters.retain(|(known, _)| known != name);
        plan.parameters.push((name.to_owned(), Literal::Number(*value)));
        let at_value = |faults: Vec<Fault>| {
            let said: Vec<String> = faults.into_iter().map(|fault| fault.detail).collect();
            Fault::new("/sweep", format!("where {name} is {value}: {}", said.join("; ")))
        };
        let outputs = vec![output.clone()];
        let plan = resolved(&checked.input, Some(&plan), &outputs).map_err(at_value)?;
        let checked = CheckedJob { plan, outputs, ..checked.clone() };
        let faults = faults_of(&checked);
        Job::new(checked, levels, None, faults).map_err(at_value)
    };
    range.values.iter().map(at).collect()
}
