//! A base mesh and the splits of its faces since; only the base and the parent of the last split are explicit.

use std::sync::Arc;

use super::anchor::Anchor;
use crate::shape::order::Order;
use crate::shape::tile::Tile;
use crate::shape::tiling::Tiling;
use crate::shape::topology::Topology;

/// The connectivity of a net: a base, and how often and how its faces were split.
#[derive(Debug, Clone)]
pub struct SplitMesh {
    /// The mesh whose vertex and face order the result follows: the input, or the mesh that the last D or the last step
    /// with a connectivity of its own made.
    pub base: Arc<Topology>,
    /// Number of steps with a connectivity of their own, such as Doo-Sabin, that led to the base.
    pub rounds: u32,
    /// The tile into which the U since the base split the faces.
    pub tile: Tile,
    /// Number of pieces per edge at each split since the base.
    pub pieces: Arc<[u32]>,
    /// The topology before the last of these splits; `None` if there was none.
    pub parent: Option<Arc<Topology>>,
}

impl SplitMesh {
    /// Creates a base that is not split.
    pub fn new(base: Arc<Topology>, rounds: u32) -> Self {
        Self { base, rounds, tile: Tile::default(), pieces: Arc::default(), parent: None }
    }

    /// Returns the mesh after the upsampling of `anchor`.
    pub(super) fn after_split(&self, anchor: &Anchor) -> Self {
        let halved = anchor.quads.is_some().then_some(2);
        let pieces = self.pieces.iter().copied().chain(halved).chain([anchor.pieces]).collect();
        let parent = Some(anchor.parent().clone());
        Self { base: self.base.clone(), rounds: self.rounds, tile: anchor.tile, pieces, parent }
    }

    /// Returns the mesh after `splits` more splits that halve edges. The topology before the last split is not built;
    /// that of the base takes its place.
    pub(super) fn after_splits(&self, tile: Tile, splits: usize) -> Self {
        let pieces = self.pieces.iter().copied().chain(std::iter::repeat_n(2, splits)).collect();
        Self { pieces, parent: Some(self.base.clone()), tile, ..self.clone() }
    }

    /// Returns the last split, unless it halved edges and made quads.
    fn tiling(&self) -> Option<Tiling<'_>> {
        let (parent, &pieces) = (self.parent.as_ref()?, self.pieces.last()?);
        let halves = self.tile == Tile::Quad && pieces == 2;
        (!halves).then(|| Tiling::new(parent, self.tile, pieces as usize))
    }

    /// Returns whether all faces are quads.
    pub(super) fn is_quads(&self) -> bool {
        if self.parent.is_some() { self.tile == Tile::Quad } else { self.base.is_quads() }
    }

    /// Returns the number of vertices.
    pub fn n_vertices(&self) -> usize {
        match (self.tiling(), &self.parent) {
            (Some(tiling), _) => tiling.n_vertices(),
            (None, Some(parent)) => parent.n_vertices() + parent.n_edges() + parent.n_faces(),
            (None, None) => self.base.n_vertices(),
        }
    }

    /// Returns the explicit topology, in the order of its construction (see [`Topology::split`] and [`Tiling`]).
    pub fn topology(&self) -> Arc<Topology> {
        match (self.tiling(), &self.parent) {
            (Some(tiling), _) => Arc::new(tiling.topology()),
            (None, Some(parent)) => Arc::new(parent.split()),
            (None, None) => self.base.clone(),
        }
    }

    /// Returns the parent, if the last split halved the edges and made quads.
    pub fn halved(&self) -> Option<&Arc<Topology>> {
        self.parent.as_ref().filter(|_| self.tiling().is_none())
    }

    /// Returns the parent, if the last split made triangles and halved the edges.
    pub(super) fn halved_triangles(&self) -> Option<&Arc<Topology>> {
        self.parent.as_ref().filter(|_| self.tile == Tile::Triangle && self.pieces.last() == Some(&2))
    }

    /// Returns the map from the order of construction to the documented one; `None` if they agree.
    pub fn order(&self) -> Option<Order> {
        let parent = self.parent.clone()?;
        Some(Order::new(self.base.clone(), parent, self.tile, self.pieces.clone()))
    }
}
