//! Which kernels of single points a plan takes.

use super::Input;
use crate::fault::Fault;
use crate::scheme::local::has_average;
use crate::scheme::ops::Role;
use crate::scheme::plan::Plan;
use crate::shape::attributes::Attributes;

/// Kernels with which the first level has no average, with pointers below the job; polygons are counted as in a list.
/// Perturbed ones are another number each level.
pub(super) fn check(input: &Input, plan: &Plan, levels: u32) -> Vec<Fault> {
    let upsamples = plan.word.letters(levels).any(|letter| letter.operator.role() == Role::Upsample);
    let perturbed = plan.perturbation.is_some_and(|perturbation| perturbation.amplitude != 0.0);
    if !upsamples || perturbed {
        return Vec::new();
    }
    match input {
        Input::Mesh(mesh) => first(mesh.attributes.as_ref(), "/input/mesh").into_iter().collect(),
        Input::Polygons(polygons) => {
            let each = polygons.iter().enumerate();
            each.filter_map(|(i, polygon)| first(polygon.attributes.as_ref(), &format!("/input/polygons/{i}")))
                .collect()
        }
    }
}

/// The first of the kernels that points carry with which no average exists.
fn first(attributes: Option<&Attributes>, place: &str) -> Option<Fault> {
    let kernel = attributes?.kernel.as_ref()?;
    let i = kernel.iter().position(|&kernel| !has_average(kernel))?;
    let detail =
        format!("with the kernel {} no average exists, as its weights add up to 0; it is any number but -1", kernel[i]);
    Some(Fault::new(format!("{place}/parameters/kernel/{i}"), detail))
}
