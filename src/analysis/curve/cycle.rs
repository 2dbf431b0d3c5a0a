//! One application of a plan's cycle to polygons as one mask, found by refining a single impulse.

use crate::math::mask::Mask;
use crate::refine::{Points, RefineError, advance};
use crate::scheme::extent::Ends;
use crate::scheme::letter::Letter;
use crate::scheme::operator::Role;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::polygon_net::PolygonNet;
use crate::watch::{Stopped, Watch};

/// Most points of the polygon that carries the impulse.
/// Masks may reach about half as far. Half and twice of it halve and double the reach from which a cycle is refused,
/// and the memory that the impulse takes.
const MAX_POINTS: u64 = 1 << 16;
/// Masks that differ by less count as equal.
/// It is about 5 units in the last place of 1. At half of it rounding may keep masks apart that are equal, and more
/// levels count as changing; at twice of it the limit may differ by 1e-15 more.
const SAME: f64 = 1e-15;
/// Products of weights that take as long as a row of a table, about 100 ns.
/// It only says how much of the budget and of the progress a product takes: with half of it a search ends after half
/// the work, with twice of it after twice.
const PRODUCTS_A_ROW: u64 = 64;
/// Most levels whose masks may differ from the static limit.
/// Cosines of an angle that is halved come four times as close at each level, so that some 25 levels settle them: half
/// and twice of it only matter to functions that settle slower.
const MAX_CHANGING: u32 = 128;
/// Levels in a row that may equal the static limit by chance, as cosines of multiples of a whole turn do.
/// It is those of angles up to 512 pi. Half of it takes 32 pi for settled; twice of it computes as many masks more of
/// every plan that follows alpha.
const COINCIDING: usize = 8;

/// The reason for which the cycle of a plan is not one mask per level.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoMask {
    /// There is nothing to repeat.
    #[error("there is no plan that could be repeated")]
    NoCycle,
    /// The rules are random.
    #[error("a perturbed plan has random rules at every level")]
    Perturbed,
    /// The rules depend on the points.
    #[error("{0} is not linear")]
    NotLinear(&'static str),
    /// The roles of points go on from one application to the next.
    #[error("the cycle does not begin with an upsampling")]
    NoUpsampling,
    /// The mask would be very long.
    #[error("the cycle reaches too far")]
    TooWide,
    /// A function has no value.
    #[error("{0}")]
    NoValue(String),
    /// There is no limit.
    #[error("the scheme does not converge")]
    Diverges,
    /// The levels do not come close to a static scheme.
    #[error("the rules do not settle as alpha goes to 0")]
    Unsettled,
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// One application of a cycle: `q[j] = sum over i of a[j - d i] p[i]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Cycle {
    /// Arity d of the whole cycle.
    pub arity: i64,
    /// The mask a.
    pub mask: Mask,
}

impl Cycle {
    /// The cycle as it is applied at level `level + 1`, closed polygons and points without parameters of their own.
    ///
    /// # Errors
    /// [`NoMask`].
    pub fn of(plan: &Plan, level: u32, watch: &Watch) -> Result<Self, NoMask> {
        if plan.perturbation.is_some() {
            return Err(NoMask::Perturbed);
        }
        if let Some(name) = plan.turns_tangents() {
            return Err(NoMask::NotLinear(name));
        }
        let first = plan.word.cycle.first().ok_or(NoMask::NoCycle)?;
        if first.facts().role != Role::Upsample {
            return Err(NoMask::NoUpsampling);
        }
        let steps = plan.schedule(level + 1).map_err(|fault| NoMask::NoValue(fault.detail))?;
        let steps: Vec<Scheduled> = steps.into_iter().filter(|step| step.level == level + 1).collect();
        let (arity, reach) = extent(&steps).ok_or(NoMask::TooWide)?;
        let n = 2 * reach.div_ceil(arity) + 3;
        if n.saturating_mul(arity) > MAX_POINTS {
            return Err(NoMask::TooWide);
        }
        let response = response(plan, &steps, usize::try_from(n).map_err(|_| NoMask::TooWide)?, watch)?;
        let reach = usize::try_from(reach).map_err(|_| NoMask::TooWide)?;
        // the points before the impulse stand at the end of the closed polygon
        let around = response[response.len() - reach..].iter().chain(&response[..=reach]);
        let around: Vec<f64> = around.copied().collect();
        let first = i32::try_from(reach).map_err(|_| NoMask::TooWide)?;
        let mask = Mask::new(-first, &around).ok_or(NoMask::Unsettled)?;
        Ok(Self { arity: arity.cast_signed(), mask })
    }

    /// The cycle to which those of a plan come ever closer as alpha is divided: the one at alpha 0.
    ///
    /// # Errors
    /// [`NoMask`].
    pub fn settled(plan: &Plan, watch: &Watch) -> Result<Self, NoMask> {
        Self::of(&Plan { alpha: 0.0, compensation_alpha: None, ..plan.clone() }, 0, watch)
    }

    /// The cycles after `levels` levels until they differ no more from the static limit, and that.
    ///
    /// # Errors
    /// [`NoMask`].
    pub fn from_level(plan: &Plan, levels: u32, watch: &Watch) -> Result<(Vec<Self>, Self), NoMask> {
        let settled = Self::settled(plan, watch)?;
        if is_static(plan) {
            return Ok((Vec::new(), settled));
        }
        let (mut changing, mut same) = (Vec::new(), 0);
        for level in levels..levels + MAX_CHANGING {
            let cycle = Self::of(plan, level, watch)?;
            same = if cycle.distance(&settled) <= SAME { same + 1 } else { 0 };
            changing.push(cycle);
            if same > COINCIDING {
                changing.truncate(changing.len() - same);
                return Ok((changing, settled));
            }
        }
        Err(NoMask::Unsettled)
    }

