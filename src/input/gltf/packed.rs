//! Views of buffers that are streams of `EXT_meshopt_compression`.
//!
//! Source: A. Kapoulkine, glTF extension `EXT_meshopt_compression` (2021).

use std::borrow::Cow;
use std::collections::BTreeMap;

use meshoptimizer_rs::codec::{BufferView, Filter, Mode};
use meshoptimizer_rs::{Limits, Workspace};
use serde_json::value::RawValue;

use crate::input::room::Room;

/// The extension, whose buffers that hold nothing but room need no data.
pub(super) const PACKED: &str = "EXT_meshopt_compression";

/// Bytes that decoding takes at most for each byte of what is made: the result, and indices of 32 bits before they are
/// written as 16.
const EACH: usize = 4;
/// The same whatever is made: blocks of rows.
const LEAST: usize = 1 << 16;

/// What is said of a stream.
struct Stream {
    buffer: usize,
    byte_offset: usize,
    byte_length: usize,
    byte_stride: usize,
    count: usize,
    mode: String,
    filter: Option<String>,
}

/// The members of an object, unread.
type Members<'a> = BTreeMap<String, &'a RawValue>;

/// The bytes of all views that are streams, by their numbers, given those of the buffers.
///
/// # Errors
/// A stream that is broken, or that comes to more than there is room for.
pub(super) fn views(
    json: &[u8],
    buffers: &[Cow<'_, [u8]>],
    room: &mut Room,
) -> Result<BTreeMap<usize, Vec<u8>>, String> {
    let mut found = BTreeMap::new();
    let unread = |error: serde_json::Error| crate::fault::cut(&error.to_string(), 200).into_owned();
    let document: Members<'_> = serde_json::from_slice(json).map_err(unread)?;
    let Some(views) = document.get("bufferViews") else { return Ok(found) };
    let views: Vec<&RawValue> = serde_json::from_str(views.get()).map_err(unread)?;
    for (i, view) in views.into_iter().enumerate() {
        let place = |detail: String| format!("bufferView {i}: its stream {PACKED}: {detail}");
        let said = |text: &str| -> serde_json::Result<Option<Stream>> {
            let view: Members<'_> = serde_json::from_str(text)?;
            let Some(extensions) = view.get("extensions") else { return Ok(None) };
            let extensions: Members<'_> = serde_json::from_str(extensions.get())?;
            extensions.get(PACKED).map(|stream| Stream::of(stream.get())).transpose()
        };
        if let Some(stream) = said(view.get()).map_err(unread).map_err(place)? {
            found.insert(i, stream.bytes(buffers, room).map_err(place)?);
        }
    }
    Ok(found)
}

impl Stream {
    /// What an object says.
    fn of(text: &str) -> serde_json::Result<Self> {
        let members: Members<'_> = serde_json::from_str(text)?;
        let text = |name: &str| members.get(name).map_or("null", |value| value.get());
        let number = |name: &str| serde_json::from_str(text(name));
        Ok(Self {
            buffer: number("buffer")?,
            byte_offset: if members.contains_key("byteOffset") { number("byteOffset")? } else { 0 },
            byte_length: number("byteLength")?,
            byte_stride: number("byteStride")?,
            count: number("count")?,
            mode: serde_json::from_str(text("mode"))?,
            filter: serde_json::from_str(text("filter"))?,
        })
    }

    /// What the stream stands for, which is taken from the room.
    fn bytes(&self, buffers: &[Cow<'_, [u8]>], room: &mut Room) -> Result<Vec<u8>, String> {
        let Self { buffer: b, byte_offset: start, byte_length: length, byte_stride: stride, count, mode, filter } =
            self;
        let buffer = buffers.get(*b).ok_or_else(|| format!("there is no buffer {b}"))?;
        let source = start.checked_add(*length).and_then(|end| buffer.get(*start..end));
        let source = source.ok_or_else(|| {
            format!("{length} bytes from byte {start}; buffer {b} has {}; send it whole", buffer.len())
        })?;
        let said = Mode::parse(mode).and_then(|mode| {
            let filter = Filter::parse(filter.as_deref().unwrap_or("NONE"))?;
            BufferView::new(mode, filter, *count, *stride)
        });
        let view = said.map_err(|_| format!("{count} rows of {stride} bytes are not packed so; export it again"))?;
        let bytes = view.byte_length();
        let most = bytes.saturating_mul(EACH).saturating_add(LEAST);
        room.take(most)?;
        let mut workspace = Workspace::new(Limits { max_bytes: most, ..Limits::default() });
        let found = view.decode(source, &mut workspace).map_err(|error| format!("it is broken ({error})"));
        room.give(most - bytes);
        found
    }
}
