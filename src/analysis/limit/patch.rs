//! Patches: the faces around a vertex, an edge or a face, numbered in an order that depends on their connectivity only.

use std::cmp::Ordering;
use std::sync::Arc;

use super::cycle::is_triangular;
use super::frame::Frame;
use super::numbers::Numbers;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::sharpness::Sharpness;
use crate::scheme::surroundings::Surroundings;
use crate::scheme::tags::{Boundary, Tags};
use crate::shape::check::{FaceList, Winding};
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::directions::{Direction, Directions};
use crate::shape::topology::{NONE, Topology, index};
use crate::watch::{Stopped, Watch};

/// Most vertices of a patch: about what three rings around a vertex of valence 1,500 have.
pub(super) const MAX_VERTICES: usize = 20_000;

/// Vertices of patches that are found in the time of a row of a table, 100 ns.
pub(super) const VERTICES_A_ROW: u64 = 2;

/// What a patch lies around.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Centre {
    /// A vertex.
    Vertex(u32),
    /// The edge from a corner to the next one of its face, as dual schemes have it where a boundary was.
    Edge(u32),
    /// A face, as dual schemes have it around their limit points.
    Face(u32),
}

/// How many rings of faces belong to a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rings {
    /// Rings whose vertices decide about the limit.
    pub(super) support: usize,
    /// Rings whose connectivity decides about it; at least as many.
    pub(super) patch: usize,
}

/// A net in the mesh that a patch is cut out of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Whole<'a> {
    /// Its topology.
    pub(super) topology: &'a Topology,
    /// Vertices that keep their place, ascending.
    pub(super) corners: &'a [u32],
    /// Sharp edges, and vertices that are sharp for a while.
    pub(super) sharpness: Option<&'a Sharpness>,
    /// Directions of edges along latitude and longitude lines.
    pub(super) directions: Option<&'a Directions>,
    /// Steps so far of a scheme of its own connectivity, as far as they matter: the first one, then odd and even ones.
    pub(super) rounds: u32,
    /// What has to be known of the net beyond a patch, where it has a say.
    pub(super) surroundings: Option<Surroundings>,
}

impl<'a> Whole<'a> {
    /// A net, `topology` being its own.
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

/// The connectivity of a patch and everything else that the weights of its limit depend on.
///
/// Vertices are numbered ring by ring around the centre; the centre is vertex 0, or the edge or the face of the first
/// vertices, which then begins the first face.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Patch {
    /// Number of vertices of the face or the edge at the centre; 0 where the centre is a vertex.
    central: u32,
    /// Number of vertices within the rings that decide about the limit.
    pub(super) support: usize,
    pub(super) n_vertices: usize,
    rounds: u32,
    surroundings: Option<Surroundings>,
    sizes: Vec<u32>,
    vertices: Vec<u32>,
    /// Vertices that keep their place, ascending.
    fixed: Vec<u32>,
    /// The bits of the sharpness of edges, each at the corners of the faces beside it, and of vertices; ascending.
    sharp_edges: Vec<(u32, u64)>,
    sharp_vertices: Vec<(u32, u64)>,
    /// The direction of the edge from each corner, where edges have any.
    directions: Vec<Direction>,
}

/// A patch and where it was found.
#[derive(Debug, Clone)]
pub(super) struct Found {
    /// The patch.
    pub(super) patch: Patch,
    /// For each of its vertices the number in the whole.
    pub(super) vertices: Vec<u32>,
    /// For each of its faces the corner in the whole that is the first one here.
    pub(super) corners: Vec<u32>,
    /// Where the walk started: this many corners after the first in the ring of the centre.
    pub(super) turn: usize,
}

impl Patch {
    /// The centre, in the numbers of the patch.
    pub(super) fn centre(&self) -> Centre {
        match self.central {
            0 => Centre::Vertex(0),
            2 => Centre::Edge(0),
            _ => Centre::Face(0),
        }
    }

    /// The centre as weights of vertices: itself, or the mean of the vertices of the edge or face.
    pub(super) fn middle(&self) -> Vec<f64> {
        let mut weights = vec![0.0; self.support];
        if self.central == 0 {
            weights[0] = 1.0;
        } else {
            weights[..self.central as usize].fill(1.0 / f64::from(self.central));
        }
        weights
    }

