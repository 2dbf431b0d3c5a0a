//! The patches of a surface: quads in whose grids points are made, and what lies around their corners and sides.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::mask::Line;
use super::star::{StarKind, StarShape};
use crate::scheme::mesh_net::MeshNet;
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::grid::Grid;
use crate::shape::topology::{NONE, Topology, index};

/// Directions of the sides of a patch, each from the corner of the same number to the next one.
pub(super) const ALONG: [[isize; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
/// Directions from the sides into the patch.
const INTO: [[isize; 2]; 4] = [[0, 1], [-1, 0], [0, -1], [1, 0]];

/// Vertices that one thread looks at at a time at least.
const CHUNK: usize = 1024;

/// The patches of a surface.
#[derive(Debug)]
pub(super) struct Surface {
    /// The mesh that is refined.
    pub(super) base: Arc<Topology>,
    /// The patches: its faces, or where some are no quads the faces of its first split.
    pub(super) patches: Arc<Topology>,
    /// Edges of the patches that are infinitely sharp; empty where none is.
    sharp: Vec<bool>,
    /// For each vertex of the patches the number of its kind, [`NONE`] where the grid is regular.
    kind_of: Vec<u32>,
    /// The kinds of the other vertices.
    pub(super) kinds: Vec<StarKind>,
}

/// The place `steps` along a side of a patch with `n` pieces and `depth` into the patch.
pub(super) fn along(n: usize, side: usize, steps: isize, depth: isize) -> [isize; 2] {
    let n = n.cast_signed();
    let corner = [[0, 0], [n, 0], [n, n], [0, n]][side];
    std::array::from_fn(|k| corner[k] + steps * ALONG[side][k] + depth * INTO[side][k])
}

impl Surface {
    /// The patches of a net that was not split yet, all of whose sharp edges and vertices are infinitely sharp once it
    /// is swept.
    pub(super) fn new(net: &MeshNet) -> Self {
        let base = net.mesh.base.clone();
        let is_quads = base.is_quads();
        let patches = if is_quads { base.clone() } else { Arc::new(base.split()) };
        let mut sharp = Vec::new();
        if let Some(sharpness) = &net.sharpness {
            sharp.resize(patches.n_edges(), false);
            let pieces = if is_quads { 1 } else { 2 };
            for &(e, _) in sharpness.edges().iter().filter(|&&(_, s)| s >= INFINITE_SHARPNESS) {
                sharp[pieces * e as usize..][..pieces].fill(true);
            }
        }
        let mut surface = Self { base, patches, sharp, kind_of: Vec::new(), kinds: Vec::new() };
        surface.sort_vertices(net);
        surface
    }

    fn sort_vertices(&mut self, net: &MeshNet) {
        let patches = &self.patches;
        let is_regular = |v: usize| {
            let mut faces = 0;
            let smooth = patches.ring(v).all(|half_edge| {
                faces += 1;
                patches.twin(half_edge) != NONE && !self.is_sharp(patches.edge(half_edge))
            });
            smooth && faces == 4 && !net.tags.is_corner(v)
        };
        let vertices = (0..patches.n_vertices()).into_par_iter().with_min_len(CHUNK);
        let mut kind_of: Vec<u32> = vertices.map(|v| if is_regular(v) { NONE } else { 0 }).collect();
        let mut kinds = Vec::new();
        let mut numbers: HashMap<StarKind, u32> = HashMap::new();
        // most are smooth and told apart by their valence
        let mut smooth: Vec<u32> = Vec::new();
        for (v, entry) in kind_of.iter_mut().enumerate().filter(|(v, kind)| **kind == 0 && !patches.is_isolated(*v)) {
            let kind = self.kind(v, net.tags.is_corner(v));
            let is_smooth = kind.closed && kind.sharp.is_empty() && !kind.corner;
            if is_smooth && smooth.get(kind.faces).is_some_and(|&number| number != NONE) {
                *entry = smooth[kind.faces];
                continue;
            }
            let faces = kind.faces;
            *entry = *numbers.entry(kind).or_insert_with_key(|kind| {
                kinds.push(kind.clone());
                index(kinds.len() - 1)
            });
            if is_smooth {
                smooth.resize(smooth.len().max(faces + 1), NONE);
                smooth[faces] = *entry;
            }
        }
        (self.kind_of, self.kinds) = (kind_of, kinds);
    }

    fn kind(&self, v: usize, corner: bool) -> StarKind {
        let patches = &self.patches;
        let (mut faces, mut sharp, mut closed) = (0, Vec::new(), true);
        for half_edge in patches.ring(v) {
            if self.is_sharp(patches.edge(half_edge)) {
                sharp.push(faces);
            }
            closed &= patches.twin(half_edge) != NONE;
            faces += 1;
        }
        StarKind { faces, closed, sharp, corner }
    }

    fn is_sharp(&self, edge: u32) -> bool {
        self.sharp.get(edge as usize).is_some_and(|&sharp| sharp)
    }

    /// The kind of a vertex of the patches around which the grid is not regular.
    pub(super) fn kind_of(&self, v: usize) -> Option<usize> {
        Some(self.kind_of[v]).filter(|&kind| kind != NONE).map(|kind| kind as usize)
    }

    /// What a side of a patch is, where it is not smooth.
    pub(super) fn line(&self, half_edge: u32) -> Option<Line> {
        if self.patches.twin(half_edge) == NONE {
            Some(Line::Boundary)
        } else {
            self.is_sharp(self.patches.edge(half_edge)).then_some(Line::Crease)
        }
    }

    /// The patches of consecutive base faces.
    pub(super) fn patches_of(&self, faces: Range<usize>) -> Range<usize> {
        if self.base.is_quads() {
            return faces;
        }
        let first = |f: usize| {
            if f == self.base.n_faces() { self.base.n_half_edges() } else { self.base.half_edges(f).start as usize }
        };
        first(faces.start)..first(faces.end)
    }

    /// Which side of which patch a half-edge is.
    pub(super) fn side(&self, half_edge: u32) -> (usize, usize) {
        let patch = self.patches.face_of(half_edge);
        (patch, (half_edge - self.patches.half_edges(patch).start) as usize)
    }

    /// Calls `put([i, j], vertex)` for the points of a patch of `n` pieces and those up to `halo` beyond it that lie in
    /// its neighbours; `order` is the documented order at that level. What lies beyond a boundary or across a vertex
    /// where the grid is not regular is left out.
    pub(super) fn gather(
        &self,
        order: &Grid,
        patch: usize,
        [n, halo]: [usize; 2],
        mut put: impl FnMut([isize; 2], u32),
    ) {
        let patches = &self.patches;
        for (j, i) in (0..=n).flat_map(|j| (0..=n).map(move |i| (j, i))) {
            put([i, j].map(usize::cast_signed), order.patch_vertex(patch, [i, j]));
        }
        let vertex = |patch, place: [isize; 2]| order.patch_vertex(patch, place.map(isize::cast_unsigned));
        let (n_, depths) = (n.cast_signed(), 1..=halo.cast_signed());
        for (side, half_edge) in patches.half_edges(patch).enumerate() {
            let twin = patches.twin(half_edge);
            if twin != NONE {
                let (neighbour, its) = self.side(twin);
                for depth in depths.clone() {
                    for steps in 0..=n_ {
                        let there = along(n, its, n_ - steps, depth);
                        put(along(n, side, steps, -depth), vertex(neighbour, there));
                    }
                }
            }
            if self.kind_of[patches.vertex(half_edge) as usize] == NONE {
                let onward = |half_edge| patches.twin(patches.previous(half_edge));
                let (opposite, its) = self.side(onward(onward(half_edge)));
                for b in depths.clone() {
                    for a in depths.clone() {
                        put(along(n, side, -a, -b), vertex(opposite, along(n, its, a, b)));
                    }
                }
            }
        }
    }

    /// The points of the star around a vertex, in the documented order at the level where patches have `n` pieces.
    pub(super) fn gather_star(&self, order: &Grid, v: usize, shape: StarShape, n: usize, mut put: impl FnMut(u32)) {
        let ring: Vec<(usize, usize)> = self.patches.ring(v).map(|half_edge| self.side(half_edge)).collect();
        for (face, place) in shape.points() {
            let (patch, side) = ring[face];
            let [a, b] = place.map(usize::cast_signed);
            put(order.patch_vertex(patch, along(n, side, a, b).map(isize::cast_unsigned)));
        }
    }
}
