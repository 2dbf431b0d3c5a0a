//! The streams of `EXT_meshopt_compression`.
//!
//! Source: A. Kapoulkine, glTF extension `EXT_meshopt_compression` (2021), appendix A: vertex codec version 0, index
//! codec version 1, octahedral filter.

use std::io;

use meshoptimizer_rs::codec::{
    IndexEncoding, VertexEncoding, encode_filter_oct, encode_index_buffer, encode_vertex_buffer,
};
use meshoptimizer_rs::{Error, Workspace};
use serde_json::{Value, json};

use crate::output::error::FormatError;

/// Bits of an octahedral coordinate of a normal, which is off by up to 1.2 degrees. At half of it normals are off by up
/// to 16 degrees, which shows as facets; twice of it takes 2.5 times as many bytes.
const NORMAL_BITS: u32 = 8;

/// Converts an error of a codec, which only a fault of planish can cause.
pub(super) fn broken(error: Error) -> FormatError {
    FormatError::Io(io::Error::other(format!("a mesh could not be compressed: {error}")))
}

/// A view of a buffer as a stream.
#[derive(Debug)]
pub(super) struct EncodedStream {
    /// The stream.
    pub(super) bytes: Vec<u8>,
    count: usize,
    stride: usize,
    mode: &'static str,
    filter: Option<&'static str>,
}

impl EncodedStream {
    /// Encodes rows of `stride` bytes, a multiple of 4 of at most 256, without loss.
    pub(super) fn rows(rows: &[u8], stride: usize, workspace: &mut Workspace) -> Result<Self, FormatError> {
        let count = rows.len() / stride;
        let encoding = VertexEncoding::new(0, 0).map_err(broken)?;
        let bytes = encode_vertex_buffer(rows, count, stride, encoding, workspace).map_err(broken)?;
        Ok(Self { bytes, count, stride, mode: "ATTRIBUTES", filter: None })
    }

    /// Encodes unit vectors, which are decoded as four `i8` each, the last of which has no meaning.
    pub(super) fn directions(rows: &[[f32; 3]], workspace: &mut Workspace) -> Result<Self, FormatError> {
        const STRIDE: usize = 4;
        let padded: Vec<f32> = rows.iter().flat_map(|&[x, y, z]| [x, y, z, 0.0]).collect();
        let filtered = encode_filter_oct(rows.len(), STRIDE, NORMAL_BITS, &padded, workspace).map_err(broken)?;
        Ok(Self { filter: Some("OCTAHEDRAL"), ..Self::rows(&filtered, STRIDE, workspace)? })
    }

    /// Encodes triangles, which are decoded as indices of `stride` bytes; the corners of a triangle may be rotated.
    pub(super) fn triangles(
        triangles: &[[u32; 3]],
        stride: usize,
        workspace: &mut Workspace,
    ) -> Result<Self, FormatError> {
        let corners = triangles.as_flattened();
        let bytes = encode_index_buffer(corners, IndexEncoding::DEFAULT, workspace).map_err(broken)?;
        Ok(Self { bytes, count: corners.len(), stride, mode: "TRIANGLES", filter: None })
    }

    /// Returns the entry of the extension for the stream, which starts at byte `offset` of the first buffer.
    pub(super) fn extension_entry(&self, offset: usize) -> Value {
        let mut entry = json!({
            "buffer": 0, "byteOffset": offset, "byteLength": self.bytes.len(), "byteStride": self.stride,
            "count": self.count, "mode": self.mode,
        });
        if let Some(filter) = self.filter {
            entry["filter"] = filter.into();
        }
        entry
    }
}

#[cfg(test)]
mod tests {
    use meshoptimizer_rs::codec::{BufferView, Filter, Mode};

    use super::*;
    use crate::output::gltf_order::workspace;

    /// Returns the bytes that a reader of the extension decodes from a stream.
    fn decoded(encoded: &EncodedStream) -> Vec<u8> {
        let mode = Mode::parse(encoded.mode).expect("a known mode");
        let filter = Filter::parse(encoded.filter.unwrap_or("NONE")).expect("a known filter");
        let view = BufferView::new(mode, filter, encoded.count, encoded.stride).expect("a layout");
        view.decode(&encoded.bytes, &mut workspace()).expect("a stream")
    }

    #[test]
    fn rows_are_restored_bit_for_bit() {
        for stride in [4, 8, 12, 16] {
            for count in [1_usize, 15, 16, 17, 255, 256, 257, 2_000] {
                let byte = |i: usize| u8::try_from(((i * i / 7) ^ (i >> 3)) % 256).expect("below 256");
                let rows: Vec<u8> = (0..count * stride).map(byte).collect();
                let encoded = EncodedStream::rows(&rows, stride, &mut workspace()).expect("it is encoded");
                assert_eq!(decoded(&encoded), rows, "{count} rows of {stride} bytes");
                assert_eq!(encoded.bytes[0], 0xa0, "version 0, which all decoders of the extension read");
            }
        }
    }

    #[test]
    fn triangles_are_restored_but_for_turns() {
        let triangles: Vec<[u32; 3]> = (0..3_000_u32).map(|i| [i / 2, (i * 7) % 1_501, i / 2 + 1]).collect();
        for stride in [2, 4] {
            let encoded = EncodedStream::triangles(&triangles, stride, &mut workspace()).expect("it is encoded");
            let found = decoded(&encoded);
            let number = |bytes: &[u8]| bytes.iter().rev().fold(0, |n, &byte| 256 * n + u32::from(byte));
            let corners: Vec<u32> = found.chunks_exact(stride).map(number).collect();
            assert_eq!(corners.len(), 9_000);
            for (&[a, b, c], found) in triangles.iter().zip(corners.as_chunks::<3>().0) {
                assert!([[a, b, c], [b, c, a], [c, a, b]].contains(found), "{found:?} for {:?}", [a, b, c]);
            }
        }
    }

    #[test]
    fn directions_turn_by_1_2_degrees_at_most() {
        let steps = || (-20_i16..=20).map(f32::from);
        let all = steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| [x, y, z])));
        let unit = |v: [f32; 3]| {
            let length = v.iter().map(|x| x * x).sum::<f32>().sqrt();
            v.map(|x| x / length)
        };
        let rows: Vec<[f32; 3]> = all.filter(|v| v.iter().any(|&x| x != 0.0)).map(unit).collect();
        let found = decoded(&EncodedStream::directions(&rows, &mut workspace()).expect("it is encoded"));
        for (row, found) in rows.iter().zip(found.as_chunks::<4>().0) {
            let found = unit([found[0], found[1], found[2]].map(|x| f32::from(x.cast_signed())));
            let cosine: f32 = row.iter().zip(found).map(|(x, y)| x * y).sum();
            assert!(cosine >= 0.999_78, "{row:?} became {found:?}");
        }
    }
}
