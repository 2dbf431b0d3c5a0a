//! The points of the input that make a point at which a refinement had to end.

use crate::scheme::mesh_net::MeshNet;
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::step::StepError;
use crate::shape::polygon::Polygon;
use crate::shape::topology::index;

/// The error of an operator on a net of a mesh; points without an average, or of a compensation beyond its bound, with the vertices of the input that make them.
pub(super) fn on_mesh(net: &MeshNet, error: StepError) -> StepError {
    match error {
        StepError::NoAverage { name, point, value, .. } => {
            StepError::NoAverage { name, point, value, from: of_mesh(net, point) }
        }
        StepError::LargeCompensation { point, value, alpha, .. } => {
            StepError::LargeCompensation { point, value, alpha, from: of_mesh(net, point) }
        }
        other => other,
    }
}

/// The same on a net of a polygon, the operator's arity given.
pub(super) fn on_polygon(polygon: &Polygon, net: &PolygonNet, arity: u32, error: StepError) -> StepError {
    match error {
        StepError::NoAverage { name, point, value, .. } => {
            StepError::NoAverage { name, point, value, from: of_polygon(polygon, net.n_control(), point) }
        }
        StepError::LargeCompensation { point, value, alpha, .. } => {
            let ends = usize::from(!net.is_closed());
            let n = (net.n_control() - ends) * arity as usize + ends;
            StepError::LargeCompensation { point, value, alpha, from: of_polygon(polygon, n, point) }
        }
        other => other,
    }
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

/// The ends of the edge of a polygon on which point `point` of `n` stands, or the point of the polygon there; none where
/// points were lost on the way.
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
