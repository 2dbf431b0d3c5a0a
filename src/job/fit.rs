//! Checks how the plan, the input and the outputs of a job fit together.

use super::complete::CheckedJob;
use super::input::Input;
use super::output::Output;
use super::steering;
use crate::analysis::limit::{LimitError, check};
use crate::fault::{Fault, under};
use crate::output::{shows_distances, surface};
use crate::scheme::forecast::check_delta;
use crate::scheme::plan::{Plan, PlanInput, Subject};

/// Returns the faults in the fit of plan, input and outputs that do not depend on the number of levels.
pub(super) fn faults_of(CheckedJob { input, entry, plan, outputs, .. }: &CheckedJob) -> Vec<Fault> {
    let mut faults = Vec::new();
    if let Input::Mesh(mesh) = &**input {
        let moves_vertices = |output: &&Output| surface::limit(&output.options)[0];
        let fault = |output: &Output| {
            let error = check(plan).err()?;
            Some(output.fault(Fault::new("/positions", LimitError::from(error).to_string())))
        };
        faults.extend(outputs.iter().filter(moves_vertices).filter_map(fault));
        let admitted = |output: &Output| {
            let fault = output.format.admits(mesh, plan, &output.options).err()?;
            Some(output.fault(fault))
        };
        faults.extend(outputs.iter().filter_map(admitted));
        faults.extend(check_delta(plan, &mesh.topology).err().map(|fault| fault.under("/plan")));
    }
    let weighs = |output: &&Output| output.format.is_of_weights() && plan.turns_tangents().is_some();
    let turned = |output: &Output| {
        let detail =
            "this scheme turns points by angles between them, so that no weights make its points; ask for json";
        output.fault(Fault::new("/format", detail))
    };
    faults.extend(outputs.iter().filter(weighs).map(turned));
    faults.extend(steering::check(input, *entry, plan));
    faults
}

/// Resolves the plan of an input; properties to which some output refers must be preserved.
pub(super) fn resolved(input: &Input, plan: Option<&PlanInput>, outputs: &[Output]) -> Result<Plan, Vec<Fault>> {
    let Some(plan) = plan else {
        return Ok(Plan::none(PlanInput::default().boundary, PlanInput::default().ends));
    };
    let subject = input.subject(plan);
    let referred = outputs.iter().find_map(|output| output.format.refers(&output.options)).filter(|_| subject.is_mesh);
    let subject = Subject { tags: subject.tags.or(referred), attached: subject.attached.or(referred), ..subject };
    Plan::resolve(plan, subject).map_err(|found| under("/plan", found))
}

/// Returns why distances cannot be measured from the surface of another job, if one is given.
pub(super) fn other_faults(CheckedJob { outputs, coordinate_system, other, .. }: &CheckedJob) -> Vec<Fault> {
    let Some(other) = other else { return Vec::new() };
    let fault = |place: &str, detail: &str| Some(Fault::new(format!("/distance_to{place}"), detail));
    let none = !outputs.iter().any(|output| shows_distances(&output.options));
    let of_curves = other.input.mesh().is_none();
    let found = [
        none.then(|| fault("", "no output shows distances; give one \"shading\": \"distance\", or leave it out")),
        of_curves.then(|| fault("/input", "distances are measured from a surface, curves have none; give a mesh")),
        (other.coordinate_system != *coordinate_system).then(|| {
            fault(
                "/input",
                "coordinates mean other lengths or directions here; give both inputs one \"unit\" and \"up\"",
            )
        }),
    ];
    found.into_iter().flatten().flatten().collect()
}
