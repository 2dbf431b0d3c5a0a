//! Which plans refine splines, so that second differences bound the distance from the limit.

use super::hull::MAX_REACH;
use crate::analysis::no_level::NoLevel;
use crate::math::functions::real;
use crate::scheme::letter::Letter;
use crate::scheme::operator::{SPLINES, SplineStep};
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::word::Word;
use crate::shape::mesh::Mesh;
use crate::shape::tile::Tile;

/// Levels whose numbers are looked at.
/// Kernels that are functions of alpha settle after 26 halvings of it, as cosines do. Half of it may miss a kernel that
/// differs from 1 later only; twice of it schedules twice as many.
const LOOKED_AT: u32 = 32;

/// A plan whose cycle is one or several upsamplings, each with its averages, as a spline has them.
#[derive(Debug)]
pub(super) struct Spline {
    /// The plan, two D in a row written as one C.
    pub(super) plan: Plan,
    /// What comes before the first cycle.
    pub(super) prefix: Vec<Scheduled>,
    /// The steps of one cycle, upsampling by upsampling.
    pub(super) rounds: Vec<Vec<Scheduled>>,
    /// Rings of faces around a face that its limit depends on: the most averages after an upsampling.
    pub(super) reach: usize,
    /// The distance from the limit over the greatest second difference, at most.
    pub(super) factor: f64,
    /// Into what faces are split.
    pub(super) tile: Tile,
    /// Whether each upsampling is followed by half an average more, which puts vertices in the place of faces. Then
    /// nets are looked at after the upsampling: the next one is that after half an average and the upsampling that
    /// follows, whose faces are quarters of the faces before.
    pub(super) halved: bool,
}

impl Spline {
    /// The spline that a plan refines on a mesh.
    ///
    /// # Errors
    /// Why second differences bound nothing.
    pub(super) fn of(plan: &Plan, mesh: &Mesh) -> Result<Self, NoLevel> {
        let local = [
            (plan.perturbation.is_some(), "perturbation"),
            (mesh.attributes.is_some(), "parameters of vertices"),
            (plan.latitude.is_some(), "latitude and longitude tags"),
        ];
        if let Some((_, what)) = local.into_iter().find(|(is_there, _)| *is_there) {
            return Err(unknown(&format!("with {what}")));
        }
        if plan.turns_tangents().is_some() {
            return Err(unknown("the scheme is not linear, so that"));
        }
        let dual = plan.word.cycle.iter().any(|letter| step(plan, letter) == Ok(SplineStep::HalfMean));
        if dual && mesh.topology.n_boundary() > 0 {
            return Err(NoLevel::Refused(
                "a dual scheme loses the boundary, which the limit is not near to; close the mesh, or give \"levels\" \
                 as a number"
                    .to_owned(),
            ));
        }
        let plan = Plan { word: Word { cycle: paired(plan)?, ..plan.word.clone() }, ..plan.clone() };
        let scheduled = |levels| plan.schedule(levels).map_err(|fault| NoLevel::Refused(fault.detail));
        let prefix = scheduled(0)?;
        for later in &scheduled(LOOKED_AT)?[prefix.len()..] {
            #[expect(clippy::float_cmp, reason = "a kernel that is 1 is computed without rounding")]
            if later.kernel != 1.0 {
                return Err(NoLevel::Refused(format!(
                    "the kernel is {} at some level; distances are bounded for splines, whose kernel is 1 at all \
                     levels: leave it out, or give \"levels\" as a number",
                    later.kernel
                )));
            }
        }
        let mut rounds: Vec<Vec<Scheduled>> = Vec::new();
        for later in scheduled(1)?.split_off(prefix.len()) {
            match step(&plan, &later.letter) {
                Ok(SplineStep::Upsample) => rounds.push(vec![later]),
                Ok(_) => match rounds.last_mut() {
                    Some(round) => round.push(later),
                    None => return Err(no_spline("its cycle does not begin with a U")),
                },
                Err(why) => return Err(no_spline(why)),
            }
        }
        let averages = rounds.iter().map(|round| round.len() - 1).max().unwrap_or(0);
        let tile = plan.tile();
        let half = |round: &Vec<Scheduled>| {
            round.last().is_some_and(|last| step(&plan, &last.letter) == Ok(SplineStep::HalfMean))
        };
        let halved = rounds.iter().any(half);
        if halved && !rounds.iter().all(half) {
            return Err(single_dual());
        }
        let (reach, factor) =
            if halved { (2 * averages, halved_factor(averages)) } else { (averages, factor(tile, averages)) };
        Ok(Self { plan, prefix, rounds, reach, factor, tile, halved })
    }

