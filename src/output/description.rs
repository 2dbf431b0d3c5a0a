//! Descriptions of jobs in files: a description is inserted into the bytes of a format while they are written, and can
//! be read back from them.
//!
//! A description consists of printable ASCII characters, so that it may stand anywhere in a file. All other bytes stay
//! as they are.

use std::io::{self, Write};

use flate2::Crc;
use quick_xml::escape::partial_escape;
use serde_json::Value;

use super::numbers::total;
use super::size::Size;

/// The name of a description, or the text before it.
const DESCRIPTION_NAME: &str = "planish-job";
/// Number of characters of a description in one line of comments. Some programs read lines of headers into buffers of
/// 4,096 bytes. Half of it makes twice as many lines; four times of it would be cut there.
const LINE_CHARS: usize = 1024;
/// Maximum number of bytes that are buffered in search of the place of the description. Half of it is still more than
/// glTF documents have before their `asset`; twice of it buffers more of bytes that have no place for a description.
const MAX_BYTES_BEFORE: usize = 64 << 20;

/// The place of the description of a job in the files of a format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DescriptionPlace {
    /// The description is a chunk `tEXt` after the first chunk of a PNG.
    Png,
    /// The description is an element `metadata`, the first of an SVG.
    Svg,
    /// The description is in the extras of the asset of a glTF document.
    Gltf,
    /// The description is in the extras of the asset of a glTF document, in the first chunk of a GLB.
    Glb,
    /// The description is in comments with this keyword, after this number of lines.
    Lines(&'static str, usize),
}

/// Returns the size of bytes with a description at `place`, given their size without it. Where formats have no place,
/// nothing is added.
pub fn size(place: Option<DescriptionPlace>, description: &str, bare: Size) -> Size {
    let Some(place) = place else { return bare };
    let added = place.written(description).len() as u128;
    let with = |bytes| total(&[(1, bytes), (1, added)]);
    match bare {
        Size::Exact(bytes) => Size::Exact(with(bytes)),
        Size::AtMost(bytes) => Size::AtMost(with(bytes)),
    }
}

impl DescriptionPlace {
    /// Returns the bytes that are inserted.
    fn written(self, description: &str) -> Vec<u8> {
        match self {
            Self::Png => {
                let mut chunk = [b"tEXt", DESCRIPTION_NAME.as_bytes(), b"\0", description.as_bytes()].concat();
                let mut crc = Crc::new();
                crc.update(&chunk);
                let length = u32::try_from(chunk.len() - 4).unwrap_or(u32::MAX).to_be_bytes();
                chunk.extend(crc.sum().to_be_bytes());
                [&length[..], &chunk].concat()
            }
            Self::Svg => {
                let text = partial_escape(description);
                format!("<metadata id=\"{DESCRIPTION_NAME}\">{text}</metadata>\n").into_bytes()
            }
            Self::Gltf => format!("\"extras\":{{\"{DESCRIPTION_NAME}\":{description}}},").into_bytes(),
            Self::Glb => {
                // spaces keep the length of the chunk a multiple of four
                let mut extras = Self::Gltf.written(description);
                extras.resize(extras.len().next_multiple_of(4), b' ');
                extras
            }
            Self::Lines(keyword, _) => {
                let lines = description.as_bytes().chunks(LINE_CHARS);
                lines
                    .flat_map(|line| [format!("{keyword} {DESCRIPTION_NAME} ").as_bytes(), line, b"\n"].concat())
                    .collect()
            }
        }
    }

    /// Returns the offset in the bytes at which the description is inserted, if the bytes suffice to find it.
    fn find(self, bytes: &[u8]) -> Option<usize> {
        let after = |text: &[u8]| bytes.windows(text.len()).position(|part| part == text).map(|at| at + text.len());
        match self {
            // the signature, and the chunk IHDR
            Self::Png => (bytes.len() >= 33).then_some(33),
            Self::Svg => after(b">\n"),
            // within strings the quotes would be escaped
            Self::Gltf | Self::Glb => after(b"\"asset\":{"),
            Self::Lines(_, lines) => {
                bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n').nth(lines - 1).map(|(at, _)| at + 1)
            }
        }
    }
}

/// A writer that inserts a description into the bytes of a format.
#[expect(missing_debug_implementations, reason = "what bytes go to need not have one")]
pub struct Describing<'a> {
    out: &'a mut dyn Write,
    /// The description that is still to be inserted.
    put: Option<Put>,
}

