//! glTF 2.0 as one text file, the buffer inside as base64.

use std::io::Write;

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;

use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::counts::Counts;
use crate::output::error::FormatError;
use crate::output::format::{Content, Format, FormatFacts};
use crate::output::gltf_amounts::{self, Amounts, Contents};
use crate::output::gltf_buffer::{Buffer, buffered};
use crate::output::gltf_document::{PARAMETERS, document};
use crate::output::hard_edges;
use crate::output::numbers::total;
use crate::output::scene::Scene;
use crate::output::size::Size;
use crate::output::stream::holds_space;
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
    holds_frames: true,
    holds: |kind, _| holds_space("gltf", kind),
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

    fn memory(&self, counts: &Counts, options: &Values) -> u128 {
        hard_edges::memory(counts, options)
    }

    fn write(
        &self,
        scene: &Scene<'_>,
        options: &Values,
        out: &mut dyn Write,
        watch: &Watch,
    ) -> Result<(), FormatError> {
        buffered(scene, options, watch, |buffer| write(buffer, out, watch))
    }
}

fn write(buffer: &Buffer<'_>, out: &mut dyn Write, watch: &Watch) -> Result<(), FormatError> {
    let json = document(buffer, Some(URI))?;
    let Some(start) = json.windows(URI.len()).position(|text| text == URI.as_bytes()) else {
        return Ok(out.write_all(&json)?);
    };
    let (before, after) = json.split_at(start + URI.len());
    out.write_all(before)?;
    let mut base64 = EncoderWriter::new(out, &STANDARD);
    buffer.write(&mut base64, watch)?;
    Ok(base64.finish()?.write_all(after)?)
}
