//! The cost of limits of surfaces in rows and bytes.

use super::complete::Job;
use super::input::Input;
use super::output::Output;
use crate::analysis::limit::{Follow, LimitCost, LimitRequest, ROWS_A_POINT, cost as limit_cost, followed_points};
use crate::output::surface;
use crate::scheme::forecast::Forecast;
use crate::shape::attributes::Attributes;
use crate::shape::tile::Tile;

/// Returns upper bounds of the rows and bytes for the limits of an output: the topology of the last level (48 per
/// face), the class of a vertex and its new point (29), two tangents and a normal (72). A vertex whose neighbourhood is
/// treated individually has its own weights for the points around it (8 each); faces of such nets store their indices
/// and those of their edges (88).
pub(super) fn limit_surface(job: &Job, forecast: &Forecast) -> (u128, u128) {
    let count = forecast.levels.last().copied().unwrap_or_default();
    let needs = |output: &Output| {
        let [positions, normals] = surface::limit(&output.options).map(u128::from);
        if positions + normals == 0 {
            return (0, 0);
        }
        let asked = LimitRequest { positions: positions > 0, normals: normals > 0 };
        let points = u128::from(followed_points(&job.plan, asked));
        let of_face = if points > 0 { 48 + 88 } else { 48 };
        let of_vertex = 29 + 72 * normals + 8 * points * (1 + 2 * normals);
        let bytes = count.faces.saturating_mul(of_face).saturating_add(count.vertices.saturating_mul(of_vertex));
        let rows = positions + 2 * normals + u128::from(ROWS_A_POINT) * points;
        (count.vertices.saturating_mul(rows), bytes)
    };
    let needs = job.outputs.iter().map(needs);
    needs.fold((0, 0), |most, need| (most.0.max(need.0), most.1.max(need.1)))
}

/// Returns the cost of limits apart from their rows: for extraordinary vertices, or for all vertices if they have
/// parameters of their own or faces are triangles.
pub(super) fn limit_patches(job: &Job, forecast: &Forecast) -> LimitCost {
    let Input::Mesh(mesh) = &*job.input else { return LimitCost::default() };
    let vertices = forecast.levels.last().map_or(0, |count| count.vertices);
    let (topology, cycle) = (&mesh.topology, &job.plan.word.cycle);
    let regular = |v: &usize| topology.boundary_edges(*v).is_none() && topology.ring(*v).take(5).count() == 4;
    let of_quads = mesh.attributes.is_none() && job.plan.tile() == Tile::Quad;
    let extraordinary = if of_quads {
        let fours = |n: usize| n.div_ceil(4);
        let uneven = (0..topology.n_vertices()).filter(|v| !regular(v));
        let vertices: usize = uneven.map(|v| fours(topology.ring(v).count())).sum();
        let sizes = (0..topology.n_faces()).map(|f| topology.face(f).len());
        let faces: usize = sizes.filter(|&size| size != 4).map(fours).sum();
        vertices as u128 + faces as u128 + mesh.creases.len() as u128
    } else {
        vertices
    };
    // the discs are compared for the least and the greatest values of all vertex parameters
    let own_alpha = job.plan.latitude.as_ref().is_some_and(|latitude| latitude.own_alpha);
    let given = |attributes: &Attributes| attributes.arrays().iter().filter(|(_, array)| array.is_some()).count();
    let kinds = mesh.attributes.as_ref().map_or(0, given).max(usize::from(own_alpha));
    let plan = &job.plan;
    let halved = [Some(plan.alpha), plan.compensation_alpha].into_iter().flatten().any(|alpha| alpha != 0.0);
    let fades = halved && plan.kernel.iter().chain([&plan.compensation]).any(|function| !function.is_constant());
    let follow = match kinds {
        0 if fades => Follow::PlanValues,
        0 => Follow::Connectivity,
        _ => Follow::VertexParameters,
    };
    limit_cost(cycle, 1 << kinds, extraordinary, vertices, follow)
}
