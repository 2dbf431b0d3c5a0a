//! Packs rectangles of bicubic faces into one B-spline face each.

use std::collections::BTreeSet;

use super::edges::Edges;
use super::isolate::Leaf;
use super::net::BicubicNet;
use super::request::Pack;
use crate::math::distinct::distinct;
use crate::shape::topology::{NONE, index};

/// Maximum number of cells along a side of a rectangle. Half as many make four times as many faces of large regular
/// meshes; twice as many make faces of a megabyte, which readers take long to intersect.
const MAX_RECTANGLE_CELLS: usize = 64;

/// A leaf in a rectangle, rotated so that the given corner comes first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PlacedLeaf {
    pub(super) leaf: u32,
    pub(super) corner: usize,
}

/// Rows of leaves, from v = 0 on, each along u.
pub(super) type Rectangle = Vec<Vec<PlacedLeaf>>;

impl PlacedLeaf {
    /// Returns the edge of a side: v = 0, u = 1, v = 1, u = 0.
    pub(super) fn side(self, leaves: &[Leaf], s: usize) -> u32 {
        leaves[self.leaf as usize].cell.sides[(self.corner + s) % 4]
    }

    /// Returns the vertex at which a side begins.
    pub(super) fn vertex(self, leaves: &[Leaf], s: usize) -> u32 {
        leaves[self.leaf as usize].cell.corners[(self.corner + s) % 4]
    }

    /// Returns the control net, rotated accordingly.
    pub(super) fn net(self, leaves: &[Leaf]) -> BicubicNet {
        let turned = |net: BicubicNet| std::array::from_fn(|i| std::array::from_fn(|j| net[3 - j][i]));
        (0..self.corner).fold(leaves[self.leaf as usize].net, |net, _| turned(net))
    }
}

/// The leaves to be packed, with the restrictions on merging them.
struct LeafPacking<'a> {
    leaves: &'a [Leaf],
    edges: &'a Edges,
    pack: Pack,
    /// The label of each input face.
    labels: &'a [u32],
    /// The leaves at each edge, as four times the leaf plus its side.
    beside: Vec<[u32; 2]>,
    used: Vec<bool>,
}

/// Returns rectangles that cover some leaves, starting at the first leaf: each grows over its four sides in turn.
/// `labels` has a number for each input face; faces with different labels are not merged.
pub(super) fn rectangles(leaves: &[Leaf], edges: &Edges, pack: Pack, labels: &[u32]) -> Vec<Rectangle> {
    let mut beside = vec![[NONE; 2]; edges.len()];
    for (leaf, s) in (0..leaves.len()).flat_map(|leaf| (0..4).map(move |s| (leaf, s))) {
        let places = &mut beside[leaves[leaf].cell.sides[s] as usize];
        let place = usize::from(places[0] != NONE);
        places[place] = index(4 * leaf + s);
    }
    let mut packing = LeafPacking { leaves, edges, pack, labels, beside, used: vec![false; leaves.len()] };
    let mut found = Vec::new();
    for leaf in 0..index(leaves.len()) {
        if !packing.used[leaf as usize] {
            found.push(packing.grown(leaf));
        }
    }
    found
}

impl LeafPacking<'_> {
    /// Returns the leaf across a side of another one, if both may be in one rectangle.
    fn across(&self, at: PlacedLeaf, s: usize) -> Option<PlacedLeaf> {
        let edge = at.side(self.leaves, s);
        let places = self.beside[edge as usize];
        let own = index(4 * at.leaf as usize + (at.corner + s) % 4);
        let other = if places[0] == own { places[1] } else { places[0] };
        if other == NONE || self.edges.is_sharp(edge) || self.used[(other / 4) as usize] {
            return None;
        }
        let [a, b] = [at.leaf, other / 4].map(|leaf| self.leaves[leaf as usize].cell.input);
        let alike = match self.pack {
            Pack::Nothing => false,
            Pack::Face => a == b,
            Pack::Patch => self.label(a) == self.label(b),
        };
        // the side of the other leaf lies opposite to that of this one
        alike.then_some(PlacedLeaf { leaf: other / 4, corner: ((other % 4) as usize + 6 - s) % 4 })
    }

    fn label(&self, input: u32) -> u32 {
        self.labels.get(input as usize).copied().unwrap_or(NONE)
    }

    /// Returns the rectangle that grows from a leaf.
    fn grown(&mut self, leaf: u32) -> Rectangle {
        let first = PlacedLeaf { leaf, corner: 0 };
        let mut rows: Rectangle = vec![vec![first]];
        self.used[leaf as usize] = true;
        let mut vertices: BTreeSet<u32> = self.leaves[leaf as usize].cell.corners.into_iter().collect();
        let mut grows = self.pack != Pack::Nothing;
        while grows {
            grows = false;
            for s in [1, 2, 3, 0] {
                let Some(line) = self.line(&rows, s, &mut vertices) else { continue };
                line.iter().for_each(|placed| self.used[placed.leaf as usize] = true);
                match s {
                    1 => rows.iter_mut().zip(line).for_each(|(row, placed)| row.push(placed)),
                    3 => rows.iter_mut().zip(line).for_each(|(row, placed)| row.insert(0, placed)),
                    2 => rows.push(line),
                    _ => rows.insert(0, line),
                }
                grows = true;
            }
        }
        rows
    }

    /// Returns the leaves beyond a side of a rectangle, if they continue it and all vertices stay distinct; their
    /// vertices are added. Closed bands are cut, so that no face meets itself.
    fn line(&self, rows: &Rectangle, s: usize, vertices: &mut BTreeSet<u32>) -> Option<Vec<PlacedLeaf>> {
        let across = |at: &PlacedLeaf| self.across(*at, s);
        let columns = rows[0].len();
        let line: Vec<PlacedLeaf> = match s {
            1 => rows.iter().map(|row| across(&row[columns - 1])).collect::<Option<_>>()?,
            3 => rows.iter().map(|row| across(&row[0])).collect::<Option<_>>()?,
            2 => rows[rows.len() - 1].iter().map(across).collect::<Option<_>>()?,
            _ => rows[0].iter().map(across).collect::<Option<_>>()?,
        };
        if (if s % 2 == 1 { columns } else { rows.len() }) >= MAX_RECTANGLE_CELLS {
            return None;
        }
        let [far, near] = if s % 2 == 1 { [2, 0] } else { [1, 3] };
        let joined = |pair: &[PlacedLeaf]| {
            let edge = pair[0].side(self.leaves, far);
            edge == pair[1].side(self.leaves, near) && !self.edges.is_sharp(edge)
        };
        // the outer vertices: the start of each leaf's outer side, and the end of the last one
        let outer = distinct(line.iter().flat_map(|at| [s, s + 1].map(|s| at.vertex(self.leaves, s))));
        let all_different = outer.len() == line.len() + 1 && outer.iter().all(|v| !vertices.contains(v));
        if !all_different || !line.windows(2).all(joined) {
            return None;
        }
        vertices.extend(outer);
        Some(line)
    }
}
