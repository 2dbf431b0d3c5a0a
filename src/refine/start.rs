//! The nets and tangents with which a refinement starts.

use std::sync::Arc;

use crate::math::planar;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::Plan;
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::sharpness::Sharpness;
use crate::shape::attributes::Attributes;
use crate::shape::directions::Directions;
use crate::shape::mesh::Mesh;
use crate::shape::polygon::Polygon;
use crate::watch::{Stopped, Watch};

/// Returns the net of a polygon before refinement.
pub fn polygon_net(polygon: &Polygon, plan: &Plan) -> PolygonNet {
    let attributes = polygon.attributes.clone().map(Arc::new);
    let pinned = polygon.pinned.as_slice().into();
    PolygonNet { pinned, attributes, ..PolygonNet::new(polygon.len(), polygon.closed, plan.ends, &polygon.corners) }
}

/// Returns the net of a mesh before refinement.
pub fn mesh_net(mesh: &Mesh, plan: &Plan) -> MeshNet {
    let sharpness = Sharpness::of(&mesh.creases, &mesh.semi_sharp_corners);
    let net = MeshNet::new(mesh.topology.clone(), &mesh.corners, &mesh.holes, plan.boundary);
    let (attributes, directions) = carried(mesh, plan);
    net.with_sharpness(sharpness, plan.rules).carrying(attributes, directions)
}

/// Returns the vertex parameters and edge directions of a mesh under a plan. The vertices of a closed latitude line of
/// n vertices get the alpha `2 pi / n` if neither the plan nor the mesh gives one.
pub fn carried(mesh: &Mesh, plan: &Plan) -> (Option<Attributes>, Option<Directions>) {
    let (Some(latitude), Some(directions)) = (&plan.latitude, &mesh.directions) else {
        return (mesh.attributes.clone(), None);
    };
    let mut attributes = mesh.attributes.clone().unwrap_or_default();
    if latitude.own_alpha && attributes.alpha.is_none() {
        let mut alpha = vec![plan.alpha; mesh.topology.n_vertices()];
        for line in directions.lines(&mesh.topology).iter().filter(|line| line.closed) {
            #[expect(clippy::cast_precision_loss, reason = "lines have far fewer than 2^52 vertices")]
            let own = std::f64::consts::TAU / line.vertices.len() as f64;
            line.vertices.iter().for_each(|&v| alpha[v as usize] = own);
        }
        attributes.alpha = Some(alpha);
    }
    (Some(attributes), Some(directions.clone()))
}

/// Returns the unit tangents of a planar polygon: those given, or else those of circles through neighbouring points.
pub(super) fn start_tangents(polygon: &Polygon, watch: &Watch) -> Result<Vec<f64>, Stopped> {
    match &polygon.tangents {
        Some(tangents) => Ok(tangents.clone()),
        None => planar::tangents(polygon.points.as_chunks().0, polygon.closed, watch).map(Vec::into_flattened),
    }
}
