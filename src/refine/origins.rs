//! Traces the point at which a refinement failed back to points of the input.

use crate::scheme::mesh_net::MeshNet;
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::step_error::{About, StepError};
use crate::shape::polygon::Polygon;
use crate::shape::topology::index;

/// Adds to an operator's error on the net of a mesh the vertices of the input from which the named point was made.
pub(super) fn on_mesh(net: &MeshNet, mut error: StepError) -> StepError {
    if let About::Point { point, from, .. } = &mut error.about {
        *from = of_mesh(net, *point);
    }
    error
}

/// Adds to an operator's error on the net of a polygon the input points from which the named point was made.
/// `arity` is that of the operator; compensations are indexed by the points that the operator makes.
pub(super) fn on_polygon(polygon: &Polygon, net: &PolygonNet, arity: u32, mut error: StepError) -> StepError {
    if let About::Point { name, point, from } = &mut error.about {
        let ends = usize::from(!net.is_closed());
        let n =
            if *name == "compensation" { (net.n_control() - ends) * arity as usize + ends } else { net.n_control() };
        *from = of_polygon(polygon, n, *point);
    }
    error
}

/// Returns the base vertices of the cell of a vertex of `net`, or of the cells around an edge point or face point of
/// it.
fn of_mesh(net: &MeshNet, point: usize) -> Vec<u32> {
    let topology = net.mesh.topology();
    let (n_v, n_e) = (topology.n_vertices(), topology.n_edges());
    let around = match point.checked_sub(n_v) {
        None => vec![index(point)],
        Some(e) if e < n_e => topology.ends(e).to_vec(),
        Some(i) => topology.face(i - n_e).to_vec(),
    };
    let Some(order) = net.mesh.order() else { return sorted(around) };
    let base = &net.mesh.base;
    let cells = (0..order.n_vertices()).filter(|&v| around.contains(&order.constructed(v))).map(|v| order.origin(v));
    let vertices = cells.flat_map(|origin| match origin.dimension {
        0 => vec![origin.cell],
        1 => base.ends(origin.cell as usize).to_vec(),
        _ => base.face(origin.cell as usize).to_vec(),
    });
    sorted(vertices.collect())
}

/// Returns the ends of the polygon edge that contains point `point` of `n`, or the input point itself if they coincide;
/// empty if the refinement lost points at the ends, so that they do not divide evenly among the edges.
fn of_polygon(polygon: &Polygon, n: usize, point: usize) -> Vec<u32> {
    let (edges, now) = if polygon.closed { (polygon.len(), n) } else { (polygon.len() - 1, n.saturating_sub(1)) };
    if edges == 0 || now < edges || now % edges != 0 {
        return Vec::new();
    }
    let pieces = now / edges;
    let (edge, at) = (point / pieces, point % pieces);
    if at == 0 { vec![index(edge)] } else { sorted(vec![index(edge), index((edge + 1) % polygon.len())]) }
}

fn sorted(mut points: Vec<u32>) -> Vec<u32> {
    points.sort_unstable();
    points.dedup();
    points
}
