//! Limits of plans with decaying perturbations: each vertex is followed through the levels with its surroundings.
//!
//! The perturbation of a point at a later level depends on the number of the point in the whole net there, so no two
//! vertices share a mask. The numbers around a vertex at one level determine those at the next (see [`Numbering`]), and
//! with them the local subdivision matrices. The product of these matrices ends at the level from which on the
//! perturbation is negligible, or at which the points around the vertex coincide. It is applied to the mask that the
//! plan without perturbation has there.

use std::convert::Infallible;
use std::sync::Arc;

use rayon::prelude::*;

use super::bounds::{MAX_FOLLOWED_LEVELS, MAX_FOLLOWED_POINTS};
use super::cycle::Child;
use super::disc::{Centre, Disc, Located, RingCount};
use super::error::Unlimited;
use super::field::{VertexMasks, located};
use super::leading::starting_vectors;
use super::mask::{Finder, LimitMask, Masks, tangential};
use super::neighbourhoods::Neighbourhoods;
use super::request::LimitRequest;
use super::vertex_parameters::{CommonParameters, VertexParameters};
use crate::math::dense::dot;
use crate::scheme::operator::Role;
use crate::scheme::plan::{Perturbation, Plan};
use crate::shape::numbering::Numbering;
use crate::shape::topology::index;
use crate::watch::Watch;

/// Number of table rows, at about 100 ns each, that take as long as following one point: 50 to 200 microseconds,
/// measured. It only converts points into predicted and reported work: half of it predicts half the time, twice of it
/// twice the time.
pub const ROWS_A_POINT: u64 = 1_000;
/// Bound on the sum of all remaining perturbations below which they are ignored; for positions the sum is multiplied by
/// the distance between the points that they move. It is half the rounding of 1, so what is ignored would be lost in
/// sums with coordinates of size 1. For a decay of 1/2, half of it follows about one level more, twice of it one less.
const NEGLIGIBLE_PERTURBATION: f64 = 1e-16;
/// Distance within which points count as coinciding, relative to their distance at the first level. It is a 200th of
/// the rounding of coordinates of size 1. Half of it follows about one level more, twice of it one less.
const COINCIDENCE_DISTANCE: f64 = 1e-18;
/// Number of random coordinate vectors that are refined to measure the distance between the points around a vertex. The
/// largest of their distances counts; the more vectors, the less it underestimates. With half of it points may count as
/// coinciding a level early; with twice of it each level takes longer.
const WITNESS_VECTORS: usize = 8;
/// Number of vertices whose surroundings are counted at a time. Half of it synchronises all threads and checks the
/// watch twice as often; twice of it delays a refusal by as much.
const SURROUNDINGS_PER_CHUNK: usize = 4_096;

/// Returns the perturbation of a plan if it has an effect: a nonzero amplitude, and averages or push-backs in the
/// cycle.
pub(super) fn of(plan: &Plan) -> Option<Perturbation> {
    let uses = |role: Role| matches!(role, Role::Average | Role::PushBack);
    let acts = plan.word.cycle.iter().any(|letter| uses(letter.facts().role));
    plan.perturbation.filter(|perturbation| acts && perturbation.amplitude != 0.0)
}

/// Returns the approximate number of points around each vertex that has to be followed through the levels to answer
/// `request`; 0 if no vertex has to be.
pub fn followed_points(plan: &Plan, request: LimitRequest) -> u64 {
    let with_normals = |perturbation: &Perturbation| request.normals && no_normals(perturbation).is_none();
    if !of(plan).is_some_and(|perturbation| request.positions || with_normals(&perturbation)) {
        return 0;
    }
    let rings = plan.word.cycle.iter().filter(|letter| letter.facts().role != Role::Upsample).count() as u64;
    (2 * rings + 1).saturating_pow(2)
}

