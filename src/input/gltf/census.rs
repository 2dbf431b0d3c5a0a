//! What a glTF document will take of memory, counted in its text before anything is made of it.
//!
//! The reader of the document makes a structure of hundreds of bytes of each `{}`. This looks at brackets, commas and
//! colons only: text that is no JSON is refused later, and up to the place where it is wrong the counts are right.

use std::mem::size_of;

use gltf::json::animation::{Animation, Channel, Sampler};
use gltf::json::buffer::{Buffer, View};
use gltf::json::material::Material;
use gltf::json::mesh::{Mesh, Primitive};
use gltf::json::{Accessor, Camera, Image, Node, Scene, Skin, Texture, Value, texture};

use super::transform::Placement;
use crate::input::room::{GROWN, Room};
use crate::input::text::quoted;

/// Copies of the text at worst: names and extras as they are, and what takes the escapes out of them as it grows.
const TEXT: usize = 4;
/// Bytes of an entry of a `BTreeMap` of small keys and values: nodes of eleven, of which five may be in use.
const IN_MAP: usize = 96;
/// Bytes of the first node of such a map.
const MAP: usize = 512;
/// Deeper than that the reader of JSON does not go.
const MAX_DEPTH: usize = 128;

/// What the parts of a list at the root take, bytes.
#[derive(Debug, Clone, Copy, Default)]
struct Prices {
    /// An entry of the list.
    entry: usize,
    /// A list within an entry; a list of one entry has room for four.
    list: usize,
    /// An entry of such a list.
    value: usize,
    /// An object in a list right in an entry: a primitive.
    object: usize,
    /// An object further within.
    inner: usize,
    /// A member of an object, from `members` open brackets on.
    member: usize,
    members: usize,
}

/// What the entries of a list at the root take; of what the reader does not know it makes nothing.
fn prices(list: &[u8]) -> Prices {
    let none = Prices { members: MAX_DEPTH, ..Prices::default() };
    let of = |size: usize| Prices { entry: GROWN * size, ..none };
    let slot = size_of::<usize>();
    match list {
        // its text, its place, and whether it was seen
        b"nodes" => {
            let entry = size_of::<Node>() + 2 * slot + size_of::<Option<Box<Placement>>>();
            Prices { list: size_of::<Placement>() + 4, value: GROWN * 4, ..of(entry + slot) }
        }
        b"accessors" => {
            let (list, value) = (size_of::<Value>(), GROWN * size_of::<Value>());
            Prices { list, value, member: value + 2 * MAP / 5, members: 5, ..of(size_of::<Accessor>()) }
        }
        b"meshes" => {
            let list = size_of::<Primitive>();
            let (object, member) = (GROWN * list + 2 * IN_MAP, 2 * IN_MAP);
            Prices { list, value: GROWN * 4, object, inner: MAP, member, members: 6, ..of(size_of::<Mesh>()) }
        }
        b"animations" => {
            let part = size_of::<Channel>().max(size_of::<Sampler>());
            Prices { list: part, object: GROWN * part, ..of(size_of::<Animation>()) }
        }
        b"buffers" => of(size_of::<Buffer>() + 3 * slot),
        // and its text, and where its stream is unpacked
        b"bufferViews" => of(size_of::<View>() + 2 * slot + IN_MAP),
        b"cameras" => of(size_of::<Camera>()),
        b"images" => of(size_of::<Image>()),
        b"materials" => of(size_of::<Material>()),
        b"samplers" => of(size_of::<texture::Sampler>()),
        b"scenes" => Prices { value: GROWN * 4, ..of(size_of::<Scene>()) },
        b"skins" => Prices { value: GROWN * 4, ..of(size_of::<Skin>()) },
        b"textures" => of(size_of::<Texture>()),
        b"extensionsUsed" | b"extensionsRequired" => of(size_of::<String>()),
        _ => none,
    }
}

/// The lists at the root that the reader knows.
const LISTS: &[&str] = &[
    "nodes",
    "accessors",
    "meshes",
    "animations",
    "buffers",
    "bufferViews",
    "cameras",
    "images",
    "materials",
    "samplers",
    "scenes",
    "skins",
    "textures",
    "extensionsUsed",
    "extensionsRequired",
];

/// The prices of a list by its name as it is written: one with escapes may be any.
fn prices_as_written(name: &[u8]) -> Prices {
    if !name.contains(&b'\\') {
        return prices(name);
    }
    let dearest = |a: Prices, b: Prices| Prices {
        entry: a.entry.max(b.entry),
        list: a.list.max(b.list),
        value: a.value.max(b.value),
        object: a.object.max(b.object),
        inner: a.inner.max(b.inner),
        member: a.member.max(b.member),
        members: a.members.min(b.members),
    };
    LISTS.iter().map(|list| prices(list.as_bytes())).fold(prices(b""), dearest)
}

/// What has been counted of a document.
#[derive(Debug, Default)]
struct Census<'a> {
    depth: usize,
    /// The last text at the root, which is the name of what follows.
    name: &'a [u8],
    prices: Prices,
    /// Entries of the list that is being counted, and what it takes.
    entries: usize,
    bytes: usize,
    /// Members of the entry that is being counted, and the most of one.
    members: usize,
    most_members: usize,
    /// The list that takes most: name, entries, bytes.
    largest: (&'a [u8], usize, usize),
    all: usize,
}

/// Takes what reading a document needs.
///
/// # Errors
/// The list that takes most, where it is more than the file may take.
pub(super) fn admit(json: &[u8], room: &mut Room) -> Result<(), String> {
    let mut census = Census::default();
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
    let bytes = census.all.saturating_add(TEXT * json.len());
    if room.has(bytes) {
        return room.take(bytes);
    }
    let (name, entries, of_list) = census.largest;
    let name = quoted(&String::from_utf8_lossy(name));
    room.take(bytes).map_err(|detail| format!("{name}: {entries} entries take {of_list} bytes: {detail}"))
}

/// Where a text ends that starts here.
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

impl Census<'_> {
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
            // the members of the root, and of one entry at a time, are kept as they are
            b':' if depth == 1 => self.all = self.all.saturating_add(IN_MAP),
            b':' if depth == 3 => {
                self.members += 1;
                if self.members > self.most_members {
                    self.most_members = self.members;
                    self.all = self.all.saturating_add(IN_MAP);
                }
            }
            b':' if depth >= prices.members => self.add(prices.member),
            _ => {}
        }
    }

    /// An entry of a list at the root.
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

    /// Ends what stands at the root.
    fn close(&mut self) {
        if self.bytes >= self.largest.2 {
            self.largest = (self.name, self.entries, self.bytes);
        }
        self.all = self.all.saturating_add(self.bytes);
        (self.prices, self.entries, self.bytes) = (Prices { members: MAX_DEPTH, ..Prices::default() }, 0, 0);
    }
}
