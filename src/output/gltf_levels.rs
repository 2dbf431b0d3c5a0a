//! Levels of detail: one document that refers to the buffers of a mesh at several levels.
//!
//! Source: Microsoft, glTF extension `MSFT_lod` (2017).

use serde_json::{Map, Value, json};

use crate::fault::Fault;
use crate::math::parameter::{Parameter, ParameterKind, Values};
use crate::output::counts::{Counts, ShapeKind};
use crate::output::error::FormatError;
use crate::output::gltf_amounts::GltfContents;
use crate::output::gltf_buffer::buffered;
use crate::output::gltf_document::{model, unwritten};
use crate::output::gltf_pack::Packed;
use crate::output::gltf_packing::Packing;
use crate::output::numbers::total;
use crate::output::scene::{Detail, Scene};
use crate::output::size::Size;
use crate::output::stream::Stream;
use crate::watch::Watch;

/// The extension by which a node names its coarser substitutes.
const MSFT_LOD: &str = "MSFT_lod";

/// Maximum number of levels of detail: as many as a model may be refined, and a few more.
const MAX_DETAIL_LEVELS: usize = 16;

/// Maximum number of bytes of the URI of a buffer.
const URI_BYTES: u128 = 128;

/// The option of `gltf` that writes a buffer for each level.
pub(super) const LOD: Parameter = Parameter::optional(
    "lod",
    ParameterKind::Numbers { most: MAX_DETAIL_LEVELS },
    "Levels of detail of a mesh, ascending, the last of which is `levels`: the buffer of each is a file of its \
     own (gltf-bin), which the document names by its key, and MSFT_lod says which nodes stand for which",
);

