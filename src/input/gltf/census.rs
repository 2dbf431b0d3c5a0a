//! Estimate of the memory that parsing a glTF document takes, counted in its text beforehand.
//!
//! The parser of the document makes a structure of hundreds of bytes of each `{}`. The census reads only strings,
//! brackets, commas and colons; invalid JSON is refused later, and the counts are right up to the fault.

use std::mem::size_of;

use gltf::json::animation::{Animation, Channel, Sampler};
use gltf::json::buffer::{Buffer, View};
use gltf::json::material::Material;
use gltf::json::mesh::{Mesh, Primitive};
use gltf::json::{Accessor, Camera, Image, Node, Scene, Skin, Texture, Value, texture};

use super::transform::Placement;
use crate::input::room::{GROWN, MemoryBudget};
use crate::input::text::quoted;

/// Maximum number of copies of the text: names and extras, and the growing buffer of the parser for strings with
/// escapes.
const TEXT_COPIES: usize = 4;
/// Bytes of an entry of a `BTreeMap` of small keys and values, whose nodes have eleven slots, of which only five may be
/// in use.
const MAP_ENTRY_BYTES: usize = 96;
/// Bytes of the first node of such a map.
const MAP_NODE_BYTES: usize = 512;
/// The maximum depth that the JSON parser accepts.
const MAX_JSON_DEPTH: usize = 128;

/// Memory in bytes of the parts of a list at the root.
#[derive(Debug, Clone, Copy, Default)]
struct Prices {
    /// An entry of the list.
    entry: usize,
    /// A list within an entry; a list of one entry has capacity for four.
    list: usize,
    /// An entry of such a list.
    value: usize,
    /// An object in a list directly within an entry, such as a primitive.
    object: usize,
    /// An object nested more deeply.
    inner: usize,
    /// A member of an object with at least `members` brackets open.
    member: usize,
    members: usize,
}

/// The prices of a list that the parser does not know, which it skips.
const FREE: Prices = Prices { entry: 0, list: 0, value: 0, object: 0, inner: 0, member: 0, members: MAX_JSON_DEPTH };

const fn entries(size: usize) -> Prices {
    Prices { entry: GROWN * size, ..FREE }
}

/// Bytes of a node: includes its text, its placement, and whether it was visited.
const NODE_BYTES: usize = size_of::<Node>() + 3 * SLOT + size_of::<Option<Box<Placement>>>();
const SLOT: usize = size_of::<usize>();
const VALUE_BYTES: usize = GROWN * size_of::<Value>();
/// Bytes of a channel or a sampler of an animation.
const PART_BYTES: usize =
    if size_of::<Channel>() > size_of::<Sampler>() { size_of::<Channel>() } else { size_of::<Sampler>() };

/// The lists at the root that the parser knows, with their prices.
const PRICES: &[(&str, Prices)] = &[
    ("nodes", Prices { list: size_of::<Placement>() + 4, value: GROWN * 4, ..entries(NODE_BYTES) }),
    (
        "accessors",
        Prices {
            list: size_of::<Value>(),
            value: VALUE_BYTES,
            member: VALUE_BYTES + 2 * MAP_NODE_BYTES / 5,
            members: 5,
            ..entries(size_of::<Accessor>())
        },
    ),
    (
        "meshes",
        Prices {
            list: size_of::<Primitive>(),
            value: GROWN * 4,
            object: GROWN * size_of::<Primitive>() + 2 * MAP_ENTRY_BYTES,
            inner: MAP_NODE_BYTES,
            member: 2 * MAP_ENTRY_BYTES,
            members: 6,
            ..entries(size_of::<Mesh>())
        },
    ),
    ("animations", Prices { list: PART_BYTES, object: GROWN * PART_BYTES, ..entries(size_of::<Animation>()) }),
    ("buffers", entries(size_of::<Buffer>() + 3 * SLOT)),
    // includes its text and its decoded bytes
    ("bufferViews", entries(size_of::<View>() + 2 * SLOT + MAP_ENTRY_BYTES)),
    ("cameras", entries(size_of::<Camera>())),
    ("images", entries(size_of::<Image>())),
    ("materials", entries(size_of::<Material>())),
    ("samplers", entries(size_of::<texture::Sampler>())),
    ("scenes", Prices { value: GROWN * 4, ..entries(size_of::<Scene>()) }),
    ("skins", Prices { value: GROWN * 4, ..entries(size_of::<Skin>()) }),
    ("textures", entries(size_of::<Texture>())),
    ("extensionsUsed", entries(size_of::<String>())),
    ("extensionsRequired", entries(size_of::<String>())),
];

