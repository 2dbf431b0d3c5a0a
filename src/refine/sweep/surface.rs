//! The patches of a surface, the quads or triangles on whose grids points are computed, with the vertices and lines at
//! which they meet.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::lanes::Lanes;
use super::lattice::{CornerFrame, last, reach, sector};
use super::line::{SharpSide, softened};
use super::numbering::SplitOrder;
use super::star::{StarKind, StarShape};
use crate::scheme::mesh_net::MeshNet;
use crate::shape::directions::{Direction, Directions};
use crate::shape::tile::Tile;
use crate::shape::topology::{NONE, Topology, index};

/// Minimum number of vertices that one thread classifies at a time, by a walk around each. Half of it costs more
/// switching for the same work; twice of it leaves threads idle at meshes of a few thousand vertices.
const CLASSIFIED_PER_TASK: usize = 1024;

/// The patches of a surface.
#[derive(Debug)]
pub(super) struct PatchSurface {
    pub(super) tile: Tile,
    /// The mesh that is refined.
    pub(super) base: Arc<Topology>,
    /// The patches: the faces of the base or, if some are not quads, the faces of its first split.
    pub(super) patches: Arc<Topology>,
    /// The kinds of sides that are not smooth: boundaries first, then sharp edges; `None` for those that are smooth
    /// when the sweep begins.
    pub(super) lines: Vec<Option<SharpSide>>,
    /// For each edge of the patches the index of its line, or 0 if it is not sharp; empty if no edge is sharp.
    line_of: Vec<u8>,
    /// For each vertex of the patches the index of its kind; [`NONE`] where the grid is regular.
    kind_of: Vec<u32>,
    /// The kinds of vertices where the grid is not regular.
    pub(super) kinds: Vec<StarKind>,
    /// The tags of the edges of the patches, if the plan uses them.
    lanes: Option<(Lanes, Arc<Directions>)>,
}

impl PatchSurface {
    /// Creates the patches of an unrefined net whose sharp edges lie on these lines, as they are after `before`
    /// rounds.
    pub(super) fn new(net: &MeshNet, tile: Tile, (lines, lanes): (&[SharpSide], Option<Lanes>), before: usize) -> Self {
        let base = net.mesh.base.clone();
        let is_split = tile == Tile::Quad && !base.is_quads();
        let patches = if is_split { Arc::new(base.split()) } else { base.clone() };
        let mut line_of = Vec::new();
        if let Some(sharpness) = &net.sharpness {
            line_of.resize(patches.n_edges(), 0);
            let pieces = if is_split { 2 } else { 1 };
            for &(e, sharpness) in sharpness.edges() {
                let still = |line: &SharpSide| *line == SharpSide::Crease(sharpness) && line.after(before).is_some();
                let line = lines.iter().position(still).unwrap_or(0);
                line_of[pieces * e as usize..][..pieces].fill(u8::try_from(line).unwrap_or(0));
            }
        }
        let (kind_of, kinds) = (Vec::new(), Vec::new());
        let lines = lines.iter().map(|line| line.after(before)).collect();
        let lanes = lanes.zip(net.annotations.directions.clone());
        let mut surface = Self { tile, base, patches, lines, line_of, kind_of, kinds, lanes };
        surface.sort_vertices(net, before);
        surface
    }

