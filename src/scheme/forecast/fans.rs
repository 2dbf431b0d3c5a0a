//! Counts of nets in which each D comes right after a U that makes quads: closed forms, whatever the mesh.
//!
//! *The state.* `V, E, F` and the sum `C` of the sizes of faces; the number `B` of boundary vertices, which is that of
//! boundary edges; the sum `S` of their fans, a fan being the number of faces at a boundary vertex; the number `T` of
//! interior vertices between two faces; and `I` isolated vertices.
//!
//! *U* with `d` pieces an edge keeps all fans and valences of old vertices. Each boundary edge gets `d - 1` vertices
//! with a fan of 2: `B' = d B`, `S' = S + 2 (d - 1) B`; `T` and `I` stay.
//!
//! *D right after U.* Every new vertex on an inner edge or in a face is interior, so no inner edge joins two boundary
//! vertices, and no face has only boundary vertices. The boundary vertices of a face follow each other: one, two or
//! three of a quad. So every face becomes one vertex with one fan, and none is isolated or split:
//! - `V' = F`; faces stand for interior vertices, but for those between two faces: `F' = V - I - B - T`, and their
//!   sizes are the valences: `C' = C - S - 2 T`.
//! - A boundary vertex with a fan of `n` has `n - 1` inner edges, each of which becomes one boundary edge:
//!   `B' = S - B`. These run through each face that touches the boundary once, so there are `S - B` such faces, and
//!   their fans are what is left of their four corners: `S' = 4 (S - B) - S`.
//! - `E' = (C' + B') / 2`; `T' = I' = 0`, as an interior face has at most one old vertex, and so at least three
//!   neighbours in the dual.

use std::collections::BTreeSet;

use super::count::Count;
use super::sizes::{Sizes, is_between_two};
use crate::shape::tile::Tile;
use crate::shape::topology::Topology;

/// The counts of a net and of its boundary.
#[derive(Debug)]
pub(super) struct FanCounts {
    count: Count,
    boundary: u128,
    fan_sum: u128,
    between_two: u128,
    isolated: u128,
    sizes: Sizes,
    /// The sizes of fans that occur.
    present: BTreeSet<usize>,
    /// The sizes of fans before the last U, and its number of pieces.
    before: (BTreeSet<usize>, u32),
}

impl FanCounts {
    /// Counts the fans of a net with known counts.
    pub(super) fn of(topology: &Topology, count: Count) -> Self {
        let on_boundary = (0..topology.n_vertices()).filter(|&v| topology.boundary_edges(v).is_some());
        let (mut present, mut fan_sum, mut boundary) = (BTreeSet::new(), 0, 0);
        for v in on_boundary {
            let fan = topology.ring(v).count();
            (fan_sum, boundary) = (fan_sum + fan as u128, boundary + 1);
            present.insert(fan);
        }
        let all = 0..topology.n_vertices();
        let between_two = all.clone().filter(|&v| is_between_two(topology, v)).count() as u128;
        let isolated = all.filter(|&v| topology.is_isolated(v)).count() as u128;
        let mut sizes = Sizes::default();
        sizes.add(topology, |_| false);
        let before = (BTreeSet::new(), 1);
        Self { count, boundary, fan_sum, between_two, isolated, sizes, present, before }
    }

    /// Returns the counts of the net.
    pub(super) fn count(&self) -> Count {
        let fan = self.present.last().map_or(0, |&fan| fan as u128 + 2);
        let largest_fan = self.sizes.largest_valence().max(fan);
        Count { largest_face: self.sizes.largest_face(), largest_fan, ..self.count }
    }

    /// Returns whether all faces are quads.
    pub(super) fn is_quads(&self) -> bool {
        self.sizes.are_all(4)
    }

    /// Splits the net into quads with `pieces` pieces per edge; faces of any size if that is 2, else quads only.
    pub(super) fn split(&mut self, pieces: u32) {
        let fours = self.sizes.valences.contains(&4) || self.sizes.faces.contains(&4);
        let inner = pieces > 2 || self.count.edges > self.boundary;
        self.sizes.split(Tile::Quad, pieces);
        if !fours && !inner {
            self.sizes.valences.remove(&4);
        }
        self.count = self.count.split(Tile::Quad, pieces);
        self.before = (self.present.clone(), pieces);
        if self.boundary > 0 {
            self.present.insert(2);
        }
        let pieces = u128::from(pieces);
        self.fan_sum = self.fan_sum.saturating_add(self.boundary.saturating_mul(2 * (pieces - 1)));
        self.boundary = self.boundary.saturating_mul(pieces);
    }

    /// Applies D right after a split; returns whether vertices were lost.
    pub(super) fn dual(&mut self) -> bool {
        let Count { vertices, faces, corners, .. } = self.count;
        let lost = self.isolated + self.boundary + self.between_two;
        let touching = self.fan_sum - self.boundary;
        self.sizes.dual();
        self.sizes.faces.remove(&2);
        let whole = faces - touching > 2 * self.between_two;
        self.sizes.valences =
            [(whole, 4), (self.between_two > 0, 3)].into_iter().filter_map(|(is, n)| is.then_some(n)).collect();
        let (fans, pieces) = &self.before;
        let straight = !fans.is_empty() && (*pieces > 2 || fans.iter().any(|&fan| fan > 1));
        let kinds = [(fans.contains(&1), 1), (straight, 2), (fans.iter().any(|&fan| fan > 2), 3)];
        self.present = kinds.into_iter().filter_map(|(is, n)| is.then_some(n)).collect();
        let corners = corners - self.fan_sum - 2 * self.between_two;
        // boundary edges have one side, others two
        let edges = touching + (corners - touching) / 2;
        self.count = Count { vertices: faces, edges, faces: vertices - lost, corners, ..Count::default() };
        self.fan_sum = 4 * touching - self.fan_sum;
        (self.boundary, self.between_two, self.isolated) = (touching, 0, 0);
        lost > 0
    }
}
