//! A glTF document: its JSON and the bytes of its buffers.

use std::borrow::Cow;
use std::collections::BTreeMap;

use gltf::json::Root;
use percent_encoding::percent_decode_str;
use serde_json::value::RawValue;

use super::census;
use super::packed::{self, PACKED};
use super::transform::Placement;
use crate::fault;
use crate::input::base64;
use crate::input::beside::{Beside, InputFile};
use crate::input::room::MemoryBudget;
use crate::input::text::quoted;

/// Bytes of the header of GLB, and of the header of a chunk.
const GLB_HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;

/// Extensions that a file may require because they do not affect what is read.
const HARMLESS_EXTENSIONS: &[&str] = &[
    "KHR_mesh_quantization",
    PACKED,
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    "EXT_lights_",
    "KHR_materials_",
    "KHR_technique_webgl",
    "KHR_techniques_webgl",
    "KHR_xmp",
];

/// The message for files of glTF 1.0.
const GLTF_1_MESSAGE: &str = "the file is glTF 1.0, which is built otherwise; 2.0 is read: convert it";

/// Replacements for Rust type names in messages of the JSON parser.
const PLAIN_PARSER_WORDS: &[(&str, &str)] = &[
    ("expected index into child of root", "expected an index from 0"),
    ("expected f32", "expected a number"),
    ("expected f64", "expected a number"),
    ("expected u32", "expected a whole number from 0"),
    ("expected a sequence", "expected a list"),
    ("expected an array", "expected a list"),
    ("invalid type: sequence", "invalid type: list"),
    ("invalid type: map", "invalid type: object"),
];

/// Whether a document has version 1, in which lists are objects.
fn is_old(json: &[u8]) -> bool {
    let Ok(document) = serde_json::from_slice::<BTreeMap<String, &RawValue>>(json) else { return false };
    let text = |name: &str| document.get(name).map_or("", |value| value.get());
    !text("asset").contains("\"2.") && ["meshes", "accessors", "buffers"].iter().any(|list| text(list).starts_with('{'))
}

/// Describes the fault of a document with a scene without `nodes`, which the specification permits.
fn empty_scene(json: &[u8]) -> Option<String> {
    let document: BTreeMap<String, &RawValue> = serde_json::from_slice(json).ok()?;
    let scenes: Vec<BTreeMap<String, &RawValue>> = serde_json::from_str(document.get("scenes")?.get()).ok()?;
    let empty = scenes.iter().position(|scene| !scene.contains_key("nodes"))?;
    Some(format!("scene {empty} has no nodes, so that nothing is in it; give it some, or leave it out"))
}

/// A document with its buffers.
#[derive(Debug)]
pub(super) struct GltfDocument<'a> {
    pub(super) root: Root,
    /// The placements of the nodes in f64; `root` rounds them to f32.
    pub(super) placements: Vec<Option<Box<Placement>>>,
    /// The bytes of each buffer, cut to the declared length.
    pub(super) buffers: Vec<Cow<'a, [u8]>>,
    /// The decoded bytes of compressed views, by index.
    pub(super) unpacked: BTreeMap<usize, Vec<u8>>,
    /// The files beside the document.
    beside: &'a dyn Beside,
}