    /// The faces, one slice of vertices each, those at the centre first and each starting nearest to it.
    pub(super) fn faces(&self) -> impl Iterator<Item = &[u32]> {
        let mut rest = self.vertices.as_slice();
        self.sizes.iter().map(move |&size| {
            let (face, after) = rest.split_at(size as usize);
            rest = after;
            face
        })
    }

    /// The faces around the vertex at the centre, the one that is the centre, or the one that begins with its edge.
    pub(super) fn central_faces(&self) -> impl Iterator<Item = &[u32]> {
        let central = self.central as usize;
        let at_centre = move |(i, face): &(usize, &[u32])| if central == 0 { face[0] == 0 } else { *i == 0 };
        self.faces().enumerate().take_while(at_centre).map(|(_, face)| face)
    }

    /// Whether the edge from a corner, counted over all faces, to the next of its face stays sharp for ever.
    pub(super) fn is_sharp_for_ever(&self, corner: usize) -> bool {
        let found = self.sharp_edges.binary_search_by_key(&index(corner), |&(corner, _)| corner);
        found.is_ok_and(|at| f64::from_bits(self.sharp_edges[at].1) >= INFINITE_SHARPNESS)
    }

    /// The patch as a net of its own, with the origin of each of its vertices in the patch.
    pub(super) fn net(&self, Frame { rules, boundary, cut }: Frame) -> Option<(MeshNet, Vec<u32>)> {
        let mut faces = FaceList::default();
        self.faces().for_each(|face| faces.push(face.iter().copied()));
        let mut checked = Topology::of_faces(self.n_vertices, faces, Winding::Refuse).ok()?;
        if self.rounds % 2 == 1 && is_triangular(&checked.topology) {
            while let Some(faces) = without_ears(&checked.topology) {
                checked = Topology::of_faces(self.n_vertices, faces, Winding::Refuse).ok()?;
            }
        }
        let origins = (0..index(self.n_vertices)).chain(checked.split_from).collect();
        let topology = Arc::new(checked.topology);
        let read = |&(at, bits): &(u32, u64)| (at, f64::from_bits(bits));
        let mut edges: Vec<(u32, f64)> = self.sharp_edges.iter().map(read).collect();
        edges.iter_mut().for_each(|(corner, _)| *corner = topology.edge(*corner));
        edges.sort_unstable_by_key(|&(e, _)| e);
        edges.dedup_by_key(|&mut (e, _)| e);
        let vertices = self.sharp_vertices.iter().map(read).collect();
        let net = MeshNet::new(topology, &self.fixed, &[], Boundary::EdgeOnly);
        let net = net.with_sharpness(Sharpness::of(&edges, &vertices), rules);
        let mut directions = vec![Direction::default(); net.mesh.base.n_edges()];
        for (corner, &direction) in self.directions.iter().enumerate() {
            directions[net.mesh.base.edge(index(corner)) as usize] = direction;
        }
        let directions = (!self.directions.is_empty()).then(|| Directions::of_edges(directions));
        // nothing that a D would lose was tagged where there is one
        let mut net = net.carrying(None, directions);
        net.tags = Tags { lost_by_dual: None, boundary, cut, ..net.tags };
        net.mesh.rounds = self.rounds;
        net.surroundings = self.surroundings;
        Some((net, origins))
    }
}

/// The faces without those that have two edges on the boundary, if there are any: the second step of sqrt 3 cuts boundary
/// edges in three, one of a face at most, and where a patch ends at the boundary of its mesh it may have such faces.
fn without_ears(topology: &Topology) -> Option<FaceList> {
    let is_ear = |&f: &usize| topology.half_edges(f).filter(|&corner| topology.twin(corner) == NONE).count() > 1;
    (0..topology.n_faces()).find(is_ear)?;
    let mut faces = FaceList::default();
    (0..topology.n_faces()).filter(|f| !is_ear(f)).for_each(|f| faces.push(topology.face(f).iter().copied()));
    Some(faces)
}

/// The greatest common divisor of two numbers that are not both 0 (Euclid).
fn common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

