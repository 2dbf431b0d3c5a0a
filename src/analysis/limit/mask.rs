//! Computes limit masks: the weights of a disc's points in the limit of its centre, and in the two tangents there.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::{Arc, Mutex, PoisonError};

use super::cycle::{Child, Cycle};
use super::disc::{Centre, Disc, RingCount};
use super::error::Unlimited;
use super::leading::starting_vectors;
use super::rotation;
use super::sector::{SectorSupport, Sectors};
use super::skeleton::{Skeletons, TracedLevel};
use super::tangent::{self, NoTangents};
use super::vertex_parameters::{CommonParameters, VertexParameters};
use crate::math::dense::dot;

/// Maximum number of levels within which the disc of a child must repeat. Each level moves vertices that differ from
/// their surroundings farther apart, and nothing else changes discs.
/// Extraordinary vertices are about twice as far apart after each level, so that 16 levels clear any disc. Half of it
/// clears 2^8 rings, still more than the 16 that may influence a limit; twice of it only takes longer to refuse.
const MAX_CHAIN: usize = 16;
/// Change per step up to which a mask counts as converged.
/// It is about 5 units in the last place of 1, the sum of the weights. Half of it may leave short masks to
/// [`MASK_STEP_ROUNDING`], which takes [`CONVERGENCE_PATIENCE`] more steps; twice of it stops earlier, and the last
/// digits differ.
const SETTLED_CHANGE: f64 = 1e-15;
/// Change per step that rounding may cause for ever in a wide mask. A mask also counts as converged once its least
/// change is at most this, and no lesser one has followed for [`CONVERGENCE_PATIENCE`] steps.
/// It is 450 units in the last place of 1, for the sum of up to some thousand weights. Half of it refuses wide masks
/// that keep changing by more; twice of it accepts them with one digit less.
const MASK_STEP_ROUNDING: f64 = 1e-13;
/// Number of steps without a new least change after which changes count as rounding.
/// Rounding makes no new least change for many steps; convergence makes one at every step or, if it oscillates, every
/// few steps. Half of it may stop an oscillation too early; twice of it takes 32 more steps per mask.
const CONVERGENCE_PATIENCE: usize = 32;
/// Number of columns by which convergence of the points is tested.
/// A column without a pattern has a component along any direction that does not vanish; a second one guards against
/// coincidence. One would almost always be enough; four take twice the time.
const WITNESS_COLUMNS: usize = 2;
/// Number of steps after which the largest eigenvalue dominates; columns that shrink in as many further steps vanish.
/// Of an eigenvalue that is 0.9 of the largest, 0.9^256, 2e-12, is left. Half of it leaves 1e-6, and initial growth may
/// mislead; twice of it takes twice as long where points converge slowly.
const WARM_UP: usize = 256;
/// Distance of the points from their limit, relative to that at the start, up to which they count as converging.
/// Columns that shrink to it go on shrinking under the same matrix, unless some component of them is below it, which a
/// start without a pattern excludes. Half and twice of it take one step more or less.
const CONVERGED_DISTANCE: f64 = 1e-6;
/// Share by which the distance must become less in the last [`WARM_UP`] steps, if it is not below
/// [`CONVERGED_DISTANCE`] by then. Points that stay apart change by rounding alone, by some 1e-12 in so many steps,
/// while 4e-12 of the distance in each step makes 1e-9. Half and twice of it stay far above rounding, and demand 2e-12
/// and 8e-12 a step.
const LEAST_DECREASE: f64 = 1e-9;
/// Maximum number of levels within which the parameters of vertices must agree; each level halves their differences.
/// The largest numbers, 2^1024, differ by less than 1e-15 after 1,074 halvings, so that parameters whose differences
/// are halved never reach it. Half of it refuses differences above 2^500; twice of it changes nothing.
const MAX_PARAMETER_LEVELS: usize = 1_100;
/// Maximum number of steps within which a mask must converge.
/// A mask that converges at the rate b takes up to 36 / (1 - b) steps, so that 0.998 is the slowest rate. Half of it
/// ends at 0.996 and refuses rates above; twice of it takes up to twice as long to refuse.
const MAX_MASK_STEPS: usize = 20_000;

