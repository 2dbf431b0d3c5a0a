//! One application of a plan's cycle to polygons as one mask, which is found by refining a single impulse.

use crate::math::mask::Mask;
use crate::math::number::Number;
use crate::refine::{Points, RefineError, advance};
use crate::scheme::extent::Ends;
use crate::scheme::letter::Letter;
use crate::scheme::operator::Role;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::polygon_net::PolygonNet;
use crate::watch::{Stopped, Watch};

/// Maximum number of points of the polygon that carries the impulse; masks may reach about half as far. Half or twice
/// of it halves or doubles the reach beyond which a cycle is refused, and the memory of the impulse.
const MAX_IMPULSE_POINTS: u64 = 1 << 16;
/// Largest difference at which masks are regarded as equal, about 5 units in the last place of 1. With half of it
/// rounding may keep equal masks apart, and more levels are regarded as changing; with twice of it the limit may differ
/// by 1e-15 more.
const SETTLED_MASK_DISTANCE: f64 = 1e-15;
/// Largest difference from 1 of a sum of weights that counts as 1. Sums of a few hundred weights are wrong by 1e-13;
/// half of it is still far above that, and twice of it takes masks for convergent whose sums are 2e-9 off.
pub(super) const SUM_TOLERANCE: f64 = 1e-9;
/// Number of products of weights that take as long as a row of a table, about 100 ns. It only sets how much of the
/// budget and of the progress a product takes: with half of it a search ends after half the work, with twice of it
/// after twice the work.
const PRODUCTS_A_ROW: u64 = 64;
/// Maximum number of levels whose masks may differ from the static limit. Cosines of an angle that is halved come four
/// times as close to their limit at each level, so that some 25 levels suffice; half or twice of it only matters to
/// functions that converge more slowly.
const MAX_CHANGING: u32 = 128;
/// Maximum number of consecutive levels that may equal the static limit by chance, as cosines of multiples of a full
/// turn do. It covers angles up to 512 pi. Half of it would take 32 pi for converged; twice of it computes as many more
/// masks of every plan that depends on alpha.
const MAX_COINCIDING_LEVELS: usize = 8;

/// The reason why the cycle of a plan is not one mask per level.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoMask {
    /// The plan has no cycle.
    #[error("there is no plan that could be repeated")]
    NoCycle,
    /// The rules are random.
    #[error("a perturbed plan has random rules at every level")]
    Perturbed,
    /// The rules depend on the positions of the points.
    #[error("{0} is not linear")]
    NotLinear(&'static str),
    /// The roles of points carry over from one application of the cycle to the next.
    #[error("the cycle does not begin with an upsampling")]
    NoUpsampling,
    /// The mask would be too long.
    #[error("the cycle reaches too far")]
    TooWide,
    /// A function of the plan has no value.
    #[error("{0}")]
    NoValue(String),
    /// The scheme has no limit.
    #[error("the scheme does not converge")]
    Diverges,
    /// The masks of the levels do not converge to that of a static scheme.
    #[error("the rules do not settle as alpha goes to 0")]
    Unsettled,
    /// The watch stopped the computation.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// One application of a cycle as a mask a: `q[j] = sum over i of a[j - d i] p[i]`.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleMask {
    /// The arity d of the whole cycle.
    pub arity: i64,
    /// The mask a.
    pub mask: Mask,
}

