//! The distance within which vertices are merged, as clients write it.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, Visitor};
use utoipa::openapi::{OneOfBuilder, RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

use super::schema::of;

/// A distance, or `false`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WeldRequest {
    /// Merges vertices up to this distance apart, in model units; 0 merges equal positions.
    Within(f64),
    /// Merges no vertices, whatever the format of the file.
    Never,
}

impl<'de> Deserialize<'de> for WeldRequest {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(WeldVisitor)
    }
}

struct WeldVisitor;

impl Visitor<'_> for WeldVisitor {
    type Value = WeldRequest;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a distance of at least 0, or false")
    }

    fn visit_bool<E: Error>(self, welds: bool) -> Result<WeldRequest, E> {
        if welds {
            return Err(E::custom("true says no distance; 0 merges equal positions"));
        }
        Ok(WeldRequest::Never)
    }

    fn visit_f64<E>(self, distance: f64) -> Result<WeldRequest, E> {
        Ok(WeldRequest::Within(distance))
    }

    fn visit_u64<E>(self, distance: u64) -> Result<WeldRequest, E> {
        #[expect(clippy::cast_precision_loss, reason = "a distance is rounded as every number is")]
        Ok(WeldRequest::Within(distance as f64))
    }

    fn visit_i64<E>(self, distance: i64) -> Result<WeldRequest, E> {
        #[expect(clippy::cast_precision_loss, reason = "a distance is rounded as every number is")]
        Ok(WeldRequest::Within(distance as f64))
    }
}

impl PartialSchema for WeldRequest {
    fn schema() -> RefOr<Schema> {
        let distance = of(Type::Number).minimum(Some(0));
        let never = of(Type::Boolean).enum_values(Some([false]));
        OneOfBuilder::new().item(distance).item(never).into()
    }
}

impl ToSchema for WeldRequest {}
