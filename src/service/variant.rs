//! Compressed variants: the bytes of an artifact in a content coding of HTTP, made once and kept under a key of their
//! own like any artifact.

use std::io::{self, Write};

use bytes::Bytes;
use flate2::Compression;
use flate2::write::GzEncoder;

use super::task::{Cost, Task};
use crate::job::key::{Key, content};
use crate::job::{KeepWork, Report, RunError};
use crate::watch::Watch;

/// Version of the variants: raised when an encoder or its effort changes, so that one ETag never names two different
/// sequences of bytes.
const VARIANTS_VERSION: u32 = 1;
/// Efforts of the encoders: the next higher effort takes at least twice the time for a tenth fewer bytes. Decision 0023
/// has the numbers.
const ZSTD_LEVEL: i32 = 3;
const BROTLI_QUALITY: u32 = 2;
const GZIP_LEVEL: u32 = 2;
/// Window of brotli as a power of two: 4 MiB, which holds a whole result of the usual size. Half of it would miss
/// repetitions in larger results; twice of it would double the memory of an encoder.
const BROTLI_WINDOW_LOG: u32 = 22;
/// Upper bound of the memory of an encoder besides its output, in bytes: that of brotli, whose tables and window are
/// the largest.
const ENCODER_BYTES: u128 = 32 << 20;
/// Bytes that are encoded between two checks of the watch. Half of it would check twice as often; twice of it would
/// stop twice as late, after some 10 ms.
const ENCODE_STEP_BYTES: usize = 256 << 10;
/// A variant is kept if it is shorter than the artifact by at least this fraction, one part in `SPARED_DIVISOR`: less
/// is not worth its place in the cache. Half of the number would reject pictures that shrink by a fifth; twice of it
/// would keep variants that save a sixteenth.
const SPARED_DIVISOR: u64 = 8;

/// A content coding of HTTP.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Coding {
    /// Zstandard (RFC 8878).
    Zstd,
    /// Brotli (RFC 7932).
    Brotli,
    /// Gzip (RFC 1952).
    Gzip,
}

impl Coding {
    /// All codings; among those that a client accepts equally, the first is used. They are in the order of their speed:
    /// each makes fewer bytes in less time than the next, except brotli on texts.
    pub const ALL: [Self; 3] = [Self::Zstd, Self::Brotli, Self::Gzip];

    /// Returns the name in HTTP headers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Zstd => "zstd",
            Self::Brotli => "br",
            Self::Gzip => "gzip",
        }
    }

    /// Returns the suffix of the ETag of a variant.
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Zstd => "-zst",
            Self::Brotli => "-br",
            Self::Gzip => "-gz",
        }
    }

    /// Returns the key of the variant of an artifact.
    pub fn key(self, artifact: &Key) -> Key {
        content(format!("planish variant {VARIANTS_VERSION} {} of {artifact}", self.name()).as_bytes())
    }

    /// Returns the media type of a variant in the stores: no format has it, so that a variant is never taken for a
    /// result.
    fn media_type(self) -> &'static str {
        match self {
            Self::Zstd => "application/vnd.planish.variant+zstd",
            Self::Brotli => "application/vnd.planish.variant+br",
            Self::Gzip => "application/vnd.planish.variant+gzip",
        }
    }

    /// Returns the approximate number of bytes encoded per millisecond.
    fn bytes_a_ms(self) -> u128 {
        match self {
            Self::Zstd => 70_000,
            Self::Brotli => 35_000,
            Self::Gzip => 40_000,
        }
    }
}

/// Returns the bytes of a file in a coding; `None` if that does not save enough.
pub fn encoded(coding: Coding, bytes: Bytes) -> Option<Vec<u8>> {
    let task = Compress::new(&content(&bytes), coding, vec![bytes]);
    let made = task.encoded(&Watch::default()).ok()?;
    (!made.is_full).then_some(made.bytes)
}

/// The compression of an artifact; its result is empty if it does not save enough.
#[derive(Debug)]
pub struct Compress {
    key: Key,
    coding: Coding,
    parts: Vec<Bytes>,
    length: u64,
}

impl Compress {
    /// Creates the task that makes the variant of an artifact with these bytes.
    pub fn new(artifact: &Key, coding: Coding, parts: Vec<Bytes>) -> Self {
        let length = parts.iter().map(|part| part.len() as u64).sum();
        Self { key: coding.key(artifact), coding, parts, length }
    }

    /// Returns the maximum length of a variant that saves enough, in bytes.
    fn most(&self) -> u64 {
        self.length - self.length / SPARED_DIVISOR
    }

    /// Writes the bytes of the artifact to an encoder.
    fn feed(&self, encoder: &mut dyn Write, watch: &Watch) -> Result<(), RunError> {
        for piece in self.parts.iter().flat_map(|part| part.chunks(ENCODE_STEP_BYTES)) {
            watch.check().map_err(RunError::Stopped)?;
            encoder.write_all(piece).map_err(RunError::Io)?;
        }
        Ok(())
    }

    /// Returns the encoded bytes; none if they do not save enough.
    fn encoded(&self, watch: &Watch) -> Result<Pays, RunError> {
        let sink = Pays { bytes: Vec::new(), most: usize::try_from(self.most()).unwrap_or(usize::MAX), is_full: false };
        match self.coding {
            Coding::Zstd => {
                let mut encoder = zstd::stream::write::Encoder::new(sink, ZSTD_LEVEL).map_err(RunError::Io)?;
                encoder.set_pledged_src_size(Some(self.length)).map_err(RunError::Io)?;
                self.feed(&mut encoder, watch)?;
                encoder.finish().map_err(RunError::Io)
            }
            Coding::Brotli => {
                let buffer = 64 << 10;
                let mut encoder = brotli::CompressorWriter::new(sink, buffer, BROTLI_QUALITY, BROTLI_WINDOW_LOG);
                self.feed(&mut encoder, watch)?;
                Ok(encoder.into_inner())
            }
            Coding::Gzip => {
                let mut encoder = GzEncoder::new(sink, Compression::new(GZIP_LEVEL));
                self.feed(&mut encoder, watch)?;
                encoder.finish().map_err(RunError::Io)
            }
        }
    }
}

impl Task for Compress {
    fn key(&self) -> Key {
        self.key
    }

    fn cost(&self) -> Cost {
        let length = u128::from(self.length);
        Cost {
            memory_bytes: 2 * length + ENCODER_BYTES,
            time_ms: length / self.coding.bytes_a_ms(),
            work: length,
            result_bytes: self.most().into(),
        }
    }

    fn media_type(&self) -> &str {
        self.coding.media_type()
    }

    fn run(&self, out: &mut dyn Write, _: &dyn KeepWork, watch: &Watch) -> Result<Report, RunError> {
        let encoded = self.encoded(watch)?;
        if !encoded.is_full {
            out.write_all(&encoded.bytes).map_err(RunError::Io)?;
        }
        Ok(Report::default())
    }
}

/// Output of an encoder, as long as it saves enough; beyond `most` bytes everything is dropped.
struct Pays {
    bytes: Vec<u8>,
    most: usize,
    is_full: bool,
}

impl Write for Pays {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.is_full |= self.bytes.len() + bytes.len() > self.most;
        if self.is_full {
            self.bytes = Vec::new();
        } else {
            self.bytes.extend_from_slice(bytes);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
