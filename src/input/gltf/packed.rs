//! Decoder of buffer views that are compressed with `EXT_meshopt_compression`.
//!
//! Source: A. Kapoulkine, glTF extension `EXT_meshopt_compression` (2021).

use std::borrow::Cow;
use std::collections::BTreeMap;

use meshoptimizer_rs::codec::{BufferView, Filter, Mode};
use meshoptimizer_rs::{Limits, Workspace};
use serde_json::value::RawValue;

use super::transform::RawMembers;
use crate::input::room::MemoryBudget;

/// The name of the extension, whose fallback buffers need no data.
pub(super) const PACKED: &str = "EXT_meshopt_compression";

/// Maximum number of bytes that decoding takes per decoded byte: the result, and indices of 32 bits before they are
/// stored as 16.
const DECODING_BYTES_A_BYTE: usize = 4;
/// Bytes that decoding takes whatever the length of the result: blocks of rows.
const DECODING_BASE_BYTES: usize = 1 << 16;

/// The parameters of a compressed stream.
struct PackedStream {
    buffer: usize,
    byte_offset: usize,
    byte_length: usize,
    byte_stride: usize,
    count: usize,
    mode: String,
    filter: Option<String>,
}

/// Decodes all compressed views from the bytes of the buffers, and returns them by index.
///
/// # Errors
/// A stream is broken or takes more than the room has.
pub(super) fn views(
    json: &[u8],
    buffers: &[Cow<'_, [u8]>],
    room: &mut MemoryBudget,
) -> Result<BTreeMap<usize, Vec<u8>>, String> {
    let mut found = BTreeMap::new();
    let unread = |error: serde_json::Error| crate::fault::cut(&error.to_string(), 200).into_owned();
    let document: RawMembers<'_> = serde_json::from_slice(json).map_err(unread)?;
    let Some(views) = document.get("bufferViews") else { return Ok(found) };
    let views: Vec<&RawValue> = serde_json::from_str(views.get()).map_err(unread)?;
    for (i, view) in views.into_iter().enumerate() {
        let place = |detail: String| format!("bufferView {i}: its stream {PACKED}: {detail}");
        let said = |text: &str| -> serde_json::Result<Option<PackedStream>> {
            let view: RawMembers<'_> = serde_json::from_str(text)?;
            let Some(extensions) = view.get("extensions") else { return Ok(None) };
            let extensions: RawMembers<'_> = serde_json::from_str(extensions.get())?;
            extensions.get(PACKED).map(|stream| PackedStream::of(stream.get())).transpose()
        };
        if let Some(stream) = said(view.get()).map_err(unread).map_err(place)? {
            found.insert(i, stream.bytes(buffers, room).map_err(place)?);
        }
    }
    Ok(found)
}

impl PackedStream {
    /// Parses the extension object of a view.
    fn of(text: &str) -> serde_json::Result<Self> {
        let members: RawMembers<'_> = serde_json::from_str(text)?;
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

    /// Decodes the stream, and takes its memory from the room.
    fn bytes(&self, buffers: &[Cow<'_, [u8]>], room: &mut MemoryBudget) -> Result<Vec<u8>, String> {
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
        let most = bytes.saturating_mul(DECODING_BYTES_A_BYTE).saturating_add(DECODING_BASE_BYTES);
        room.take(most)?;
        let mut workspace = Workspace::new(Limits { max_bytes: most, ..Limits::default() });
        let found = view.decode(source, &mut workspace).map_err(|error| format!("it is broken ({error})"));
        room.give(most - bytes);
        found
    }
}
