//! Counts of nets under several D in a row: what lies far from the boundary is counted, and only a collar along it
//! built.
//!
//! *Why a collar suffices.* Under D vertices and faces change places, but for three kinds of vertices that get no face:
//! those on the boundary, those between two faces, and isolated ones. With `V, E, F`, the sum `C` of the sizes of
//! faces, `B` boundary vertices with fans of `S` faces in all, `T` vertices between two faces and `I` isolated ones
//! `F' = V - B - T - I`, `C' = C - S - 2 T`, `V' = F +` the faces whose corners left make several fans, one for each
//! more, and `E' = (C' + B') / 2`. All of `B, S, T`, the fans of faces and what becomes of them lie at faces that touch
//! such vertices. The faces within some layers of them, as far as one vertex leads to the next face, are the collar. It
//! is a net that is refined by the operators themselves; nothing about it is guessed, be it ever so narrow, pinched or
//! torn.
//!
//! *How thick it is.* A net of `r` layers has `r - 1` after a D: vertices between the layers `j` and `j + 1` become
//! faces of layer `j`. After a split with `d` pieces an edge it has `d r`, as a way through one face takes `d` of its
//! pieces (two of those around its middle). So the layers needed are known from the end of the schedule backwards: two
//! at the end, one more before each D, one part in `d` before a split and never fewer than two. With two layers no face
//! touches both the boundary of the net and where the collar was cut off, so every vertex of the collar is known to be
//! one or the other. What lies beyond is never reached by the boundary, so that sizes and valences that were there once
//! stay.

use super::count::Count;
use super::sizes::{Sizes, is_between_two};
use crate::scheme::ops::{dual, no_interior, no_manifold};
use crate::scheme::step_error::StepError;
use crate::shape::tile::Tile;
use crate::shape::tiling::Tiling;
use crate::shape::topology::{Topology, index};

/// A net of which only a collar along its boundary is explicit.
#[derive(Debug)]
pub(super) struct Collar {
    count: Count,
    isolated: u128,
    /// The faces near the boundary.
    net: Topology,
    /// For each vertex of the collar whether it lies on the boundary of the net, not only on the cut edge of the
    /// collar.
    real: Vec<bool>,
    /// The sizes and valences beyond the collar.
    beyond: Sizes,
}

impl Collar {
    /// Creates the collar of a net with known counts, within `layers` layers of faces.
    ///
    /// # Errors
    /// None are known, but for those of [`Topology::of_faces`].
    pub(super) fn of(net: &Topology, count: Count, layers: u32) -> Result<Self, StepError> {
        let all = 0..net.n_vertices();
        let real: Vec<bool> = all.clone().map(|v| net.boundary_edges(v).is_some()).collect();
        let isolated = all.filter(|&v| net.is_isolated(v)).count() as u128;
        let (count, mut beyond) = (Count { largest_face: 0, largest_fan: 0, ..count }, Sizes::default());
        let (net, real) = near(net, &real, layers, &mut beyond)?.unwrap_or_else(|| (net.clone(), real));
        Ok(Self { count, isolated, net, real, beyond })
    }

    /// Returns the counts of the whole net.
    pub(super) fn count(&self) -> Count {
        let mut sizes = self.beyond.clone();
        sizes.add(&self.net, |_| false);
        let fans = (0..self.net.n_vertices()).filter(|&v| self.real[v]).map(|v| self.net.ring(v).count() + 2);
        let largest_fan = sizes.largest_valence().max(fans.max().unwrap_or(0) as u128);
        Count { largest_face: sizes.largest_face(), largest_fan, ..self.count }
    }

    /// Returns the number of corners of the explicit part.
    pub(super) fn n_corners(&self) -> usize {
        self.net.n_half_edges()
    }

    /// Returns whether all faces have `size` vertices.
    pub(super) fn are_all(&self, size: usize) -> bool {
        self.beyond.are_all(size) && (0..self.net.n_faces()).all(|f| self.net.face(f).len() == size)
    }

    /// Shrinks the collar to `layers` layers of faces.
    pub(super) fn keep(&mut self, layers: u32) -> Result<(), StepError> {
        if let Some((net, real)) = near(&self.net, &self.real, layers, &mut self.beyond)? {
            (self.net, self.real) = (net, real);
        }
        Ok(())
    }

