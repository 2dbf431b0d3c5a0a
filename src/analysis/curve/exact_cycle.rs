//! One application of a plan's cycle to polygons as one exact mask, in the limit alpha = 0.

use num_traits::{One, Zero};

use crate::math::exact::{Exact, ExactSequence};
use crate::math::exactly;
use crate::math::number::Number;
use crate::scheme::curve_rule::{CurveRule, between, pair, spread, triple};
use crate::scheme::mask_range::MaskRange;
use crate::scheme::operator::Role;
use crate::scheme::parameters::AVERAGES;
use crate::scheme::plan::{Plan, Scheduled};

/// One application of a cycle as an exact mask a: `q[j] = sum over i of a[j - d i] p[i]`.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactCycle {
    /// The arity d of the whole cycle.
    pub arity: i64,
    /// The index of the first entry.
    pub first: i64,
    /// The entries of the mask a, including zero weights within the reach of its operators.
    pub mask: Vec<Exact>,
}

impl ExactCycle {
    /// Returns the cycle to which the cycles of a plan converge; `None` if some weight is not known as a fraction.
    pub fn settled(plan: &Plan) -> Option<Self> {
        let settled = Plan { alpha: 0.0, compensation_alpha: None, ..plan.clone() };
        let steps = settled.schedule(1).ok()?;
        let mut state = ImpulseResponse::new();
        for step in steps.iter().filter(|step| step.level == 1) {
            state.apply(plan, step)?;
        }
        Some(Self { arity: state.arity, first: state.points.first, mask: state.points.values })
    }
}

/// The response to an impulse at point 0, after some of the steps of a cycle.
#[derive(Clone)]
pub(super) struct ImpulseResponse {
    pub(super) points: ExactSequence,
    /// The points that entered the last upsampling.
    pub(super) anchor: ExactSequence,
    pub(super) arity: i64,
    /// The arity of the last upsampling; vertices have the indices that are multiples of it.
    last_arity: i64,
    duals: u32,
    averages: usize,
}

impl ImpulseResponse {
    pub(super) fn new() -> Self {
        let points = ExactSequence::impulse(0);
        Self { anchor: points.clone(), points, arity: 1, last_arity: 1, duals: 0, averages: 0 }
    }

    pub(super) fn apply(&mut self, plan: &Plan, step: &Scheduled) -> Option<()> {
        let settings = &step.letter.settings;
        let facts = step.letter.facts();
        let duals = self.duals;
        self.points = match facts.curve? {
            CurveRule::Interpolate => self.upsampled(i64::from(settings.arity()), |points, d| {
                ExactSequence::made(d * points.first - (d - 1), d * points.last() + (d - 1), |j| {
                    let (i, part) = (j.div_euclid(d), j.rem_euclid(d));
                    let [before, after] = between::<Exact>(part, d);
                    before * points.at(i) + after * points.at(i + 1)
                })
            })?,
            CurveRule::Mask => {
                let mask =
                    ExactSequence { first: settings.mask()?.first.into(), values: settings.exact_mask()?.to_vec() };
                self.masked(settings.arity().into(), &mask)?
            }
            CurveRule::Circle => {
                let weights = spread(settings.arity(), settings.whole(&AVERAGES)?, |k| Exact::whole(k.into()));
                let mask = ExactSequence { first: settings.mask()?.first.into(), values: weights };
                self.masked(settings.arity().into(), &mask)?
            }
            CurveRule::Pair => {
                let (weight, back) = (self.weights(plan)?, i64::from(duals % 2));
                self.duals += 1;
                let old = &self.points;
                ExactSequence::made(old.first - 1 + back, old.last() + back, |j| {
                    let [a, b] = pair(&weight(j - back), &weight(j - back + 1));
                    a * old.at(j - back) + b * old.at(j - back + 1)
                })?
            }
            CurveRule::Triple => {
                let (weight, old) = (self.weights(plan)?, &self.points);
                ExactSequence::made(old.first - 1, old.last() + 1, |j| {
                    let [a, b, c] = triple(&[j - 1, j, j + 1].map(&weight));
                    a * old.at(j - 1) + b * old.at(j) + c * old.at(j + 1)
                })?
            }
            CurveRule::Mean => {
                let range = MaskRange::mean(settings.arity(), duals % 2 == 1);
                let (from, to) = (i64::from(range.first), i64::from(range.last));
                self.duals += u32::from(range.shifts());
                let (share, old) = (Exact::ratio(1, settings.arity().into()), &self.points);
                ExactSequence::made(old.first + from, old.last() + to, |j| {
                    (j - to..=j - from).map(|i| old.at(i)).sum::<Exact>() * &share
                })?
            }
            CurveRule::PushBack { compensated } => self.pushed_back(plan, compensated)?,
        };
        self.averages += usize::from(facts.role == Role::Average);
        Some(())
    }

    fn upsampled(
        &mut self,
        d: i64,
        made: impl Fn(&ExactSequence, i64) -> Option<ExactSequence>,
    ) -> Option<ExactSequence> {
        self.anchor = self.points.clone();
        self.arity = self.arity.checked_mul(d)?;
        (self.last_arity, self.duals, self.averages) = (d, 0, 0);
        made(&self.points, d)
    }

    fn masked(&mut self, d: i64, mask: &ExactSequence) -> Option<ExactSequence> {
        self.upsampled(d, |points, d| {
            ExactSequence::made(d * points.first + mask.first, d * points.last() + mask.last(), |j| {
                (points.first..=points.last()).map(|i| mask.at(j - d * i) * points.at(i)).sum()
            })
        })
    }

    /// Returns the weights of points in the next average by index: the kernel at vertices, 1 elsewhere.
    fn weights(&self, plan: &Plan) -> Option<impl Fn(i64) -> Exact + use<>> {
        let kernel = match plan.kernel.get(self.averages) {
            Some(kernel) => exactly::value(kernel, "alpha", &Exact::zero())?,
            None => Exact::one(),
        };
        if (&kernel + Exact::one()).is_zero() {
            return None;
        }
        let d = self.last_arity;
        Some(move |i: i64| if i.rem_euclid(d) == 0 { kernel.clone() } else { Exact::one() })
    }

    fn pushed_back(&self, plan: &Plan, compensated: bool) -> Option<ExactSequence> {
        let zero = Exact::zero();
        let delta = exactly::value(&plan.delta, "", &zero)?;
        let compensation = if compensated { exactly::value(&plan.compensation, "alpha", &zero)? } else { Exact::one() };
        let (d, points, anchor) = (self.last_arity, &self.points, &self.anchor);
        let displacement = |i: i64| &delta * (anchor.at(i) - points.at(d * i));
        // indices of vertices before or after the upsampling
        let first = anchor.first.min(-(-points.first).div_euclid(d));
        let last = anchor.last().max(points.last().div_euclid(d));
        ExactSequence::made(d * first - (d - 1), d * last + (d - 1), |j| {
            let (i, part) = (j.div_euclid(d), j.rem_euclid(d));
            let [before, after] = between::<Exact>(part, d);
            let pushed = if part == 0 {
                displacement(i)
            } else {
                (before * displacement(i) + after * displacement(i + 1)) * &compensation
            };
            points.at(j) + pushed
        })
    }
}
