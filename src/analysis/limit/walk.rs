//! Walks ring by ring around a vertex, an edge or a face of a net, to cut out the disc there.

use std::cmp::Ordering;

use super::bounds::{MAX_DISC_VERTICES, VERTICES_A_ROW};
use super::disc::{Centre, Disc, Located, RingCount};
use super::first_use::FirstUse;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::sharpness::Sharpness;
use crate::scheme::surroundings::Surroundings;
use crate::shape::directions::{Direction, Directions};
use crate::shape::topology::{NONE, Topology, index};
use crate::watch::{Stopped, Watch};

/// The net out of which a disc is cut.
#[derive(Debug, Clone, Copy)]
pub(super) struct WholeNet<'a> {
    /// The topology of the mesh.
    pub(super) topology: &'a Topology,
    /// Vertices that keep their place, ascending.
    pub(super) corners: &'a [u32],
    /// Sharp edges, and vertices with a sharpness of their own.
    pub(super) sharpness: Option<&'a Sharpness>,
    /// Directions of edges along latitude and longitude lines.
    pub(super) directions: Option<&'a Directions>,
    /// Number of steps so far of a scheme with its own connectivity, as far as it matters: 0, 1, then 2 or 3 by parity.
    pub(super) rounds: u32,
    /// What rules need to know of the net beyond a disc, if anything.
    pub(super) surroundings: Option<Surroundings>,
}

impl<'a> WholeNet<'a> {
    /// Returns the view of a net with its topology.
    pub(super) fn of(net: &'a MeshNet, topology: &'a Topology) -> Self {
        let rounds = if net.mesh.rounds < 2 { net.mesh.rounds } else { 2 + net.mesh.rounds % 2 };
        Self {
            topology,
            corners: &net.tags.corners,
            sharpness: net.sharpness.as_deref(),
            directions: net.annotations.directions.as_deref(),
            rounds,
            surroundings: net.surroundings,
        }
    }
}

/// Returns the greatest common divisor of two numbers that are not both 0 (Euclid).
fn common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

impl WholeNet<'_> {
    /// Returns the disc around a centre; `None` if it has more than [`MAX_DISC_VERTICES`] vertices.
    pub(super) fn disc(&self, centre: Centre, rings: RingCount) -> Option<Located> {
        self.walk(centre, self.starts(centre).next()?, rings)
    }

    /// Returns the least of the discs that walks around a centre find from all starts, the first of equal ones. It does
    /// not depend on the order in which the net numbers its faces. `None` means that the disc is too large.
    ///
    /// If two walks that start k faces apart find the same disc, a turn by k faces maps the surroundings to themselves.
    /// So does a turn by the greatest common divisor d of k and the number of starts, and all later walks repeat those
    /// from the first d starts: around a vertex that looks the same from all its faces, two walks are enough.
    ///
    /// # Errors
    /// [`Stopped`].
    pub(super) fn least_disc(
        &self,
        centre: Centre,
        rings: RingCount,
        watch: &Watch,
    ) -> Result<Option<Located>, Stopped> {
        let starts: Vec<u32> = self.starts(centre).collect();
        let mut different = starts.len();
        let mut least: Option<Located> = None;
        for (rotation, &start) in starts.iter().enumerate() {
            if rotation >= different {
                break;
            }
            watch.check()?;
            let Some(found) = self.walk(centre, start, rings) else { return Ok(None) };
            let found = Located { rotation, ..found };
            watch.advance(found.vertices.len() as u64 / VERTICES_A_ROW + 1);
            match least.as_ref().map(|known| (found.disc.cmp(&known.disc), rotation - known.rotation)) {
                None | Some((Ordering::Less, _)) => least = Some(found),
                Some((Ordering::Equal, rotation)) => different = common_divisor(rotation, different),
                Some((Ordering::Greater, _)) => {}
            }
        }
        Ok(least)
    }

    /// Returns the half-edges at which a walk around a centre may start.
    pub(super) fn starts(&self, centre: Centre) -> impl Iterator<Item = u32> {
        let (around, sides, of) = match centre {
            Centre::Vertex(v) => {
                let open = self.topology.boundary_edges(v as usize).is_some();
                (Some(self.topology.ring(v as usize).take(if open { 1 } else { usize::MAX })), None, None)
            }
            Centre::Edge(half_edge) => (None, Some([half_edge, self.topology.twin(half_edge)]), None),
            Centre::Face(f) => (None, None, Some(self.topology.half_edges(f as usize))),
        };
        let sides = sides.into_iter().flatten().filter(|&half_edge| half_edge != NONE);
        around.into_iter().flatten().chain(sides).chain(of.into_iter().flatten())
    }

    /// Returns the disc that a walk around a centre finds from the half-edge `start`; `None` if it has more than
    /// [`MAX_DISC_VERTICES`] vertices.
    pub(super) fn walk(&self, centre: Centre, start: u32, rings: RingCount) -> Option<Located> {
        let mut walk = RingWalk {
            whole: *self,
            sizes: Vec::new(),
            local: Vec::new(),
            reached: Vec::new(),
            known: FirstUse::default(),
            half_edges: Vec::new(),
            faces: FirstUse::default(),
            sharp_edges: Vec::new(),
            directions: Vec::new(),
        };
        let central = match centre {
            Centre::Vertex(v) => {
                walk.known.number(v);
                walk.reached.push(start);
                0
            }
            Centre::Edge(_) => {
                for half_edge in [start, self.topology.next(start)] {
                    walk.known.number(self.topology.vertex(half_edge));
                    walk.reached.push(half_edge);
                }
                2
            }
            Centre::Face(f) => {
                walk.add_face(start);
                self.topology.face(f as usize).len()
            }
        };
        let (mut from, mut support) = (0, 0);
        for ring in 1..=rings.disc {
            let to = walk.reached.len();
            (from..to).for_each(|u| walk.add_ring(u));
            from = to;
            if walk.reached.len() > MAX_DISC_VERTICES {
                return None;
            }
            if ring == rings.support {
                support = walk.reached.len();
            }
        }
        let vertices = walk.known.order;
        let is_corner = |v: &u32| self.corners.binary_search(v).is_ok();
        let fixed = vertices.iter().enumerate().filter(|(_, v)| is_corner(v)).map(|(i, _)| index(i)).collect();
        let fixed = if self.corners.is_empty() { Vec::new() } else { fixed };
        let n_vertices = vertices.len();
        let mut sharp_vertices = Vec::new();
        if let Some(sharpness) = self.sharpness.filter(|sharpness| !sharpness.vertices().is_empty()) {
            let known = vertices.iter().enumerate().map(|(i, &v)| (index(i), sharpness.vertex(v as usize).to_bits()));
            sharp_vertices.extend(known.filter(|&(_, bits)| bits != 0));
        }
        let disc = Disc {
            central: index(central),
            support,
            n_vertices,
            rounds: self.rounds,
            surroundings: self.surroundings,
            sizes: walk.sizes,
            vertices: walk.local,
            fixed,
            sharp_edges: walk.sharp_edges,
            sharp_vertices,
            directions: walk.directions,
        };
        Some(Located { disc, vertices, half_edges: walk.half_edges, rotation: 0 })
    }
}

