//! Channels of numbers on vertices or on face corners, as clients write them.

use std::fmt;

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use utoipa::openapi::schema::AdditionalProperties;
use utoipa::openapi::{OneOfBuilder, RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

use super::corners::{InterpolationRequest, face_list};
use super::literal::fields;
use super::{schema, whole};
use crate::shape::attachments::{ChannelInput, MAX_CHANNELS, MAX_WIDTH};
use crate::shape::seams::{Interpolation, SeamsInput};

/// Channels by name: lists of numbers, or of rows with the same number of entries each.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ChannelsRequest(pub Vec<ChannelInput>);

impl<'de> Deserialize<'de> for ChannelsRequest {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(ChannelsVisitor).map(Self)
    }
}

/// Returns the schema of all channels.
pub(super) fn described() -> RefOr<Schema> {
    let entries = OneOfBuilder::new().item(schema::channel_rows()).item(CornerChannelRequest::schema());
    let properties = AdditionalProperties::from(RefOr::from(Schema::from(entries.build())));
    let doc = "Numbers that vertices carry, by name: a number or a list of 1 to 4 numbers for each vertex; or those of \
               corners of faces, as `values` and `faces`. `color` (red, green, blue, perhaps alpha; sRGB from 0 to 1) \
               is the colour.";
    schema::of(Type::Object).additional_properties(Some(properties)).description(Some(doc)).into()
}

struct ChannelsVisitor;

impl<'de> Visitor<'de> for ChannelsVisitor {
    type Value = Vec<ChannelInput>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of lists")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        let channels = fields(map, MAX_CHANNELS, &format!("more than {MAX_CHANNELS} channels"))?;
        let channel = |(name, request)| match request {
            ChannelRequest::Vertices(rows) => {
                ChannelInput { name, width: rows.width, values: rows.values, seams: None }
            }
            ChannelRequest::Corners(CornerChannelRequest { values, faces, interpolation }) => {
                let interpolation = interpolation.map_or(Interpolation::None, Into::into);
                let seams = Some(SeamsInput { faces: face_list(&faces), interpolation });
                ChannelInput { name, width: values.width, values: values.values, seams }
            }
        };
        Ok(channels.into_iter().map(channel).collect())
    }
}

/// A channel on vertices or on face corners.
enum ChannelRequest {
    Vertices(ChannelRows),
    Corners(CornerChannelRequest),
}

/// Numbers that corners of faces carry, refined like positions, with seams between faces whose corners differ.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CornerChannelRequest {
    /// Values: numbers, or lists of 1 to 4 numbers.
    #[schema(schema_with = schema::channel_rows)]
    values: ChannelRows,
    /// For each face of the mesh the values at its corners, in their order. Neighbours are joined where both have the
    /// same values at both ends of their edge; all other edges are seams.
    #[serde(deserialize_with = "whole::lists")]
    #[schema(schema_with = schema::corner_values)]
    faces: Vec<Vec<u64>>,
    /// Where values are interpolated linearly; `none` when left out.
    interpolation: Option<InterpolationRequest>,
}

impl<'de> Deserialize<'de> for ChannelRequest {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ChannelVisitor)
    }
}

struct ChannelVisitor;

impl<'de> Visitor<'de> for ChannelVisitor {
    type Value = ChannelRequest;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list with an entry for each vertex, or \"values\" and \"faces\" for corners")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<ChannelRequest, A::Error> {
        ChannelRows::deserialize(SeqAccessDeserializer::new(list)).map(ChannelRequest::Vertices)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ChannelRequest, A::Error> {
        CornerChannelRequest::deserialize(MapAccessDeserializer::new(map)).map(ChannelRequest::Corners)
    }
}

/// Rows of equal width, one after another; without rows the width is 1.
#[derive(Debug, Clone)]
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
        f.write_str("a list of numbers, or of lists of numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<ChannelRows, A::Error> {
        let mut rows = ChannelRows { width: 1, values: Vec::new() };
        while let Some(row) = list.next_element::<ChannelEntry>()? {
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

/// One entry of a channel: a number, or a list of 1 to 4 numbers.
#[derive(Default)]
struct ChannelEntry {
    numbers: [f64; MAX_WIDTH],
    n: usize,
}

impl<'de> Deserialize<'de> for ChannelEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(RowVisitor)
    }
}

struct RowVisitor;

impl<'de> Visitor<'de> for RowVisitor {
    type Value = ChannelEntry;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a number or a list of 1 to {MAX_WIDTH} numbers")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<ChannelEntry, E> {
        Ok(ChannelEntry { numbers: [value, 0.0, 0.0, 0.0], n: 1 })
    }

    #[expect(clippy::cast_precision_loss, reason = "JSON knows one kind of number, f64")]
    fn visit_i64<E: Error>(self, value: i64) -> Result<ChannelEntry, E> {
        self.visit_f64(value as f64)
    }

    #[expect(clippy::cast_precision_loss, reason = "JSON knows one kind of number, f64")]
    fn visit_u64<E: Error>(self, value: u64) -> Result<ChannelEntry, E> {
        self.visit_f64(value as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<ChannelEntry, A::Error> {
        let mut row = ChannelEntry::default();
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
