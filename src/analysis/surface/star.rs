//! Nets that are regular except around the vertex, or the face, at their centre, and the walks that find sector
//! coordinates in any net.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::sectors::{LatticePoint, NetKind};
use crate::analysis::limit::Centre;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::tags::Boundary;
use crate::shape::check::{FaceList, Winding};
use crate::shape::directions::{Direction, Directions};
use crate::shape::topology::{NONE, Topology, index};

/// A place around the centre: a sector and a point of it.
pub(super) type SectorPoint = (usize, LatticePoint);

/// A net of n sectors around its centre.
#[derive(Debug)]
pub(super) struct Star {
    /// The net.
    pub(super) net: MeshNet,
    /// The vertex or the face at the centre.
    pub(super) centre: Centre,
    /// The place of each vertex; `None` for the vertex at the centre.
    pub(super) places: Vec<Option<SectorPoint>>,
}

impl Star {
    /// Creates the net of n sectors with points up to a radius.
    pub(super) fn new(kind: NetKind, n: usize, radius: i32) -> Self {
        let (points, cells) = (kind.points(radius), kind.faces(radius));
        let mut places: Vec<Option<SectorPoint>> = if kind.has_centre() { vec![None] } else { Vec::new() };
        places.extend((0..n).flat_map(|s| points.iter().map(move |&p| Some((s, p)))));
        let numbers: BTreeMap<SectorPoint, u32> =
            places.iter().enumerate().filter_map(|(v, place)| place.map(|place| (place, index(v)))).collect();
        let at = |s: usize, [i, j]: LatticePoint| match (kind.has_centre(), i, j) {
            (true, 0, 0) => 0,
            (true, 0, j) => numbers[&((s + 1) % n, [j, 0])],
            _ => numbers[&(s % n, [i, j])],
        };
        let mut faces = FaceList::default();
        if !kind.has_centre() {
            faces.push((0..n).map(|s| at(s, [0, 0])));
        }
        for s in 0..n {
            cells.iter().for_each(|face| faces.push(face.iter().map(|&p| at(s, p))));
            if !kind.has_centre() {
                let before = (s + n - 1) % n;
                let strip = |i: i32| [at(before, [0, i]), at(before, [0, i + 1]), at(s, [i + 1, 0]), at(s, [i, 0])];
                (0..radius).for_each(|i| faces.push(strip(i)));
            }
        }
        let checked = Topology::of_faces(places.len(), faces, Winding::Refuse).expect("sectors side by side fit");
        let mut net = MeshNet::new(Arc::new(checked.topology), &[], &[], Boundary::EdgeOnly);
        // the net is cut out of a larger one, so that D loses no vertices at its rim
        net.tags.cut = true;
        let centre = if kind.has_centre() { Centre::Vertex(0) } else { Centre::Face(0) };
        Self { net, centre, places }
    }
}

impl Star {
    /// Returns the directions of the edges of a regular net whose first lattice coordinate counts steps along latitude
    /// lines.
    pub(super) fn latitude_lines(&self, kind: NetKind) -> Directions {
        let topology = &self.net.mesh.base;
        let row = |v: u32| {
            let lattice = |(sector, point): SectorPoint| kind.rotated(point, i32::try_from(sector).unwrap_or(0));
            self.places[v as usize].map_or(0, |place| lattice(place)[1])
        };
        let direction = |e: usize| {
            let [a, b] = topology.ends(e).map(row);
            if a == b { Direction::Latitude } else { Direction::Longitude }
        };
        Directions::of_edges((0..topology.n_edges()).map(direction).collect())
    }
}

/// Returns the half-edges at which the sectors around a centre begin, counter-clockwise.
pub(super) fn starts(topology: &Topology, centre: Centre) -> Vec<u32> {
    match centre {
        Centre::Vertex(v) => topology.ring(v as usize).collect(),
        Centre::Face(f) => topology.half_edges(f as usize).collect(),
        Centre::Edge(_) => Vec::new(),
    }
}

/// Returns the vertices at the points of the sector that begins at a half-edge, as far as the net reaches.
pub(super) fn sector(topology: &Topology, kind: NetKind, start: u32, radius: i32) -> BTreeMap<LatticePoint, u32> {
    let half = kind.regular() / 2;
    let turned = |half_edge: u32, times: usize| (0..times).try_fold(half_edge, |at, _| counter_clockwise(topology, at));
    let straight = |half_edge: u32| turned(topology.twin(half_edge), half);
    let mut found = BTreeMap::new();
    // the next half-edge along the first side, and the index of the vertex from which it leaves
    let (mut along, mut i) = match kind {
        NetKind::Dual => (turned(start, half), 0),
        NetKind::Quads | NetKind::Triangles => (straight(start), 1),
    };
    while let Some(out) = along.filter(|_| i <= radius) {
        found.insert([i, 0], topology.vertex(out));
        let mut side = turned(out, 1);
        let mut j = 1;
        while let Some(up) = side.filter(|_| kind.radius([i, j]) <= radius) {
            found.insert([i, j], topology.vertex(topology.next(up)));
            side = straight(up);
            j += 1;
        }
        along = straight(out);
        i += 1;
    }
    found
}

/// Returns the half-edge that leaves the same vertex after this one, counter-clockwise; `None` at the rim.
fn counter_clockwise(topology: &Topology, half_edge: u32) -> Option<u32> {
    if half_edge == NONE {
        return None;
    }
    let next = topology.twin(topology.previous(half_edge));
    (next != NONE).then_some(next)
}