/// The limit mask of a disc, over the points of its support.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LimitMask {
    /// The weights of the limit position; they sum to 1.
    pub(super) position: Vec<f64>,
    /// For each sector the weights of two tangents whose cross product is the normal, or why there are none; empty if
    /// tangents are not requested.
    pub(super) tangents: Vec<Result<[Vec<f64>; 2], NoTangents>>,
}

impl LimitMask {
    /// Returns the mask of `disc`, of which `child` is the child with this mask.
    fn before(&self, disc: &Disc, child: &Child) -> Self {
        let back = |row: &[f64]| Ok::<_, Infallible>(child.back(row));
        let both = |[t, u]: &[Vec<f64>; 2]| Ok([tangential(back(t)?), tangential(back(u)?)]);
        let Ok(mask) = self.seen_from(disc, (&child.disc, child.rotation), back, both);
        mask
    }

    /// Returns the mask of `disc`, of which `level` makes the child with this mask, without computing the matrix of the
    /// level.
    fn before_traced(&self, disc: &Disc, level: &TracedLevel) -> Result<Self, Unlimited> {
        let back = |row: &[f64]| level.times_row(row);
        let both = |[t, u]: &[Vec<f64>; 2]| Ok([tangential(back(t)?), tangential(back(u)?)]);
        self.seen_from(disc, (level.disc(), level.rotation()), back, both)
    }

    /// Returns the mask of a disc whose child has this mask. `back` turns a row over the child's points into one over
    /// the disc's points, and `both` does so for the two tangents of a sector. Face 0 of the child is the child of face
    /// `rotation`.
    pub(super) fn seen_from<E>(
        &self,
        disc: &Disc,
        (child, rotation): (&Disc, usize),
        back: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
        both: impl Fn(&[Vec<f64>; 2]) -> Result<[Vec<f64>; 2], E>,
    ) -> Result<Self, E> {
        let one_or_none = vec![0; self.tangents.len()];
        let sectors = if one_or_none.len() > 1 { Sectors::children(disc, child, rotation) } else { one_or_none };
        let tangents = sectors.into_iter().map(|sector| match &self.tangents[sector] {
            Ok(tangents) => both(tangents).map(Ok),
            Err(why) => Ok(Err(*why)),
        });
        Ok(Self { position: summing_to_one(back(&self.position)?), tangents: tangents.collect::<Result<_, E>>()? })
    }
}

/// Returns weights divided by their sum, which differs from 1 only by rounding.
fn summing_to_one(mut row: Vec<f64>) -> Vec<f64> {
    let sum: f64 = row.iter().sum();
    row.iter_mut().for_each(|x| *x /= sum);
    row
}

/// Returns the weights of a tangent corrected to sum to 0, as their sum is a rounding error that would grow relative to
/// them from level to level, and divided by the largest absolute weight, so that they do not vanish.
pub(super) fn tangential(mut row: Vec<f64>) -> Vec<f64> {
    tangent::sum_to_zero(&mut row);
    let largest = row.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    if largest > 0.0 {
        row.iter_mut().for_each(|x| *x /= largest);
    }
    row
}

/// Finds masks of discs whose vertices all carry the same parameters, and keeps them.
#[derive(Debug)]
pub(super) struct Masks<'a> {
    finder: &'a Finder<'a>,
    common: CommonParameters,
    known: Mutex<BTreeMap<(usize, Disc), KnownMask>>,
}

/// A mask, with the length of the chain of discs from which it was found.
#[derive(Debug, Clone)]
struct KnownMask {
    mask: Arc<LimitMask>,
    /// Number of discs from that of the mask through its children until one repeats; 0 before the settled level.
    chain: usize,
}

