//! The number of levels, as clients write it.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, Deserializer, Error, MapAccess, Unexpected, Visitor};
use utoipa::openapi::schema::AdditionalProperties;
use utoipa::openapi::{OneOfBuilder, RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

use super::schema::of;
use crate::job::Levels;

/// The text that chooses as many levels as make the faces of a picture about a pixel in size.
const AUTO: &str = "auto";

/// Maximum number of levels. Each level at least doubles the number of elements, so that no job can have more.
pub(super) const MAX_LEVELS_ASKED: usize = 64;

/// A number of levels, a tolerance, or as many levels as a picture can show: `4`, `{"tolerance": 0.01}` or `"auto"`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelsRequest(pub Levels);

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct ToleranceRequest {
    tolerance: f64,
}

impl<'de> Deserialize<'de> for LevelsRequest {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(LevelsVisitor).map(Self)
    }
}

struct LevelsVisitor;

impl<'de> Visitor<'de> for LevelsVisitor {
    type Value = Levels;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a whole number of levels, an object with a \"tolerance\", or \"{AUTO}\"")
    }

    fn visit_u64<E>(self, levels: u64) -> Result<Levels, E> {
        Ok(Levels::Count(levels))
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is whole and not negative")]
    fn visit_f64<E: Error>(self, levels: f64) -> Result<Levels, E> {
        // the cast saturates, and a number as large as that is refused later
        let is_whole = levels >= 0.0 && levels.fract() == 0.0;
        if is_whole { Ok(Levels::Count(levels as u64)) } else { Err(E::invalid_type(Unexpected::Float(levels), &self)) }
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Levels, E> {
        if text == AUTO { Ok(Levels::Auto) } else { Err(E::invalid_value(Unexpected::Str(text), &self)) }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Levels, A::Error> {
        let request = ToleranceRequest::deserialize(MapAccessDeserializer::new(map))?;
        Ok(Levels::Tolerance(request.tolerance))
    }
}

impl PartialSchema for LevelsRequest {
    fn schema() -> RefOr<Schema> {
        let count = of(Type::Integer).minimum(Some(0)).maximum(Some(MAX_LEVELS_ASKED));
        let doc = "Greatest distance between the result and the limit, model units.";
        let tolerance = of(Type::Number).exclusive_minimum(Some(0)).description(Some(doc));
        let within = of(Type::Object).property("tolerance", tolerance).required("tolerance");
        let within = within.additional_properties(Some(AdditionalProperties::FreeForm(false)));
        let doc = "Of pictures: as many as make faces of about a pixel, and two million faces at most.";
        let auto = of(Type::String).enum_values(Some([AUTO])).description(Some(doc));
        OneOfBuilder::new().item(count).item(within).item(auto).into()
    }
}

impl ToSchema for LevelsRequest {}