/// Returns the prices of a list by its name in the text; a name with escapes gets the maximum of all prices.
fn prices_as_written(name: &[u8]) -> Prices {
    if !name.contains(&b'\\') {
        return PRICES.iter().find(|(known, _)| known.as_bytes() == name).map_or(FREE, |(_, prices)| *prices);
    }
    let dearest = |a: Prices, (_, b): &(&str, Prices)| Prices {
        entry: a.entry.max(b.entry),
        list: a.list.max(b.list),
        value: a.value.max(b.value),
        object: a.object.max(b.object),
        inner: a.inner.max(b.inner),
        member: a.member.max(b.member),
        members: a.members.min(b.members),
    };
    PRICES.iter().fold(FREE, dearest)
}

/// The state of the count.
#[derive(Debug, Default)]
struct GltfCensus<'a> {
    depth: usize,
    /// The last string at the root level, which is the name of the following value.
    name: &'a [u8],
    prices: Prices,
    /// Entries of the current list, and its memory in bytes.
    entries: usize,
    bytes: usize,
    /// Members of the current entry, and the maximum over all entries.
    members: usize,
    most_members: usize,
    /// The list with the most memory: name, entries, bytes.
    largest: (&'a [u8], usize, usize),
    all: usize,
}

/// Takes from the room the memory for parsing a document.
///
/// # Errors
/// The document takes more than the file may take; the message names the list that takes most.
pub(super) fn admit(json: &[u8], room: &mut MemoryBudget) -> Result<(), String> {
    let mut census = GltfCensus::default();
    let mut at = 0;
    while let Some(&byte) = json.get(at) {
        at = if byte == b'"' {
            let end = end_of_text(json, at + 1);
            if census.depth == 1 {
                census.name = json.get(at + 1..end).unwrap_or_default();
            }
            end + 1
        } else {
            census.count(byte);
            at + 1
        };
    }
    census.close();
    let bytes = census.all.saturating_add(TEXT_COPIES * json.len());
    if room.has(bytes) {
        return room.take(bytes);
    }
    let (name, entries, of_list) = census.largest;
    let name = quoted(&String::from_utf8_lossy(name));
    room.take(bytes).map_err(|detail| format!("{name}: {entries} entries take {of_list} bytes: {detail}"))
}

/// Returns the end of the string that starts at `start`.
fn end_of_text(json: &[u8], start: usize) -> usize {
    let mut at = start;
    while let Some(&byte) = json.get(at) {
        match byte {
            b'"' => return at,
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
    json.len()
}

impl GltfCensus<'_> {
    fn count(&mut self, byte: u8) {
        let prices = self.prices;
        let depth = self.depth;
        match byte {
            b'[' | b'{' => {
                self.depth += 1;
                match (byte, depth) {
                    (b'[', 1) => self.enter(),
                    (b'{', 2) => self.members = 0,
                    (b'{', 4) => self.add(prices.object),
                    (b'{', 5..) => self.add(prices.inner),
                    (b'[', 3..) => self.add(prices.list + prices.value),
                    _ => {}
                }
            }
            b']' | b'}' => {
                self.depth = depth.saturating_sub(1);
                if self.depth == 1 {
                    self.close();
                }
            }
            b',' if depth == 2 => self.enter(),
            b',' if depth > 3 => self.add(prices.value),
            // the members of the root, and of one entry at a time, are kept as raw text
            b':' if depth == 1 => self.all = self.all.saturating_add(MAP_ENTRY_BYTES),
            b':' if depth == 3 => {
                self.members += 1;
                if self.members > self.most_members {
                    self.most_members = self.members;
                    self.all = self.all.saturating_add(MAP_ENTRY_BYTES);
                }
            }
            b':' if depth >= prices.members => self.add(prices.member),
            _ => {}
        }
    }

    /// Counts an entry of a list at the root.
    fn enter(&mut self) {
        if self.bytes == 0 && self.entries == 0 {
            self.prices = prices_as_written(self.name);
        }
        self.entries += 1;
        self.add(self.prices.entry);
    }

    fn add(&mut self, bytes: usize) {
        self.bytes = self.bytes.saturating_add(bytes);
    }

    /// Ends a value at the root level.
    fn close(&mut self) {
        if self.bytes >= self.largest.2 {
            self.largest = (self.name, self.entries, self.bytes);
        }
        self.all = self.all.saturating_add(self.bytes);
        (self.prices, self.entries, self.bytes) = (FREE, 0, 0);
    }
}
