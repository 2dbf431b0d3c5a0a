//! Limits under perturbations that decay: each vertex is followed through the levels with its surroundings.
//!
//! The perturbation of a point at a later level goes by its number in the whole net there, so that no two vertices
//! share a mask. The numbers of the points around a vertex follow from level to level (see [`Numbering`]), and with
//! them the matrices. The product of these ends where what is left of the perturbation no longer matters, or where the
//! points around the vertex are together. The rest is a mask of the plan without perturbation.

use std::convert::Infallible;
use std::sync::Arc;

use rayon::prelude::*;

use super::bounds::{MAX_FOLLOWED_LEVELS, MAX_FOLLOWED_POINTS};
use super::cycle::Child;
use super::disc::{Centre, Disc, Located, Rings};
use super::error::Unlimited;
use super::field::{Field, located};
use super::mask::{Finder, Mask, Masks, tangential};
use super::neighbourhoods::Neighbourhoods;
use super::request::LimitRequest;
use super::small::dot;
use super::tangent::starting_vectors;
use super::vertex_parameters::{CommonParameters, VertexParameters};
use crate::scheme::operator::Role;
use crate::scheme::plan::{Perturbation, Plan};
use crate::shape::numbering::Numbering;
use crate::shape::topology::index;
use crate::watch::Watch;

/// Rows that take as long as following one of them: measured, 50 to 200 microseconds.
/// It only says how much of the budget a point takes: with half of it limits are told half as long as they take, at
/// twice of it twice as long.
pub const ROWS_A_POINT: u64 = 1_000;
/// Perturbations below which what is still to come is left out: times the distances they act on for positions, by
/// themselves for tangents.
/// It is half of the rounding of 1, so that what is left out would be lost in sums with coordinates of size 1. Half and
/// twice of it follow about one level more or less for a decay of 1/2.
const QUIET: f64 = 1e-16;
/// Points that are no further apart, of 1 at the beginning, are together.
/// It is a 200th of the rounding of coordinates of size 1. Half and twice of it follow about one level more or less.
const TOGETHER: f64 = 1e-18;
/// Vectors of coordinates that tell how far the points around a vertex are apart.
/// The largest of them is what counts, which random columns underestimate by less the more there are. With half of it
/// points may be called together a level early; with twice of it each level takes longer.
const WITNESSES: usize = 8;
/// Vertices whose surroundings are counted at a time.
/// Half of it waits for all threads, and looks at the watch, twice as often; with twice of it a refusal comes later by
/// as much.
const CHUNK: usize = 4_096;

/// The perturbation of a plan, if it has any say in the cycle.
pub(super) fn of(plan: &Plan) -> Option<Perturbation> {
    let uses = |role: Role| matches!(role, Role::Average | Role::PushBack);
    let acts = plan.word.cycle.iter().any(|letter| uses(letter.facts().role));
    plan.perturbation.filter(|perturbation| acts && perturbation.amplitude != 0.0)
}

/// About how many points are around a vertex that is followed by itself for what is asked of a mesh; 0 where none is.
pub fn followed_points(plan: &Plan, request: LimitRequest) -> u64 {
    let with_normals = |perturbation: &Perturbation| request.normals && no_normals(perturbation).is_none();
    if !of(plan).is_some_and(|perturbation| request.positions || with_normals(&perturbation)) {
        return 0;
    }
    let rings = plan.word.cycle.iter().filter(|letter| letter.facts().role != Role::Upsample).count() as u64;
    (2 * rings + 1).saturating_pow(2)
}

/// Why there are no limit normals: perturbations are known to leave tangents where they decay by less than 1/2.
pub(super) fn no_normals(perturbation: &Perturbation) -> Option<String> {
    let decay = perturbation.decay;
    (decay >= 0.5).then(|| {
        format!(
            "the normals are weighted by area, as limits of perturbed plans are known to have normals where \"decay\" \
             is below 1/2; here it is {decay}"
        )
    })
}

/// The masks of all vertices of a net; each counts as work of so many rows.
pub(super) fn field<'a>(
    around: &'a dyn Neighbourhoods,
    rings: Rings,
    finder: &Finder<'_>,
    perturbation: Perturbation,
    rows: u64,
    watch: &Watch,
) -> Result<Field<'a>, Unlimited> {
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
    Ok(Field::of_masks(around, rings, masks))
}

/// Whether not too many points are around all vertices together.
fn check_size(around: &dyn Neighbourhoods, rings: Rings, watch: &Watch) -> Result<(), Unlimited> {
    let all: Vec<Centre> = (0..around.n_vertices()).filter_map(|v| around.centre(v)).collect();
    let mut points = 0;
    for chunk in all.chunks(CHUNK) {
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

/// Follows vertices.
struct Follower<'a> {
    finder: &'a Finder<'a>,
    plain: &'a Masks<'a>,
    perturbation: Perturbation,
    watch: &'a Watch,
}

impl Follower<'_> {
    /// The mask of a disc whose parts have these numbers in the whole net.
    fn mask(&self, found: Located, parameters: VertexParameters, numbering: Numbering) -> Result<Mask, Unlimited> {
        let (mut disc, mut parameters, mut numbering) = (found.disc, parameters, numbering);
        let mut spread = Spread::new(disc.support);
        let mut levels: Vec<(Disc, Child)> = Vec::new();
        let last = loop {
            self.watch.check()?;
            if !self.finder.with_tangents && spread.is_none() {
                break Mask { position: disc.middle(), tangents: Vec::new() };
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

    /// Whether the perturbations from a level on change nothing.
    fn is_quiet(&self, level: usize, spread: &Spread) -> bool {
        let cycle = self.finder.cycle;
        let upsamplings = cycle.level(level).first().map_or(0, |step| cycle.upsamplings(level, step));
        // c gamma^h (1 + gamma + gamma^2 + ...)
        let left = self.perturbation.at(upsamplings).amplitude / (1.0 - self.perturbation.decay);
        left * if self.finder.with_tangents { 1.0 } else { spread.now.min(1.0) } <= QUIET
    }

    /// The mask of the plan without perturbation.
    fn unperturbed(&self, level: usize, disc: &Disc, parameters: &VertexParameters) -> Result<Mask, Unlimited> {
        let common = parameters.first();
        let mask = if common.are_there() {
            Masks::new(self.finder, common).of(level, disc)?
        } else {
            self.plain.of(level, disc)?
        };
        Ok(Mask::clone(&mask))
    }
}

/// Returns a limit as it is seen from one level before.
///
/// Of two tangents the second is cleared of the first, which changes no normal: where the first grows faster backwards
/// the second would drown in it.
fn before(mask: &Mask, disc: &Disc, child: &Child) -> Mask {
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

/// How far the points around a vertex are apart, of 1 at the beginning.
struct Spread {
    /// Coordinates, less those of the centre.
    witnesses: Vec<Vec<f64>>,
    now: f64,
    least: f64,
    /// By what it grew at most between any two levels: perturbations to come are smaller.
    growth: f64,
}

impl Spread {
    fn new(support: usize) -> Self {
        Self { witnesses: starting_vectors(support, WITNESSES), now: 1.0, least: 1.0, growth: 1.0 }
    }

    /// After a level.
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

    /// Whether the points are together, and stay so.
    fn is_none(&self) -> bool {
        self.now * self.growth <= TOGETHER
    }

    fn is_finite(&self) -> bool {
        self.now.is_finite() && self.growth.is_finite()
    }
}
