//! Normals of the limit surface, one per sector of a vertex.

use super::field::VertexMasks;
use crate::math::vector::{cross, direction, length, plus};
use crate::refine::Normals;

/// Sine of the angle between two tangents up to which they count as parallel.
/// Tangents are exact to some 1e-15, and their normal is the less exact the smaller the sine is: at 1e-9 it has six
/// digits. Half of it accepts normals with a third of a digit less; twice of it refuses those of surfaces that are
/// folded twice as wide.
const PARALLEL_SINE: f64 = 1e-9;

/// Returns the unit normals of all vertices, and a warning if some do not exist. `places` are the sectors of the field,
/// sector 0 of all vertices first; `first` and `second` are their tangents, `n x 3`. A vertex with several sectors has
/// a normal per side, and as its own the direction of their sum. Missing normals are zero.
pub(super) fn of(
    field: &VertexMasks<'_>,
    places: &[(u32, usize)],
    first: &[f64],
    second: &[f64],
) -> (Normals, Option<String>) {
    let (first, second) = (first.as_chunks::<3>().0, second.as_chunks::<3>().0);
    let found: Vec<Option<[f64; 3]>> = first.iter().zip(second).map(|(t, u)| normal(*t, *u)).collect();
    let n = field.n_vertices();
    let missing = |&at: &usize| found[at].is_none() && !field.is_isolated(places[at].0 as usize);
    let mut missing: Vec<usize> = (0..found.len()).filter(missing).collect();
    let warning = missing.first().map(|&at| {
        let (v, sector) = (places[at].0 as usize, places[at].1);
        let place = field.describe(v);
        let lie_in_a_line = || format!("the points around {place} lie in a line");
        field.no_tangents(v, sector).map_or_else(lie_in_a_line, |why| why.at(&place))
    });
    missing.sort_unstable_by_key(|&at| places[at].0);
    missing.dedup_by_key(|at| places[*at].0);
    let warning = warning.map(|why| explained(missing.len(), n, &why));
    let mut of_vertices: Vec<[f64; 3]> = found[..n].iter().map(|normal| normal.unwrap_or_default()).collect();
    let mut sides = Vec::new();
    let beside: Vec<usize> = (n..places.len()).collect();
    for others in beside.chunk_by(|&a, &b| places[a].0 == places[b].0) {
        let v = places[others[0]].0;
        let of_sector = |sector: usize| if sector == 0 { found[v as usize] } else { found[others[sector - 1]] };
        let corners = field.sides(v as usize);
        sides.extend(corners.iter().map(|&(next, sector)| ([v, next], of_sector(sector).unwrap_or_default())));
        let all: Option<Vec<[f64; 3]>> = (0..=others.len()).map(of_sector).collect();
        let sum = all.and_then(|all| direction(all.into_iter().fold([0.0; 3], plus)));
        of_vertices[v as usize] = sum.unwrap_or_default();
    }
    sides.sort_unstable_by_key(|&(side, _)| side);
    (Normals { of_vertices: of_vertices.into_flattened().into(), sides }, warning)
}

/// Returns the warning that `missing` of `all` vertices have no limit normal, because of `why`.
fn explained(missing: usize, all: usize, why: &str) -> String {
    let vertices = if all == 1 { "vertex" } else { "vertices" };
    format!("at {missing} of {all} {vertices} the normal is weighted by area, as a limit one does not exist: {why}")
}

/// Returns the unit vector along `t x u`; `None` if t and u are parallel.
fn normal(t: [f64; 3], u: [f64; 3]) -> Option<[f64; 3]> {
    let product = cross(direction(t)?, direction(u)?);
    if length(product) > PARALLEL_SINE { direction(product) } else { None }
}
