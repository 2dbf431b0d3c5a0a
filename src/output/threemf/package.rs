//! ZIP archives of compressed files, written from front to back, with the same bytes for the same files.
//!
//! Lengths and checksums follow the bytes of each file, so no file is held in memory; no file has a time.

use std::io::{self, Write};

use flate2::Compression;
use flate2::write::DeflateEncoder;
use rawzip::{CompressionMethod, Error, ErrorKind, ZipArchiveWriter};

/// Compression level: the usual balance of zlib. At 1 models are a third longer, at 9 they take twice as long and are
/// hardly shorter.
const COMPRESSION_LEVEL: u32 = 6;

/// Returns the maximum number of bytes of an archive besides its stored files, for `n_files` files with names of
/// `names` bytes in total: headers of 30 and 46 bytes, lengths of 24, and twice 32 for large files.
pub(super) const fn overhead(n_files: u128, names: u128) -> u128 {
    n_files * (30 + 24 + 46 + 2 * 32) + 2 * names + 22
}

/// An archive that is being written.
pub(super) struct Package<'a>(ZipArchiveWriter<&'a mut dyn Write>);

impl<'a> Package<'a> {
    /// Starts an archive without files.
    pub(super) fn new(out: &'a mut dyn Write) -> Self {
        Self(ZipArchiveWriter::new(out))
    }

    /// Appends a file, whose bytes `write` writes.
    ///
    /// # Errors
    /// Errors of `write` and of the writer below.
    pub(super) fn file<E: From<io::Error>>(
        &mut self,
        name: &str,
        write: impl FnOnce(&mut dyn Write) -> Result<(), E>,
    ) -> Result<(), E> {
        let file = self.0.new_file(name).compression_method(CompressionMethod::DEFLATE);
        let (mut entry, config) = file.start().map_err(unwritten)?;
        let mut packed = config.wrap(DeflateEncoder::new(&mut entry, Compression::new(COMPRESSION_LEVEL)));
        write(&mut packed)?;
        let (packed, sums) = packed.finish().map_err(unwritten)?;
        packed.finish()?;
        entry.finish(sums).map_err(unwritten)?;
        Ok(())
    }

    /// Writes the list of files.
    ///
    /// # Errors
    /// Errors of the writer below.
    pub(super) fn finish(self) -> io::Result<()> {
        self.0.finish().map(|_| ()).map_err(unwritten)
    }
}

fn unwritten(error: Error) -> io::Error {
    match error.into_kind() {
        ErrorKind::IO(error) => error,
        other => io::Error::other(other.to_string()),
    }
}
