//! Refines the polygons of a job as one of its outputs requires.

use super::entry::{JobFault, JobPart};
use super::error::RunError;
use super::output::Output;
use crate::analysis::curve::{LimitRows, NoLimit, check, refine_to_limit};
use crate::fault::Fault;
use crate::math::vector::reduce;
use crate::output::{LIMIT, POSITIONS, TANGENTS};
use crate::refine::refine_polygon;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::polygon::Polygon;
use crate::shape::source::Curve;
use crate::watch::Watch;

/// Returns whether an output needs points of the limit curve, and whether it needs tangents.
fn wanted(output: &Output) -> [bool; 2] {
    [output.options.choice(POSITIONS.name) == Some(LIMIT), output.options.flag(TANGENTS.name)]
}

/// Returns whether an output needs limit points.
pub(super) fn moves_points(output: &Output) -> bool {
    wanted(output)[0]
}

/// Checks that the plan can provide the limits of these polygons that an output needs.
///
/// # Errors
/// A fault below the output.
pub(super) fn check_wanted(polygons: &[Polygon], plan: &Plan, levels: u32, output: &Output) -> Result<(), Fault> {
    let [points, tangents] = wanted(output);
    if !points && !tangents || plan.turns_tangents().is_some() {
        return Ok(());
    }
    let place = if points { "/positions" } else { "/tangents" };
    let fault = |error: NoLimit| Fault::new(place, error.to_string());
    polygons.iter().try_for_each(|polygon| check(polygon, plan)).map_err(fault)?;
    let rows = LimitRows::of(plan, levels).map_err(|error| fault(error.into()))?;
    if tangents && rows.tangent.is_none() {
        return Err(Fault::new("/tangents", NoLimit::NoTangent.to_string()));
    }
    Ok(())
}

/// Returns the polygons of a job after its levels.
///
/// # Errors
/// [`RunError`].
pub(super) fn refine_all(
    polygons: &[Polygon],
    (plan, levels, steps): (&Plan, u32, &[Scheduled]),
    output: &Output,
    watch: &Watch,
) -> Result<Vec<Curve>, RunError> {
    let [wants_points, wants_tangents] = wanted(output);
    // a scheme that turns tangents is interpolating: its points are limit points, and it provides tangents
    if !wants_points && !wants_tangents || plan.turns_tangents().is_some() {
        let refine = |(i, polygon): (usize, &Polygon)| {
            let curve = refine_polygon(polygon, plan, steps, watch);
            finished(curve.map_err(|error| RunError::of_shape(error, polygon.attributes.as_ref(), i))?, polygon, i)
        };
        return polygons.iter().enumerate().map(refine).collect();
    }
    let rows = LimitRows::of(plan, levels);
    let no_limit = |error| JobFault::new(JobPart::Plan, "", NoLimit::Plan(error));
    let rows = rows.map_err(|error| RunError::Impossible(no_limit(error)))?;
    let refine = |(i, polygon): (usize, &Polygon)| {
        let refined = refine_to_limit(polygon, plan, steps, &rows, watch);
        let (mut curve, limit) = refined.map_err(|error| RunError::of_shape(error, polygon.attributes.as_ref(), i))?;
        if wants_tangents {
            curve.tangents = Some(tangents(polygon, &limit.points, &limit.tangents));
        }
        if wants_points {
            curve.points = limit.points;
        }
        finished(curve, polygon, i)
    };
    polygons.iter().enumerate().map(refine).collect()
}

/// Returns the control polygon as the curve that pictures show beside its refinement.
pub(super) fn control(polygon: &Polygon) -> Curve {
    let points = polygon.points.clone();
    divided(Curve { points, dimension: polygon.dimension, closed: polygon.closed, tangents: None }, polygon)
}

/// Returns unit tangents; for rational points those of the projected curve, `(x' w - x w') / |x' w - x w'|`.
fn tangents(polygon: &Polygon, points: &[f64], derivatives: &[f64]) -> Vec<f64> {
    let (width, kept) = (polygon.dimension, polygon.result_dimension());
    let mut tangents = Vec::with_capacity(points.len() / width * kept);
    for (point, derivative) in points.chunks_exact(width).zip(derivatives.chunks_exact(width)) {
        let last = width - 1;
        let projected = |i: usize| derivative[i] * point[last] - point[i] * derivative[last];
        let along = |i: usize| if polygon.rational { projected(i) } else { derivative[i] };
        let mut tangent: Vec<f64> = (0..kept).map(along).collect();
        match reduce(&mut tangent) {
            Some(length) => tangents.extend(tangent.iter().map(|x| x / length)),
            None => tangents.extend(vec![0.0; kept]),
        }
    }
    tangents
}

/// Returns the curve of a result, after a check that its points are finite.
fn finished(curve: Curve, polygon: &Polygon, shape: usize) -> Result<Curve, RunError> {
    let curve = divided(curve, polygon);
    if !polygon.rational || curve.points.iter().all(|x| x.is_finite()) {
        return Ok(curve);
    }
    let detail = "a weight of the refined curve is 0, a point at infinity; choose other weights";
    Err(RunError::Impossible(JobFault::new(JobPart::Shape(shape), "", detail)))
}

/// Returns the curve of a polygon, with homogeneous points divided by their last coordinate.
fn divided(curve: Curve, polygon: &Polygon) -> Curve {
    if !polygon.rational {
        return curve;
    }
    let dimension = polygon.result_dimension();
    let divided = |point: &[f64]| point[..dimension].iter().map(|x| x / point[dimension]).collect::<Vec<_>>();
    let points = curve.points.chunks_exact(curve.dimension).flat_map(divided).collect();
    Curve { points, dimension, ..curve }
}
