//! Values of any type for parameters and options.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Number, Value};

use crate::fault::shortened;
use crate::math::parameter::Literal;

/// Maximum number of entries of one list among parameters.
const MAX_LIST_ENTRIES: usize = 10_000;

/// A [`Literal`] read from JSON.
#[derive(Debug, Clone, PartialEq)]
pub struct WireLiteral(pub Literal);

/// Named literals read from a JSON object, in the order of the text; names must be unique.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WireFields(pub Vec<(String, Literal)>);

impl<'de> Deserialize<'de> for WireLiteral {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(LiteralVisitor).map(Self)
    }
}

impl<'de> Deserialize<'de> for WireFields {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(FieldsVisitor).map(Self)
    }
}

/// Converts a literal to JSON.
pub(super) fn written(value: &Literal) -> Value {
    match value {
        Literal::Null => Value::Null,
        Literal::Flag(flag) => (*flag).into(),
        Literal::Number(x) => whole(*x).map_or_else(|| Number::from_f64(*x).into(), Value::from),
        Literal::Text(text) => text.as_str().into(),
        Literal::List(items) => items.iter().map(written).collect(),
        Literal::Map(fields) => fields.iter().map(|(name, value)| (name.clone(), written(value))).collect(),
    }
}

/// Returns the integer equal to `x`, if there is one below 2^53 in magnitude.
fn whole(x: f64) -> Option<i64> {
    #[expect(clippy::cast_possible_truncation, reason = "checked by its value")]
    let n = x as i64;
    #[expect(clippy::cast_precision_loss, clippy::float_cmp, reason = "checked by its value")]
    let is_same = n as f64 == x && n.abs() < 1 << 53;
    is_same.then_some(n)
}

struct LiteralVisitor;

impl<'de> Visitor<'de> for LiteralVisitor {
    type Value = Literal;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, a text, a flag, a list or an object")
    }

    fn visit_unit<E: Error>(self) -> Result<Literal, E> {
        Ok(Literal::Null)
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Literal, E> {
        Ok(Literal::Flag(value))
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Literal, E> {
        Ok(Literal::Number(value))
    }

    #[expect(clippy::cast_precision_loss, reason = "JSON knows one kind of number, f64")]
    fn visit_i64<E: Error>(self, value: i64) -> Result<Literal, E> {
        Ok(Literal::Number(value as f64))
    }

    #[expect(clippy::cast_precision_loss, reason = "JSON knows one kind of number, f64")]
    fn visit_u64<E: Error>(self, value: u64) -> Result<Literal, E> {
        Ok(Literal::Number(value as f64))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Literal, E> {
        Ok(Literal::Text(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Literal, A::Error> {
        let mut items = Vec::new();
        while let Some(WireLiteral(item)) = list.next_element()? {
            if items.len() == MAX_LIST_ENTRIES {
                return Err(A::Error::custom(format!("the list has more than {MAX_LIST_ENTRIES} entries")));
            }
            items.push(item);
        }
        // a nested list of one item would otherwise keep a capacity of four
        items.shrink_to_fit();
        Ok(Literal::List(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Literal, A::Error> {
        FieldsVisitor.visit_map(map).map(Literal::Map)
    }
}

struct FieldsVisitor;

impl<'de> Visitor<'de> for FieldsVisitor {
    type Value = Vec<(String, Literal)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        let fields = fields(map, 100, "the object has more than 100 fields")?;
        Ok(fields.into_iter().map(|(name, WireLiteral(value))| (name, value)).collect())
    }
}

/// Reads the fields of an object, at most `most` and each name once; `too_many` is the error message for more fields.
pub(super) fn fields<'de, A: MapAccess<'de>, T: Deserialize<'de>>(
    mut map: A,
    most: usize,
    too_many: &str,
) -> Result<Vec<(String, T)>, A::Error> {
    let mut fields: Vec<(String, T)> = Vec::new();
    while let Some((name, value)) = map.next_entry::<String, _>()? {
        if fields.iter().any(|(known, _)| *known == name) {
            return Err(A::Error::custom(format!("duplicate field \"{}\"", shortened(&name))));
        }
        if fields.len() == most {
            return Err(A::Error::custom(too_many));
        }
        fields.push((name, value));
    }
    fields.shrink_to_fit();
    Ok(fields)
}