impl<'a> GltfDocument<'a> {
    /// Parses a document, whose `binary` is the second chunk of GLB, and takes its memory from the room.
    pub(super) fn of_json(
        json: &[u8],
        binary: Option<&'a [u8]>,
        beside: &'a dyn Beside,
        room: &mut MemoryBudget,
    ) -> Result<Self, String> {
        let json = json.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(json);
        census::admit(json, room)?;
        // the parser repeats a misplaced string in full, so the message is cut
        let no_gltf = |error: serde_json::Error| {
            let detail =
                PLAIN_PARSER_WORDS.iter().fold(error.to_string(), |detail, (word, plain)| detail.replace(word, plain));
            format!("the document is no glTF: {}", fault::cut(&detail, 200))
        };
        let no_root = |error| {
            if is_old(json) { GLTF_1_MESSAGE.to_owned() } else { empty_scene(json).unwrap_or_else(|| no_gltf(error)) }
        };
        let root = Root::from_slice(json).map_err(no_root)?;
        let placements = Placement::all(json).map_err(no_gltf)?;
        if root.asset.version.starts_with("1.") {
            return Err(GLTF_1_MESSAGE.to_owned());
        }
        if !root.asset.version.starts_with("2.") {
            return Err(format!("version {} of glTF; 2.0 is read", quoted(&root.asset.version)));
        }
        if let Some(least) = root.asset.min_version.as_deref().filter(|&least| least != "2.0") {
            return Err(format!("the file asks for version {} of glTF at least; 2.0 is read", quoted(least)));
        }
        let is_harmless = |name: &String| HARMLESS_EXTENSIONS.iter().any(|known| name.starts_with(known));
        if let Some(name) = root.extensions_required.iter().find(|name| !is_harmless(name)) {
            return Err(format!("the file requires {}, which is not read; export it without", quoted(name)));
        }
        let is_packed = root.extensions_used.iter().chain(&root.extensions_required).any(|name| name == PACKED);
        let mut buffers = Vec::with_capacity(root.buffers.len());
        for (i, buffer) in root.buffers.iter().enumerate() {
            let bytes: Cow<'a, [u8]> = match (&buffer.uri, binary) {
                (Some(uri), _) => {
                    Cow::Owned(referred(uri, beside, room).map_err(|detail| format!("buffer {i}: {detail}"))?)
                }
                (None, Some(binary)) if i == 0 => Cow::Borrowed(binary),
                // this is a fallback buffer for readers without the extension
                (None, _) if is_packed => {
                    buffers.push(Cow::Borrowed(&[][..]));
                    continue;
                }
                (None, _) => return Err(format!("buffer {i} has no data; give it a data URI, or send glb")),
            };
            let (claimed, found) = (buffer.byte_length.0, bytes.len());
            let length = usize::try_from(claimed).ok().filter(|&length| length <= found);
            let length = length
                .ok_or_else(|| format!("buffer {i} says it has {claimed} bytes, and has {found}; send it whole"))?;
            buffers.push(cut(bytes, length));
        }
        let unpacked = if is_packed { packed::views(json, &buffers, room)? } else { BTreeMap::new() };
        Ok(Self { root, placements, buffers, unpacked, beside })
    }

    /// Parses a document in the binary container.
    pub(super) fn of_glb(file: &InputFile<'a>, room: &mut MemoryBudget) -> Result<Self, String> {
        let bytes = file.bytes;
        let word = |at: usize| bytes.get(at..at + 4)?.try_into().ok().map(u32::from_le_bytes);
        let (Some(magic), Some(version), Some(length)) = (bytes.get(..4), word(4), word(8)) else {
            return Err(format!("{} bytes; a GLB has at least {GLB_HEADER_BYTES}", bytes.len()));
        };
        if magic != b"glTF" {
            return Err("byte 0: a GLB starts with \"glTF\"; read the text form as gltf".to_owned());
        }
        if version != 2 {
            return Err(match version {
                1 => format!("byte 4: {GLTF_1_MESSAGE}"),
                _ => format!("byte 4: version {version} of GLB; 2 is read"),
            });
        }
        if length as usize != bytes.len() {
            return Err(format!(
                "byte 8: the header counts {length} bytes, the file has {}; send it whole",
                bytes.len()
            ));
        }
        let (json, rest) = chunk(bytes, GLB_HEADER_BYTES, Some(*b"JSON"))?;
        let binary = if rest < bytes.len() { Some(chunk(bytes, rest, None)?.0) } else { None };
        Self::of_json(json, binary, file.beside, room)
    }
}

/// Returns the content of the chunk that starts at byte `at`, and the offset of the next chunk.
fn chunk(bytes: &[u8], at: usize, kind: Option<[u8; 4]>) -> Result<(&[u8], usize), String> {
    let header = bytes
        .get(at..at + CHUNK_HEADER_BYTES)
        .ok_or_else(|| format!("byte {at}: the file ends within a chunk's header"))?;
    let (length, found) = header.split_at(4);
    let length = length.try_into().map_or(0, u32::from_le_bytes) as usize;
    if kind.is_some_and(|kind| kind != *found) {
        return Err(format!(
            "byte {}: the first chunk is {}; it has to be JSON",
            at + 4,
            quoted(&String::from_utf8_lossy(found))
        ));
    }
    let start = at + CHUNK_HEADER_BYTES;
    match bytes.get(start..).and_then(|rest| rest.get(..length)) {
        Some(content) => Ok((content, start + length)),
        None => Err(format!("byte {at}: a chunk of {length} bytes; the file has {} more", bytes.len() - start)),
    }
}

/// Cuts a buffer to its first `length` bytes; the rest is padding or unused.
fn cut(bytes: Cow<'_, [u8]>, length: usize) -> Cow<'_, [u8]> {
    match bytes {
        Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[..length]),
        Cow::Owned(mut bytes) => {
            bytes.truncate(length);
            Cow::Owned(bytes)
        }
    }
}

impl GltfDocument<'_> {
    /// Reads the bytes that a URI refers to, embedded or beside the document.
    pub(super) fn referred(&self, uri: &str, room: &mut MemoryBudget) -> Result<Vec<u8>, String> {
        referred(uri, self.beside, room)
    }
}

/// Reads the bytes that a URI refers to.
fn referred(uri: &str, beside: &dyn Beside, room: &mut MemoryBudget) -> Result<Vec<u8>, String> {
    if uri.starts_with("data:") {
        room.take(uri.len()).and_then(|()| embedded(uri))
    } else {
        neighbour(uri, beside, room)
    }
}

/// Decodes a data URI.
fn embedded(uri: &str) -> Result<Vec<u8>, String> {
    match uri.split_once(";base64,") {
        Some((_, text)) => base64::decode(text),
        None => Err("the data URI is not in base64; write data:application/octet-stream;base64,...".to_owned()),
    }
}

/// Reads a file beside the document, whose name may be percent-encoded.
fn neighbour(uri: &str, beside: &dyn Beside, room: &mut MemoryBudget) -> Result<Vec<u8>, String> {
    let bytes = beside.read(&percent_decode_str(uri).decode_utf8_lossy(), u64::MAX)?;
    room.widen(bytes.len());
    room.take(bytes.len())?;
    Ok(bytes)
}
