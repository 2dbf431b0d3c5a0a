//! Determines whether a plan refines splines, so that second differences bound the distance from the limit.

use super::hull::MAX_REACH;
use crate::analysis::no_level::NoLevel;
use crate::math::functions::real;
use crate::scheme::letter::Letter;
use crate::scheme::operator::{SPLINES, SplineStep};
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::word::Word;
use crate::shape::mesh::Mesh;
use crate::shape::tile::Tile;

/// Number of levels whose kernels are checked.
/// Kernels that are functions of alpha settle after 26 halvings of it, as cosines do. Half of it may miss a kernel that
/// differs from 1 only later; twice of it schedules twice as many levels.
const CHECKED_KERNELS: u32 = 32;

/// A plan that refines splines: each cycle is one or several rounds, an upsampling followed by averages.
#[derive(Debug)]
pub(super) struct Spline {
    /// The plan, with each pair of D written as one C.
    pub(super) plan: Plan,
    /// The steps before the first cycle.
    pub(super) prefix: Vec<Scheduled>,
    /// The rounds of one cycle; each begins with its upsampling.
    pub(super) rounds: Vec<Vec<Scheduled>>,
    /// Number of rings of faces around a face that its limit depends on: the greatest number of averages in a round,
    /// counted twice if `halved`.
    pub(super) reach: usize,
    /// An upper bound of the distance between a face and its limit, relative to the greatest second difference.
    pub(super) factor: f64,
    /// The tile into which faces are split.
    pub(super) tile: Tile,
    /// Whether each round ends with half an average, a D without a partner, which replaces faces by vertices. Then
    /// nets are compared after the upsampling: the faces of the net after the rest of a round and the next upsampling
    /// are quarters of its faces.
    pub(super) halved: bool,
}

impl Spline {
    /// Returns the spline that a plan refines on a mesh.
    ///
    /// # Errors
    /// [`NoLevel`] if second differences do not bound the distance from the limit, with the reason.
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
        for later in &scheduled(CHECKED_KERNELS)?[prefix.len()..] {
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

    /// Returns the steps of round `number`, counted from 0 over all cycles.
    pub(super) fn round(&self, number: usize) -> &[Scheduled] {
        &self.rounds[number % self.rounds.len()]
    }

    /// Returns the number of rings of faces around a face that are compared with its limit, and whose limits are
    /// compared with it.
    pub(super) fn rings(&self) -> usize {
        if self.reach <= MAX_REACH { self.reach + 1 } else { 1 }
    }

    /// Returns the number of rings of faces that are kept around the faces that are followed. A level doubles them, but
    /// makes `reach` of them wrong along the cut; the others must contain all that the limits of the compared faces and
    /// of the faces next to them depend on.
    pub(super) fn margin(&self) -> usize {
        (self.reach + 2).max((2 * self.reach + self.rings() + 1).div_ceil(2))
    }
}

/// Returns the refusal of plans or meshes for which no distance is known in advance.
fn unknown(why: &str) -> NoLevel {
    NoLevel::Refused(format!("{why} no distance to the limit is known in advance; give \"levels\" as a number"))
}

/// Returns the refusal of schemes that do not refine splines.
fn no_spline(why: &str) -> NoLevel {
    NoLevel::Refused(format!(
        "distances are bounded for {SPLINES}, which this plan does not as {why}; give \"levels\" as a number"
    ))
}

/// Returns the refusal of plans in which a D without a partner does not end each round.
fn single_dual() -> NoLevel {
    NoLevel::Refused(
        "distances are bounded where each U of the cycle is followed by C and pairs of D, or each by one D more, \
         which comes last; use C instead, or give \"levels\" as a number"
            .to_owned(),
    )
}

/// Returns the role of a letter in refining splines, or why it has none.
fn step(plan: &Plan, letter: &Letter) -> Result<SplineStep, &'static str> {
    letter.operator.spline(&letter.settings, plan.mu)
}

/// Returns the cycle with each pair of consecutive D replaced by one C, which on closed meshes makes the same net in
/// another order. A D without a partner must be the last letter before the next upsampling.
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
            // two D do not make a C if another average is applied between them
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

/// Returns [`Spline::factor`] for rounds of `averages` averages on quads, the last of which is half an average, with
/// second differences taken after the upsampling: `4/3 averages/2`. Each average moves points by at most half of the
/// greatest second difference, and so do half an average and the next upsampling together.
fn halved_factor(averages: usize) -> f64 {
    4.0 / 3.0 * 0.5 * real(averages)
}

/// Returns [`Spline::factor`] for rounds of `averages` averages: `4/3 (1/4 + (averages - 1)/8)` on quads and
/// `4/3 (3/16 + 3 (averages - 1)/32)` on triangles; 0 without averages. The summands bound the movements by the first
/// average of a round and by the others, relative to the greatest second difference before the round; each round
/// divides that by 4, so that the sum over all rounds is 4/3 of the first.
fn factor(tile: Tile, averages: usize) -> f64 {
    let Some(others) = averages.checked_sub(1) else { return 0.0 };
    let (first, each) = match tile {
        Tile::Quad => (1.0 / 4.0, 1.0 / 8.0),
        Tile::Triangle => (3.0 / 16.0, 3.0 / 32.0),
    };
    4.0 / 3.0 * (first + each * real(others))
}
