//! 3MF: reads the triangles of the objects that are built, from the model in the archive.

mod archive;
mod build;
mod model;
mod xml;

use self::archive::Archive;
use self::xml::XmlTags;
use super::likeness::Likeness;
use super::reader::{ReadLimits, ReadMesh, Reader, Vertices};
use super::room::MemoryBudget;
use super::text::quoted;
use crate::shape::coordinate_system::Up;

/// The reader of 3MF Core 1.3: the objects of the build with the transforms of their items, with components, and with
/// materials and colours of the Materials Extension.
///
/// The unit of the model and its up axis, z, become those of the input unless the job gives others; micrometres are
/// read as millimetres, feet as inches. Base materials become materials, corner colours the channel `color`, and
/// objects become groups if there are several. Textures, supports and other extensions are left out with a note, or
/// refused if the model declares them as required.
pub(super) const THREE_MF: Reader = Reader {
    name: "3mf",
    media_type: "model/3mf",
    doc: "3MF: the objects of the build with unit, materials and colours",
    vertices: Vertices::Shared,
    likeness: |file| likeness(file.bytes),
    read: |file, limits| read(file.bytes, limits).map_err(|detail| vec![detail]),
};

/// The first bytes of a ZIP archive.
const ZIP_START: &[u8] = b"PK\x03\x04";
/// Number of bytes at the end of an archive that are searched for the name of a model: the list of some hundred files.
/// Half of it misses models among many pictures; twice of it searches more of other archives in vain.
const MAX_LIST_BYTES: usize = 64 << 10;

/// Returns whether a file is a ZIP archive, and whether its list of files, at the end, names a model.
fn likeness(bytes: &[u8]) -> Likeness {
    let list = &bytes[bytes.len().saturating_sub(MAX_LIST_BYTES)..];
    match bytes.starts_with(ZIP_START) {
        true if list.windows(6).any(|window| window == b".model") => Likeness::Is,
        true => Likeness::Begins,
        false => Likeness::Unlike,
    }
}

fn read(bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, String> {
    let archive = Archive::new(bytes)?;
    let name = main_model(&archive)?;
    let file = archive.file(&name)?.ok_or_else(|| format!("the archive has no file {}", quoted(&name)))?;
    let mut tags = XmlTags::new(file);
    let mut room = MemoryBudget::new(bytes.len());
    let found = model::read(&mut tags, &mut room, limits);
    let model = found.map_err(|detail| format!("{}, line {}: {detail}", quoted(&name), tags.line))?;
    let unit = model.unit;
    let mesh = build::built(model, room, limits)?;
    Ok(ReadMesh { unit: Some(unit), up: Some(Up::Z), ..mesh })
}

/// Returns the name of the main model, from the relationships of the archive.
fn main_model(archive: &Archive<'_>) -> Result<String, String> {
    const RELATIONS_NAME: &str = "_rels/.rels";
    let missing = || format!("the archive has no model: {RELATIONS_NAME} names none; it is no 3MF file");
    let mut tags = XmlTags::new(archive.file(RELATIONS_NAME)?.ok_or_else(missing)?);
    let mut model = None;
    while let Some(tag) = tags.next().map_err(|detail| format!("{RELATIONS_NAME}, line {}: {detail}", tags.line))? {
        let is_model = tag.get("Type").is_some_and(|kind| kind.ends_with("/3dmodel"));
        if tag.name == "Relationship" && is_model && model.is_none() {
            model = tag.get("Target").map(|target| target.trim_start_matches('/').to_owned());
        }
    }
    model.ok_or_else(missing)
}
