//! The points of the input that make a point at which a refinement had to end.

use crate::scheme::mesh_net::MeshNet;
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::step_error::{About, StepError};
use crate::shape::polygon::Polygon;
use crate::shape::topology::index;

/// The error of an operator on a net of a mesh; one about a value of a point with the vertices of the input that make
/// it.
pub(super) fn on_mesh(net: &MeshNet, mut error: StepError) -> StepError {
    if let About::Point { point, from, .. } = &mut error.about {
        *from = of_mesh(net, *point);
    }
    error
}

/// Names the points of the input in an error of an operator of this arity on the net of a polygon; compensations belong
/// to the points that it makes.
pub(super) fn on_polygon(polygon: &Polygon, net: &PolygonNet, arity: u32, mut error: StepError) -> StepError {
    if let About::Point { name, point, from } = &mut error.about {
        let ends = usize::from(!net.is_closed());
        let n =
            if *name == "compensation" { (net.n_control() - ends) * arity as usize + ends } else { net.n_control() };
        *from = of_polygon(polygon, n, *point);
    }
    error
}

/// The vertices of the base around a vertex of a net, or around the point of an edge or a face of it.
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

/// The ends of the edge of a polygon on which point `point` of `n` stands, or the point of the polygon there; none
/// where points were lost on the way.
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
