//! What a limit costs beside the rows of its masks: the points that operators make of discs and of the impulse,
//! counted from the word, before anything is made.

use super::bounds::{MAX_LEVEL_POINTS, MAX_RINGS};
use super::cycle::{self, made};
use super::impulse;
use crate::scheme::letter::Letter;
use crate::scheme::operator::Children;

/// Bytes a point: its topology, its place among the rows that were made, the numbers of an impulse before and after.
/// With half of it less is promised than is taken; with twice of it half as many limits run at once.
const BYTES_A_POINT: usize = 160;
/// Disces that are worked on at a time, at most as far as this is counted.
/// Half of it promises half the bytes of discs, less than eight threads take; twice of it promises twice as many,
/// which eight threads do not take.
const AT_A_TIME: usize = 8;
/// Levels after which a disc usually is its own child.
/// It only scales the predicted cost of discs: a disc whose chain is twice as long takes twice as long as told, up
/// to `MAX_CHAIN` of the masks.
const CHAIN: usize = 3;
/// Levels after which numbers that are halved with every one no longer change anything, as alpha does.
/// The kernel is a cosine, whose distance from 1 falls to a quarter with each halving: 4^-26 is the rounding of 1. Half
/// and twice of it halve and double the predicted cost of plans with an alpha; results do not depend on it.
const FADING: usize = 28;
/// Levels after which the parameters of vertices agree, of which every one halves the differences.
/// 2^-50 is the difference that counts as none, 1e-15. Half and twice of it halve and double the predicted cost of
/// meshes that carry parameters; results do not depend on it.
const AGREEING: usize = 50;

/// What is followed until it no longer changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Follow {
    /// What is around a vertex.
    Connectivity,
    /// The values of the plan, too.
    PlanValues,
    /// The parameters of vertices, too.
    VertexParameters,
}

impl Follow {
    fn levels(self) -> usize {
        match self {
            Self::Connectivity => CHAIN,
            Self::PlanValues => CHAIN + FADING,
            Self::VertexParameters => CHAIN + AGREEING,
        }
    }
}

/// What a limit costs, about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Cost {
    /// Points that operators make, each of which takes about as long as a row.
    pub points: u128,
    /// Bytes for the most of them that are there at a time.
    pub bytes: u128,
}

/// What the limits of `n_vertices` under a cycle cost, so many impulses being looked at and so many vertices of the
/// mesh that is refined being extraordinary, those with many faces counted as several.
pub fn cost(cycle: &[Letter], impulses: usize, extraordinary: u128, n_vertices: u128, follow: Follow) -> Cost {
    let pieces = cycle::pieces(cycle.iter());
    let support = support(cycle);
    let square = |rings: usize| (2 * rings + 1) * (2 * rings + 1);
    let disc = |rings: usize| made(square(rings + 2), &pieces, 1).min(MAX_LEVEL_POINTS);
    // all numbers of rings up to the right one are tried, each on two discs, and then whether larger ones agree
    let tried = (1..=support).map(|rings| 2 * disc(rings)).sum::<usize>() + 12 * disc(support);
    let side = impulse::side(support, number(cycle, &[Children::Dual, Children::Faces]));
    let impulse = impulse::compared(side, &pieces).map_or(MAX_LEVEL_POINTS, |(_, points)| points);
    let discs = n_vertices.min(extraordinary.saturating_mul(square(support) as u128));
    let points = discs
        .saturating_mul((follow.levels() * disc(support)) as u128)
        .saturating_add((tried + impulses * impulse) as u128);
    let threads = usize::try_from(discs).unwrap_or(AT_A_TIME).clamp(1, AT_A_TIME);
    let bytes = BYTES_A_POINT * impulse.max(threads * disc(support));
    Cost { points, bytes: bytes as u128 }
}

/// Rings that decide about a limit, at most as far as operators reach a ring each.
pub(super) fn support(cycle: &[Letter]) -> usize {
    MAX_RINGS.min(1 + number(cycle, &[Children::Same]))
}

/// Whether the discs of all vertices around one have all faces around that, so that those of n vertices have n times
/// as many faces: where more than the faces at a vertex decide about its limit.
pub fn sees_whole_fans(cycle: &[Letter]) -> bool {
    number(cycle, &[Children::Same]) > 1 || number(cycle, &[Children::Dual, Children::Faces]) > 0
}

fn number(cycle: &[Letter], children: &[Children]) -> usize {
    cycle.iter().filter(|letter| children.contains(&letter.facts().children)).count()
}

/// Whether the impulse of the least support would take too many points even for one level.
pub(super) fn is_beyond(cycle: &[Letter]) -> bool {
    impulse::compared(impulse::side(1, 0), &cycle::pieces(cycle.iter())).is_none()
}
