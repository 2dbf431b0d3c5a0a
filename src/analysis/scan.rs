//! Parameter studies: the properties proved of a scheme at each value of a parameter, and the ranges that follow.

use std::collections::BTreeMap;
use std::ops::Bound::{Excluded, Unbounded};

use num_traits::ToPrimitive;

use super::smoothness::Smoothness;
use super::study::Study;
use crate::fault::Fault;
use crate::math::exact::{Exact, rounded};
use crate::math::number::Number;
use crate::math::parameter::Literal;
use crate::scheme::plan::PlanInput;
use crate::watch::{Stopped, Watch};

/// Halvings of the gap between two values of which only one has a proof.
/// A step of a scan comes to its 65,536th part. Half of it brackets ends to 1/256 of a step, twice of it takes twice as
/// many analyses for digits that few search budgets decide.
const HALVINGS: u32 = 16;
/// Most values that are looked at beside those of the scan.
/// Two ends take 64 at most. Half of it leaves ends of schemes with four ranges as wide as a step; twice of it takes
/// twice as long for schemes with many.
pub const MOST_BETWEEN: u32 = 256;

/// A parameter and the range of its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// The plan, whose value of the parameter does not count.
    pub input: PlanInput,
    /// The name of the parameter.
    pub parameter: String,
    /// The first value.
    pub from: Exact,
    /// The last value, above the first.
    pub to: Exact,
    /// Equal steps between them.
    pub steps: u32,
    /// Whether the parameter has whole numbers alone: then all values are rounded down to such.
    pub is_whole: bool,
}

/// The results at all values.
#[derive(Debug, Clone, PartialEq)]
pub struct Scanned {
    /// One row for each value of the scan, in ascending order.
    pub rows: Vec<Row>,
    /// For each k the intervals where C^k is proved, in ascending order.
    pub intervals: Vec<Interval>,
}

/// A value of the parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The value.
    pub value: Exact,
    /// What is known there.
    pub found: Found,
}

/// The result for the scheme at one value.
#[derive(Debug, Clone, PartialEq)]
pub enum Found {
    /// What is proved and disproved of the scheme.
    Verdict(Verdict),
    /// There is no scheme that could be analysed: why.
    Refused(String),
}

/// What is proved and disproved at one value.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The order of the sum rules.
    pub order: usize,
    /// The largest k for which limits are proved to be C^k, -1 where not even convergence is.
    pub proved_c: i64,
    /// The smallest k for which it is disproved.
    pub disproved_c: Option<i64>,
    /// Between which numbers the Hoelder exponent lies.
    pub holder: Option<[f64; 2]>,
}

/// An interval of values at each of which C^k was proved, as far as they were looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct Interval {
    /// The order k.
    pub k: i64,
    /// The least value with a proof.
    pub from: Exact,
    /// The greatest value with a proof.
    pub to: Exact,
    /// The next value below at which C^k is disproved, where there is one before the next interval.
    pub before: Option<Exact>,
    /// The next value above at which C^k is disproved, likewise.
    pub after: Option<Exact>,
}

impl Found {
    fn proves(&self, k: i64) -> bool {
        matches!(self, Self::Verdict(verdict) if verdict.proved_c >= k)
    }

    fn disproves(&self, k: i64) -> bool {
        matches!(self, Self::Verdict(verdict) if verdict.disproved_c.is_some_and(|least| least <= k))
    }
}

impl Scan {
    /// The value after so many steps.
    pub fn value(&self, step: u32) -> Exact {
        let share = Exact::ratio(step.into(), self.steps.max(1).into());
        self.among(&self.from + (&self.to - &self.from) * share)
    }

    /// A value, or the whole number below it where the parameter has no others.
    fn among(&self, value: Exact) -> Exact {
        if self.is_whole { value.floor() } else { value }
    }

    /// The plan with a value of the parameter.
    pub fn at(&self, value: &Exact) -> PlanInput {
        let mut input = self.input.clone();
        input.parameters.retain(|(name, _)| *name != self.parameter);
        let whole = if value.is_integer() { value.to_i32() } else { None };
        let literal = whole.map_or_else(|| Literal::Text(value.to_string()), |n| Literal::Number(n.into()));
        input.parameters.push((self.parameter.clone(), literal));
        input
    }

    /// What is found with so many products of matrices at each value; `study` says what a plan comes to.
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
            Ok(study) => verdict(&study, nodes, watch).map(Found::Verdict),
            Err(faults) => {
                // a search that was stopped says so as a fault, too
                watch.check()?;
                let details: Vec<&str> = faults.iter().map(|fault| fault.detail.as_str()).collect();
                Ok(Found::Refused(details.join("; ")))
            }
        };
        let mut known = Known { values: BTreeMap::new(), left: MOST_BETWEEN };
        for step in 0..=self.steps {
            let value = self.value(step);
            let found = look(&value)?;
            known.values.insert(value, found);
        }
        let rows = known.values.iter().map(|(value, found)| Row { value: value.clone(), found: found.clone() });
        let rows: Vec<Row> = rows.collect();
        let most = rows.iter().filter_map(|row| match &row.found {
            Found::Verdict(verdict) => Some(verdict.proved_c),
            Found::Refused(_) => None,
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
    // what is disproved of the static limit need not be of levels that come close to it
    let disproved_c = smoothness.disproved_c.filter(|_| study.levels.is_empty());
    Ok(Verdict {
        order: study.settled.order,
        proved_c: study.concluded(smoothness.proved_c, smoothness.contracts_c),
        disproved_c,
        holder: smoothness.radius.map(|radius| radius.holder),
    })
}

/// All values that were looked at.
struct Known {
    values: BTreeMap<Exact, Found>,
    /// How many more may be.
    left: u32,
}

impl Known {
    /// Halves the gaps beside values with a proof of C^k: first towards those without one, then, where these are open,
    /// towards those where C^k is disproved.
    fn narrow(&mut self, k: i64, scan: &Scan, look: &impl Fn(&Exact) -> Result<Found, Stopped>) -> Result<(), Stopped> {
        for ends in self.changes(|found| found.proves(k)) {
            self.halve(scan, ends, |found| found.proves(k), look)?;
        }
        let is_open = |found: &Found| !found.disproves(k);
        for (inside, outside) in self.changes(is_open) {
            // between a proof and its contrary the gap is narrow already
            if !self.values.get(&inside).is_some_and(|found| found.proves(k)) {
                self.halve(scan, (inside, outside), is_open, look)?;
            }
        }
        Ok(())
    }

    /// The neighbours of which only the first holds.
    fn changes(&self, holds: impl Fn(&Found) -> bool) -> Vec<(Exact, Exact)> {
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
        holds: impl Fn(&Found) -> bool,
        look: &impl Fn(&Exact) -> Result<Found, Stopped>,
    ) -> Result<(), Stopped> {
        for _ in 0..HALVINGS {
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
            let decided = |(value, at): (&Exact, &Found)| {
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

impl Row {
    /// The value in f64.
    pub fn rounded(&self) -> f64 {
        rounded(&self.value)
    }
}
