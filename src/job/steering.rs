//! Checks that inputs fit plans that turn tangents, and that plans use the tangents of inputs.

use super::entry::InputEntry;
use super::input::Input;
use crate::fault::Fault;
use crate::scheme::extent::Ends;
use crate::scheme::ops::OPERATORS;
use crate::scheme::plan::Plan;
use crate::shape::polygon::Polygon;

/// Returns every fault in the fit of plan and input, with pointers into the request.
pub(super) fn check(input: &Input, entry: InputEntry, plan: &Plan) -> Vec<Fault> {
    let Input::Polygons(polygons) = input else { return Vec::new() };
    let mut faults = Vec::new();
    let steered = plan.turns_tangents();
    if let Some(name) = steered.filter(|_| plan.ends == Ends::Natural && polygons.iter().any(|p| !p.closed)) {
        let detail = format!(
            "{name} finds the points next to an end from the tangent there, so that none is without a stencil; leave \
             \"ends\" out"
        );
        faults.push(Fault::new("/plan/ends", detail));
    }
    for (i, polygon) in polygons.iter().enumerate() {
        let found = match steered {
            Some(name) => unfit(polygon, name),
            None => unused(polygon),
        };
        faults.extend(found.into_iter().map(|fault| entry.fault(i, fault)));
    }
    faults
}

/// Returns why a plan that turns tangents cannot refine a polygon.
fn unfit(polygon: &Polygon, name: &str) -> Vec<Fault> {
    let mut faults = Vec::new();
    if polygon.rational {
        let detail = format!("{name} draws arcs through points as they are; give points without a weight");
        faults.push(Fault::new("/rational", detail));
    } else if polygon.dimension != 2 {
        let detail = format!("{name} refines points of 2 coordinates; these have {}", polygon.dimension);
        faults.push(Fault::new("/points/0", detail));
    }
    if !polygon.corners.is_empty() {
        let detail = format!(
            "{name} keeps every point in its place, and a tangent has one direction; for a corner give the point \
             twice, with a tangent for each side, and pin both"
        );
        faults.push(Fault::new("/corners", detail));
    }
    if polygon.attributes.is_some() {
        let detail = format!("{name} uses no alpha, kernel, compensation or delta; leave them out");
        faults.push(Fault::new("/parameters", detail));
    }
    faults
}

/// Returns faults for tangents that the plan does not use.
fn unused(polygon: &Polygon) -> Vec<Fault> {
    let users: Vec<_> = OPERATORS.iter().filter(|op| op.facts().turns_tangents).map(|op| op.facts().name).collect();
    let detail = format!("tangents are used by the preset {} alone; use it, or leave them out", users.join(", "));
    let tangents = polygon.tangents.is_some().then_some("/tangents");
    let pinned = (!polygon.pinned.is_empty()).then_some("/pinned");
    tangents.into_iter().chain(pinned).map(|place| Fault::new(place, detail.clone())).collect()
}