/// The state of a walk ring by ring.
struct RingWalk<'a> {
    whole: WholeNet<'a>,
    /// For each face of the disc its number of vertices.
    sizes: Vec<u32>,
    /// The vertices of the faces, face after face, in the numbers of the disc.
    local: Vec<u32>,
    /// For each vertex of the disc the half-edge from it by which it was reached.
    reached: Vec<u32>,
    known: FirstUse,
    half_edges: Vec<u32>,
    faces: FirstUse,
    sharp_edges: Vec<(u32, u64)>,
    directions: Vec<Direction>,
}

impl RingWalk<'_> {
    /// Adds the faces around vertex `u` of the disc, counter-clockwise from the half-edge by which it was reached.
    fn add_ring(&mut self, u: usize) {
        let topology = self.whole.topology;
        let start = self.reached[u];
        let mut half_edge = start;
        loop {
            self.add_face(half_edge);
            half_edge = topology.twin(topology.previous(half_edge));
            if half_edge == start {
                return;
            }
            if half_edge == NONE {
                break;
            }
        }
        // at a boundary, the faces clockwise of the start follow
        for half_edge in topology.ring(topology.vertex(start) as usize) {
            if half_edge == start {
                return;
            }
            self.add_face(half_edge);
        }
    }

    fn add_face(&mut self, half_edge: u32) {
        let topology = self.whole.topology;
        let face = topology.face_of(half_edge);
        if !self.faces.number(index(face)).1 {
            return;
        }
        let size = topology.face(face).len();
        self.sizes.push(index(size));
        self.half_edges.push(half_edge);
        let mut at = half_edge;
        for _ in 0..size {
            if let Some(sharpness) = self.whole.sharpness {
                let bits = sharpness.edge(topology.edge(at) as usize).to_bits();
                if bits != 0 {
                    self.sharp_edges.push((index(self.local.len()), bits));
                }
            }
            self.directions.extend(self.whole.directions.map(|directions| directions.of(topology.edge(at))));
            let (number, new) = self.known.number(topology.vertex(at));
            if new {
                self.reached.push(at);
            }
            self.local.push(number);
            at = topology.next(at);
        }
    }
}
