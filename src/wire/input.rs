//! The input of a job as clients write it.

use serde::Deserialize;
use utoipa::ToSchema;

use super::mesh::MeshRequest;
use super::object;
use super::polygon::{PolygonRequest, polygons};
use crate::fault::{Fault, under};
use crate::job::Input;
use crate::shape::frame::{Frame, Unit, Up};

/// The input: exactly one of `mesh`, `polygon` and `polygons`.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct InputRequest {
    /// A control mesh.
    #[serde(default, deserialize_with = "object::optional")]
    pub mesh: Option<MeshRequest>,
    /// A control polygon.
    #[serde(default, deserialize_with = "object::optional")]
    pub polygon: Option<PolygonRequest>,
    /// Several control polygons, refined alike.
    #[serde(default, deserialize_with = "object::optional_list")]
    #[schema(min_items = 1, max_items = 4096)]
    pub polygons: Option<Vec<PolygonRequest>>,
    /// Unit of the coordinates: `m` (default), `mm`, `cm`, `in`.
    pub unit: Option<UnitRequest>,
    /// The axis that points up: `y` (default) or `z`.
    pub up: Option<UpRequest>,
    /// What to do with faces whose winding disagrees with their neighbours': `refuse` (default) or `repair`.
    pub orient: Option<OrientRequest>,
}

/// What to do with inconsistent winding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OrientRequest {
    /// Refuse the mesh.
    Refuse,
    /// Turn faces to agree with the lowest of their component.
    Repair,
}

/// Unit of the coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum UnitRequest {
    /// Metres.
    M,
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Inches.
    In,
}

/// The axis that points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum UpRequest {
    /// The second, as in glTF.
    Y,
    /// The third.
    Z,
}

impl InputRequest {
    /// What its coordinates mean.
    pub fn frame(&self) -> Frame {
        let unit = match self.unit {
            None | Some(UnitRequest::M) => Unit::Metre,
            Some(UnitRequest::Mm) => Unit::Millimetre,
            Some(UnitRequest::Cm) => Unit::Centimetre,
            Some(UnitRequest::In) => Unit::Inch,
        };
        let up = match self.up {
            None | Some(UpRequest::Y) => Up::Y,
            Some(UpRequest::Z) => Up::Z,
        };
        Frame { unit, up }
    }

    /// Checks the input.
    ///
    /// # Errors
    /// All faults, with pointers below the input.
    pub fn resolve(self) -> Result<Input, Vec<Fault>> {
        let given = [self.mesh.is_some(), self.polygon.is_some(), self.polygons.is_some()];
        if given.iter().filter(|given| **given).count() != 1 {
            let detail = "give exactly one of \"mesh\", \"polygon\" and \"polygons\"";
            return Err(vec![Fault::new("", detail)]);
        }
        if let Some(mesh) = self.mesh {
            return mesh.resolve(self.orient).map(Input::Mesh).map_err(|found| under("/mesh", found));
        }
        if self.orient.is_some() {
            return Err(vec![Fault::new("/orient", "polygons have no winding; leave it out")]);
        }
        if let Some(polygon) = self.polygon {
            let polygon = polygon.resolve().map_err(|found| under("/polygon", found))?;
            return Ok(Input::Polygons(vec![polygon]));
        }
        polygons(self.polygons.unwrap_or_default()).map(Input::Polygons).map_err(|found| under("/polygons", found))
    }
}
