//! Whole numbers. JSON has one type of number, so that 2, 2.0 and 2e0 are the same, as in JSON Schema.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, Unexpected, Visitor};

use super::fixed;

/// A whole number of at least 0.
#[derive(Debug, Clone, Copy, Default)]
struct Whole(u64);

/// 2^53: from here on every f64 is whole, whatever the text was.
const TWO_TO_53: f64 = 9_007_199_254_740_992.0;

impl<'de> Deserialize<'de> for Whole {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_u64(WholeVisitor).map(Self)
    }
}

struct WholeVisitor;

impl Visitor<'_> for WholeVisitor {
    type Value = u64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a whole number of at least 0")
    }

    fn visit_u64<E>(self, value: u64) -> Result<u64, E> {
        Ok(value)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<u64, E> {
        u64::try_from(value).map_err(|_| E::invalid_value(Unexpected::Signed(value), &self))
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is whole and in range")]
    fn visit_f64<E: Error>(self, value: f64) -> Result<u64, E> {
        let is_whole = (0.0..TWO_TO_53).contains(&value) && value.fract() == 0.0;
        if is_whole { Ok(value as u64) } else { Err(E::invalid_type(Unexpected::Float(value), &self)) }
    }
}

/// Reads a field that holds a whole number.
pub(super) fn one<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
    Whole::deserialize(deserializer).map(|Whole(value)| value)
}

/// Reads a field that may hold a whole number.
pub(super) fn optional<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<u64>, D::Error> {
    Option::<Whole>::deserialize(deserializer).map(|value| value.map(|Whole(value)| value))
}

/// Reads a field that holds a list of whole numbers.
pub(super) fn list<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<u64>, D::Error> {
    Vec::<Whole>::deserialize(deserializer).map(unwrapped)
}

/// Reads a field that holds a list of lists of whole numbers.
pub(super) fn lists<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Vec<u64>>, D::Error> {
    let lists = Vec::<Vec<Whole>>::deserialize(deserializer)?;
    Ok(lists.into_iter().map(unwrapped).collect())
}

/// Reads a field that holds two whole numbers.
pub(super) fn pair<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[u64; 2], D::Error> {
    fixed::one::<D, Whole, 2>(deserializer).map(|pair| pair.map(|Whole(value)| value))
}

/// Reads a field that holds a list of pairs of whole numbers.
pub(super) fn pairs<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<[u64; 2]>, D::Error> {
    let pairs = fixed::list::<D, Whole, 2>(deserializer)?;
    Ok(pairs.into_iter().map(|pair| pair.map(|Whole(value)| value)).collect())
}

/// Unwraps the numbers in place.
fn unwrapped(list: Vec<Whole>) -> Vec<u64> {
    list.into_iter().map(|Whole(value)| value).collect()
}