/// Returns the levels that the options give, if any.
pub(super) fn of(options: &Values) -> Option<Vec<u32>> {
    let levels = options.numbers(LOD.name);
    (!levels.is_empty()).then(|| levels.iter().filter_map(|&level| whole(level)).collect())
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked to be whole and small")]
fn whole(level: f64) -> Option<u32> {
    (level.fract() == 0.0 && (0.0..1000.0).contains(&level)).then_some(level as u32)
}

/// Refuses levels that are not whole or do not ascend, and levels of curves.
pub(super) fn suits(kind: ShapeKind, options: &Values) -> Result<(), Fault> {
    let levels = options.numbers(LOD.name);
    let fault = |detail: String| Err(Fault::new(format!("/{}", LOD.name), detail));
    if let Some(level) = levels.iter().find(|&&level| whole(level).is_none()) {
        return fault(format!("{level} is no level; levels are whole numbers from 0 on"));
    }
    if let Some([before, after]) = levels.array_windows().find(|[before, after]| before >= after) {
        return fault(format!("level {after} comes after {before}; levels ascend"));
    }
    match kind {
        ShapeKind::Curves { .. } if !levels.is_empty() => {
            fault("levels of detail are for meshes, and these are curves; leave it out".to_owned())
        }
        _ => Ok(()),
    }
}

/// Refuses levels of detail for meshes with frames.
pub(super) fn fits(counts: &Counts, options: &Values) -> Result<(), Fault> {
    if of(options).is_some() && counts.frames > 0 {
        let detail = "meshes with frames have one level of detail; leave it out, or name one with \"frame\"";
        return Err(Fault::new(format!("/{}", LOD.name), detail));
    }
    Ok(())
}

/// Returns the maximum length of a document about several levels.
pub(super) fn size(contents: GltfContents<'_>, options: &Values) -> Option<Size> {
    let levels = of(options)?.len() as u128;
    let room = if Packing::of(options).is_some() { contents.packed_room() } else { contents.room() };
    // references of all levels have more digits than those of one
    Some(Size::AtMost(total(&[(room, 2 * levels), (URI_BYTES, levels)])))
}

/// Writes the document about all details of a scene.
pub(super) fn write(scene: &Scene<'_>, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let mut all = Value::Null;
    for detail in scene.details {
        let level = document(scene, detail, stream.watch)?;
        all = if all.is_null() { level } else { joined(all, level) };
    }
    let nodes = all["scenes"][0]["nodes"].as_array().cloned().unwrap_or_default();
    let (finest, coarser) = nodes.split_last().ok_or_else(|| FormatError::Unfit("there is no level".to_owned()))?;
    if !coarser.is_empty() {
        let ids: Vec<&Value> = coarser.iter().rev().collect();
        if let Some(node) = finest.as_u64().and_then(|at| all.pointer_mut(&format!("/nodes/{at}"))) {
            node["extensions"] = json!({ MSFT_LOD: { "ids": ids } });
        }
        let used = all.as_object_mut().map(|all| all.entry("extensionsUsed").or_insert_with(|| json!([])));
        used.and_then(Value::as_array_mut).into_iter().for_each(|used| used.push(MSFT_LOD.into()));
        all["scenes"][0]["nodes"] = json!([finest]);
    }
    let bytes = serde_json::to_vec(&all).map_err(|error| unwritten(&error))?;
    stream.bytes(&bytes)
}

/// Returns the document about a single level.
fn document(scene: &Scene<'_>, detail: &Detail<'_>, watch: &Watch) -> Result<Value, FormatError> {
    let options = detail.options;
    let scene = Scene { shape: detail.shape, details: &[], ..*scene };
    let mut document = Value::Null;
    buffered(&scene, options, watch, |buffer| {
        document = if let Some(packing) = Packing::of(options) {
            Packed::of(buffer, packing, watch)?.value(Some(&detail.uri))?
        } else {
            let mut root = model(buffer)?;
            root.buffers.iter_mut().for_each(|buffer| buffer.uri = Some(detail.uri.clone()));
            let written = root.to_vec().map_err(|error| unwritten(&error))?;
            serde_json::from_slice(&written).map_err(|error| unwritten(&error))?
        };
        Ok(())
    })?;
    Ok(document)
}

/// The places where documents refer to entries of their lists by number, and the lists.
const REFERENCES: &[(&str, &str)] = &[
    ("accessors/*/bufferView", "bufferViews"),
    ("bufferViews/*/buffer", "buffers"),
    ("bufferViews/*/extensions/EXT_meshopt_compression/buffer", "buffers"),
    ("images/*/bufferView", "bufferViews"),
    ("textures/*/sampler", "samplers"),
    ("textures/*/source", "images"),
    ("materials/*/pbrMetallicRoughness/baseColorTexture/index", "textures"),
    ("meshes/*/primitives/*/attributes/*", "accessors"),
    ("meshes/*/primitives/*/indices", "accessors"),
    ("meshes/*/primitives/*/material", "materials"),
    ("meshes/*/primitives/*/extras/faces", "accessors"),
    ("nodes/*/mesh", "meshes"),
    ("nodes/*/children/*", "nodes"),
    ("scenes/*/nodes/*", "nodes"),
];

/// Joins two documents: the lists of the second follow those of the first, and one scene has all nodes of both.
fn joined(mut first: Value, mut second: Value) -> Value {
    for (place, list) in REFERENCES {
        let before = first[list].as_array().map_or(0, Vec::len) as u64;
        add(&mut second, &mut place.split('/'), before);
    }
    let (Value::Object(all), Value::Object(more)) = (&mut first, second) else { return first };
    for (name, more) in more {
        match (name.as_str(), more) {
            ("scenes", more) => {
                let nodes = more[0]["nodes"].as_array().cloned().unwrap_or_default();
                all["scenes"][0]["nodes"].as_array_mut().into_iter().for_each(|all| all.extend_from_slice(&nodes));
            }
            (name, Value::Array(more)) => join_lists(all, name, more),
            _ => {}
        }
    }
    first
}

/// Appends a list to the list of the same name; names of extensions only if they are new.
fn join_lists(all: &mut Map<String, Value>, name: &str, more: Vec<Value>) {
    let Some(list) = all.entry(name).or_insert_with(|| json!([])).as_array_mut() else { return };
    for entry in more {
        if !(name.starts_with("extensions") && list.contains(&entry)) {
            list.push(entry);
        }
    }
}

/// Adds `more` to the numbers at a place, where `*` stands for every entry.
fn add(value: &mut Value, place: &mut (impl Iterator<Item = &'static str> + Clone), more: u64) {
    match (place.next(), value) {
        (None, value) => {
            if let Some(number) = value.as_u64() {
                *value = (number + more).into();
            }
        }
        (Some("*"), Value::Array(entries)) => {
            entries.iter_mut().for_each(|entry| add(entry, &mut place.clone(), more));
        }
        (Some("*"), Value::Object(entries)) => {
            entries.values_mut().for_each(|entry| add(entry, &mut place.clone(), more));
        }
        (Some(name), Value::Object(entries)) => {
            if let Some(entry) = entries.get_mut(name) {
                add(entry, place, more);
            }
        }
        _ => {}
    }
}
