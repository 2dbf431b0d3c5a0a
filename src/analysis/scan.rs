//! Parameter studies: the properties proved of a scheme at each value of a parameter, and the ranges that follow.

use std::collections::BTreeMap;
use std::ops::Bound::{Excluded, Unbounded};

use num_traits::ToPrimitive;

use super::smoothness::Smoothness;
use super::study::Study;
use crate::fault::Fault;
use crate::math::exact::Exact;
use crate::math::number::Number;
use crate::math::parameter::Literal;
use crate::scheme::plan::PlanInput;
use crate::watch::{Stopped, Watch};

/// Number of halvings of the gap between two values of which only one has a proof. They narrow a gap of one step to
/// 1/65,536 of it. Half as many narrow it to 1/256 of a step; twice as many take twice as many analyses for digits that
/// few search budgets decide.
const GAP_HALVINGS: u32 = 16;
/// Maximum number of values analysed in addition to those of the scan. The two ends of a range take 64 at most. Half as
/// many leave the ends of schemes with four ranges as wide as a step; twice as many take twice as long for schemes with
/// many ranges.
pub const MAX_BETWEEN: u32 = 256;

/// A parameter and the range of its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// The plan; its own value of the scanned parameter is replaced.
    pub input: PlanInput,
    /// The name of the parameter.
    pub parameter: String,
    /// The first value.
    pub from: Exact,
    /// The last value, above the first.
    pub to: Exact,
    /// The number of equal steps between the first and the last value.
    pub steps: u32,
    /// Whether the parameter takes whole numbers only; all values are then rounded down to whole numbers.
    pub is_whole: bool,
}

/// The results at all values of a scan.
#[derive(Debug, Clone, PartialEq)]
pub struct Scanned {
    /// The results at the values of the scan, in ascending order of the values.
    pub rows: Vec<ScanRow>,
    /// The intervals on which C^k is proved, by ascending k, then by ascending value.
    pub intervals: Vec<Interval>,
}

/// A value of the parameter and the result there.
#[derive(Debug, Clone, PartialEq)]
pub struct ScanRow {
    /// The value.
    pub value: Exact,
    /// The result at the value.
    pub found: ScanResult,
}

/// The result for the scheme at one value.
#[derive(Debug, Clone, PartialEq)]
pub enum ScanResult {
    /// What is proved and disproved about the scheme.
    Verdict(Verdict),
    /// The plan has no scheme that can be analysed, for the reason given.
    Refused(String),
}

/// What is proved and disproved about the scheme at one value.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The order of the sum rules.
    pub order: usize,
    /// The largest k for which limits are proved to be C^k; -1 if not even convergence is proved.
    pub proved_c: i64,
    /// The smallest k for which C^k is disproved, if any.
    pub disproved_c: Option<i64>,
    /// The lower and the upper bound of the Hoelder exponent, if known.
    pub holder: Option<[f64; 2]>,
}

/// An interval in which C^k is proved at every analysed value.
#[derive(Debug, Clone, PartialEq)]
pub struct Interval {
    /// The order k.
    pub k: i64,
    /// The least value at which C^k is proved.
    pub from: Exact,
    /// The greatest value at which C^k is proved.
    pub to: Exact,
    /// The nearest value below the interval at which C^k is disproved; `None` if another interval comes first.
    pub before: Option<Exact>,
    /// The nearest value above the interval at which C^k is disproved; `None` if another interval comes first.
    pub after: Option<Exact>,
}

impl ScanResult {
    fn proves(&self, k: i64) -> bool {
        matches!(self, Self::Verdict(verdict) if verdict.proved_c >= k)
    }

    fn disproves(&self, k: i64) -> bool {
        matches!(self, Self::Verdict(verdict) if verdict.disproved_c.is_some_and(|least| least <= k))
    }
}

impl Scan {
    /// Returns the value after `step` steps.
    pub fn value(&self, step: u32) -> Exact {
        let share = Exact::ratio(step.into(), self.steps.max(1).into());
        self.among(&self.from + (&self.to - &self.from) * share)
    }

    /// Returns the value itself, or rounds it down if the parameter takes whole numbers only.
    fn among(&self, value: Exact) -> Exact {
        if self.is_whole { value.floor() } else { value }
    }

    /// Returns the plan with this value of the parameter.
    pub fn at(&self, value: &Exact) -> PlanInput {
        let mut input = self.input.clone();
        input.parameters.retain(|(name, _)| *name != self.parameter);
        let whole = if value.is_integer() { value.to_i32() } else { None };
        let literal = whole.map_or_else(|| Literal::Text(value.to_string()), |n| Literal::Number(n.into()));
        input.parameters.push((self.parameter.clone(), literal));
        input
    }

