//! A mesh as the operators see it: an explicit topology, or the split of one, whose vertices carry the labels V, E, F.

use std::sync::Arc;

use super::anchor::Anchor;
use super::local_mesh::{MeshLocal, upsampled};
use super::sharpness::{Creasing, Sharpness};
use crate::shape::attributes::Attributes;
use crate::shape::directions::Directions;
use crate::shape::numbering::Numbering;
use crate::shape::order::Order;
use crate::shape::tile::Tile;
use crate::shape::tiling::Tiling;
use crate::shape::topology::{Topology, index};

/// Boundary rule of meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Boundary {
    /// Boundary curves by the curve rule; vertices with one face keep their place.
    #[default]
    EdgeAndCorner,
    /// Boundary curves by the curve rule.
    EdgeOnly,
    /// As `EdgeOnly`, and faces that touch the boundary are not shown.
    None,
}

/// What Catmull-Clark does at edges beside triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TriangleRule {
    /// What it does everywhere.
    #[default]
    Catmark,
    /// Face points count more, so that triangles in a mesh of quads dent it less.
    Smooth,
}

/// Rules that a preset chooses for meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rules {
    /// How sharpness becomes less.
    pub creasing: Creasing,
    /// What happens beside triangles.
    pub triangles: TriangleRule,
}

/// What has to be known of a mesh to refine a part of it: into how many pieces faces are split depends on all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Surroundings {
    /// Whether all faces are quads.
    pub quads: bool,
    /// Whether four faces are around each inner vertex, but for those between two faces.
    pub regular: bool,
}

impl Surroundings {
    /// Those in a mesh.
    pub fn of(topology: &Topology) -> Self {
        let regular = |v: usize| {
            let n = topology.ring(v).take(5).count();
            topology.boundary_edges(v).is_some() || n <= 2 || n == 4
        };
        Self { quads: topology.is_quads(), regular: (0..topology.n_vertices()).all(regular) }
    }

    /// After an upsampling into quads, which puts vertices in the middle of faces that are none.
    fn upsampled(self) -> Self {
        Self { quads: true, regular: self.regular && self.quads }
    }

    /// After a D, under which vertices and faces change places.
    fn dual(self) -> Self {
        Self { quads: self.regular, regular: self.quads }
    }
}

/// The state of a mesh under refinement.
#[derive(Debug, Clone)]
pub struct MeshNet {
    /// The mesh whose vertex and face order the result follows: the input, or the result of the last D.
    pub base: Arc<Topology>,
    /// Into what the U since the base split the faces.
    pub tile: Tile,
    /// Pieces of an edge at each split since the base.
    pub pieces: Arc<[u32]>,
    /// The topology before the last of these splits, of which the net is the split. `None` when there was none.
    pub parent: Option<Arc<Topology>>,
    /// Vertices that keep their place, ascending; they are vertices of the base.
    pub corners: Arc<[u32]>,
    /// Sharpness of its edges and of its other vertices; `None` when all are smooth.
    pub sharpness: Option<Arc<Sharpness>>,
    /// Rules of the scheme.
    pub rules: Rules,
    /// Base faces that are not shown, ascending.
    pub holes: Arc<[u32]>,
    /// Boundary rule.
    pub boundary: Boundary,
    /// Whether its boundary is where it was cut out of a closed mesh, which D loses no vertices of.
    pub cut: bool,
    /// Whether D would lose something the client tagged.
    pub tagged: Option<&'static str>,
    /// Number of D since the last U.
    pub duals: u32,
    /// Number of steps of a scheme with a connectivity of its own, such as Doo-Sabin.
    pub rounds: u32,
    /// What entered the last U.
    pub anchor: Option<Anchor>,
    /// Parameters that vertices carry.
    pub attributes: Option<Arc<Attributes>>,
    /// Values of single vertices at the last U.
    pub local: Option<Arc<MeshLocal>>,
    /// Directions of edges along latitude and longitude lines.
    pub directions: Option<Arc<Directions>>,
    /// Numbers in the whole net, where the net is only a part of it.
    pub numbering: Option<Arc<Numbering>>,
    /// The whole net, where the net is only a part of it and the split of its faces depends on the others.
    pub surroundings: Option<Surroundings>,
}

