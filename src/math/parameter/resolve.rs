//! Resolves literals to the values of declared parameters.

use super::read::{
    choices, chosen, color, constant, direction, expression, expressions, groups, named, numbers, one, ranged, vector,
    whole,
};
use super::{Default, Literal, NamedValue, Parameter, ParameterKind, Value, Values};
use crate::fault::{Fault, did_you_mean, shortened, token, under};

impl Values {
    /// Checks `given` against the declarations and fills in the defaults.
    ///
    /// # Errors
    /// Every fault found: unknown names, wrong kinds, values out of range, required ones missing. Pointers start at the
    /// object that holds the parameters.
    pub fn resolve(declared: &'static [Parameter], given: &[(String, Literal)]) -> Result<Self, Vec<Fault>> {
        let mut faults: Vec<Fault> = given
            .iter()
            .filter(|(name, _)| declared.iter().all(|p| p.name != name))
            .map(|(name, _)| Fault::new(format!("/{}", token(name)), unknown(name, declared)))
            .collect();
        let mut values = Vec::with_capacity(declared.len());
        for parameter in declared {
            let written = given.iter().find(|(name, _)| name == parameter.name).map(|(_, literal)| literal);
            match parameter.value(written) {
                Ok(value) => {
                    let usual = written.is_none() || parameter.value(None).is_ok_and(|usual| usual == value);
                    let written = parameter.written(written);
                    values.push(NamedValue { name: parameter.name, value, usual, written });
                }
                Err(found) => faults.extend(under(&format!("/{}", parameter.name), found)),
            }
        }
        if faults.is_empty() { Ok(Self(values)) } else { Err(faults) }
    }

    /// Returns the values of parameters that are all left out; required ones are absent.
    pub fn usual(declared: &[Parameter]) -> Self {
        let entry = |parameter: &Parameter| {
            let value = parameter.value(None).unwrap_or(Value::Absent);
            NamedValue { name: parameter.name, value, usual: true, written: parameter.written(None) }
        };
        Self(declared.iter().map(entry).collect())
    }

    /// Sets the value of a parameter if it is declared.
    pub fn set(&mut self, parameter: &Parameter, value: Value) {
        if let Some(entry) = self.0.iter_mut().find(|entry| entry.name == parameter.name) {
            let usual = parameter.value(None).is_ok_and(|usual| usual == value);
            *entry = NamedValue { name: parameter.name, value, usual, written: None };
        }
    }
}

fn unknown(name: &str, declared: &[Parameter]) -> String {
    let known: Vec<&str> = declared.iter().map(|p| p.name).collect();
    let meant = did_you_mean(name, known.iter().copied());
    let known =
        if known.is_empty() { "there are none here".into() } else { format!("known here: {}", known.join(", ")) };
    format!("unknown parameter \"{}\"; {meant}{known}", shortened(name))
}

impl Parameter {
    /// Returns the literals of the numbers of a value.
    fn written(&self, written: Option<&Literal>) -> Option<Literal> {
        match (self.kind, self.default, written) {
            (ParameterKind::Number { .. } | ParameterKind::Numbers { .. }, _, Some(literal)) => Some(literal.clone()),
            (ParameterKind::Number { .. }, Default::Number(x), None) => Some(Literal::Number(x)),
            (ParameterKind::Number { .. }, Default::Text(text), None) => Some(Literal::Text(text.into())),
            _ => None,
        }
    }

    /// Returns the value of a literal, or of the default if there is none.
    fn value(&self, written: Option<&Literal>) -> Result<Value, Vec<Fault>> {
        match (written, self.default) {
            (Some(literal), _) => self.kind.value(literal),
            (None, Default::Absent) => Ok(Value::Absent),
            (None, Default::Required) => Err(vec![Fault::new("", format!("\"{}\" is required", self.name))]),
            (None, Default::Number(x)) => self.kind.value(&Literal::Number(x)),
            (None, Default::Flag(x)) => self.kind.value(&Literal::Flag(x)),
            (None, Default::Text(x)) => self.kind.value(&Literal::Text(x.into())),
            (None, Default::Texts(x)) => {
                self.kind.value(&Literal::List(x.iter().map(|&t| Literal::Text(t.into())).collect()))
            }
            (None, Default::Fields) => self.kind.value(&Literal::Map(Vec::new())),
        }
    }
}

impl ParameterKind {
    fn value(&self, literal: &Literal) -> Result<Value, Vec<Fault>> {
        match (self, literal) {
            (Self::Number { min, max }, Literal::Number(_) | Literal::Text(_)) => {
                constant(literal).and_then(|x| ranged(x, *min, *max)).map(Value::Number).map_err(one)
            }
            (Self::Integer { min, max }, Literal::Number(x)) => whole(*x, *min, *max).map(Value::Integer).map_err(one),
            (Self::Flag, Literal::Flag(x)) => Ok(Value::Flag(*x)),
            (Self::Choice(names), Literal::Text(text)) => chosen(names, text).map(Value::Choice).map_err(one),
            (Self::Name, Literal::Text(text)) => named(text).map(Value::Name).map_err(one),
            (Self::Choices(names), Literal::List(items)) => choices(names, items).map(Value::Choices),
            (Self::Expression { variable }, Literal::Number(_) | Literal::Text(_)) => {
                expression(literal, variable).map(Value::Expression).map_err(one)
            }
            (Self::Expressions { variable, .. }, Literal::Number(_) | Literal::Text(_)) => {
                expression(literal, variable).map(|e| Value::Expressions(vec![e])).map_err(one)
            }
            (Self::Expressions { variable, most }, Literal::List(items)) => expressions(items, variable, *most),
            (Self::Numbers { most }, Literal::List(items)) => numbers(items, *most).map(Value::Numbers),
            (Self::Color, Literal::Text(text)) => color(text).map(Value::Color).map_err(one),
            (Self::Vector, Literal::List(items)) => vector(items).map(Value::Vector).map_err(one),
            (Self::Direction, Literal::List(items)) => direction(items).map(Value::Vector).map_err(one),
            (Self::Group(fields), Literal::Map(given)) => Values::resolve(fields, given).map(Value::Group),
            (Self::Groups { fields, most }, Literal::List(items)) => groups(items, fields, *most).map(Value::Groups),
            _ => Err(one(format!("expected {}, got {}", self.expected(), literal.kind()))),
        }
    }
}
