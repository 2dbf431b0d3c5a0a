//! Readers that convert literals to values of a kind, or explain what is wrong.

use super::{Literal, MAX_PARAMETER_NAME, Parameter, ParameterKind, Value, Values, range};
use crate::fault::{Fault, did_you_mean, shortened, under};
use crate::math::expression::Expression;

pub(super) fn constant(literal: &Literal) -> Result<f64, String> {
    match literal {
        Literal::Number(x) => Ok(*x),
        Literal::Text(text) => Expression::parse(text, "").and_then(|e| e.value(0.0)).map_err(|e| e.to_string()),
        _ => Err("expected a number".into()),
    }
}

pub(super) fn ranged(x: f64, min: f64, max: f64) -> Result<f64, String> {
    if !x.is_finite() {
        Err(format!("{x} is not a finite number"))
    } else if x < min || x > max {
        Err(format!("{x} is out of range; expected a number {}", range(min, max)))
    } else {
        Ok(x + 0.0)
    }
}

pub(super) fn whole(x: f64, min: i64, max: i64) -> Result<i64, String> {
    #[expect(clippy::cast_precision_loss, reason = "bounds of whole parameters are small")]
    let inside = x >= min as f64 && x <= max as f64;
    #[expect(clippy::cast_possible_truncation, reason = "checked to be whole and inside the bounds")]
    if inside && x.fract() == 0.0 {
        Ok(x as i64)
    } else {
        Err(format!("{x} is not a whole number from {min} to {max}"))
    }
}

pub(super) fn chosen(names: &'static [&'static str], text: &str) -> Result<&'static str, String> {
    let found = names.iter().copied().find(|name| *name == text);
    found.ok_or_else(|| {
        let meant = did_you_mean(text, names.iter().copied());
        format!("\"{}\" is unknown; {meant}expected one of {}", shortened(text), names.join(", "))
    })
}

pub(super) fn named(text: &str) -> Result<String, String> {
    let n = text.chars().count();
    if (1..=MAX_PARAMETER_NAME).contains(&n) {
        Ok(text.to_owned())
    } else {
        Err(format!("\"{}\" is not {}", shortened(text), ParameterKind::Name.expected()))
    }
}

pub(super) fn choices(names: &'static [&'static str], items: &[Literal]) -> Result<Vec<&'static str>, Vec<Fault>> {
    let mut faults = Vec::new();
    let mut found = Vec::new();
    for (i, item) in items.iter().enumerate().take(names.len() + 1) {
        let name = if let Literal::Text(text) = item { chosen(names, text) } else { Err("expected a text".into()) };
        match name {
            Ok(name) if found.contains(&name) => faults.push(Fault::new(format!("/{i}"), "named twice")),
            Ok(name) => found.push(name),
            Err(detail) => faults.push(Fault::new(format!("/{i}"), detail)),
        }
    }
    let ordered = names.iter().copied().filter(|name| found.contains(name)).collect();
    if faults.is_empty() { Ok(ordered) } else { Err(faults) }
}

pub(super) fn expression(literal: &Literal, variable: &'static str) -> Result<Expression, String> {
    match literal {
        Literal::Number(x) => ranged(*x, f64::NEG_INFINITY, f64::INFINITY).map(Expression::constant),
        Literal::Text(text) => Expression::parse(text, variable).map_err(|e| e.to_string()),
        _ => Err("expected a number or an expression".into()),
    }
}

/// Reads the entries of a list of 1 to `most`, or returns the faults of all of them.
fn entries<T>(
    items: &[Literal],
    most: usize,
    read: impl Fn(&Literal) -> Result<T, Vec<Fault>>,
) -> Result<Vec<T>, Vec<Fault>> {
    check_length(items, most)?;
    let mut faults = Vec::new();
    let mut found = Vec::new();
    for (i, item) in items.iter().enumerate() {
        match read(item) {
            Ok(entry) => found.push(entry),
            Err(wrong) => faults.extend(under(&format!("/{i}"), wrong)),
        }
    }
    if faults.is_empty() { Ok(found) } else { Err(faults) }
}

fn check_length(items: &[Literal], most: usize) -> Result<(), Vec<Fault>> {
    let n = items.len();
    if (1..=most).contains(&n) { Ok(()) } else { Err(one(format!("{n} entries; expected 1 to {most}"))) }
}

/// Returns a list with a single fault.
pub(super) fn one(detail: String) -> Vec<Fault> {
    vec![Fault::new("", detail)]
}

pub(super) fn expressions(items: &[Literal], variable: &'static str, most: usize) -> Result<Value, Vec<Fault>> {
    entries(items, most, |item| expression(item, variable).map_err(one)).map(Value::Expressions)
}

pub(super) fn numbers(items: &[Literal], most: usize) -> Result<Vec<f64>, Vec<Fault>> {
    check_length(items, most)?;
    let number = |(i, item): (usize, &Literal)| {
        let value = constant(item).and_then(|x| ranged(x, f64::NEG_INFINITY, f64::INFINITY));
        value.map_err(|detail| vec![Fault::new(format!("/{i}"), detail)])
    };
    items.iter().enumerate().map(number).collect()
}

/// Parses a colour such as `#f80`, `#ff8800` or `transparent` into red, green, blue and alpha.
///
/// # Errors
/// A description of a text that is not a colour.
pub fn color(text: &str) -> Result<[u8; 4], String> {
    if text == "transparent" {
        return Ok([0; 4]);
    }
    let digits: Option<Vec<u8>> = text
        .strip_prefix('#')
        .and_then(|hex| hex.chars().map(|c| c.to_digit(16).and_then(|d| u8::try_from(d).ok())).collect());
    match digits.as_deref() {
        Some([r, g, b]) => Ok([r * 17, g * 17, b * 17, 255]),
        Some([a, b, c, d, e, f]) => Ok([a * 16 + b, c * 16 + d, e * 16 + f, 255]),
        Some([a, b, c, d, e, f, g, h]) => Ok([a * 16 + b, c * 16 + d, e * 16 + f, g * 16 + h]),
        _ => Err(format!("\"{}\" is not {}", shortened(text), ParameterKind::Color.expected())),
    }
}

pub(super) fn vector(items: &[Literal]) -> Result<[f64; 3], String> {
    let [x, y, z] = items else { return Err(format!("{} entries; expected three numbers", items.len())) };
    let finite = |literal| constant(literal).and_then(|v| ranged(v, f64::NEG_INFINITY, f64::INFINITY));
    Ok([finite(x)?, finite(y)?, finite(z)?])
}

/// Reads a direction: a vector divided by its largest absolute coordinate, so that positive multiples are equal.
pub(super) fn direction(items: &[Literal]) -> Result<[f64; 3], String> {
    let vector = vector(items)?;
    let largest = vector.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    if largest > 0.0 { Ok(vector.map(|x| x / largest + 0.0)) } else { Err("[0, 0, 0] has no direction".into()) }
}

pub(super) fn groups(items: &[Literal], fields: &'static [Parameter], most: usize) -> Result<Vec<Values>, Vec<Fault>> {
    entries(items, most, |item| match item {
        Literal::Map(given) => Values::resolve(fields, given),
        other => Err(one(format!("expected an object, got {}", other.kind()))),
    })
}
