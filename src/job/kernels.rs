//! Checks kernels and compensations of single points against a plan.

use super::entry::InputEntry;
use super::input::Input;
use crate::fault::Fault;
use crate::scheme::local::{MAX_COMPENSATION, has_average};
use crate::scheme::operator::Role;
use crate::scheme::plan::Plan;
use crate::shape::attributes::Attributes;

/// Returns the faults, with pointers into the request, of kernels for which the first level has no average, and of
/// compensations beyond their bound. Perturbed kernels differ at each level and are not checked here.
pub(super) fn check(input: &Input, entry: InputEntry, plan: &Plan, levels: u32) -> Vec<Fault> {
    let has = |role: Role| plan.word.letters(levels).any(|letter| letter.facts().role == role);
    let perturbed = plan.perturbation.is_some_and(|perturbation| perturbation.amplitude != 0.0);
    let (averages, pushes_back) = (has(Role::Upsample) && !perturbed, has(Role::PushBack));
    let of_shape = |shape: usize, attributes: Option<&Attributes>| {
        let kernel = attributes.filter(|_| averages).and_then(without_average);
        let compensation = attributes.filter(|_| pushes_back).and_then(too_large);
        kernel.into_iter().chain(compensation).map(move |fault| entry.fault(shape, fault))
    };
    match input {
        Input::Mesh(mesh) => of_shape(0, mesh.attributes.as_ref()).collect(),
        Input::Polygons(polygons) => {
            let each = polygons.iter().enumerate();
            each.flat_map(|(i, polygon)| of_shape(i, polygon.attributes.as_ref())).collect()
        }
    }
}

/// Returns a fault for the first kernel of a point for which no average exists.
fn without_average(attributes: &Attributes) -> Option<Fault> {
    let kernel = attributes.kernel.as_ref()?;
    let i = kernel.iter().position(|&kernel| !has_average(kernel))?;
    let detail =
        format!("with the kernel {} no average exists, as its weights add up to 0; it is any number but -1", kernel[i]);
    Some(Fault::new(format!("/parameters/kernel/{i}"), detail))
}

/// Returns a fault for the first compensation of a point that exceeds the bound.
fn too_large(attributes: &Attributes) -> Option<Fault> {
    let compensation = attributes.compensation.as_ref()?;
    let i = compensation.iter().position(|&value| value.abs() > MAX_COMPENSATION)?;
    let detail = format!(
        "the compensation is {}; at most {MAX_COMPENSATION} in size is allowed: choose a smaller one",
        compensation[i]
    );
    Some(Fault::new(format!("/parameters/compensation/{i}"), detail))
}
