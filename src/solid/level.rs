//! One level of a refinement: the faces that are still to be split, with the neighbours that their limits need.

use std::sync::Arc;

use super::edges::Edges;
use super::error::SolidError;
use crate::math::distinct::distinct;
use crate::math::rows::blend;
use crate::math::vector::Vector;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::sharpness::Sharpness;
use crate::scheme::stepper::Stepper;
use crate::scheme::tags::Boundary;
use crate::shape::creases::{INFINITE_SHARPNESS, Sharp};
use crate::shape::mesh::Mesh;
use crate::shape::topology::{NONE, Topology, index};
use crate::watch::Watch;

/// The sharpness of an edge or a vertex, as far as it matters here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sharpened {
    /// Smooth.
    No,
    /// Sharp for some levels.
    Semi,
    /// Infinitely sharp.
    Ever,
}

impl Sharpened {
    fn of(sharpness: f64) -> Self {
        match sharpness {
            s if s <= 0.0 => Self::No,
            s if s >= INFINITE_SHARPNESS => Self::Ever,
            _ => Self::Semi,
        }
    }
}

/// A part of a mesh at some level. All data are valid at the vertices of wanted faces and in one ring around them; what
/// lies farther out was cut off and is not used.
#[derive(Debug, Clone)]
pub(super) struct Level {
    /// The connectivity.
    pub(super) topology: Arc<Topology>,
    /// Positions of its vertices, in model units.
    pub(super) points: Vec<Vector>,
    sharpness: Option<Sharpness>,
    /// Corners, which keep their position; ascending.
    fixed: Vec<u32>,
    /// Input faces that are holes, ascending.
    holes: Arc<[u32]>,
    /// The index on all levels of each vertex, and of each edge.
    pub(super) vertices: Vec<u32>,
    pub(super) edges: Vec<u32>,
    /// The input face from which each face arose.
    pub(super) inputs: Vec<u32>,
    /// Whether the surface of each face is still to be made.
    pub(super) wanted: Vec<bool>,
}

/// A vertex and the edges at which the faces around it begin, by their indices on all levels.
#[derive(Debug, Clone)]
pub(super) struct Spot {
    vertex: u32,
    spokes: Vec<u32>,
}

impl Spot {
    /// Returns the spot of the vertex at which the half-edges start.
    pub(super) fn of(level: &Level, half_edges: &[u32]) -> Self {
        let vertex = half_edges.first().map_or(NONE, |&first| level.vertices[level.topology.vertex(first) as usize]);
        let edge = |&half_edge: &u32| level.edges[level.topology.edge(half_edge) as usize];
        Self { vertex, spokes: half_edges.iter().map(edge).collect() }
    }

    /// Returns the half-edges at a level that contains the vertex with all faces around it.
    pub(super) fn half_edges(&self, level: &Level) -> Vec<u32> {
        let v = level.vertices.iter().position(|&v| v == self.vertex).unwrap_or_default();
        let edge = |half_edge: u32| level.edges[level.topology.edge(half_edge) as usize];
        let spoke = |&spoke: &u32| level.topology.ring(v).find(|&half_edge| edge(half_edge) == spoke);
        self.spokes.iter().filter_map(spoke).collect()
    }

    /// Returns all faces around the vertex at a level, ascending.
    fn faces(&self, level: &Level) -> Vec<u32> {
        let v = level.vertices.iter().position(|&v| v == self.vertex).unwrap_or_default();
        let mut faces: Vec<u32> = level.topology.ring(v).map(|spoke| index(level.topology.face_of(spoke))).collect();
        faces.sort_unstable();
        faces
    }
}

/// Applies the steps of one level of a plan.
#[derive(Debug)]
pub(super) struct Refiner<'a> {
    plan: &'a Plan,
    steps: Vec<Scheduled>,
    /// The watch, asked between pieces of work.
    pub(super) watch: &'a Watch,
}

impl<'a> Refiner<'a> {
    /// Creates the refiner of a plan whose levels are all the same.
    pub(super) fn new(plan: &'a Plan, watch: &'a Watch) -> Result<Self, SolidError> {
        let steps = plan.schedule(1).map_err(|fault| SolidError::at("", fault.detail))?;
        Ok(Self { plan, steps, watch })
    }
}

