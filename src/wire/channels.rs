//! Channels of numbers on vertices, as clients write them.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};

use super::literal::fields;
use crate::shape::attachments::{Channel, MAX_CHANNELS, MAX_WIDTH};

/// Channels by name: lists of numbers, or of lists of as many numbers each.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ChannelsRequest(pub Vec<Channel>);

impl<'de> Deserialize<'de> for ChannelsRequest {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(ChannelsVisitor).map(Self)
    }
}

struct ChannelsVisitor;

impl<'de> Visitor<'de> for ChannelsVisitor {
    type Value = Vec<Channel>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of lists")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        let channels = fields(map, MAX_CHANNELS, &format!("more than {MAX_CHANNELS} channels"))?;
        let channel = |(name, ChannelRows { width, values })| Channel { name, width, values };
        Ok(channels.into_iter().map(channel).collect())
    }
}

/// Rows of equal width, one after another; the width of none is 1.
struct ChannelRows {
    width: usize,
    values: Vec<f64>,
}

impl<'de> Deserialize<'de> for ChannelRows {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(RowsVisitor)
    }
}

struct RowsVisitor;

impl<'de> Visitor<'de> for RowsVisitor {
    type Value = ChannelRows;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list with an entry for each vertex")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<ChannelRows, A::Error> {
        let mut rows = ChannelRows { width: 1, values: Vec::new() };
        while let Some(row) = list.next_element::<Row>()? {
            let n = row.n;
            if rows.values.is_empty() {
                rows.width = n;
            } else if rows.width != n {
                let before = rows.width;
                return Err(A::Error::custom(format!(
                    "an entry of {n} numbers after entries of {before}; all have the same number"
                )));
            }
            rows.values.extend_from_slice(&row.numbers[..n]);
        }
        Ok(rows)
    }
}

/// One entry: a number, or a list of 1 to 4.
#[derive(Default)]
struct Row {
    numbers: [f64; MAX_WIDTH],
    n: usize,
}

impl<'de> Deserialize<'de> for Row {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(RowVisitor)
    }
}

struct RowVisitor;

impl<'de> Visitor<'de> for RowVisitor {
    type Value = Row;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a number or a list of 1 to {MAX_WIDTH} numbers")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Row, E> {
        Ok(Row { numbers: [value, 0.0, 0.0, 0.0], n: 1 })
    }

    #[expect(clippy::cast_precision_loss, reason = "JSON knows one kind of number, f64")]
    fn visit_i64<E: Error>(self, value: i64) -> Result<Row, E> {
        self.visit_f64(value as f64)
    }

    #[expect(clippy::cast_precision_loss, reason = "JSON knows one kind of number, f64")]
    fn visit_u64<E: Error>(self, value: u64) -> Result<Row, E> {
        self.visit_f64(value as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Row, A::Error> {
        let mut row = Row::default();
        while let Some(number) = list.next_element::<f64>()? {
            let Some(slot) = row.numbers.get_mut(row.n) else {
                return Err(A::Error::custom(format!("more than {MAX_WIDTH} numbers")));
            };
            *slot = number;
            row.n += 1;
        }
        if row.n == 0 { Err(A::Error::custom(format!("no number; an entry has 1 to {MAX_WIDTH}"))) } else { Ok(row) }
    }
}