    fn sort_vertices(&mut self, net: &MeshNet, before: usize) {
        let patches = &self.patches;
        let corner = |v: usize| match &net.sharpness {
            _ if net.tags.is_corner(v) => f64::INFINITY,
            Some(sharpness) => softened(sharpness.vertex(v), before).unwrap_or(0.0),
            None => 0.0,
        };
        let valence = self.tile.regular_valence();
        let is_regular = |v: usize| {
            let mut faces = 0;
            let smooth = patches.ring(v).all(|half_edge| {
                faces += 1;
                patches.twin(half_edge) != NONE && !self.is_sharp(patches.edge(half_edge))
            });
            smooth && faces == valence && corner(v) == 0.0
        };
        let vertices = (0..patches.n_vertices()).into_par_iter().with_min_len(CLASSIFIED_PER_TASK);
        let mut kind_of: Vec<u32> = vertices.map(|v| if is_regular(v) { NONE } else { 0 }).collect();
        let mut kinds = Vec::new();
        let mut numbers: HashMap<StarKind, u32> = HashMap::new();
        // most vertices are smooth and differ only by their valence
        let mut smooth: Vec<u32> = Vec::new();
        for (v, entry) in kind_of.iter_mut().enumerate().filter(|(v, kind)| **kind == 0 && !patches.is_isolated(*v)) {
            let kind = self.kind(v, corner(v));
            let is_smooth = kind.closed && kind.sharp.is_empty() && kind.corner == 0;
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

    fn kind(&self, v: usize, corner: f64) -> StarKind {
        let patches = &self.patches;
        let (mut faces, mut sharp, mut closed) = (0, Vec::new(), true);
        for half_edge in patches.ring(v) {
            let edge = patches.edge(half_edge);
            if let Some(SharpSide::Crease(sharpness)) = self.line_of(edge).and_then(|line| self.lines[line]) {
                sharp.push((faces, sharpness.to_bits()));
            }
            closed &= patches.twin(half_edge) != NONE;
            faces += 1;
        }
        let lanes = patches.ring(v).next().and_then(|first| self.lanes(first));
        StarKind { faces, closed, sharp, corner: corner.to_bits(), lanes }
    }

    /// Returns the tags as seen from a half-edge, whose direction is the first.
    fn lanes(&self, half_edge: u32) -> Option<Lanes> {
        let (lanes, directions) = self.lanes.as_ref()?;
        Some(lanes.seen(directions.of(self.patches.edge(half_edge)) == Direction::Longitude))
    }

    /// Returns whether the first side of a patch is a longitude edge.
    pub(super) fn is_turned(&self, patch: usize) -> bool {
        self.lanes(self.patches.half_edges(patch).start).is_some_and(|lanes| lanes.turned)
    }

    /// Returns whether edges have tags.
    pub(super) fn is_tagged(&self) -> bool {
        self.lanes.is_some()
    }

    fn line_of(&self, edge: u32) -> Option<usize> {
        self.line_of.get(edge as usize).map(|&line| line as usize).filter(|&line| line != 0)
    }

    fn is_sharp(&self, edge: u32) -> bool {
        self.line_of(edge).is_some()
    }

    /// Returns the kind of a vertex of the patches, or `None` where the grid is regular.
    pub(super) fn kind_of(&self, v: usize) -> Option<usize> {
        Some(self.kind_of[v]).filter(|&kind| kind != NONE).map(|kind| kind as usize)
    }

    /// Returns the shape of the star around a vertex of this kind, for grids with `halo` cells beyond their sides.
    pub(super) fn shape(&self, kind: usize, halo: usize) -> StarShape {
        let StarKind { faces, closed, .. } = self.kinds[kind];
        StarShape { tile: self.tile, faces, closed, reach: reach(self.tile, halo) }
    }

    /// Returns the index of the line on which a side of a patch lies, or `None` where it is smooth.
    pub(super) fn line(&self, half_edge: u32) -> Option<usize> {
        if self.patches.twin(half_edge) == NONE { Some(0) } else { self.line_of(self.patches.edge(half_edge)) }
    }

    /// Returns whether the grid is regular around all corners of a patch. Then no line runs along its sides either, as
    /// the grid is not regular at the ends of a line.
    pub(super) fn is_plain(&self, patch: usize) -> bool {
        self.patches.half_edges(patch).all(|side| self.kind_of[self.patches.vertex(side) as usize] == NONE)
    }

    /// Returns everything whose sharpness decays, as lines: edges and vertices.
    pub(super) fn softening(&self) -> Vec<SharpSide> {
        let corners = self.kinds.iter().map(|kind| SharpSide::Crease(f64::from_bits(kind.corner)));
        self.lines.iter().copied().flatten().chain(corners).collect()
    }

    /// Returns the patches of consecutive base faces.
    pub(super) fn patches_of(&self, faces: Range<usize>) -> Range<usize> {
        if Arc::ptr_eq(&self.base, &self.patches) {
            return faces;
        }
        let first = |f: usize| {
            if f == self.base.n_faces() { self.base.n_half_edges() } else { self.base.half_edges(f).start as usize }
        };
        first(faces.start)..first(faces.end)
    }

    /// Returns the patch of a half-edge, and the side of it that the half-edge is.
    pub(super) fn side(&self, half_edge: u32) -> (usize, usize) {
        // a division by a constant is many times faster than one by a variable
        let (patch, side) = match self.tile {
            Tile::Quad => (half_edge / 4, half_edge % 4),
            Tile::Triangle => (half_edge / 3, half_edge % 3),
        };
        (patch as usize, side as usize)
    }

    /// Returns the documented index of the point at a place in the frame of a half-edge (see [`CornerFrame`]), in a
    /// patch with `n` pieces per side; `order` gives the indices at that level.
    fn vertex(&self, order: &SplitOrder, half_edge: u32, n: usize, place: [isize; 2]) -> u32 {
        let patches = &self.patches;
        if self.is_whole(order) {
            // the corners are the only points of the patches
            return patches.vertex(match place {
                [0, 0] => half_edge,
                [_, 0] => patches.next(half_edge),
                [0, _] => patches.previous(half_edge),
                _ => patches.next(patches.next(half_edge)),
            });
        }
        let (patch, side) = self.side(half_edge);
        order.vertex(patch, CornerFrame::new(self.tile, n, side, 0).place(place))
    }

    /// Returns whether the patches are undivided at the level of this numbering.
    fn is_whole(&self, order: &SplitOrder) -> bool {
        order.pieces() == if Arc::ptr_eq(&self.base, &self.patches) { 1 } else { 2 }
    }

    /// Calls `put([i, j], vertex)` for the points of a patch of `n` pieces and for those up to `halo` beyond it in its
    /// neighbours; `order` gives the documented indices at that level. Points beyond a boundary, or across a vertex
    /// where the grid is not regular, are left out.
    pub(super) fn gather(
        &self,
        order: &SplitOrder,
        patch: usize,
        [n, halo]: [usize; 2],
        mut put: impl FnMut([isize; 2], u32),
    ) {
        if self.tile == Tile::Quad && halo == 1 && self.is_whole(order) {
            return self.gather_corners(patch, put);
        }
        let (tile, patches, [most, depths]) = (self.tile, &self.patches, [n, halo].map(usize::cast_signed));
        let first = patches.half_edges(patch).start;
        for (j, i) in (0..=n).flat_map(|j| (0..=last(tile, n, j)).map(move |i| (j, i))) {
            let place = [i, j].map(usize::cast_signed);
            put(place, self.vertex(order, first, n, place));
        }
        for (side, half_edge) in patches.half_edges(patch).enumerate() {
            let twin = patches.twin(half_edge);
            if twin != NONE {
                let here = CornerFrame::new(tile, n, side, 0);
                for depth in 1..=depths {
                    // on triangles, lines parallel to the side become shorter across it
                    for steps in if tile == Tile::Quad { 0 } else { depth }..=most {
                        let vertex = self.vertex(order, twin, n, [most - steps, depth]);
                        put(here.place([steps, -depth]), vertex);
                    }
                }
            }
            if self.kind_of[patches.vertex(half_edge) as usize] == NONE {
                self.gather_across(order, half_edge, [n, halo], &mut put);
            }
        }
    }

    /// [`gather`](Self::gather) for undivided quads and one cell beyond them: all points are corners of faces. Without
    /// frames and loops over steps, level 3 takes a twelfth less time.
    fn gather_corners(&self, patch: usize, mut put: impl FnMut([isize; 2], u32)) {
        /// For each side its start, the two points beyond the side, and the one across its start.
        const PLACES: [[[isize; 2]; 4]; 4] = [
            [[0, 0], [0, -1], [1, -1], [-1, -1]],
            [[1, 0], [2, 0], [2, 1], [2, -1]],
            [[1, 1], [1, 2], [0, 2], [2, 2]],
            [[0, 1], [-1, 1], [-1, 0], [-1, 2]],
        ];
        let patches = &self.patches;
        let opposite = |half_edge| patches.vertex(patches.next(patches.next(half_edge)));
        let onward = |half_edge| patches.twin(patches.previous(half_edge));
        for (half_edge, [start, first, second, across]) in patches.half_edges(patch).zip(PLACES) {
            let (corner, twin) = (patches.vertex(half_edge), patches.twin(half_edge));
            put(start, corner);
            if twin != NONE {
                put(first, opposite(twin));
                put(second, patches.vertex(patches.previous(twin)));
            }
            if self.kind_of[corner as usize] == NONE {
                put(across, opposite(onward(onward(half_edge))));
            }
        }
    }

    /// Returns the documented index of a point of the patch of a half-edge, or of its neighbour across it: `along`
    /// steps along the side and `beside` steps away from it, negative in the neighbour. Patches have `n` pieces per
    /// side.
    pub(super) fn vertex_near(&self, order: &SplitOrder, half_edge: u32, n: usize, [along, beside]: [isize; 2]) -> u32 {
        let (inside, place) = if beside < 0 {
            (self.patches.twin(half_edge), [n.cast_signed() - along, -beside])
        } else {
            (half_edge, [along, beside])
        };
        self.vertex(order, inside, n, place)
    }

    /// Calls `put` for the points beyond a corner of a patch, in the faces around it that share no side with the
    /// patch.
    pub(super) fn gather_across(
        &self,
        order: &SplitOrder,
        half_edge: u32,
        [n, halo]: [usize; 2],
        put: &mut impl FnMut([isize; 2], u32),
    ) {
        let (tile, (_, side)) = (self.tile, self.side(half_edge));
        let onward = |half_edge| self.patches.twin(self.patches.previous(half_edge));
        let mut next = onward(half_edge);
        for turn in 2..tile.regular_valence().cast_signed() - 1 {
            next = onward(next);
            let here = CornerFrame::new(tile, n, side, turn);
            for place in sector(tile, halo) {
                let place = place.map(usize::cast_signed);
                put(here.place(place), self.vertex(order, next, n, place));
            }
        }
    }

    /// Calls `put` for the points of the star around a vertex, in order, at the level where patches have `n` pieces.
    pub(super) fn gather_star(
        &self,
        order: &SplitOrder,
        v: usize,
        shape: StarShape,
        n: usize,
        mut put: impl FnMut(u32),
    ) {
        let ring: Vec<u32> = self.patches.ring(v).collect();
        for (face, place) in shape.points() {
            put(self.vertex(order, ring[face], n, place.map(usize::cast_signed)));
        }
    }
}