impl CycleMask {
    /// Returns the cycle that makes level `level + 1`, on closed polygons without parameters at single points.
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
        if n.saturating_mul(arity) > MAX_IMPULSE_POINTS {
            return Err(NoMask::TooWide);
        }
        let response = response(plan, &steps, usize::try_from(n).map_err(|_| NoMask::TooWide)?, watch)?;
        let reach = usize::try_from(reach).map_err(|_| NoMask::TooWide)?;
        // points with negative indices are at the end of the closed polygon
        let around = response[response.len() - reach..].iter().chain(&response[..=reach]);
        let around: Vec<f64> = around.copied().collect();
        let first = i32::try_from(reach).map_err(|_| NoMask::TooWide)?;
        let mask = Mask::new(-first, &around).ok_or(NoMask::Unsettled)?;
        Ok(Self { arity: arity.cast_signed(), mask })
    }

    /// Returns the cycle to which the cycles of a plan converge as alpha is divided: the cycle at alpha 0.
    ///
    /// # Errors
    /// [`NoMask`].
    pub fn settled(plan: &Plan, watch: &Watch) -> Result<Self, NoMask> {
        Self::of(&Plan { alpha: 0.0, compensation_alpha: None, ..plan.clone() }, 0, watch)
    }

    /// Returns the cycles after `levels` levels that differ from the static limit, and the static limit.
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
            same = if cycle.distance(&settled) <= SETTLED_MASK_DISTANCE { same + 1 } else { 0 };
            changing.push(cycle);
            if same > MAX_COINCIDING_LEVELS {
                changing.truncate(changing.len() - same);
                return Ok((changing, settled));
            }
        }
        Err(NoMask::Unsettled)
    }

    /// Returns `2 c`, rounded to a whole number, where `c` is the centre of gravity of the mask: old point `i` has its
    /// new place at `d i + c`. Exact for symmetric masks.
    pub fn twice_centre(&self) -> i64 {
        let sum: f64 = self.mask.values.iter().sum();
        let moment: f64 = self.entries().map(|(j, a)| f64::whole(j) * a).sum();
        let centre = (2.0 * moment / sum).round();
        let (least, most) = (2 * i64::from(self.mask.first), 2 * i64::from(self.mask.last()));
        // a mask whose centre of gravity is outside of its support is centred on its support
        (least..=most).find(|&c| (f64::whole(c) - centre).abs() < 0.25).unwrap_or_else(|| i64::midpoint(least, most))
    }

    /// Returns the cycle that changes nothing.
    pub fn identity() -> Self {
        Self { arity: 1, mask: Mask { first: 0, values: vec![1.0] } }
    }

    /// Returns the work of composing this cycle with `next`, in rows of a table.
    pub fn work_with(&self, next: &Self) -> u64 {
        (self.mask.values.len() as u64).saturating_mul(next.mask.values.len() as u64 / PRODUCTS_A_ROW + 1)
    }

    /// Returns the composition of this cycle and `next` after it.
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

    /// Returns the entries of the mask with their indices.
    pub fn entries(&self) -> impl Iterator<Item = (i64, f64)> + '_ {
        (i64::from(self.mask.first)..).zip(self.mask.values.iter().copied())
    }

    /// Returns the entry `a[j]`, 0 outside of the mask.
    pub fn at(&self, j: i64) -> f64 {
        isize::try_from(j).map_or(0.0, |j| self.mask.at(j))
    }

    fn distance(&self, other: &Self) -> f64 {
        let least = self.mask.first.min(other.mask.first);
        let most = self.mask.last().max(other.mask.last());
        (least..=most).map(|j| (self.at(j.into()) - other.at(j.into())).abs()).fold(0.0, f64::max)
    }
}

/// Returns whether all levels of a plan have the same rules, because nothing depends on alpha or alpha is 0.
pub fn is_static(plan: &Plan) -> bool {
    let follows = |letter: &Letter| letter.facts().needs_alpha;
    let in_alpha = plan.kernel.iter().any(|kernel| !kernel.is_constant())
        || !plan.compensation.is_constant()
        || plan.word.cycle.iter().any(follows);
    let alphas = [plan.alpha, plan.compensation_alpha.unwrap_or(plan.alpha)];
    !in_alpha || alphas.iter().all(|&alpha| alpha == 0.0)
}

/// Returns the arity of all steps together and the reach of one point in new points; `None` if either is too large.
fn extent(steps: &[Scheduled]) -> Option<(u64, u64)> {
    let (mut arity, mut last, mut reach, mut duals) = (1_u64, 1_u64, 0_u64, 0);
    for step in steps {
        let operator = step.letter.operator;
        if operator.facts().role == Role::Upsample {
            duals = 0;
        }
        if let Some(range) = operator.mask_range(&step.letter.settings, duals) {
            let d = u64::from(range.arity);
            arity = arity.checked_mul(d).filter(|&arity| arity <= MAX_IMPULSE_POINTS)?;
            let spread = range.first.unsigned_abs().max(range.last.unsigned_abs());
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

/// Refines the values 1 at point 0 and 0 at the other points of a closed polygon of `n` points.
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