/// Returns why there are no limit normals, if so: tangents are known to exist only for decays below 1/2.
pub(super) fn no_normals(perturbation: &Perturbation) -> Option<String> {
    let decay = perturbation.decay;
    (decay >= 0.5).then(|| {
        format!(
            "the normals are weighted by area, as limits of perturbed plans are known to have normals where \"decay\" \
             is below 1/2; here it is {decay}"
        )
    })
}

/// Computes the masks of all vertices of a net, each as a part of the whole net. `rows` is the work per mask, in rows.
///
/// # Errors
/// [`Unlimited`], in particular [`Unlimited::Followed`] for too many points around all vertices and [`Unlimited::Wild`]
/// for perturbations that do not fade.
pub(super) fn field<'a>(
    around: &'a dyn Neighbourhoods,
    rings: RingCount,
    finder: &Finder<'_>,
    perturbation: Perturbation,
    rows: u64,
    watch: &Watch,
) -> Result<VertexMasks<'a>, Unlimited> {
    check_size(around, rings, watch)?;
    let plain = Masks::new(finder, CommonParameters::default());
    let mask = |v: u32| {
        watch.check()?;
        let Some((found, parameters)) = located(around, v, rings)? else { return Ok(None) };
        let numbering = around.numbering(&found);
        let follower = Follower { finder, plain: &plain, perturbation, watch };
        let mask = follower.mask(found, parameters, numbering)?;
        watch.advance(rows);
        Ok(Some(Arc::new(mask)))
    };
    let all = 0..index(around.n_vertices());
    let masks = all.into_par_iter().map(mask).collect::<Result<Vec<_>, Unlimited>>()?;
    Ok(VertexMasks::of_masks(around, rings, masks))
}

/// Checks that the discs of all vertices together have at most [`MAX_FOLLOWED_POINTS`] points.
///
/// # Errors
/// [`Unlimited::Followed`], and [`Unlimited::Size`] if a single disc is too large.
fn check_size(around: &dyn Neighbourhoods, rings: RingCount, watch: &Watch) -> Result<(), Unlimited> {
    let all: Vec<Centre> = (0..around.n_vertices()).filter_map(|v| around.centre(v)).collect();
    let mut points = 0;
    for chunk in all.chunks(SURROUNDINGS_PER_CHUNK) {
        watch.check()?;
        let size = |&centre: &Centre| around.disc(centre, rings).map(|found| found.vertices.len());
        let sizes: Option<Vec<usize>> = chunk.par_iter().map(size).collect();
        points += sizes.ok_or(Unlimited::Size)?.iter().sum::<usize>();
        if points > MAX_FOLLOWED_POINTS {
            return Err(Unlimited::Followed);
        }
    }
    Ok(())
}

/// Computes the mask of one vertex at a time by following its disc through the levels.
struct Follower<'a> {
    finder: &'a Finder<'a>,
    plain: &'a Masks<'a>,
    perturbation: Perturbation,
    watch: &'a Watch,
}

