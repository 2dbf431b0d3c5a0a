//! Faces of a solid before their edges are merged.

use super::edges::{Edges, SidePiece};
use super::isolate::{ExtraordinaryCap, Leaf};
use super::pack::Rectangle;
use super::spline::{BSplineCurve, BSplineSurface};
use crate::math::distinct::distinct;
use crate::math::functions::real;

/// A face with the pieces of its four sides, counter-clockwise from v = 0.
#[derive(Debug, Clone)]
pub(super) struct FacePatch {
    pub(super) surface: BSplineSurface,
    pub(super) sides: [Vec<SidePiece>; 4],
    /// The input faces from which it arose, ascending.
    pub(super) inputs: Vec<u32>,
    /// Whether it is exactly the limit surface.
    pub(super) is_exact: bool,
}

impl FacePatch {
    /// Returns the face of a rectangle of leaves.
    pub(super) fn of_rectangle(rows: &Rectangle, leaves: &[Leaf], edges: &Edges) -> Self {
        let (n, m) = (rows.len(), rows[0].len());
        let mut net = vec![vec![[0.0; 3]; n + 3]; m + 3];
        for (j, row) in rows.iter().enumerate() {
            for (i, placed) in row.iter().enumerate() {
                for (a, column) in placed.net(leaves).iter().enumerate() {
                    net[i + a][j..j + 4].copy_from_slice(column);
                }
            }
        }
        let along = |s: usize| -> Vec<_> {
            let mut line: Vec<_> = match s {
                0 => rows[0].clone(),
                1 => rows.iter().map(|row| row[m - 1]).collect(),
                2 => rows[n - 1].clone(),
                _ => rows.iter().map(|row| row[0]).collect(),
            };
            if s > 1 {
                line.reverse();
            }
            line
        };
        let side = |s: usize| {
            let mut steps = Vec::new();
            for (k, placed) in along(s).into_iter().enumerate() {
                let range = [real(k), real(k + 1)];
                edges.steps(placed.side(leaves, s), placed.vertex(leaves, s), range, &mut steps);
            }
            steps
        };
        let inputs = distinct(rows.iter().flatten().map(|placed| leaves[placed.leaf as usize].cell.input));
        Self { surface: BSplineSurface::of_uniform(&net), sides: [0, 1, 2, 3].map(side), inputs, is_exact: true }
    }

    /// Returns the face of a cap.
    pub(super) fn of_cap(cap: ExtraordinaryCap, edges: &Edges) -> Self {
        let side = |s: usize| {
            let mut steps = Vec::new();
            edges.steps(cap.cell.sides[s], cap.cell.corners[s], [0.0, 1.0], &mut steps);
            steps
        };
        Self { sides: [0, 1, 2, 3].map(side), surface: cap.surface, inputs: vec![cap.cell.input], is_exact: false }
    }

    /// Returns the boundary curves.
    pub(super) fn curves(&self) -> [BSplineCurve; 4] {
        [0, 1, 2, 3].map(|s| self.surface.side(s))
    }
}
