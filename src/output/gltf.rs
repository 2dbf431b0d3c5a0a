//! glTF 2.0 as one text file, the buffer inside as base64.

use std::io::{self, Write};

use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::counts::Counts;
use crate::output::error::FormatError;
use crate::output::format::{Content, Format, FormatFacts};
use crate::output::gltf_amounts::{self, Amounts, Contents, with_normals};
use crate::output::gltf_buffer::Buffer;
use crate::output::gltf_document::{PARAMETERS, document};
use crate::output::numbers::total;
use crate::output::scene::Scene;
use crate::output::size::Size;
use crate::output::stream::holds_space;
use crate::output::vertex_sides::Sides;
use crate::watch::Watch;

const URI: &str = "data:application/octet-stream;base64,";

/// Self-contained glTF 2.0: the same content as GLB, with the buffer in a data URI.
#[derive(Debug)]
pub(super) struct Gltf;

const FACTS: &FormatFacts = &FormatFacts {
    name: "gltf",
    extension: "gltf",
    media_type: "model/gltf+json",
    content: Content::Json,
    doc: "Self-contained glTF 2.0 in JSON: as glb, with the numbers as base64",
    parameters: PARAMETERS,
    holds: |kind, _| holds_space("gltf", kind),
    shows_control: false,
};

impl Format for Gltf {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn fits(&self, counts: &Counts, options: &Values) -> Result<(), Fault> {
        gltf_amounts::fits(counts, options)
    }

    fn size(&self, counts: &Counts, options: &Values) -> Size {
        let binary = Amounts::of(counts, options).bytes();
        let json = Contents::of(counts, options).room();
        Size::AtMost(total(&[(json, 1), (URI.len() as u128, 1), (binary.div_ceil(3), 4)]))
    }

    fn write(
        &self,
        scene: &Scene<'_>,
        options: &Values,
        out: &mut dyn Write,
        watch: &Watch,
    ) -> Result<(), FormatError> {
        let sides = Sides::of(scene.shape);
        let parts = sides.split_vertices(with_normals(options), watch)?;
        let buffer = Buffer::of(&Scene { shape: parts.shape(), ..*scene }, parts.smooth(), options, watch)?;
        let json = document(&buffer, Some(URI))?;
        let Some(start) = json.windows(URI.len()).position(|text| text == URI.as_bytes()) else {
            return Ok(out.write_all(&json)?);
        };
        let (before, after) = json.split_at(start + URI.len());
        out.write_all(before)?;
        let mut base64 = Base64::new(out);
        buffer.write(&mut base64, watch)?;
        base64.finish()?;
        Ok(out.write_all(after)?)
    }
}

/// Encodes what is written to it. Source: RFC 4648, section 4.
struct Base64<'a> {
    out: &'a mut dyn Write,
    /// Bytes that do not fill a group of three yet.
    rest: Vec<u8>,
    text: Vec<u8>,
}

impl<'a> Base64<'a> {
    fn new(out: &'a mut dyn Write) -> Self {
        Self { out, rest: Vec::with_capacity(3), text: Vec::new() }
    }

    /// Writes the last, incomplete group.
    fn finish(mut self) -> io::Result<()> {
        let n = self.rest.len();
        if n == 0 {
            return Ok(());
        }
        self.rest.resize(3, 0);
        let mut last = letters([self.rest[0], self.rest[1], self.rest[2]]);
        last[n + 1..].fill(b'=');
        self.out.write_all(&last)
    }
}

impl Write for Base64<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let missing = if self.rest.is_empty() { 0 } else { 3 - self.rest.len() };
        let (head, body) = bytes.split_at(missing.min(bytes.len()));
        self.rest.extend_from_slice(head);
        let (begun, _) = self.rest.as_chunks::<3>();
        let (groups, tail) = body.as_chunks::<3>();
        self.text.clear();
        self.text.extend(begun.iter().chain(groups).flat_map(|group| letters(*group)));
        self.out.write_all(&self.text)?;
        if self.rest.len() == 3 {
            self.rest.clear();
        }
        self.rest.extend_from_slice(tail);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Four letters for three bytes.
fn letters([a, b, c]: [u8; 3]) -> [u8; 4] {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let bits = u32::from_be_bytes([0, a, b, c]);
    [18, 12, 6, 0].map(|shift| ALPHABET[(bits >> shift) as usize & 63])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_pieces_is_base64_of_the_whole() {
        for (bytes, expected) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            for cut in 0..=bytes.len() {
                let mut out = Vec::new();
                let mut base64 = Base64::new(&mut out);
                let (left, right) = bytes.as_bytes().split_at(cut);
                base64.write_all(left).and_then(|()| base64.write_all(right)).expect("a vector takes all");
                base64.finish().expect("a vector takes all");
                assert_eq!(String::from_utf8_lossy(&out), expected);
            }
        }
    }
}