impl MeshNet {
    /// The net of a control mesh with tagged corners and holes.
    pub fn new(topology: Arc<Topology>, corners: &[u32], holes: &[u32], boundary: Boundary) -> Self {
        let holes = shown_holes(&topology, holes, boundary);
        let tagged = if !corners.is_empty() {
            Some("corners")
        } else if !holes.is_empty() {
            Some("holes (boundary \"none\" makes some)")
        } else {
            None
        };
        let corners = fixed(&topology, corners, boundary);
        Self {
            base: topology,
            tile: Tile::default(),
            pieces: Arc::default(),
            parent: None,
            corners,
            sharpness: None,
            rules: Rules::default(),
            holes,
            boundary,
            cut: false,
            tagged,
            duals: 0,
            rounds: 0,
            anchor: None,
            attributes: None,
            local: None,
            directions: None,
            numbering: None,
            surroundings: None,
        }
    }

    /// The same net with parameters of its vertices and directions of its edges.
    #[must_use]
    pub fn carrying(self, attributes: Option<Attributes>, directions: Option<Directions>) -> Self {
        let tagged = self.tagged.or(attributes.is_some().then_some("parameters of vertices"));
        let tagged = tagged.or(directions.is_some().then_some("latitude and longitude tags"));
        Self { attributes: attributes.map(Arc::new), directions: directions.map(Arc::new), tagged, ..self }
    }

    /// The same net with sharp edges and vertices, and the rules of a scheme.
    #[must_use]
    pub fn with_sharpness(self, sharpness: Option<Sharpness>, rules: Rules) -> Self {
        let tagged = self.tagged.or(sharpness.is_some().then_some("creases"));
        Self { sharpness: sharpness.map(Arc::new), rules, tagged, ..self }
    }

    /// The net of an explicit topology that came of a D.
    pub(super) fn after_dual(&self, topology: Topology, anchor: Option<Anchor>) -> Self {
        let corners = fixed(&topology, &[], self.boundary);
        Self {
            base: Arc::new(topology),
            tile: Tile::default(),
            pieces: Arc::default(),
            parent: None,
            corners,
            sharpness: None,
            rules: self.rules,
            holes: Arc::default(),
            boundary: self.boundary,
            cut: self.cut,
            tagged: None,
            duals: self.duals + 1,
            rounds: 0,
            anchor,
            attributes: None,
            local: None,
            directions: None,
            numbering: None,
            surroundings: self.surroundings.map(Surroundings::dual),
        }
    }

    /// The net of an explicit topology that a scheme of its own connectivity made, with the vertices that keep their
    /// place, ascending.
    pub(super) fn after_own(&self, topology: Topology, corners: Vec<u32>) -> Self {
        let corners = corners.into();
        let (base, pieces, rounds) = (Arc::new(topology), Arc::default(), self.rounds + 1);
        Self { base, pieces, parent: None, corners, rounds, anchor: None, ..self.clone() }
    }

    /// The net after an upsampling of the topology in `anchor`, with the values of its vertices there. What vertices and
    /// edges carry needs an upsampling that halves edges and makes quads.
    pub(super) fn upsampled(&self, anchor: Anchor, local: Option<Arc<MeshLocal>>) -> Self {
        let entered = anchor.topology.clone();
        let kept = |attributes: &Arc<Attributes>| Arc::new(attributes.changed(|array| upsampled(array, &entered)));
        let attributes = self.attributes.as_ref().map(kept);
        let directions = self.directions.as_ref().map(|directions| Arc::new(directions.split(&entered)));
        let halved = anchor.quads.is_some().then_some(2);
        let pieces = self.pieces.iter().copied().chain(halved).chain([anchor.pieces]).collect();
        let (tile, parent) = (anchor.tile, Some(anchor.parent().clone()));
        let sharpness = anchor.sharpness_after(self.rules.creasing);
        let numbering = self.numbering.as_ref().map(|numbering| Arc::new(numbering.split(&entered)));
        let anchor = Some(anchor);
        let surroundings = self.surroundings.map(Surroundings::upsampled);
        Self {
            tile,
            pieces,
            parent,
            sharpness,
            duals: 0,
            anchor,
            attributes,
            local,
            directions,
            numbering,
            surroundings,
            ..self.clone()
        }
    }

