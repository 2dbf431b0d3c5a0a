//! Scans of a plan's parameter over a range of values, as a client requests them.

use num_traits::ToPrimitive;

use super::codec::Item;
use super::key::{Key, versioned};
use crate::analysis::Study;
use crate::analysis::scan::Scan;
use crate::fault::Fault;
use crate::math::exact::{self, Exact};
use crate::math::exactly;
use crate::math::expression::Expression;
use crate::math::parameter::{Literal, ParameterKind};
use crate::scheme::parameters::WORD_PARAMETERS;
use crate::scheme::plan::PlanInput;
use crate::scheme::presets::PRESETS;

/// Maximum number of steps of a scan: one value per pixel of a figure. Half as many make plots coarser; twice as many
/// take twice as long.
pub const MAX_SCAN_STEPS: u32 = 1000;
/// A scan as a client requests it.
#[derive(Debug, Clone)]
pub struct RequestedScan {
    /// The name of the parameter.
    pub parameter: String,
    /// Its first value.
    pub from: Literal,
    /// Its last value.
    pub to: Literal,
    /// The number of steps between them.
    pub steps: u32,
}

/// Creates the scan of a parameter with a number of matrix products at each value, and a maximum in all; `study`
/// analyses the plan of one value.
///
/// # Errors
/// Every fault found, with pointers into the request.
pub(super) fn scan(
    plan: &PlanInput,
    requested: &RequestedScan,
    [nodes, most]: [u64; 2],
    study: impl Fn(&PlanInput) -> Result<Study, Vec<Fault>>,
) -> Result<Scan, Vec<Fault>> {
    let RequestedScan { parameter, from, to, steps } = requested;
    let mut faults = Vec::new();
    if !(1..=MAX_SCAN_STEPS).contains(steps) {
        let detail = format!("{steps} steps; write a whole number from 1 to {MAX_SCAN_STEPS}");
        faults.push(Fault::new("/scan/steps", detail));
    } else if nodes.saturating_mul(u64::from(steps + 1)) > most {
        let detail = format!(
            "{nodes} products of matrices at each of {} values; at most {most} are looked at in all, so that {} at \
             each value or fewer steps can be had",
            steps + 1,
            most / u64::from(steps + 1)
        );
        faults.push(Fault::new("/nodes", detail));
    }
    let ends = [("/scan/from", from), ("/scan/to", to)].map(|(place, literal)| {
        let fault = || Fault::new(place, "write a number, or a text such as \"1/60\" whose value is a number");
        end(literal).ok_or_else(fault).map_err(|fault| faults.push(fault)).ok()
    });
    let [Some(from), Some(to)] = ends else { return Err(faults) };
    if from >= to {
        faults.push(Fault::new("/scan/to", format!("{to} is not above {from}; let \"to\" be the larger end")));
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let is_whole = is_whole(plan, parameter);
    for (place, end) in [("/scan/from", &from), ("/scan/to", &to)] {
        if is_whole && !end.is_integer() {
            faults.push(Fault::new(place, format!("{end}, and {parameter} is a whole number; write one")));
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    // each whole number is used once
    let span = if is_whole { (&to - &from).to_integer().to_u32().unwrap_or(u32::MAX) } else { u32::MAX };
    let steps = span.min(*steps);
    let scan = Scan { input: plan.clone(), parameter: parameter.clone(), from, to, steps, is_whole };
    // faults at the ends, or after the first step, are faults of the request
    for step in [0, 1, steps] {
        let value = scan.value(step);
        study(&scan.at(&value)).map_err(|found| misfits(&scan, &value.to_string(), found))?;
    }
    Ok(scan)
}

/// Returns whether a parameter of a plan takes whole numbers.
fn is_whole(plan: &PlanInput, name: &str) -> bool {
    let preset = PRESETS.iter().find(|preset| Some(preset.name) == plan.preset.as_deref());
    let mut declared = preset.map_or(WORD_PARAMETERS, |preset| preset.parameters).iter();
    declared.any(|parameter| parameter.name == name && matches!(parameter.kind, ParameterKind::Integer { .. }))
}

/// Returns the exact value of an end of the range, or the shortest decimal near a value that is not a fraction.
fn end(literal: &Literal) -> Option<Exact> {
    let decimal = |text: &str| Expression::parse(text, "").ok()?.value(0.0).ok().and_then(exact::written);
    exactly::literal(literal).or_else(|| if let Literal::Text(text) = literal { decimal(text) } else { None })
}

/// Returns the faults of a plan at a value of the scanned parameter; faults of the parameter itself become those of the
/// scan.
fn misfits(scan: &Scan, value: &str, faults: Vec<Fault>) -> Vec<Fault> {
    let own = format!("/parameters/{}", scan.parameter);
    let placed = |fault: Fault| {
        if fault.pointer.starts_with(&own) {
            return Fault::new("/scan/parameter", format!("at {value}: {}", fault.detail));
        }
        fault.under("/plan")
    };
    faults.into_iter().map(placed).collect()
}

/// Returns the key of a scan: over the plan as written, since the masks of all values are only computed when it runs.
pub(super) fn key(scan: &Scan, nodes: u64) -> Key {
    // whether values are whole follows from the parameter
    let Scan { input, parameter, from, to, steps, is_whole: _ } = scan;
    // boundary, ends and seed matter to inputs only
    let PlanInput { preset, word, parameters, boundary: _, ends: _, seed: _ } = input;
    let mut others: Vec<_> = parameters.iter().filter(|(name, _)| name != parameter).collect();
    others.sort_by(|a, b| a.0.cmp(&b.0));
    let others = others.into_iter().map(|(name, value)| Item::List(vec![Item::text(name), literal(value)]));
    let items = [
        Item::List(preset.iter().map(|name| Item::text(name)).collect()),
        Item::List(word.iter().map(|word| Item::text(word)).collect()),
        Item::List(others.collect()),
        Item::text(parameter),
        Item::text(&from.to_string()),
        Item::text(&to.to_string()),
        Item::Integer(u64::from(*steps)),
        Item::Integer(nodes),
    ];
    versioned("planish scan", items)
}

/// Returns the item of a literal; numbers enter by their exact value, if there is one.
fn literal(written: &Literal) -> Item<'static> {
    match written {
        Literal::Null => Item::text("null"),
        Literal::Flag(flag) => Item::Integer(u64::from(*flag)),
        Literal::Number(_) | Literal::Text(_) if let Some(exact) = exactly::literal(written) => {
            Item::text(&exact.to_string())
        }
        Literal::Number(x) => Item::Number(*x),
        Literal::Text(text) => Item::text(text),
        Literal::List(items) => Item::List(items.iter().map(literal).collect()),
        Literal::Map(fields) => {
            Item::List(fields.iter().map(|(name, value)| Item::List(vec![Item::text(name), literal(value)])).collect())
        }
    }
}
