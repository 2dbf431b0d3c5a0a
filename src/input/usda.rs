//! USD as text: reads the meshes of a scene with their subdivision tags.

mod looks;
mod place;
mod polygons;
mod primvars;
mod scene;
mod tokens;
mod tree;

use self::tree::{Layer, UsdaValue, metadata_value};
use super::reader::{ReadLimits, ReadMesh, Reader, Vertices};
use super::room::MemoryBudget;
use super::text::text;
use crate::shape::coordinate_system::{Unit, Up};

/// The reader of USD as text (`.usda`): the visible meshes, with their transforms applied, as one mesh.
///
/// It reads creases, corners, holes, the boundary rule, texture coordinates with their interpolation, colours, primvars
/// of vertices and corners, face subsets, bound materials with a `UsdPreviewSurface`, unit and up axis; of time samples
/// only the first. The scheme is that of the plan, whatever `subdivisionScheme` says. Other files, variants, instances,
/// skins and textures are left out with a note.
///
/// Source: Pixar, `OpenUSD` 26.11, `UsdGeomMesh`, `UsdGeomPrimvar`, `UsdGeomSubset`, `UsdGeomXformable`.
pub(super) const USDA: Reader = Reader {
    name: "usda",
    media_type: "model/vnd.usda",
    doc: "USD as text: meshes with creases, corners, holes, uvs, primvars, subsets and materials",
    vertices: Vertices::Shared,
    likeness: |file| (file.first_word() == b"#usda").into(),
    read: |file, limits| read(file.bytes, limits).map_err(|detail| vec![detail]),
};

/// Relative tolerance for recognising a known unit, since files store f32.
const UNIT_TOLERANCE: f64 = 1e-6;
/// The default unit of USD in metres.
const DEFAULT_UNIT_M: f64 = 0.01;

fn read(bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, String> {
    let text = text(bytes);
    if !text.starts_with("#usda") {
        return Err("the file does not begin with #usda; it is no USD as text".to_owned());
    }
    let mut room = MemoryBudget::new(bytes.len());
    let layer = tree::read(&text, &mut room)?;
    let (unit, scale) = unit(&layer)?;
    let up = match metadata_value(&layer.metadata, "upAxis").and_then(UsdaValue::word) {
        None | Some("Y") => Up::Y,
        Some("Z") => Up::Z,
        Some(other) => return Err(format!("upAxis is {other:?}; it is Y or Z")),
    };
    let mesh = scene::read(&layer, room, limits, scale)?;
    Ok(ReadMesh { unit: Some(unit), up: Some(up), ..mesh })
}

/// Returns the unit of a layer, and the factor that converts lengths to it, if needed.
fn unit(layer: &Layer<'_>) -> Result<(Unit, Option<f64>), String> {
    let metres = metadata_value(&layer.metadata, "metersPerUnit").map_or(Some(DEFAULT_UNIT_M), UsdaValue::number);
    let metres = metres.filter(|&x| x.is_finite() && x > 0.0).ok_or("metersPerUnit is no length above 0")?;
    let is_it = |unit: &Unit| (unit.metres() - metres).abs() <= UNIT_TOLERANCE * metres;
    let known = [Unit::Metre, Unit::Millimetre, Unit::Centimetre, Unit::Inch].into_iter().find(is_it);
    Ok(known.map_or((Unit::Metre, Some(metres)), |unit| (unit, None)))
}
