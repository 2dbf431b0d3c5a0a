//! Compressed streams for PDF files.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::drawing::error::DrawError;

/// Compresses bytes by deflate.
pub(super) fn packed(bytes: &[u8]) -> Result<Vec<u8>, DrawError> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes)?;
    Ok(encoder.finish()?)
}
