//! Compressed variants of artifacts: the bytes of an artifact in a content coding of HTTP, made once and kept under a
//! key of their own like any artifact.

use std::io::{self, Write};

use bytes::Bytes;
use flate2::Compression;
use flate2::write::GzEncoder;

use super::task::{Cost, Task};
use crate::job::key::{Key, content};
use crate::job::{KeepWork, Report, RunError};
use crate::watch::Watch;

/// Version of the variants: raised when an encoder or its effort changes, so that one ETag never names two texts.
const VERSION: u32 = 1;
/// Efforts, each the least beyond which the next takes twice the time or more for a tenth fewer bytes: decision 0023
/// has the numbers.
const ZSTD_LEVEL: i32 = 3;
const BROTLI_QUALITY: u32 = 2;
const GZIP_LEVEL: u32 = 2;
/// How far back brotli refers, as a power of two: 4 MiB, which holds a whole result of the usual size. Half of it sees
/// fewer repetitions in larger ones; twice of it takes twice the memory of an encoder.
const BROTLI_WINDOW_LOG: u32 = 22;
/// Memory of an encoder beside its output, at most: that of brotli, whose tables and window are the largest.
const ENCODER_BYTES: u128 = 32 << 20;
/// Bytes that are encoded between two looks at the watch.
/// Half of it looks twice as often; twice of it stops twice as late, after some 10 ms.
const PIECE_BYTES: usize = 256 << 10;
/// A variant is kept where it spares at least one part in so many: less is not worth its place in the cache. Half of it
/// gives up pictures that shrink by a fifth; twice of it keeps variants for a sixteenth.
const SPARED: u64 = 8;

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
    /// All of them; of those that a client likes equally it gets the first. The order is that of their speed: each
    /// makes fewer bytes in less time than the one behind it, but for brotli on texts.
    pub const ALL: [Self; 3] = [Self::Zstd, Self::Brotli, Self::Gzip];

    /// Its name in headers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Zstd => "zstd",
            Self::Brotli => "br",
            Self::Gzip => "gzip",
        }
    }

    /// What it adds to an ETag.
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Zstd => "-zst",
            Self::Brotli => "-br",
            Self::Gzip => "-gz",
        }
    }

    /// Key of the variant of an artifact.
    pub fn key(self, artifact: &Key) -> Key {
        content(format!("planish variant {VERSION} {} of {artifact}", self.name()).as_bytes())
    }

    /// The media type that a variant has in the stores: that of no format, so that it is never taken for a result.
    fn media_type(self) -> &'static str {
        match self {
            Self::Zstd => "application/vnd.planish.variant+zstd",
            Self::Brotli => "application/vnd.planish.variant+br",
            Self::Gzip => "application/vnd.planish.variant+gzip",
        }
    }

    /// Bytes that are encoded in a millisecond, about.
    fn bytes_a_ms(self) -> u128 {
        match self {
            Self::Zstd => 70_000,
            Self::Brotli => 35_000,
            Self::Gzip => 40_000,
        }
    }
}

/// The bytes of a file in a coding; `None` where that does not pay.
pub fn encoded(coding: Coding, bytes: Bytes) -> Option<Vec<u8>> {
    let task = Compress::new(&content(&bytes), coding, vec![bytes]);
    let made = task.encoded(&Watch::default()).ok()?;
    (!made.is_full).then_some(made.bytes)
}

/// The compression of an artifact: empty where it does not pay.
#[derive(Debug)]
pub struct Compress {
    key: Key,
    coding: Coding,
    parts: Vec<Bytes>,
    length: u64,
}

impl Compress {
    /// The task that makes the variant of an artifact with these bytes.
    pub fn new(artifact: &Key, coding: Coding, parts: Vec<Bytes>) -> Self {
        let length = parts.iter().map(|part| part.len() as u64).sum();
        Self { key: coding.key(artifact), coding, parts, length }
    }

    /// Most bytes of a variant that pays.
    fn most(&self) -> u64 {
        self.length - self.length / SPARED
    }

    /// Hands the bytes to an encoder.
    fn feed(&self, encoder: &mut dyn Write, watch: &Watch) -> Result<(), RunError> {
        for piece in self.parts.iter().flat_map(|part| part.chunks(PIECE_BYTES)) {
            watch.check().map_err(RunError::Stopped)?;
            encoder.write_all(piece).map_err(RunError::Io)?;
        }
        Ok(())
    }

    /// The encoded bytes, as far as they pay.
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

/// Encoded bytes, as long as they pay; what comes after is counted out and forgotten.
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
