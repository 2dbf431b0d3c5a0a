//! The polygons of a job, refined as one of its outputs wants them.

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

/// Whether an output wants points of the limit curve, and whether tangents.
fn wanted(output: &Output) -> [bool; 2] {
    [output.options.choice(POSITIONS.name) == Some(LIMIT), output.options.flag(TANGENTS.name)]
}

/// Whether an output wants limit points.
pub(super) fn moves_points(output: &Output) -> bool {
    wanted(output)[0]
}

/// Checks that the plan has for these polygons what an output wants of their limit.
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

/// The polygons of a job after its levels.
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
    // a scheme that turns tangents interpolates: its points are limit points, and it has its own tangents
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

/// A polygon as it was given, as the curve that pictures show beside its refinement.
pub(super) fn control(polygon: &Polygon) -> Curve {
    let points = polygon.points.clone();
    divided(Curve { points, dimension: polygon.dimension, closed: polygon.closed, tangents: None }, polygon)
}

/// Unit tangents; those of rational points are tangents of the projected curve, `(x' w - x w') / |x' w - x w'|`.
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

/// The curve of a result.
fn finished(curve: Curve, polygon: &Polygon, shape: usize) -> Result<Curve, RunError> {
    let curve = divided(curve, polygon);
    if !polygon.rational || curve.points.iter().all(|x| x.is_finite()) {
        return Ok(curve);
    }
    let detail = "a weight of the refined curve is 0, a point at infinity; choose other weights";
    Err(RunError::Impossible(JobFault::new(JobPart::Shape(shape), "", detail)))
}

/// The curve of a polygon, homogeneous points divided by their last coordinate.
fn divided(curve: Curve, polygon: &Polygon) -> Curve {
    if !polygon.rational {
        return curve;
    }
    let dimension = polygon.result_dimension();
    let divided = |point: &[f64]| point[..dimension].iter().map(|x| x / point[dimension]).collect::<Vec<_>>();
    let points = curve.points.chunks_exact(curve.dimension).flat_map(divided).collect();
    Curve { points, dimension, ..curve }
}
