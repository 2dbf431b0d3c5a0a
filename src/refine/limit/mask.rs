//! Limit masks: the weights of a patch's points in the limit of its centre, and in two tangents there.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::Unlimited;
use super::cycle::Cycle;
use super::matrix::Matrix;
use super::patch::{Patch, Rings};
use super::tangent::{self, NoTangents};

/// Levels after which a neighbourhood has to look like itself: vertices that differ from their surroundings move apart
/// with every level, and nothing else changes it.
const MAX_CHAIN: usize = 16;
/// A mask that changes by less than this has settled.
const SETTLED: f64 = 1e-15;
/// Levels after which a mask has to have settled.
const MAX_STEPS: usize = 5_000;

/// The weights of one patch, over the points of its support.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mask {
    /// Of the limit position; they sum to 1.
    pub(super) position: Vec<f64>,
    /// Of two tangents whose cross product is the normal, where they were asked for and exist.
    pub(super) tangents: Result<[Vec<f64>; 2], NoTangents>,
}

impl Mask {
    /// The same limit seen from one level before.
    fn before(&self, matrix: &Matrix) -> Self {
        let back = |[a, b]: &[Vec<f64>; 2]| [a, b].map(|tangent| tangential(matrix.times_row(tangent)));
        Self {
            position: summing_to_one(matrix.times_row(&self.position)),
            tangents: self.tangents.as_ref().map(back).map_err(Clone::clone),
        }
    }
}

/// Weights divided by their sum, which differs from 1 by rounding only.
fn summing_to_one(mut row: Vec<f64>) -> Vec<f64> {
    let sum: f64 = row.iter().sum();
    row.iter_mut().for_each(|x| *x /= sum);
    row
}

/// The weights of a tangent, cleared of what they sum to, which is rounding and would grow against them from level to
/// level, and divided by the largest, so that they do not vanish.
fn tangential(mut row: Vec<f64>) -> Vec<f64> {
    tangent::sum_to_zero(&mut row);
    let largest = row.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    if largest > 0.0 {
        row.iter_mut().for_each(|x| *x /= largest);
    }
    row
}

/// Finds masks, and remembers them.
#[derive(Debug)]
pub(super) struct Masks<'a> {
    cycle: Cycle<'a>,
    rings: Rings,
    with_tangents: bool,
    known: Mutex<BTreeMap<(usize, Patch), Arc<Mask>>>,
}

impl<'a> Masks<'a> {
    /// The masks of a cycle, with tangents or without.
    pub(super) fn new(cycle: Cycle<'a>, rings: Rings, with_tangents: bool) -> Self {
        Self { cycle, rings, with_tangents, known: Mutex::default() }
    }

    /// The mask of a patch of the net before level `level` of the cycle.
    ///
    /// While numbers change, a mask is that of the child's patch times the matrix between them; once they do not, the
    /// patch soon is its own child, and the mask a fixed point.
    pub(super) fn of(&self, level: usize, patch: &Patch) -> Result<Arc<Mask>, Unlimited> {
        let level = level.min(self.cycle.settled);
        let key = (level, patch.clone());
        if let Some(mask) = self.known(&key) {
            return Ok(mask);
        }
        let mask = if level < self.cycle.settled {
            let child = self.cycle.step(level, patch, self.rings)?;
            self.of(level + 1, &child.patch)?.before(&child.matrix)
        } else {
            self.settled(patch)?
        };
        Ok(self.keep(key, mask))
    }

    fn known(&self, key: &(usize, Patch)) -> Option<Arc<Mask>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner).get(key).cloned()
    }

    fn keep(&self, key: (usize, Patch), mask: Mask) -> Arc<Mask> {
        // whoever comes first, all find the same
        self.known.lock().unwrap_or_else(PoisonError::into_inner).entry(key).or_insert_with(|| Arc::new(mask)).clone()
    }

    /// Follows a patch to one that comes again, or whose mask is known, and its mask back to the patch.
    fn settled(&self, patch: &Patch) -> Result<Mask, Unlimited> {
        let level = self.cycle.settled;
        let mut patches = vec![patch.clone()];
        let mut matrices: Vec<Matrix> = Vec::new();
        let mut mask = loop {
            let last = &patches[patches.len() - 1];
            if let Some(known) = self.known(&(level, last.clone())) {
                break Mask::clone(&known);
            }
            if patches.len() > MAX_CHAIN {
                return Err(Unlimited::Unsettled);
            }
            let child = self.cycle.step(level, last, self.rings)?;
            matrices.push(child.matrix);
            if let Some(from) = patches.iter().position(|known| *known == child.patch) {
                let mask = self.fixed_point(&patches[from], &matrices[from..])?;
                matrices.truncate(from);
                patches.truncate(from + 1);
                break Mask::clone(&self.keep((level, patches[from].clone()), mask));
            }
            patches.push(child.patch);
        };
        for (patch, matrix) in patches.iter().zip(&matrices).rev() {
            mask = Mask::clone(&self.keep((level, patch.clone()), mask.before(matrix)));
        }
        Ok(mask)
    }

    /// The mask of a patch that comes again after `matrices`: `middle M^k` for growing k, with the product M of them.
    ///
    /// This is the left eigenvector of the eigenvalue 1, reached as the limit of the centre itself, so that a plan
    /// without a limit is found out.
    fn fixed_point(&self, patch: &Patch, matrices: &[Matrix]) -> Result<Mask, Unlimited> {
        let back = |row: &[f64]| matrices.iter().rev().fold(row.to_vec(), |row, matrix| matrix.times_row(&row));
        let mut position = patch.middle();
        let mut steps = 0;
        loop {
            let next = back(&position);
            let change: f64 = next.iter().zip(&position).map(|(a, b)| (a - b).abs()).sum();
            let size: f64 = next.iter().map(|x| x.abs()).sum();
            position = next;
            // also false for a change that is not a number
            if change <= SETTLED * size.max(1.0) {
                break;
            }
            steps += 1;
            if steps > MAX_STEPS || !size.is_finite() {
                return Err(Unlimited::Unsettled);
            }
        }
        let position = summing_to_one(position);
        let tangents = if self.with_tangents {
            let forth =
                |column: &[f64]| matrices.iter().fold(column.to_vec(), |column, matrix| matrix.times_column(&column));
            tangent::of(patch, &position, back, forth)
        } else {
            Err(NoTangents::NotAsked)
        };
        Ok(Mask { position, tangents })
    }
}
