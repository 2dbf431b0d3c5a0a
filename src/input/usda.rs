//! USD as text: the meshes of a scene with all that makes subdivision surfaces of them.

mod looks;
mod place;
mod polygons;
mod primvars;
mod scene;
mod tokens;
mod tree;

use self::tree::{Layer, Value, told};
use super::reader::{ReadLimits, ReadMesh, Reader, Vertices};
use super::room::Room;
use super::text::text;
use crate::shape::frame::{Unit, Up};

/// USD as text (`.usda`): the meshes that are shown, where transforms put them, as one.
///
/// Creases, corners, holes, the boundary rule, texture coordinates with their rule, colours, primvars of vertices and
/// corners, subsets of faces, bound materials with a `UsdPreviewSurface`, unit and up axis are read; of values over
/// time the first. The scheme is that of the plan, whatever `subdivisionScheme` says. Other files, variants, instances,
/// skins and textures are left out with a note.
///
/// Source: Pixar, `OpenUSD` 26.11, `UsdGeomMesh`, `UsdGeomPrimvar`, `UsdGeomSubset`, `UsdGeomXformable`.
pub(super) const USDA: Reader = Reader {
    name: "usda",
    media_type: "model/vnd.usda",
    doc: "USD as text: meshes with creases, corners, holes, uvs, primvars, subsets and materials",
    vertices: Vertices::Shared,
    read: |file, limits| read(file.bytes, limits).map_err(|detail| vec![detail]),
};

/// How far the length of a unit may be from that of one which is known, as a share of it: files have f32.
const SAME_UNIT: f64 = 1e-6;
/// What USD takes for the unit where a layer has none, metres.
const USUAL: f64 = 0.01;

fn read(bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, String> {
    let text = text(bytes);
    if !text.starts_with("#usda") {
        return Err("the file does not begin with #usda; it is no USD as text".to_owned());
    }
    let mut room = Room::new(bytes.len());
    let layer = tree::read(&text, &mut room)?;
    let (unit, scale) = unit(&layer)?;
    let up = match told(&layer.metadata, "upAxis").and_then(Value::word) {
        None | Some("Y") => Up::Y,
        Some("Z") => Up::Z,
        Some(other) => return Err(format!("upAxis is {other:?}; it is Y or Z")),
    };
    let mesh = scene::read(&layer, room, limits, scale)?;
    Ok(ReadMesh { unit: Some(unit), up: Some(up), ..mesh })
}

/// The unit of a layer, and what lengths are multiplied with to be in it, if need be.
fn unit(layer: &Layer<'_>) -> Result<(Unit, Option<f64>), String> {
    let metres = told(&layer.metadata, "metersPerUnit").map_or(Some(USUAL), Value::number);
    let metres = metres.filter(|&x| x.is_finite() && x > 0.0).ok_or("metersPerUnit is no length above 0")?;
    let is_it = |unit: &Unit| (unit.metres() - metres).abs() <= SAME_UNIT * metres;
    let known = [Unit::Metre, Unit::Millimetre, Unit::Centimetre, Unit::Inch].into_iter().find(is_it);
    Ok(known.map_or((Unit::Metre, Some(metres)), |unit| (unit, None)))
}