impl Follower<'_> {
    /// Returns the mask of a disc. `numbering` holds the numbers of its vertices, edges and faces in the whole net.
    fn mask(&self, found: Located, parameters: VertexParameters, numbering: Numbering) -> Result<LimitMask, Unlimited> {
        let (mut disc, mut parameters, mut numbering) = (found.disc, parameters, numbering);
        let mut spread = Spread::new(disc.support);
        let mut levels: Vec<(Disc, Child)> = Vec::new();
        let last = loop {
            self.watch.check()?;
            if !self.finder.with_tangents && spread.is_none() {
                break LimitMask { position: disc.middle(), tangents: Vec::new() };
            }
            if parameters.agree() && self.is_quiet(levels.len(), &spread) {
                break self.unperturbed(levels.len(), &disc, &parameters)?;
            }
            if levels.len() >= MAX_FOLLOWED_LEVELS || !spread.is_finite() {
                return Err(Unlimited::Wild);
            }
            let parts = (&parameters, Some((&numbering, self.perturbation)));
            let (level, next) = self.finder.skeletons.followed(levels.len(), &disc, parts)?;
            let child = level.child()?;
            spread.go_on(&child);
            let before = std::mem::replace(&mut disc, child.disc.clone());
            levels.push((before, child));
            parameters = next.0;
            numbering = next.1.ok_or(Unlimited::Wild)?;
        };
        Ok(levels.iter().rev().fold(last, |mask, (disc, child)| before(&mask, disc, child)))
    }

    /// Returns whether all perturbations from `level` on are negligible together.
    fn is_quiet(&self, level: usize, spread: &Spread) -> bool {
        let cycle = self.finder.cycle;
        let upsamplings = cycle.level(level).first().map_or(0, |step| cycle.upsamplings(level, step));
        // the sum c gamma^h (1 + gamma + gamma^2 + ...) after h upsamplings
        let left = self.perturbation.at(upsamplings).amplitude / (1.0 - self.perturbation.decay);
        left * if self.finder.with_tangents { 1.0 } else { spread.now.min(1.0) } <= NEGLIGIBLE_PERTURBATION
    }

    /// Returns the mask that a disc before `level` has under the plan without perturbation.
    fn unperturbed(&self, level: usize, disc: &Disc, parameters: &VertexParameters) -> Result<LimitMask, Unlimited> {
        let common = parameters.first();
        let mask = if common.are_there() {
            Masks::new(self.finder, common).of(level, disc)?
        } else {
            self.plain.of(level, disc)?
        };
        Ok(LimitMask::clone(&mask))
    }
}

/// Returns the mask of a disc, given the mask of its child.
///
/// The second tangent is made orthogonal to the first, which does not change the normal: if the first grows faster from
/// level to level backwards, the second would otherwise become parallel to it within rounding.
fn before(mask: &LimitMask, disc: &Disc, child: &Child) -> LimitMask {
    let both = |[t, u]: &[Vec<f64>; 2]| {
        let t = tangential(child.back(t));
        let mut u = child.back(u);
        let along = dot(&u, &t) / dot(&t, &t);
        u.iter_mut().zip(&t).for_each(|(x, y)| *x -= along * y);
        Ok::<_, Infallible>([t, tangential(u)])
    };
    let Ok(mask) = mask.seen_from(disc, (&child.disc, child.rotation), |row| Ok(child.back(row)), both);
    mask
}

/// The distance between the points around a vertex from level to level, relative to the first level.
struct Spread {
    /// Coordinate vectors refined so far, relative to the centre.
    witnesses: Vec<Vec<f64>>,
    now: f64,
    least: f64,
    /// The largest factor by which the distance grew between any two levels; it bounds later growth, as later
    /// perturbations are smaller.
    growth: f64,
}

impl Spread {
    fn new(support: usize) -> Self {
        Self { witnesses: starting_vectors(support, WITNESS_VECTORS), now: 1.0, least: 1.0, growth: 1.0 }
    }

    /// Applies one level to the witnesses and updates the distances.
    fn go_on(&mut self, child: &Child) {
        for witness in &mut self.witnesses {
            let mut next = child.forth(witness);
            let centre = next[0];
            next.iter_mut().for_each(|x| *x -= centre);
            *witness = next;
        }
        let all = || self.witnesses.iter().flatten();
        let largest = all().fold(0.0, |most: f64, x| most.max(x.abs()));
        self.now = if all().all(|x| x.is_finite()) { largest } else { f64::INFINITY };
        self.least = self.least.min(self.now);
        self.growth = self.growth.max(self.now / self.least);
    }

    /// Returns whether the points coincide and will continue to.
    fn is_none(&self) -> bool {
        self.now * self.growth <= COINCIDENCE_DISTANCE
    }

    fn is_finite(&self) -> bool {
        self.now.is_finite() && self.growth.is_finite()
    }
}