    /// Runs the scan with at most `nodes` matrix products at each value; `study` resolves a plan to its curve scheme.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn run(
        &self,
        study: impl Fn(&PlanInput) -> Result<Study, Vec<Fault>>,
        nodes: u64,
        watch: &Watch,
    ) -> Result<Scanned, Stopped> {
        let look = |value: &Exact| match study(&self.at(value)) {
            Ok(study) => verdict(&study, nodes, watch).map(ScanResult::Verdict),
            Err(faults) => {
                // a stopped search also arrives here as a fault
                watch.check()?;
                let details: Vec<&str> = faults.iter().map(|fault| fault.detail.as_str()).collect();
                Ok(ScanResult::Refused(details.join("; ")))
            }
        };
        let mut known = KnownResults { values: BTreeMap::new(), left: MAX_BETWEEN };
        for step in 0..=self.steps {
            let value = self.value(step);
            let found = look(&value)?;
            known.values.insert(value, found);
        }
        let rows = known.values.iter().map(|(value, found)| ScanRow { value: value.clone(), found: found.clone() });
        let rows: Vec<ScanRow> = rows.collect();
        let most = rows.iter().filter_map(|row| match &row.found {
            ScanResult::Verdict(verdict) => Some(verdict.proved_c),
            ScanResult::Refused(_) => None,
        });
        let most = most.max().unwrap_or(-1);
        for k in 0..=most {
            known.narrow(k, self, &look)?;
        }
        let intervals = (0..=most).flat_map(|k| known.intervals(k)).collect();
        Ok(Scanned { rows, intervals })
    }
}

fn verdict(study: &Study, nodes: u64, watch: &Watch) -> Result<Verdict, Stopped> {
    let smoothness = Smoothness::of(&study.settled, nodes, watch)?;
    // smoothness that is disproved for the static limit is not disproved for levels that converge to it
    let disproved_c = smoothness.disproved_c.filter(|_| study.levels.is_empty());
    Ok(Verdict {
        order: study.settled.order,
        proved_c: study.concluded(smoothness.proved_c, smoothness.contracts_c),
        disproved_c,
        holder: smoothness.radius.map(|radius| radius.holder),
    })
}

/// The results at all values analysed so far.
struct KnownResults {
    values: BTreeMap<Exact, ScanResult>,
    /// The number of further values that may be analysed.
    left: u32,
}

impl KnownResults {
    /// Halves the gaps between values with a proof of C^k and neighbours without one; then, next to neighbours where
    /// C^k is undecided, the gaps between undecided values and those where C^k is disproved.
    fn narrow(
        &mut self,
        k: i64,
        scan: &Scan,
        look: &impl Fn(&Exact) -> Result<ScanResult, Stopped>,
    ) -> Result<(), Stopped> {
        for ends in self.changes(|found| found.proves(k)) {
            self.halve(scan, ends, |found| found.proves(k), look)?;
        }
        let is_open = |found: &ScanResult| !found.disproves(k);
        for (inside, outside) in self.changes(is_open) {
            // between a value with a proof and one with a disproof the gap is already narrow
            if !self.values.get(&inside).is_some_and(|found| found.proves(k)) {
                self.halve(scan, (inside, outside), is_open, look)?;
            }
        }
        Ok(())
    }

    /// Returns the pairs of neighbouring values of which only one satisfies `holds`, that one first.
    fn changes(&self, holds: impl Fn(&ScanResult) -> bool) -> Vec<(Exact, Exact)> {
        let neighbours = self.values.iter().zip(self.values.iter().skip(1));
        let ordered = neighbours.filter_map(|((a, found), (b, next))| match (holds(found), holds(next)) {
            (true, false) => Some((a.clone(), b.clone())),
            (false, true) => Some((b.clone(), a.clone())),
            _ => None,
        });
        ordered.collect()
    }

    fn halve(
        &mut self,
        scan: &Scan,
        (mut inside, mut outside): (Exact, Exact),
        holds: impl Fn(&ScanResult) -> bool,
        look: &impl Fn(&Exact) -> Result<ScanResult, Stopped>,
    ) -> Result<(), Stopped> {
        for _ in 0..GAP_HALVINGS {
            let middle = scan.among((&inside + &outside) / Exact::whole(2));
            if middle == inside || middle == outside {
                break;
            }
            let Some(left) = self.left.checked_sub(1) else { break };
            self.left = left;
            let found = look(&middle)?;
            let end = if holds(&found) { &mut inside } else { &mut outside };
            end.clone_from(&middle);
            self.values.insert(middle, found);
        }
        Ok(())
    }

    fn intervals(&self, k: i64) -> Vec<Interval> {
        let mut found: Vec<Interval> = Vec::new();
        let mut is_inside = false;
        for (value, at) in &self.values {
            let proves = at.proves(k);
            match found.last_mut().filter(|_| is_inside && proves) {
                Some(interval) => interval.to.clone_from(value),
                None if proves => {
                    let (from, to) = (value.clone(), value.clone());
                    found.push(Interval { k, from, to, before: None, after: None });
                }
                None => {}
            }
            is_inside = proves;
        }
        for interval in &mut found {
            let decided = |(value, at): (&Exact, &ScanResult)| {
                if at.proves(k) { Some(None) } else { at.disproves(k).then(|| Some(value.clone())) }
            };
            let below = self.values.range(..interval.from.clone()).rev();
            interval.before = below.into_iter().find_map(decided).flatten();
            let mut above = self.values.range((Excluded(interval.to.clone()), Unbounded));
            interval.after = above.find_map(decided).flatten();
        }
        found
    }
}
