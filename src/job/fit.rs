//! How the plan, the input and the outputs of a job fit.

use super::complete::Checked;
use super::input::Input;
use super::output::Output;
use super::steering;
use crate::analysis::limit::{LimitError, check};
use crate::fault::{Fault, under};
use crate::output::surface;
use crate::scheme::forecast::check_delta;
use crate::scheme::plan::{Plan, PlanInput, Subject};

/// The faults in how plan, input and outputs fit that do not depend on the number of levels.
pub(super) fn faults_of(Checked { input, entry, plan, outputs, .. }: &Checked) -> Vec<Fault> {
    let mut faults = Vec::new();
    if let Input::Mesh(mesh) = &**input {
        let moves_vertices = |output: &&Output| surface::limit(&output.options)[0];
        let fault = |output: &Output| {
            let error = check(plan).err()?;
            Some(output.fault(Fault::new("/positions", LimitError::from(error).to_string())))
        };
        faults.extend(outputs.iter().filter(moves_vertices).filter_map(fault));
        faults.extend(check_delta(plan, &mesh.topology).err().map(|fault| fault.under("/plan")));
    }
    faults.extend(steering::check(input, *entry, plan));
    faults
}

/// The plan of an input; what some output refers to has to stay what it is.
pub(super) fn resolved(input: &Input, plan: Option<&PlanInput>, outputs: &[Output]) -> Result<Plan, Vec<Fault>> {
    let Some(plan) = plan else {
        return Ok(Plan::none(PlanInput::default().boundary, PlanInput::default().ends));
    };
    let subject = input.subject(plan);
    let told = outputs.iter().find_map(|output| output.format.refers(&output.options)).filter(|_| subject.is_mesh);
    let subject = Subject { tags: subject.tags.or(told), attached: subject.attached.or(told), ..subject };
    Plan::resolve(plan, subject).map_err(|found| under("/plan", found))
}