    /// Twice the index `c` around which the mask is balanced, to the nearest whole number: old point `i` has its new
    /// place at `d i + c`. Exact for masks that are their own mirror image.
    pub fn twice_centre(&self) -> i64 {
        let sum: f64 = self.mask.values.iter().sum();
        let moment: f64 = self.entries().map(|(j, a)| real(j) * a).sum();
        let centre = (2.0 * moment / sum).round();
        let (least, most) = (2 * i64::from(self.mask.first), 2 * i64::from(self.mask.last()));
        // a mask that is balanced nowhere within itself is placed by its middle
        (least..=most).find(|&c| (real(c) - centre).abs() < 0.25).unwrap_or_else(|| i64::midpoint(least, most))
    }

    /// The cycle that changes nothing.
    pub fn identity() -> Self {
        Self { arity: 1, mask: Mask { first: 0, values: vec![1.0] } }
    }

    /// The work of composing this cycle and another one after it into one, in rows.
    pub fn work_with(&self, next: &Self) -> u64 {
        (self.mask.values.len() as u64).saturating_mul(next.mask.values.len() as u64 / PRODUCTS_A_ROW + 1)
    }

    /// This cycle and another one after it, as one.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn then(&self, next: &Self, watch: &Watch) -> Result<Self, Stopped> {
        let first = i64::from(self.mask.first) * next.arity + i64::from(next.mask.first);
        let last = i64::from(self.mask.last()) * next.arity + i64::from(next.mask.last());
        let mut values = vec![0.0; usize::try_from(last - first + 1).unwrap_or(0)];
        for (m, weight) in self.entries() {
            watch.check()?;
            watch.advance(next.mask.values.len() as u64 / PRODUCTS_A_ROW + 1);
            for (j, value) in next.entries() {
                let at = m * next.arity + j - first;
                values[usize::try_from(at).unwrap_or(0)] += weight * value;
            }
        }
        let first = i32::try_from(first).unwrap_or(0);
        Ok(Self { arity: self.arity * next.arity, mask: Mask { first, values } })
    }

    /// The entries with their indices.
    pub fn entries(&self) -> impl Iterator<Item = (i64, f64)> + '_ {
        (i64::from(self.mask.first)..).zip(self.mask.values.iter().copied())
    }

    /// The entry `a[j]`, 0 outside.
    pub fn at(&self, j: i64) -> f64 {
        isize::try_from(j).map_or(0.0, |j| self.mask.at(j))
    }

    fn distance(&self, other: &Self) -> f64 {
        let least = self.mask.first.min(other.mask.first);
        let most = self.mask.last().max(other.mask.last());
        (least..=most).map(|j| (self.at(j.into()) - other.at(j.into())).abs()).fold(0.0, f64::max)
    }
}

/// Whether all levels of a plan have the same rules, as nothing follows alpha or alpha is 0.
pub fn is_static(plan: &Plan) -> bool {
    let follows = |letter: &Letter| letter.facts().needs_alpha;
    let in_alpha = plan.kernel.iter().any(|kernel| !kernel.is_constant())
        || !plan.compensation.is_constant()
        || plan.word.cycle.iter().any(follows);
    let alphas = [plan.alpha, plan.compensation_alpha.unwrap_or(plan.alpha)];
    !in_alpha || alphas.iter().all(|&alpha| alpha == 0.0)
}

/// A small whole number as a real one.
#[expect(clippy::cast_precision_loss, reason = "indices of masks are far below 2^52")]
pub(super) fn real(n: i64) -> f64 {
    n as f64
}

/// Arity of all steps together, and how far they spread a point, in new points.
fn extent(steps: &[Scheduled]) -> Option<(u64, u64)> {
    let (mut arity, mut last, mut reach, mut duals) = (1_u64, 1_u64, 0_u64, 0);
    for step in steps {
        let operator = step.letter.operator;
        if operator.facts().role == Role::Upsample {
            duals = 0;
        }
        if let Some(window) = operator.window(&step.letter.settings, duals) {
            let d = u64::from(window.arity);
            arity = arity.checked_mul(d).filter(|&arity| arity <= MAX_POINTS)?;
            let spread = window.first.unsigned_abs().max(window.last.unsigned_abs());
            reach = reach.checked_mul(d)?.checked_add(spread.into())?;
            last = if d > 1 { d } else { last };
        }
        if operator.facts().role == Role::PushBack {
            reach += last;
        }
        duals += u32::from(step.letter.shifts());
    }
    Some((arity, reach))
}

/// What becomes of 1 at point 0 and 0 at the other points of a closed polygon.
fn response(plan: &Plan, steps: &[Scheduled], n: usize, watch: &Watch) -> Result<Vec<f64>, NoMask> {
    let mut net = PolygonNet::new(n, true, Ends::Clamped, &[]);
    let mut impulse = vec![0.0; n];
    impulse[0] = 1.0;
    let mut points = Points::new(impulse, 1);
    advance(&mut net, std::slice::from_mut(&mut points), plan, steps, watch).map_err(|error| match error {
        RefineError::Stopped(stopped) => NoMask::Stopped(stopped),
        RefineError::Step { error, .. } => NoMask::NoValue(error.to_string()),
        error @ RefineError::NotFinite { .. } => NoMask::NoValue(error.to_string()),
    })?;
    Ok(points.now)
}
