//! An explicit mesh and the splits of its faces since, of which all but the parent of the last are only counted.

use std::sync::Arc;

use super::anchor::Anchor;
use crate::shape::order::Order;
use crate::shape::tile::Tile;
use crate::shape::tiling::Tiling;
use crate::shape::topology::Topology;

/// The connectivity of a net: a base, and how often and into what its faces were split.
#[derive(Debug, Clone)]
pub struct SplitMesh {
    /// The mesh whose vertex and face order the result follows: the input, or what the last D or the last step with a
    /// connectivity of its own made.
    pub base: Arc<Topology>,
    /// Number of steps with a connectivity of their own, such as Doo-Sabin, that led to the base.
    pub rounds: u32,
    /// Into what the U since the base split the faces.
    pub tile: Tile,
    /// Pieces of an edge at each split since the base.
    pub pieces: Arc<[u32]>,
    /// The topology before the last of these splits, of which the net is the split. `None` when there was none.
    pub parent: Option<Arc<Topology>>,
}

impl SplitMesh {
    /// A base that is not split.
    pub fn new(base: Arc<Topology>, rounds: u32) -> Self {
        Self { base, rounds, tile: Tile::default(), pieces: Arc::default(), parent: None }
    }

    /// After the upsampling that `anchor` entered.
    pub(super) fn after_split(&self, anchor: &Anchor) -> Self {
        let halved = anchor.quads.is_some().then_some(2);
        let pieces = self.pieces.iter().copied().chain(halved).chain([anchor.pieces]).collect();
        let parent = Some(anchor.parent().clone());
        Self { base: self.base.clone(), rounds: self.rounds, tile: anchor.tile, pieces, parent }
    }

    /// After so many more splits into such faces with two pieces an edge, without the topology before the last of them:
    /// in its place stands that of the base.
    pub(super) fn after_splits(&self, tile: Tile, splits: usize) -> Self {
        let pieces = self.pieces.iter().copied().chain(std::iter::repeat_n(2, splits)).collect();
        Self { pieces, parent: Some(self.base.clone()), tile, ..self.clone() }
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

    /// The topology made explicit, in the order of its construction (see [`Topology::split`] and [`Tiling`]).
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

    /// The parent, if the last split made triangles and halved the edges.
    pub(super) fn halved_triangles(&self) -> Option<&Arc<Topology>> {
        self.parent.as_ref().filter(|_| self.tile == Tile::Triangle && self.pieces.last() == Some(&2))
    }

    /// The way from the order of construction to the documented one; `None` when they agree.
    pub fn order(&self) -> Option<Order> {
        let parent = self.parent.clone()?;
        Some(Order::new(self.base.clone(), parent, self.tile, self.pieces.clone()))
    }
}