/// The data that all searches for masks share.
#[derive(Debug)]
pub(super) struct Finder<'a> {
    /// The levels that are applied to discs.
    pub(super) cycle: &'a Cycle<'a>,
    /// The rings of the discs.
    pub(super) rings: RingCount,
    /// Whether tangents are requested.
    pub(super) with_tangents: bool,
    /// Steps of discs whose vertices carry parameters.
    pub(super) skeletons: Skeletons<'a>,
}

impl<'a> Finder<'a> {
    /// Creates a finder for the levels of a cycle, with tangents or without.
    pub(super) fn new(cycle: &'a Cycle<'a>, rings: RingCount, with_tangents: bool) -> Self {
        Self { cycle, rings, with_tangents, skeletons: Skeletons::new(cycle, rings) }
    }

    /// Returns the mask of a disc whose vertices carry different parameters: follows the disc level by level until they
    /// agree, and turns the mask of the last disc back into one of the first.
    pub(super) fn varying(&self, disc: &Disc, parameters: &VertexParameters) -> Result<LimitMask, Unlimited> {
        let (mut disc, mut parameters) = (disc.clone(), parameters.clone());
        let mut steps = Vec::new();
        while !parameters.agree() {
            if steps.len() > MAX_PARAMETER_LEVELS {
                return Err(Unlimited::Unsettled);
            }
            let (level, next) = self.skeletons.step(steps.len(), &disc, &parameters)?;
            let before = std::mem::replace(&mut disc, level.disc().clone());
            steps.push((before, level));
            parameters = next;
        }
        // parameters that no other vertex has: their masks are not kept
        let last = Masks::new(self, parameters.first()).of(steps.len(), &disc)?;
        let back = |mask: LimitMask, (disc, level): &(Disc, TracedLevel)| mask.before_traced(disc, level);
        steps.iter().rev().try_fold(LimitMask::clone(&last), back)
    }
}

impl<'a> Masks<'a> {
    /// Creates an empty set of masks of discs whose vertices all carry these parameters.
    pub(super) fn new(finder: &'a Finder<'a>, common: CommonParameters) -> Self {
        Self { finder, common, known: Mutex::default() }
    }

    /// Returns the child of a disc under a level.
    fn step(&self, level: usize, disc: &Disc) -> Result<Child, Unlimited> {
        let finder = self.finder;
        if self.common.are_there() {
            let parameters = self.common.of_all(disc.n_vertices);
            finder.skeletons.step(level, disc, &parameters)?.0.child()
        } else {
            finder.cycle.step(level, disc, finder.rings)
        }
    }

    /// Returns the mask of a disc of the net before level `level` of the cycle.
    ///
    /// While the values of the plan change from level to level, the mask of a disc is that of its child times the
    /// matrix of the level. Once they are settled, the disc soon is its own child, and the mask a fixed point.
    pub(super) fn of(&self, level: usize, disc: &Disc) -> Result<Arc<LimitMask>, Unlimited> {
        let level = level.min(self.finder.cycle.settled);
        let key = (level, disc.clone());
        if let Some(known) = self.known(&key) {
            return Ok(known.mask);
        }
        if level < self.finder.cycle.settled {
            let child = self.step(level, disc)?;
            let mask = self.of(level + 1, &child.disc)?.before(disc, &child);
            Ok(self.keep(key, mask, 0))
        } else {
            self.settled(disc)
        }
    }