impl Whole<'_> {
    /// The patch around a centre; `None` where it has more than [`MAX_VERTICES`] vertices.
    pub(super) fn patch(&self, centre: Centre, rings: Rings) -> Option<Found> {
        self.walk(centre, self.starts(centre).next()?, rings)
    }

    /// The least of all patches around a centre that differ by where the walk starts: the same for nets that differ by
    /// a turn, and of several starts the first.
    ///
    /// Where a walk finds what one k starts before it found, a turn by k faces maps the surroundings to themselves. So does
    /// one by the greatest divisor d that k and the number of starts have in common, and all later walks find what those
    /// from the first d starts do: around a vertex that looks the same from all its faces, two walks are enough.
    ///
    /// # Errors
    /// [`Stopped`].
    pub(super) fn least_patch(&self, centre: Centre, rings: Rings, watch: &Watch) -> Result<Option<Found>, Stopped> {
        let starts: Vec<u32> = self.starts(centre).collect();
        let mut different = starts.len();
        let mut least: Option<Found> = None;
        for (turn, &start) in starts.iter().enumerate() {
            if turn >= different {
                break;
            }
            watch.check()?;
            let Some(found) = self.walk(centre, start, rings) else { return Ok(None) };
            let found = Found { turn, ..found };
            watch.advance(found.vertices.len() as u64 / VERTICES_A_ROW + 1);
            match least.as_ref().map(|known| (found.patch.cmp(&known.patch), turn - known.turn)) {
                None | Some((Ordering::Less, _)) => least = Some(found),
                Some((Ordering::Equal, turn)) => different = common_divisor(turn, different),
                Some((Ordering::Greater, _)) => {}
            }
        }
        Ok(least)
    }

    /// Corners at which a walk around a centre may start.
    pub(super) fn starts(&self, centre: Centre) -> impl Iterator<Item = u32> {
        let (around, sides, of) = match centre {
            Centre::Vertex(v) => {
                let open = self.topology.boundary_edges(v as usize).is_some();
                (Some(self.topology.ring(v as usize).take(if open { 1 } else { usize::MAX })), None, None)
            }
            Centre::Edge(corner) => (None, Some([corner, self.topology.twin(corner)]), None),
            Centre::Face(f) => (None, None, Some(self.topology.half_edges(f as usize))),
        };
        let sides = sides.into_iter().flatten().filter(|&corner| corner != NONE);
        around.into_iter().flatten().chain(sides).chain(of.into_iter().flatten())
    }

    pub(super) fn walk(&self, centre: Centre, start: u32, rings: Rings) -> Option<Found> {
        let mut walk = Walk {
            whole: *self,
            sizes: Vec::new(),
            local: Vec::new(),
            reached: Vec::new(),
            known: Numbers::default(),
            corners: Vec::new(),
            faces: Numbers::default(),
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
                for corner in [start, self.topology.next(start)] {
                    walk.known.number(self.topology.vertex(corner));
                    walk.reached.push(corner);
                }
                2
            }
            Centre::Face(f) => {
                walk.add_face(start);
                self.topology.face(f as usize).len()
            }
        };
        let (mut from, mut support) = (0, 0);
        for ring in 1..=rings.patch {
            let to = walk.reached.len();
            (from..to).for_each(|u| walk.add_ring(u));
            from = to;
            if walk.reached.len() > MAX_VERTICES {
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
        let patch = Patch {
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
        Some(Found { patch, vertices, corners: walk.corners, turn: 0 })
    }
}

/// A walk ring by ring.
struct Walk<'a> {
    whole: Whole<'a>,
    sizes: Vec<u32>,
    local: Vec<u32>,
    /// For each vertex of the patch a corner at it, by which it was reached.
    reached: Vec<u32>,
    known: Numbers,
    corners: Vec<u32>,
    faces: Numbers,
    sharp_edges: Vec<(u32, u64)>,
    directions: Vec<Direction>,
}

impl Walk<'_> {
    /// Adds the faces around vertex `u` of the patch, counter-clockwise from the corner by which it was reached.
    fn add_ring(&mut self, u: usize) {
        let topology = self.whole.topology;
        let start = self.reached[u];
        let mut corner = start;
        loop {
            self.add_face(corner);
            corner = topology.twin(topology.previous(corner));
            if corner == start {
                return;
            }
            if corner == NONE {
                break;
            }
        }
        // a boundary: go on with what lies clockwise of the start
        for corner in topology.ring(topology.vertex(start) as usize) {
            if corner == start {
                return;
            }
            self.add_face(corner);
        }
    }

    fn add_face(&mut self, corner: u32) {
        let topology = self.whole.topology;
        let face = topology.face_of(corner);
        if !self.faces.number(index(face)).1 {
            return;
        }
        let size = topology.face(face).len();
        self.sizes.push(index(size));
        self.corners.push(corner);
        let mut at = corner;
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
