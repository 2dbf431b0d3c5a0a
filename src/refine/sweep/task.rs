//! Divides the patches into tasks for threads, and the result into the parts that they write.

use std::ops::Range;

use super::program::Sweep;

/// Approximate number of faces that one task refines: small enough that all threads finish together, large enough that
/// few stars are refined twice. Half as many refine more stars twice; twice as many let threads wait longer.
const FACES_PER_SWEEP_TASK: usize = 1 << 14;

/// Consecutive patches and the parts of the result that hold their points.
pub(super) struct PatchRun<'a, const W: usize> {
    pub(super) patches: Range<usize>,
    /// The documented indices of the first point of `edges` and of `inner`.
    starts: [usize; 2],
    pub(super) edges: &'a mut [[f64; W]],
    pub(super) inner: &'a mut [[f64; W]],
    /// Vertices of the base and their points.
    pub(super) vertices: Vec<(u32, [f64; W])>,
}

impl<const W: usize> PatchRun<'_, W> {
    /// Returns the slots of `n` points inside base faces, from a documented index on.
    pub(super) fn inside(&mut self, first: u32, n: usize) -> &mut [[f64; W]] {
        let first = first as usize - self.starts[1];
        &mut self.inner[first..first + n]
    }

    /// Returns the slots of `n` consecutive points that are not base vertices, if they belong to this task.
    pub(super) fn places(&mut self, first: usize, n: usize) -> Option<&mut [[f64; W]]> {
        if let Some(at) = first.checked_sub(self.starts[1]) {
            return self.inner.get_mut(at..at + n);
        }
        let at = first.checked_sub(self.starts[0])?;
        self.edges.get_mut(at..at + n)
    }
}

impl Sweep {
    /// Divides the patches into tasks of consecutive base faces, each with the points of the edges that appear there
    /// first and with the points inside the faces.
    pub(super) fn tasks<'a, const W: usize>(&self, points: &'a mut [[f64; W]]) -> Vec<PatchRun<'a, W>> {
        let (base, order) = (&self.surface.base, &self.orders[1]);
        let on_edge = order.pieces() - 1;
        let (mut edges, mut inner) = points.split_at_mut(base.n_edges() * on_edge);
        let mut at = [base.n_vertices(), base.n_vertices() + edges.len()];
        let most = (FACES_PER_SWEEP_TASK / (order.pieces() * order.pieces())).max(1);
        let (mut tasks, mut e) = (Vec::new(), 0);
        for first in (0..base.n_faces()).step_by(most) {
            let last = (first + most).min(base.n_faces());
            let from = e;
            while e < base.n_edges() && base.face_of(base.halves(e)[0]) < last {
                e += 1;
            }
            let (mine, others) = std::mem::take(&mut edges).split_at_mut((e - from) * on_edge);
            let inside = (first..last).map(|f| order.inner_of(f)).sum();
            let (within, beyond) = std::mem::take(&mut inner).split_at_mut(inside);
            (edges, inner) = (others, beyond);
            let starts = at;
            at = [at[0] + mine.len(), at[1] + within.len()];
            let patches = self.surface.patches_of(first..last);
            tasks.push(PatchRun { patches, starts, edges: mine, inner: within, vertices: Vec::new() });
        }
        tasks
    }
}