    fn known(&self, key: &(usize, Disc)) -> Option<KnownMask> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner).get(key).cloned()
    }

    /// Keeps a mask and returns the one that is kept.
    fn keep(&self, key: (usize, Disc), mask: LimitMask, chain: usize) -> Arc<LimitMask> {
        let mut all = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        // all threads find the same mask, so that it does not matter which one comes first
        all.entry(key).or_insert_with(|| KnownMask { mask: Arc::new(mask), chain }).mask.clone()
    }

    /// Returns the mask of a disc at the settled level: follows its children until one repeats or its mask is known,
    /// and turns that mask back into one of the disc.
    fn settled(&self, disc: &Disc) -> Result<Arc<LimitMask>, Unlimited> {
        let level = self.finder.cycle.settled;
        let mut discs = vec![disc.clone()];
        let mut children: Vec<Child> = Vec::new();
        let KnownMask { mut mask, mut chain } = loop {
            let last = &discs[discs.len() - 1];
            let known = self.known(&(level, last.clone()));
            if children.len() + known.as_ref().map_or(1, |known| known.chain) > MAX_CHAIN {
                return Err(Unlimited::Unsettled);
            }
            if let Some(known) = known {
                break known;
            }
            let child = self.step(level, last)?;
            let next = child.disc.clone();
            children.push(child);
            if let Some(from) = discs.iter().position(|known| *known == next) {
                self.come_again(&mut discs[from..], &mut children[from..])?;
                children.truncate(from);
                discs.truncate(from);
            }
            discs.push(next);
        };
        for (disc, child) in discs.iter().zip(&children).rev() {
            chain += 1;
            mask = self.keep((level, disc.clone()), mask.before(disc, child), chain);
        }
        Ok(mask)
    }

    /// Finds the masks of a cycle of discs, each the child of the one before and the first the child of the last.
    ///
    /// The fixed point is computed for the least of the discs, so that the masks do not depend on which was met first.
    fn come_again(&self, discs: &mut [Disc], children: &mut [Child]) -> Result<(), Unlimited> {
        let level = self.finder.cycle.settled;
        let least = (0..discs.len()).min_by_key(|&i| &discs[i]).unwrap_or_default();
        discs.rotate_left(least);
        children.rotate_left(least);
        let mut mask = self.keep((level, discs[0].clone()), self.fixed_point(&discs[0], children)?, discs.len());
        for (disc, child) in discs[1..].iter().zip(&children[1..]).rev() {
            mask = self.keep((level, disc.clone()), mask.before(disc, child), discs.len());
        }
        Ok(())
    }

    /// Returns the mask of a disc that repeats as the last of `children`: the limit of `middle M^k` for growing k,
    /// where `middle` are the weights of the centre and M is the product of the matrices of the children. It is a left
    /// eigenvector of the eigenvalue 1; found as the limit of the centre itself, it exposes plans without a limit.
    ///
    /// # Errors
    /// [`Unlimited::Unsettled`] if the weights do not converge, [`Unlimited::Rough`] if the points of the disc do not.
    fn fixed_point(&self, disc: &Disc, children: &[Child]) -> Result<LimitMask, Unlimited> {
        let back = |row: &[f64]| children.iter().rev().fold(row.to_vec(), |row, child| child.back(&row));
        let mut position = disc.middle();
        let mut steps = 0;
        let (mut least, mut least_at) = (f64::INFINITY, 0);
        loop {
            let next = back(&position);
            let change: f64 = next.iter().zip(&position).map(|(a, b)| (a - b).abs()).sum();
            let size: f64 = next.iter().map(|x| x.abs()).sum();
            position = next;
            // false if the change is NaN
            if change <= SETTLED_CHANGE * size.max(1.0) {
                break;
            }
            if change < least {
                (least, least_at) = (change, steps);
            }
            if least <= MASK_STEP_ROUNDING * size && steps - least_at >= CONVERGENCE_PATIENCE {
                break;
            }
            steps += 1;
            if steps > MAX_MASK_STEPS || !size.is_finite() {
                return Err(Unlimited::Unsettled);
            }
        }
        let position = summing_to_one(position);
        let forth = |column: &[f64]| children.iter().fold(column.to_vec(), |column, child| child.forth(&column));
        if !comes_together(&position, forth) {
            return Err(Unlimited::Rough);
        }
        let sectors = Sectors::of(disc);
        let tangents = match sectors.n {
            _ if !self.finder.with_tangents => Vec::new(),
            1 => vec![self.tangents(disc, &position, back, forth)],
            // one-sided tangents need sectors that are their own children, which a rotation does not ensure
            _ if children.iter().any(|child| child.rotation > 0) => vec![Err(NoTangents::Eigenvalues); sectors.n],
            n => (0..n)
                .map(|sector| one_sided(&SectorSupport::of(disc, &sectors, sector), &position, back, forth))
                .collect(),
        };
        Ok(LimitMask { position, tangents })
    }

    /// Returns the tangents of a disc that repeats, from its matrix or, if that has none, from the matrix followed by
    /// the rotation back by as many faces as the matrix rotates the disc. A rotation turns a double eigenvalue into a
    /// pair of complex ones.
    fn tangents(
        &self,
        disc: &Disc,
        position: &[f64],
        back: impl Fn(&[f64]) -> Vec<f64>,
        forth: impl Fn(&[f64]) -> Vec<f64>,
    ) -> Result<[Vec<f64>; 2], NoTangents> {
        let found = tangent::of(disc.centre(), disc.central_faces(), position, &back, &forth);
        if found != Err(NoTangents::Eigenvalues) {
            return found;
        }
        let Some(faces) = rotation::by(disc, &forth).filter(|&faces| faces > 0) else { return found };
        let finder = self.finder;
        let Some(places) = rotation::places(disc, finder.cycle, finder.rings, faces) else { return found };
        // the points after the matrix, each at its place before the rotation
        let forth = |column: &[f64]| {
            let mut moved = vec![0.0; column.len()];
            forth(column).into_iter().zip(&places).for_each(|(x, &place)| moved[place as usize] = x);
            moved
        };
        let back = |row: &[f64]| {
            let moved: Vec<f64> = places.iter().map(|&place| row[place as usize]).collect();
            back(&moved)
        };
        tangent::of(disc.centre(), disc.central_faces(), position, back, forth)
    }
}