impl Level {
    /// Returns the control mesh with its edges. Holes are not wanted.
    pub(super) fn of(mesh: &Mesh, plan: &Plan) -> (Self, Edges) {
        let sharpness = Sharpness::of(&mesh.creases, &mesh.semi_sharp_corners);
        let topology = mesh.topology.clone();
        let tags = MeshNet::new(topology.clone(), &mesh.corners, &mesh.holes, plan.boundary).tags;
        let mut wanted = vec![true; topology.n_faces()];
        tags.holes.iter().for_each(|&f| wanted[f as usize] = false);
        let level = Self {
            points: mesh.positions.as_chunks().0.to_vec(),
            sharpness,
            fixed: tags.corners.to_vec(),
            holes: tags.holes.clone(),
            vertices: (0..index(topology.n_vertices())).collect(),
            edges: (0..index(topology.n_edges())).collect(),
            inputs: (0..index(topology.n_faces())).collect(),
            wanted,
            topology,
        };
        let edges = Edges::of(&level.topology);
        (level, edges)
    }

    /// Returns the sharpness of an edge; boundary edges are infinitely sharp.
    pub(super) fn edge_sharpened(&self, e: u32) -> Sharpened {
        if self.topology.is_boundary_edge(e as usize) {
            return Sharpened::Ever;
        }
        self.sharpness.as_ref().map_or(Sharpened::No, |sharpness| Sharpened::of(sharpness.edge(e as usize)))
    }

    /// Returns the sharpness of a vertex itself.
    pub(super) fn vertex_sharpened(&self, v: u32) -> Sharpened {
        if self.fixed.binary_search(&v).is_ok() {
            return Sharpened::Ever;
        }
        self.sharpness.as_ref().map_or(Sharpened::No, |sharpness| Sharpened::of(sharpness.vertex(v as usize)))
    }

    /// Returns the position of the vertex at which a half-edge starts.
    pub(super) fn start(&self, half_edge: u32) -> Vector {
        self.points[self.topology.vertex(half_edge) as usize]
    }

    /// Returns the half-edge that is `n` places after another one in its face.
    pub(super) fn after(&self, half_edge: u32, n: usize) -> u32 {
        (0..n).fold(half_edge, |half_edge, _| self.topology.next(half_edge))
    }

    /// Returns the next level of some faces and their surroundings, in which their children are wanted.
    ///
    /// # Errors
    /// If the watch says stop, or a coordinate is no longer finite.
    pub(super) fn refined(&self, split: &[u32], refiner: &Refiner<'_>, edges: &mut Edges) -> Result<Self, SolidError> {
        self.part_around(split)?.split(refiner, edges)
    }

    /// Returns the faces around a spot with their surroundings, with new indices of edges and vertices: a separate
    /// refinement that leaves that of the surface unchanged.
    pub(super) fn alone(&self, spot: &Spot) -> Result<(Self, Edges, Spot), SolidError> {
        let mut part = self.part_around(&spot.faces(self))?;
        let number = |all: &[u32], one: u32| all.iter().position(|&found| found == one).map_or(NONE, index);
        let spokes = spot.spokes.iter().map(|&spoke| number(&part.edges, spoke)).collect();
        let spot = Spot { vertex: number(&part.vertices, spot.vertex), spokes };
        let edges = part.renumber();
        Ok((part, edges, spot))
    }

    /// Returns some faces, ascending, with their surroundings, as a separate refinement.
    pub(super) fn taken_out(&self, faces: &[u32]) -> Result<(Self, Edges), SolidError> {
        let mut part = self.part_around(faces)?;
        let edges = part.renumber();
        Ok((part, edges))
    }

    /// Renumbers vertices and edges as in the topology.
    fn renumber(&mut self) -> Edges {
        self.vertices = (0..index(self.topology.n_vertices())).collect();
        self.edges = (0..index(self.topology.n_edges())).collect();
        Edges::of(&self.topology)
    }

    /// Returns the next level of the faces around a spot, and the spot there.
    pub(super) fn closer(
        &self,
        spot: &Spot,
        refiner: &Refiner<'_>,
        edges: &mut Edges,
    ) -> Result<(Self, Spot), SolidError> {
        let next = self.refined(&spot.faces(self), refiner, edges)?;
        let spokes = spot.spokes.iter().map(|&spoke| edges.halve(spoke, spot.vertex).1[0]).collect();
        Ok((next, Spot { vertex: spot.vertex, spokes }))
    }

    /// Returns the given faces and those that share a vertex with them, ascending.
    fn ring_of(&self, faces: &[u32]) -> Vec<u32> {
        let vertices = faces.iter().flat_map(|&f| self.topology.face(f as usize));
        let corners = vertices.flat_map(|&v| self.topology.ring(v as usize));
        distinct(corners.map(|half_edge| index(self.topology.face_of(half_edge))))
    }

