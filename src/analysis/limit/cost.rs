//! The cost of a limit apart from the rows of its masks: the points that operators make of discs and of the impulse,
//! counted from the word before anything is made.

use super::bounds::{MAX_INFLUENCE_RINGS, MAX_LEVEL_POINTS};
use super::cycle::{self, made};
use super::impulse;
use crate::scheme::letter::Letter;
use crate::scheme::operator::Children;

/// Bytes per point: its topology, its index among the rows made, and the coordinates of an impulse before and after.
/// Half of it would book less memory than is used; twice of it would let half as many limits run at once.
const LIMIT_BYTES_A_POINT: usize = 160;
/// Number of discs assumed to be processed at once when memory is booked. Half of it would book half the bytes of
/// discs, less than eight threads use; twice of it would book twice as much, which eight threads do not use.
const CONCURRENT_DISCS: usize = 8;
/// Typical number of levels after which a disc is its own child. It only scales the predicted cost of discs: a disc
/// with a chain twice as long takes twice the predicted time, up to `MAX_CHAIN` of the masks.
const CHAIN_LEVELS: usize = 3;
/// Number of levels after which numbers that are halved at every level, such as alpha, no longer change anything. The
/// kernel is a cosine, whose distance from 1 falls to a quarter with each halving: 4^-26 is the rounding of 1. Half and
/// twice of it halve and double the predicted cost of plans with an alpha; results do not depend on it.
const FADING_LEVELS: usize = 28;
/// Number of levels after which vertex parameters agree, if every level halves their differences. 2^-50 is 1e-15, the
/// difference that is treated as none. Half and twice of it halve and double the predicted cost of meshes that carry
/// parameters; results do not depend on it.
const AGREEMENT_LEVELS: usize = 50;

/// What must stop changing before a limit is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Follow {
    /// The connectivity around a vertex.
    Connectivity,
    /// The connectivity and the values of the plan.
    PlanValues,
    /// The connectivity, the values of the plan and the vertex parameters.
    VertexParameters,
}

impl Follow {
    fn levels(self) -> usize {
        match self {
            Self::Connectivity => CHAIN_LEVELS,
            Self::PlanValues => CHAIN_LEVELS + FADING_LEVELS,
            Self::VertexParameters => CHAIN_LEVELS + AGREEMENT_LEVELS,
        }
    }
}

/// The approximate cost of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LimitCost {
    /// Number of points that operators make; each takes about as long as a row.
    pub points: u128,
    /// Bytes of the largest number of points held at once.
    pub bytes: u128,
}

/// Returns the cost of the limits of `n_vertices` under a cycle. `impulses` is the number of impulses examined;
/// `extraordinary` is the number of extraordinary vertices of the mesh that is refined, each with many faces counted as
/// several.
pub fn cost(cycle: &[Letter], impulses: usize, extraordinary: u128, n_vertices: u128, follow: Follow) -> LimitCost {
    let pieces = cycle::pieces(cycle.iter());
    let support = support(cycle);
    let square = |rings: usize| (2 * rings + 1) * (2 * rings + 1);
    let disc = |rings: usize| made(square(rings + 2), &pieces, 1).min(MAX_LEVEL_POINTS);
    // every number of rings up to the right one is tried on two discs; then larger discs are compared
    let tried = (1..=support).map(|rings| 2 * disc(rings)).sum::<usize>() + 12 * disc(support);
    let side = impulse::side(support, number(cycle, &[Children::Dual, Children::Faces]));
    let impulse = impulse::compared(side, &pieces).map_or(MAX_LEVEL_POINTS, |(_, points)| points);
    let discs = n_vertices.min(extraordinary.saturating_mul(square(support) as u128));
    let points = discs
        .saturating_mul((follow.levels() * disc(support)) as u128)
        .saturating_add((tried + impulses * impulse) as u128);
    let threads = usize::try_from(discs).unwrap_or(CONCURRENT_DISCS).clamp(1, CONCURRENT_DISCS);
    let bytes = LIMIT_BYTES_A_POINT * impulse.max(threads * disc(support));
    LimitCost { points, bytes: bytes as u128 }
}

/// Returns an upper bound of the rings that influence a limit, if each operator reaches one ring.
pub(super) fn support(cycle: &[Letter]) -> usize {
    MAX_INFLUENCE_RINGS.min(1 + number(cycle, &[Children::Same]))
}

/// Returns whether more than the faces at a vertex influence its limit. Then the disc of each of the n vertices around
/// a vertex of valence n contains all faces there, so that these discs have n times as many faces.
pub fn sees_whole_fans(cycle: &[Letter]) -> bool {
    number(cycle, &[Children::Same]) > 1 || number(cycle, &[Children::Dual, Children::Faces]) > 0
}

fn number(cycle: &[Letter], children: &[Children]) -> usize {
    cycle.iter().filter(|letter| children.contains(&letter.facts().children)).count()
}

/// Returns whether the impulse of the smallest support exceeds the point limit even for one level.
pub(super) fn is_beyond(cycle: &[Letter]) -> bool {
    impulse::compared(impulse::side(1, 0), &cycle::pieces(cycle.iter())).is_none()
}