/// Returns whether all points of a disc that repeats converge to the limit of its centre: whether columns that the
/// limit mask maps to 0 vanish under repeated multiplication by the matrix.
fn comes_together(position: &[f64], forth: impl Fn(&[f64]) -> Vec<f64>) -> bool {
    starting_vectors(position.len(), WITNESS_COLUMNS).into_iter().all(|mut column| {
        let (mut size, mut early) = (1.0, f64::INFINITY);
        for step in 0..=2 * WARM_UP {
            let limit = dot(position, &column);
            let largest = column.iter().map(|x| (x - limit).abs()).fold(0.0, f64::max);
            size *= largest;
            if size <= CONVERGED_DISTANCE {
                return true;
            }
            column.iter_mut().for_each(|x| *x = (*x - limit) / largest);
            if step == WARM_UP {
                early = size;
            }
            column = forth(&column);
        }
        size < (1.0 - LEAST_DECREASE) * early
    })
}

/// Returns the tangents of one sector, from the part of the matrix that belongs to it.
///
/// # Errors
/// [`NoTangents::Eigenvalues`] if the limit or the points of the sector depend on others, and as [`tangent::of`].
fn one_sided(
    part: &SectorSupport,
    position: &[f64],
    back: impl Fn(&[f64]) -> Vec<f64>,
    forth: impl Fn(&[f64]) -> Vec<f64>,
) -> Result<[Vec<f64>; 2], NoTangents> {
    let some = part.widened(&vec![1.0; position.len()]);
    if !part.holds(position) || !part.holds(&back(&some)) {
        return Err(NoTangents::Eigenvalues);
    }
    let back = |row: &[f64]| part.within(&back(&part.widened(row)));
    let forth = |column: &[f64]| part.within(&forth(&part.widened(column)));
    let tangents =
        tangent::of(Centre::Vertex(0), part.faces.iter().map(Vec::as_slice), &part.within(position), back, forth);
    tangents.map(|tangents| tangents.map(|tangent| part.widened(&tangent)))
}