    /// Returns some faces, ascending, with those that share a vertex with them. Holes among these come with their own
    /// neighbours: their surface is not wanted, but caps next to them depend on it.
    fn part_around(&self, faces: &[u32]) -> Result<Self, SolidError> {
        let mut around = self.ring_of(faces);
        if !self.holes.is_empty() {
            let is_hole = |&f: &u32| self.holes.binary_search(&self.inputs[f as usize]).is_ok();
            let holes: Vec<u32> = around.iter().copied().filter(is_hole).collect();
            around = distinct(around.into_iter().chain(self.ring_of(&holes)));
        }
        let (topology, origins) =
            self.topology.submesh(&around).map_err(|faults| SolidError::at("", format!("{faults:?}")))?;
        let mut origin_of_edge = vec![NONE; topology.n_edges()];
        for (f, &from) in around.iter().enumerate() {
            let pairs = topology.half_edges(f).zip(self.topology.half_edges(from as usize));
            pairs.for_each(|(to, from)| origin_of_edge[topology.edge(to) as usize] = self.topology.edge(from));
        }
        let sharpness = self.sharpness.as_ref().and_then(|all| {
            let inner = (0..topology.n_edges()).filter(|&e| !topology.is_boundary_edge(e));
            let edges = inner.map(|e| (index(e), all.edge(origin_of_edge[e] as usize)));
            let vertices = origins.iter().enumerate().map(|(v, &from)| (index(v), all.vertex(from as usize)));
            let sharp = |&(_, sharpness): &(u32, f64)| sharpness > 0.0;
            Sharpness::of(&edges.filter(sharp).collect(), &vertices.filter(sharp).collect::<Sharp>())
        });
        let is_fixed = |v: &u32| self.fixed.binary_search(&origins[*v as usize]).is_ok();
        let fixed = (0..index(origins.len())).filter(is_fixed).collect();
        Ok(Self {
            points: origins.iter().map(|&v| self.points[v as usize]).collect(),
            sharpness,
            fixed,
            holes: self.holes.clone(),
            vertices: origins.iter().map(|&v| self.vertices[v as usize]).collect(),
            edges: origin_of_edge.iter().map(|&e| self.edges[e as usize]).collect(),
            inputs: around.iter().map(|&f| self.inputs[f as usize]).collect(),
            wanted: around.iter().map(|f| faces.binary_search(f).is_ok()).collect(),
            topology: Arc::new(topology),
        })
    }

    /// Returns the level after one split of all faces.
    fn split(self, refiner: &Refiner<'_>, edges: &mut Edges) -> Result<Self, SolidError> {
        let parent = self.topology;
        let net = MeshNet::new(parent.clone(), &self.fixed, &[], Boundary::EdgeOnly);
        let mut net = net.with_sharpness(self.sharpness, refiner.plan.rules);
        let mut points = self.points.into_flattened();
        for step in &refiner.steps {
            let next = Stepper::new(refiner.plan).next(&net, step);
            let next = next.map_err(|error| SolidError::at("", error.to_string()))?;
            if let Some(rows) = next.action.rows() {
                points = blend(rows, &points, 3, refiner.watch)?;
            }
            net = next.net;
        }
        if !points.iter().all(|x| x.is_finite()) {
            return Err(SolidError::at("", "a coordinate is no longer finite; send a mesh with smaller coordinates"));
        }
        let topology = net.mesh.topology();
        let (mut vertices, mut of_edges) = (self.vertices, Vec::with_capacity(topology.n_edges()));
        for e in 0..parent.n_edges() {
            let start = vertices[parent.ends(e)[0] as usize];
            let (middle, halves) = edges.halve(self.edges[e], start);
            vertices.push(middle);
            of_edges.extend(halves);
        }
        (0..parent.n_faces()).for_each(|_| vertices.push(edges.add_vertex()));
        let (n_v, n_e) = (parent.n_vertices(), parent.n_edges());
        of_edges.extend((0..index(parent.n_half_edges())).map(|half_edge| {
            let middle = vertices[n_v + parent.edge(half_edge) as usize];
            edges.add([middle, vertices[n_v + n_e + parent.face_of(half_edge)]])
        }));
        let face = |child| parent.face_of(parent.parent_half_edge(child));
        let children = || 0..index(topology.n_faces());
        Ok(Self {
            points: points.as_chunks().0.to_vec(),
            sharpness: net.sharpness.as_deref().cloned(),
            fixed: self.fixed,
            holes: self.holes,
            vertices,
            edges: of_edges,
            inputs: children().map(|child| self.inputs[face(child)]).collect(),
            wanted: children().map(|child| self.wanted[face(child)]).collect(),
            topology,
        })
    }
}
