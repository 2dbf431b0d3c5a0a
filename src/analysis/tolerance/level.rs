//! A net under refinement towards its limit: the whole net, or its part around the faces that are still followed.

use std::sync::Arc;

use crate::math::vector::{Vector, mean};
use crate::refine::{Points, RefineError, advance};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::Role;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::sharpness::Sharpness;
use crate::scheme::stepper::Stepper;
use crate::scheme::tags::Boundary;
use crate::shape::tile::Tile;
use crate::shape::topology::{NONE, Topology, index};
use crate::watch::Watch;

/// A net with its points, and for each vertex its place on the surface that the net is compared with.
#[derive(Clone)]
pub(super) struct ComparedNet {
    pub(super) net: MeshNet,
    /// The net's topology made explicit.
    pub(super) topology: Arc<Topology>,
    pub(super) points: Points,
    /// The places of the vertices on the surface that the net is compared with, which consists of bilinear quads or of
    /// triangles.
    pub(super) flat: Points,
    /// For each face the face of that surface of which it is a part.
    pub(super) home: Vec<u32>,
    /// The faces that are still followed, ascending; the other faces are kept because the limits of these depend on
    /// them.
    pub(super) live: Vec<u32>,
}

impl ComparedNet {
    /// Creates the level of a net that is compared with its own surface. All its faces are followed, except for holes
    /// as long as the net is not split.
    pub(super) fn new(net: MeshNet, points: Points) -> Self {
        let topology = net.mesh.topology();
        let n = index(topology.n_faces());
        let shown = |f: &u32| net.mesh.parent.is_some() || net.tags.holes.binary_search(f).is_err();
        let live = (0..n).filter(shown).collect();
        Self { flat: points.clone(), home: (0..n).collect(), live, net, topology, points }
    }

    /// Returns the same level, compared with the surface of its net whose vertices are at `places`.
    pub(super) fn compared(&self, places: Vec<f64>) -> Self {
        let home = (0..index(self.topology.n_faces())).collect();
        Self { flat: Points::new(places, 3), home, ..self.clone() }
    }

    /// Returns an upper bound of the number of faces after `rounds` rounds, at least one: the first splits a face into
    /// a quad per corner or, if it splits into triangles, into four, and each later one into four.
    pub(super) fn faces_after(&self, rounds: usize) -> usize {
        let first = self.topology.n_half_edges().max(4 * self.topology.n_faces());
        (1..rounds).fold(first, |faces, _| faces.saturating_mul(4))
    }

    /// Returns the level after a round, an upsampling and its averages. The places on the compared surface are only
    /// upsampled, so that the surface stays the same.
    ///
    /// # Errors
    /// [`RefineError`].
    pub(super) fn next(&self, plan: &Plan, round: &[Scheduled], watch: &Watch) -> Result<Self, RefineError> {
        let mut net = self.net.clone();
        let (mut points, mut flat) = (self.points.clone(), self.flat.clone());
        for step in round {
            let next = Stepper::new(plan).next(&net, step).map_err(RefineError::at(step))?;
            points.act(&next.action, step.level, watch)?;
            if step.letter.facts().role == Role::Upsample {
                flat.act(&next.action, step.level, watch)?;
            }
            net = next.net;
        }
        let topology = net.mesh.topology();
        let tile = net.mesh.tile;
        let parent = |child: usize| match tile {
            // the children of a face are numbered like its half-edges
            Tile::Quad => self.topology.face_of(index(child)),
            Tile::Triangle => child / 4,
        };
        let mut alive = vec![false; self.topology.n_faces()];
        self.live.iter().for_each(|&f| alive[f as usize] = true);
        let home = (0..topology.n_faces()).map(|child| self.home[parent(child)]).collect();
        let live = (0..topology.n_faces()).filter(|&child| alive[parent(child)]).map(index).collect();
        Ok(Self { net, topology, points, flat, home, live })
    }

    /// Returns the level after an upsampling of the net and of the compared surface, which then has the faces of the
    /// split net. Of a quad these are the four quarters, which leave the surface the same, of another face one quad per
    /// corner. All faces are followed.
    ///
    /// # Errors
    /// [`RefineError`].
    pub(super) fn upsampled(&self, plan: &Plan, step: &Scheduled, watch: &Watch) -> Result<Self, RefineError> {
        let (mut net, mut both) = (self.net.clone(), [self.points.clone(), self.flat.clone()]);
        advance(&mut net, &mut both, plan, [step], watch)?;
        let [points, flat] = both;
        Ok(Self::new(net, points).compared(flat.now))
    }

