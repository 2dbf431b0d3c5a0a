//! The report on a mesh.

use std::collections::BTreeMap;

use super::answer::MeshReport;
use crate::analysis::circles::outlooks;
use crate::math::vector::{cross, dot, length, minus, plus};
use crate::scheme::plan::Plan;
use crate::shape::mesh::Mesh;
use crate::shape::topology::{Topology, index};

/// Maximum number of pairs of coincident vertices in a report.
const MAX_REPORTED_PAIRS: usize = 1000;
/// Area of a face, as a share of its squared extent, up to which it counts as flat: some thousand times what rounding
/// leaves of it. Half and twice of it list nearly the same faces.
const FLAT_AREA_SHARE: f64 = 1e-12;

impl MeshReport {
    /// Creates the report on a mesh, with the fate of its latitude lines under a plan, or the reason why the plan does
    /// not fit the mesh.
    pub fn new(mesh: &Mesh, plan: Result<&Plan, &str>) -> Self {
        let topology = &mesh.topology;
        let isolated: Vec<u32> = (0..topology.n_vertices()).filter(|&v| topology.is_isolated(v)).map(index).collect();
        let mut valences = BTreeMap::new();
        for v in (0..topology.n_vertices()).filter(|&v| !topology.is_isolated(v)) {
            *valences.entry(topology.valence(v)).or_default() += 1;
        }
        let mut face_sizes = BTreeMap::new();
        for f in 0..topology.n_faces() {
            *face_sizes.entry(topology.face(f).len()).or_default() += 1;
        }
        let signed = |n: usize| i64::try_from(n).unwrap_or(i64::MAX);
        let joined = signed(topology.n_vertices() - isolated.len());
        let boundary_loops = topology.boundary_loops();
        Self {
            vertices: topology.n_vertices(),
            edges: topology.n_edges(),
            faces: topology.n_faces(),
            components: components(topology),
            euler_characteristic: joined - signed(topology.n_edges()) + signed(topology.n_faces()),
            manifold: true,
            closed: boundary_loops.is_empty(),
            boundary_loops,
            valences,
            creases: mesh.creases.len(),
            corners: mesh.corners.len() + mesh.semi_sharp_corners.len(),
            face_sizes,
            latitude_lines: outlooks(mesh, plan).into_iter().map(Into::into).collect(),
            isolated_vertices: isolated,
            degenerate_faces: degenerate(mesh),
            coincident_vertices: coincident(mesh),
        }
    }
}

fn components(topology: &Topology) -> usize {
    let mut seen = vec![false; topology.n_faces()];
    let mut n = 0;
    for first in 0..topology.n_faces() {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        n += 1;
        let mut waiting = vec![first];
        while let Some(f) = waiting.pop() {
            let neighbours = topology.half_edges(f).map(|corner| topology.twin(corner));
            for twin in neighbours.filter(|&twin| twin != crate::shape::topology::NONE) {
                let g = topology.face_of(twin);
                if !std::mem::replace(&mut seen[g], true) {
                    waiting.push(g);
                }
            }
        }
    }
    n
}

/// Returns the faces whose area (by Newell's sum) is at most 1e-12 of the square of their extent.
fn degenerate(mesh: &Mesh) -> Vec<u32> {
    let point = |v: u32| -> [f64; 3] {
        let at = 3 * v as usize;
        [mesh.positions[at], mesh.positions[at + 1], mesh.positions[at + 2]]
    };
    let is_flat = |f: &usize| {
        let face = mesh.topology.face(*f);
        let origin = point(face[0]);
        let relative = |v: u32| minus(point(v), origin);
        let (mut normal, mut extent) = ([0.0; 3], 0.0_f64);
        for (j, &v) in face.iter().enumerate() {
            let (p, q) = (relative(v), relative(face[(j + 1) % face.len()]));
            normal = plus(normal, cross(p, q));
            extent = extent.max(dot(p, p));
        }
        0.5 * length(normal) <= FLAT_AREA_SHARE * extent
    };
    (0..mesh.topology.n_faces()).filter(is_flat).map(index).collect()
}

/// Returns pairs of vertices with equal coordinates: each vertex with the first one at its position.
fn coincident(mesh: &Mesh) -> Vec<[u32; 2]> {
    let mut first: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    let mut pairs = Vec::new();
    for (v, place) in mesh.positions.as_chunks::<3>().0.iter().enumerate() {
        let known = *first.entry(place.map(f64::to_bits)).or_insert(index(v));
        if known != index(v) && pairs.len() < MAX_REPORTED_PAIRS {
            pairs.push([known, index(v)]);
        }
    }
    pairs
}