    /// The last split, if it was not one into quads with two pieces an edge.
    fn tiling(&self) -> Option<Tiling<'_>> {
        let (parent, &pieces) = (self.parent.as_ref()?, self.pieces.last()?);
        let halves = self.tile == Tile::Quad && pieces == 2;
        (!halves).then(|| Tiling::new(parent, self.tile, pieces as usize))
    }

    /// Whether all faces are quads.
    pub(super) fn is_quads(&self) -> bool {
        if self.parent.is_some() { self.tile == Tile::Quad } else { self.base.is_quads() }
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        match (self.tiling(), &self.parent) {
            (Some(tiling), _) => tiling.n_vertices(),
            (None, Some(parent)) => parent.n_vertices() + parent.n_edges() + parent.n_faces(),
            (None, None) => self.base.n_vertices(),
        }
    }

    /// Number of faces, hidden ones included.
    pub fn n_faces(&self) -> usize {
        match (self.tiling(), &self.parent) {
            (Some(tiling), _) => tiling.n_faces(),
            (None, Some(parent)) => parent.n_half_edges(),
            (None, None) => self.base.n_faces(),
        }
    }

    /// The net's topology made explicit, in the order of its construction (see [`Topology::split`] and [`Tiling`]).
    pub fn topology(&self) -> Arc<Topology> {
        match (self.tiling(), &self.parent) {
            (Some(tiling), _) => Arc::new(tiling.topology()),
            (None, Some(parent)) => Arc::new(parent.split()),
            (None, None) => self.base.clone(),
        }
    }

    /// The parent, if the last split halved the edges and made quads.
    pub fn halved(&self) -> Option<&Arc<Topology>> {
        self.parent.as_ref().filter(|_| self.tiling().is_none())
    }

    /// The way from the order of construction to the documented one; `None` when they agree.
    pub fn order(&self) -> Option<Order> {
        let parent = self.parent.clone()?;
        Some(Order::new(self.base.clone(), parent, self.tile, self.pieces.clone()))
    }

    /// Whether vertex `v` keeps its place.
    #[inline]
    pub fn is_corner(&self, v: usize) -> bool {
        !self.corners.is_empty() && self.corners.binary_search(&index(v)).is_ok()
    }
}

/// Tagged corners and, where the boundary rule says so, boundary vertices with one face.
fn fixed(topology: &Topology, corners: &[u32], boundary: Boundary) -> Arc<[u32]> {
    let mut fixed = corners.to_vec();
    if boundary == Boundary::EdgeAndCorner {
        let lone = (0..topology.n_vertices())
            .filter(|&v| topology.boundary_edges(v).is_some() && topology.ring(v).count() == 1);
        fixed.extend(lone.map(index));
        fixed.sort_unstable();
        fixed.dedup();
    }
    fixed.into()
}

/// Tagged holes and, where the boundary is not interpolated, faces that touch it.
fn shown_holes(topology: &Topology, holes: &[u32], boundary: Boundary) -> Arc<[u32]> {
    let mut hidden = holes.to_vec();
    if boundary == Boundary::None {
        let touches = |f: &usize| topology.face(*f).iter().any(|&v| topology.boundary_edges(v as usize).is_some());
        hidden.extend((0..topology.n_faces()).filter(touches).map(index));
        hidden.sort_unstable();
        hidden.dedup();
    }
    hidden.into()
}