    /// Returns the level after the averages of a round, the last of which is half an average, and the next upsampling.
    /// The places on the compared surface are only upsampled.
    ///
    /// Half an average puts vertices at the centres of faces, and the upsampling adds the means of the two centres
    /// beside an edge and of those around a vertex. Together they split each quad of the net; the children of its
    /// vertices, edges and faces are the means of the centres of the faces around them.
    ///
    /// # Errors
    /// [`RefineError`].
    pub(super) fn next_halved(&self, plan: &Plan, round: &[Scheduled], watch: &Watch) -> Result<Self, RefineError> {
        let (mut net, mut points) = (self.net.clone(), self.points.clone());
        let (upsampling, averages) = round.split_first().expect("a round begins with an upsampling");
        let whole = averages.split_last().map_or(&[][..], |(_, whole)| whole);
        advance(&mut net, std::slice::from_mut(&mut points), plan, whole, watch)?;
        let averaged = Self { net, points, ..self.clone() };
        let next = averaged.next(plan, std::slice::from_ref(upsampling), watch)?;
        Ok(Self { points: Points::new(averaged.means_of_centres(), 3), ..next })
    }

    /// Returns for each vertex, then each edge, then each face the mean of the centres of the faces around it, which
    /// for a face is its own centre; `n x 3`. Vertices without faces keep their place.
    fn means_of_centres(&self) -> Vec<f64> {
        let (topology, points) = (&self.topology, self.points.now.as_chunks::<3>().0);
        let centres: Vec<Vector> =
            (0..topology.n_faces()).map(|f| mean(topology.face(f).iter().map(|&v| points[v as usize]))).collect();
        let centre = |half_edge: u32| centres[topology.face_of(half_edge)];
        let vertices = (0..topology.n_vertices())
            .map(|v| if topology.is_isolated(v) { points[v] } else { mean(topology.ring(v).map(centre)) });
        let sides = |e: usize| topology.halves(e).into_iter().filter(|&half_edge| half_edge != NONE);
        let edges = (0..topology.n_edges()).map(|e| mean(sides(e).map(centre)));
        vertices.chain(edges).chain(centres.iter().copied()).flatten().collect()
    }

    /// Returns the part of the net within `rings` rings of faces around the faces `on`, which alone stay followed.
    ///
    /// The part has a boundary where it is cut out of the net. This makes points of the next level wrong in as many
    /// rings along the cut as a round has averages.
    pub(super) fn focused(&self, on: &[u32], rings: usize) -> Self {
        let kept = self.surroundings(on, rings);
        let (topology, vertices) = self.topology.submesh(&kept).expect("a part of an oriented manifold is one");
        let topology = Arc::new(topology);
        let picked = |points: &Points| {
            let all = points.now.as_chunks::<3>().0;
            Points::new(vertices.iter().flat_map(|&v| all[v as usize]).collect(), 3)
        };
        let corners: Vec<u32> =
            (0..vertices.len()).filter(|&v| self.net.tags.is_corner(vertices[v] as usize)).map(index).collect();
        let net = MeshNet::new(topology.clone(), &corners, &[], Boundary::EdgeOnly);
        let sharpness = self.net.sharpness.as_deref().and_then(|s| self.sharpness(s, &kept, &vertices, &topology));
        let net = net.with_sharpness(sharpness, self.net.rules);
        let live = (0..kept.len()).filter(|&f| on.binary_search(&kept[f]).is_ok()).map(index).collect();
        let home = kept.iter().map(|&f| self.home[f as usize]).collect();
        Self { net, topology, points: picked(&self.points), flat: picked(&self.flat), home, live }
    }

    /// Returns the faces `on` and those within `rings` rings around them, ascending; `rings` is at least 1.
    pub(super) fn surroundings(&self, on: &[u32], rings: usize) -> Vec<u32> {
        let mut reached = vec![false; self.topology.n_vertices()];
        on.iter().flat_map(|&f| self.topology.face(f as usize)).for_each(|&v| reached[v as usize] = true);
        let kept = self.topology.faces_within(rings, &mut reached);
        (0..kept.len()).filter(|&f| kept[f]).map(index).collect()
    }

    /// Returns the sharpness of a part of the net; the faces and vertices of its `topology` are the faces `kept` and
    /// the vertices `vertices` of the net, in this order.
    fn sharpness(
        &self,
        sharpness: &Sharpness,
        kept: &[u32],
        vertices: &[u32],
        topology: &Topology,
    ) -> Option<Sharpness> {
        let half_edges = kept.iter().flat_map(|&f| self.topology.half_edges(f as usize));
        let mut edges: Vec<(u32, f64)> = (0..)
            .zip(half_edges)
            .map(|(half_edge, old)| (topology.edge(half_edge), sharpness.edge(self.topology.edge(old) as usize)))
            .filter(|&(_, s)| s > 0.0)
            .collect();
        edges.sort_unstable_by_key(|&(e, _)| e);
        edges.dedup_by_key(|&mut (e, _)| e);
        let vertices = vertices.iter().enumerate().map(|(v, &old)| (index(v), sharpness.vertex(old as usize)));
        Sharpness::of(&edges, &vertices.filter(|&(_, s)| s > 0.0).collect())
    }
}