    /// Splits the net into `pieces` pieces per edge: faces of any size into quads if that is 2, else faces like `tile`.
    pub(super) fn split(&mut self, tile: Tile, pieces: u32) {
        let halves = tile == Tile::Quad && pieces == 2;
        let split = if halves { self.net.split() } else { Tiling::new(&self.net, tile, pieces as usize).topology() };
        // old vertices keep their index, and a boundary loop belongs to the net's boundary as a whole or not at all
        let mut real = vec![false; split.n_vertices()];
        for round in split.boundary_loops() {
            let is_real = round.iter().any(|&v| self.real.get(v as usize) == Some(&true));
            round.iter().for_each(|&v| real[v as usize] = is_real);
        }
        (self.net, self.real) = (split, real);
        self.beyond.split(tile, pieces);
        self.count = self.count.split(tile, pieces);
    }

    /// Applies D; returns whether vertices were lost.
    ///
    /// # Errors
    /// When there is no dual.
    pub(super) fn dual(&mut self) -> Result<bool, StepError> {
        let net = &self.net;
        let fans = (0..net.n_vertices()).filter(|&v| self.real[v]).map(|v| net.ring(v).count() as u128);
        let (boundary, fan_sum) = fans.fold((0, 0), |(n, sum), fan| (n + 1, sum + fan));
        let between_two = (0..net.n_vertices()).filter(|&v| is_between_two(net, v)).count() as u128;
        let is_cut = |v: u32| !self.real[v as usize] && net.boundary_edges(v as usize).is_some();
        let at_cut: Vec<bool> = (0..net.n_faces()).map(|f| net.face(f).iter().any(|&v| is_cut(v))).collect();
        let lost = boundary + between_two + self.isolated;
        if self.count.vertices <= lost {
            return Err(no_interior());
        }
        let found = dual(net)?;
        let origin = |v: usize| if v < at_cut.len() { v } else { found.split_from[v - at_cut.len()] as usize };
        let known: Vec<bool> = (0..found.topology.n_vertices()).map(|v| !at_cut[origin(v)]).collect();
        let split = (at_cut.len()..known.len()).filter(|&v| known[v]).count() as u128;
        let isolated = (0..at_cut.len()).filter(|&v| known[v] && found.topology.is_isolated(v)).count() as u128;
        let real: Vec<bool> =
            known.iter().enumerate().map(|(v, &known)| known && found.topology.boundary_edges(v).is_some()).collect();
        // vertices on the cut become faces all of whose vertices exist
        self.beyond.faces.extend((0..at_cut.len()).filter(|&f| at_cut[f]).map(|f| net.face(f).len()));
        self.beyond.dual();
        let Count { vertices, faces, corners, .. } = self.count;
        let corners = corners - fan_sum - 2 * between_two;
        // boundary edges have one side, others two
        let open = real.iter().filter(|&&real| real).count() as u128;
        let edges = open + (corners - open) / 2;
        self.count = Count { vertices: faces + split, edges, faces: vertices - lost, corners, ..Count::default() };
        (self.net, self.real, self.isolated) = (found.topology, real, isolated);
        Ok(lost > 0)
    }
}

/// Returns the faces within `layers` layers of the boundary and of vertices between two faces, and which of their
/// vertices lie on the boundary; `None` if these are all faces. Adds what is left out to `beyond`.
fn near(
    net: &Topology,
    real: &[bool],
    layers: u32,
    beyond: &mut Sizes,
) -> Result<Option<(Topology, Vec<bool>)>, StepError> {
    let mut reached: Vec<bool> = (0..net.n_vertices()).map(|v| real[v] || is_between_two(net, v)).collect();
    let kept = net.faces_within(layers as usize, &mut reached);
    if kept.iter().all(|&kept| kept) {
        return Ok(None);
    }
    for f in (0..net.n_faces()).filter(|&f| !kept[f]) {
        beyond.faces.insert(net.face(f).len());
        let inside = net.face(f).iter().map(|&v| v as usize).filter(|&v| net.boundary_edges(v).is_none());
        beyond.valences.extend(inside.map(|v| net.ring(v).count()));
    }
    let kept: Vec<u32> = (0..index(net.n_faces())).filter(|&f| kept[f as usize]).collect();
    let (part, origins) = net.submesh(&kept).map_err(|faults| no_manifold(&faults))?;
    Ok(Some((part, origins.iter().map(|&v| real[v as usize]).collect())))
}