/// A description that waits for its place.
struct Put {
    place: DescriptionPlace,
    text: Vec<u8>,
    /// The bytes before the place.
    before: Vec<u8>,
}

impl<'a> Describing<'a> {
    /// Wraps `out`; bytes pass unchanged if the format has no place for a description.
    pub fn new(place: Option<DescriptionPlace>, description: &str, out: &'a mut dyn Write) -> Self {
        let put = place.map(|place| Put { place, text: place.written(description), before: Vec::new() });
        Self { out, put }
    }

    /// Ends the bytes.
    ///
    /// # Errors
    /// The bytes had no place for the description.
    pub fn finish(self) -> io::Result<()> {
        if self.put.is_some() {
            return Err(io::Error::other("there was no place for the description"));
        }
        Ok(())
    }
}

impl Write for Describing<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some(put) = &mut self.put else { return self.out.write(bytes) };
        put.before.extend_from_slice(bytes);
        if let Some(at) = put.place.find(&put.before) {
            if put.place == DescriptionPlace::Glb {
                lengthen(&mut put.before, put.text.len())?;
            }
            let (before, after) = put.before.split_at(at);
            self.out.write_all(before)?;
            self.out.write_all(&put.text)?;
            self.out.write_all(after)?;
            self.put = None;
        } else if put.before.len() > MAX_BYTES_BEFORE {
            return Err(io::Error::other("there was no place for the description"));
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Adds to the lengths of a GLB and of its first chunk.
fn lengthen(head: &mut [u8], by: usize) -> io::Result<()> {
    for at in [8, 12] {
        let place: &mut [u8; 4] = &mut head[at..at + 4].try_into().map_err(io::Error::other)?;
        let length = u32::try_from(by).ok().and_then(|by| u32::from_le_bytes(*place).checked_add(by));
        let length = length.ok_or_else(|| io::Error::other("with its description the file is longer than a glb"))?;
        head[at..at + 4].copy_from_slice(&length.to_le_bytes());
    }
    Ok(())
}

/// Returns the description that a file holds, if any.
pub fn description(bytes: &[u8]) -> Option<String> {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).ok();
    if let Some(chunks) = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n") {
        return of_png(chunks).and_then(text);
    }
    if bytes.starts_with(b"glTF") {
        let length = u32::from_le_bytes(bytes.get(12..16)?.try_into().ok()?) as usize;
        return of_gltf(bytes.get(20..)?.get(..length)?);
    }
    if bytes.starts_with(b"{") {
        return of_gltf(bytes);
    }
    if bytes.starts_with(b"<svg") {
        let start = format!("<metadata id=\"{DESCRIPTION_NAME}\">");
        let rest = std::str::from_utf8(bytes).ok()?.split_once(&start)?.1.split_once("</metadata>")?.0;
        return Some(rest.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"));
    }
    let keyword = if bytes.starts_with(b"ply") { "comment" } else { "#" };
    let start = format!("{keyword} {DESCRIPTION_NAME} ");
    // the description is in one piece among the first lines
    let lines = bytes.split(|byte| *byte == b'\n').skip_while(|line| !line.starts_with(start.as_bytes()));
    let lines: Vec<&[u8]> = lines.map_while(|line| line.strip_prefix(start.as_bytes())).collect();
    if lines.is_empty() { None } else { text(&lines.concat()) }
}

fn of_png(mut chunks: &[u8]) -> Option<&[u8]> {
    loop {
        let (length, rest) = chunks.split_first_chunk::<4>()?;
        let (kind, rest) = rest.split_first_chunk::<4>()?;
        let (content, rest) = rest.split_at_checked(u32::from_be_bytes(*length) as usize)?;
        if kind == b"tEXt"
            && let Some(text) =
                content.strip_prefix(DESCRIPTION_NAME.as_bytes()).and_then(|text| text.strip_prefix(b"\0"))
        {
            return Some(text);
        }
        chunks = rest.get(4..)?;
    }
}

fn of_gltf(document: &[u8]) -> Option<String> {
    let document: Value = serde_json::from_slice(document).ok()?;
    Some(document.get("asset")?.get("extras")?.get(DESCRIPTION_NAME)?.to_string())
}
