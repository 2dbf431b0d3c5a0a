//! Values written as plain texts instead of JSON, in flags of the command line and in queries of addresses.

use serde_json::{Map, Number, Value};

use crate::math::parameter::{Parameter, ParameterKind};

/// Converts the text of a parameter to JSON. A list is written with commas (`0,0,1`), an object as
/// `azimuth_deg=40,zoom=2` (names with dashes or underscores), and a list of objects with semicolons between them;
/// lists and objects may also be written as JSON. A text that does not fit remains a text, which the checks of the job
/// refuse.
pub(crate) fn written(kind: &ParameterKind, text: &str) -> Value {
    if let (true, Ok(json)) = (text.starts_with(['[', '{']), serde_json::from_str(text)) {
        return json;
    }
    match kind {
        ParameterKind::Number { .. } | ParameterKind::Integer { .. } | ParameterKind::Expression { .. } => number(text),
        ParameterKind::Flag => text.parse().map_or_else(|_| text.into(), Value::Bool),
        ParameterKind::Choice(_) | ParameterKind::Name | ParameterKind::Color => text.into(),
        ParameterKind::Choices(_) if text.is_empty() => Value::Array(Vec::new()),
        ParameterKind::Choices(_) => text.split(',').map(|item| Value::from(item.trim())).collect(),
        ParameterKind::Numbers { .. } | ParameterKind::Vector | ParameterKind::Direction => {
            items(text).into_iter().map(number).collect()
        }
        ParameterKind::Expressions { .. } => match items(text).as_slice() {
            [one] => number(one),
            several => several.iter().map(|item| number(item)).collect(),
        },
        ParameterKind::Group(fields) => group(fields, text),
        ParameterKind::Groups { fields, .. } => text.split(';').map(|item| group(fields, item)).collect(),
    }
}

/// Returns the separator that joins the values of a repeated flag, if the parameter takes several values.
pub(crate) fn separator(kind: &ParameterKind) -> Option<&'static str> {
    match kind {
        ParameterKind::Choices(_)
        | ParameterKind::Numbers { .. }
        | ParameterKind::Expressions { .. }
        | ParameterKind::Group(_) => Some(","),
        ParameterKind::Groups { .. } => Some(";"),
        _ => None,
    }
}

/// Converts a text to a JSON number; a text that is not a number, such as the expression `pi/6`, remains a text.
pub(crate) fn number(text: &str) -> Value {
    let text = text.trim();
    if let Ok(whole) = text.parse::<u64>() {
        return whole.into();
    }
    text.parse().ok().and_then(Number::from_f64).map_or_else(|| text.into(), Value::Number)
}

/// Converts numbers separated by commas to a JSON list; any other text remains a text.
pub(crate) fn numbers(text: &str) -> Value {
    let all: Vec<Value> = text.split(',').map(number).collect();
    if all.iter().all(Value::is_number) { all.into() } else { text.into() }
}

/// Splits a text at the commas outside parentheses.
fn items(text: &str) -> Vec<&str> {
    let mut depth = 0_usize;
    text.split(|c| {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        c == ',' && depth == 0
    })
    .map(str::trim)
    .collect()
}

/// Converts a text such as `eye=1,2,3,zoom=2` to an object with declared fields.
fn group(fields: &[Parameter], text: &str) -> Value {
    object(text, |name, text| {
        let known = fields.iter().find(|field| field.name == name);
        known.map_or_else(|| number(text), |field| written(&field.kind, text))
    })
}

/// Converts a text such as `eye=1,2,3,zoom=2` to an object; `value` converts the text of each field. An item without a
/// name continues the value before it. A text in braces is JSON.
pub(crate) fn object(text: &str, value: impl Fn(&str, &str) -> Value) -> Value {
    if let (true, Ok(json)) = (text.starts_with('{'), serde_json::from_str(text)) {
        return json;
    }
    let mut found: Vec<(String, String)> = Vec::new();
    for item in items(text) {
        match (item.split_once('='), found.last_mut()) {
            (Some((name, value)), _) => found.push((name.trim().replace('-', "_"), value.trim().to_owned())),
            (None, Some((_, value))) => *value = format!("{value},{item}"),
            (None, None) => return text.into(),
        }
    }
    let field = |(name, text): (String, String)| {
        let value = value(&name, &text);
        (name, value)
    };
    Value::Object(found.into_iter().map(field).collect::<Map<_, _>>())
}