    /// The steps of the round that comes after so many, the cycle beginning with round 0.
    pub(super) fn round(&self, number: usize) -> &[Scheduled] {
        &self.rounds[number % self.rounds.len()]
    }

    /// Rings of faces around a face that are compared with its limit, and it with theirs.
    pub(super) fn rings(&self) -> usize {
        if self.reach <= MAX_REACH { self.reach + 1 } else { 1 }
    }

    /// Rings of faces that are kept around those that are followed. A level makes twice as many of them, of which a cut
    /// changes as many as the limit depends on; what is left has to hold all that the limits of the faces that are
    /// compared, and of those beside them, depend on.
    pub(super) fn margin(&self) -> usize {
        (self.reach + 2).max((2 * self.reach + self.rings() + 1).div_ceil(2))
    }
}

/// The refusal of what lets no distance be known.
fn unknown(why: &str) -> NoLevel {
    NoLevel::Refused(format!("{why} no distance to the limit is known in advance; give \"levels\" as a number"))
}

/// The refusal of another scheme, which makes no splines for a reason.
fn no_spline(why: &str) -> NoLevel {
    NoLevel::Refused(format!(
        "distances are bounded for {SPLINES}, which this plan does not as {why}; give \"levels\" as a number"
    ))
}

/// The refusal of D that stand alone in other places than the last before an upsampling.
fn single_dual() -> NoLevel {
    NoLevel::Refused(
        "distances are bounded where each U of the cycle is followed by C and pairs of D, or each by one D more, \
         which comes last; use C instead, or give \"levels\" as a number"
            .to_owned(),
    )
}

fn step(plan: &Plan, letter: &Letter) -> Result<SplineStep, &'static str> {
    letter.operator.spline(&letter.settings, plan.mu)
}

/// The cycle with each pair of D as one C, on closed meshes the same net in another order; a D that is left over comes
/// last before the next upsampling.
fn paired(plan: &Plan) -> Result<Vec<Letter>, NoLevel> {
    let mut cycle: Vec<Letter> = Vec::new();
    let mut half: Option<&Letter> = None;
    for letter in &plan.word.cycle {
        match (step(plan, letter), half) {
            (Ok(SplineStep::HalfMean), None) => half = Some(letter),
            (Ok(SplineStep::HalfMean), Some(_)) => {
                let whole = letter.facts().twice.ok_or_else(single_dual)?;
                cycle.push(Letter { operator: whole, ..letter.clone() });
                half = None;
            }
            // halves that are not next to each other do not make a whole where averages see the net between them
            (Ok(SplineStep::Mean) | Err(_), Some(_)) => return Err(single_dual()),
            _ => {
                cycle.extend(half.take().cloned());
                cycle.push(letter.clone());
            }
        }
    }
    cycle.extend(half.cloned());
    Ok(cycle)
}

/// The same where half an average is the last of so many, for quads after the upsampling: each moves by half of the
/// greatest second difference at most, and half an average and the next upsampling by no more.
fn halved_factor(averages: usize) -> f64 {
    4.0 / 3.0 * 0.5 * real(averages)
}

/// The sum of what all averages of all levels move, over the greatest second difference before them, at most: the first
/// average after each upsampling and the others, the upsampling and the first average together dividing by 4.
fn factor(tile: Tile, averages: usize) -> f64 {
    let Some(others) = averages.checked_sub(1) else { return 0.0 };
    let (first, each) = match tile {
        Tile::Quad => (1.0 / 4.0, 1.0 / 8.0),
        Tile::Triangle => (3.0 / 16.0, 3.0 / 32.0),
    };
    4.0 / 3.0 * (first + each * real(others))
}
