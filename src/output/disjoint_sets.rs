//! Disjoint sets of vertices.

use crate::shape::topology::index;

/// Disjoint sets of vertices (union and find with path halving; R. Tarjan, J. van Leeuwen, J. ACM 31 (1984), 245-281).
pub(super) struct DisjointSets {
    parents: Vec<u32>,
    /// Number of sets.
    pub(super) n: usize,
}

impl DisjointSets {
    /// Returns a set for each of `n` vertices.
    pub(super) fn new(n: usize) -> Self {
        Self { parents: (0..index(n)).collect(), n }
    }

    /// Returns the lowest vertex of the set of `v`, which represents the set, and shortens the path to it.
    pub(super) fn root(&mut self, mut v: u32) -> u32 {
        while self.parents[v as usize] != v {
            let above = self.parents[self.parents[v as usize] as usize];
            self.parents[v as usize] = above;
            v = above;
        }
        v
    }

    /// Joins the sets of two vertices.
    pub(super) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            self.parents[a.max(b) as usize] = a.min(b);
            self.n -= 1;
        }
    }
}
