//! A tree of bounding boxes around parts of a surface.

use crate::math::functions::sqrt;
use crate::math::vector::{Vector, length, minus};
use crate::shape::topology::index;

/// Maximum number of parts of a leaf. Half as many double the nodes; twice as many visit more parts that are too far
/// away.
const PARTS_PER_LEAF: usize = 4;

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BoundingBox {
    low: Vector,
    high: Vector,
}

impl BoundingBox {
    const NOTHING: Self = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    /// Returns the box around some points.
    pub(super) fn of(points: impl Iterator<Item = Vector>) -> Self {
        points.fold(Self::NOTHING, |all, point| all.with(Self { low: point, high: point }))
    }

    fn with(self, other: Self) -> Self {
        Self {
            low: [0, 1, 2].map(|k| self.low[k].min(other.low[k])),
            high: [0, 1, 2].map(|k| self.high[k].max(other.high[k])),
        }
    }

    /// Returns the length of the diagonal.
    pub(super) fn diagonal(&self) -> f64 {
        length(minus(self.high, self.low))
    }

    /// Returns the distance of a point from the box.
    pub(super) fn distance(&self, point: Vector) -> f64 {
        let off = |k: usize| (self.low[k] - point[k]).max(point[k] - self.high[k]).max(0.0);
        sqrt((0..3).map(|k| off(k) * off(k)).sum())
    }
}

/// A node with the parts `from..to` of the order. Its first child is the next node, its second child the node `second`,
/// or 0 if the node is a leaf.
#[derive(Debug)]
struct BoxNode {
    bounds: BoundingBox,
    from: u32,
    to: u32,
    second: u32,
}

/// A tree of boxes.
#[derive(Debug)]
pub(super) struct BoxTree {
    order: Vec<u32>,
    nodes: Vec<BoxNode>,
}

impl BoxTree {
    /// Builds the tree of some boxes.
    pub(super) fn of(all: &[BoundingBox]) -> Self {
        let mut tree = Self { order: (0..index(all.len())).collect(), nodes: Vec::new() };
        if !all.is_empty() {
            tree.grow(all, 0, all.len());
        }
        tree
    }

    /// Returns the length of the diagonal of the box around all parts.
    pub(super) fn diagonal(&self) -> f64 {
        self.nodes.first().map_or(0.0, |all| all.bounds.diagonal())
    }

    fn grow(&mut self, all: &[BoundingBox], from: usize, to: usize) {
        let bounds = self.order[from..to].iter().fold(BoundingBox::NOTHING, |sum, &i| sum.with(all[i as usize]));
        let here = self.nodes.len();
        self.nodes.push(BoxNode { bounds, from: index(from), to: index(to), second: 0 });
        if to - from <= PARTS_PER_LEAF {
            return;
        }
        let side = |k: usize| bounds.high[k] - bounds.low[k];
        let longest = (1..3).fold(0, |k, other| if side(other) > side(k) { other } else { k });
        let middle = |&i: &u32| all[i as usize].low[longest] + all[i as usize].high[longest];
        let half = (to - from) / 2;
        // ties are broken by index, so that the order is unique
        self.order[from..to].select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)).then(a.cmp(b)));
        self.grow(all, from, from + half);
        self.nodes[here].second = index(self.nodes.len());
        self.grow(all, from + half, to);
    }

    /// Visits parts whose leaf is nearer to a point than the current bound, mostly nearer leaves first; `visit` returns
    /// the new bound.
    pub(super) fn visit(&self, point: Vector, mut visit: impl FnMut(u32) -> f64) {
        let mut most = f64::INFINITY;
        let mut waiting = vec![(0.0, 0_u32)];
        while let Some((distance, number)) = waiting.pop() {
            let Some(node) = self.nodes.get(number as usize).filter(|_| distance < most) else { continue };
            if node.second == 0 {
                for &part in &self.order[node.from as usize..node.to as usize] {
                    most = visit(part);
                }
                continue;
            }
            let distance = |half: u32| (self.nodes[half as usize].bounds.distance(point), half);
            let mut halves = [distance(number + 1), distance(node.second)];
            if halves[0].0 < halves[1].0 {
                halves.swap(0, 1);
            }
            waiting.extend(halves);
        }
    }
}
