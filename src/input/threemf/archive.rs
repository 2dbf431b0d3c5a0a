//! Reader of the files of a ZIP archive, which are found by the list at its end.

use std::io::Read;

use flate2::bufread::DeflateDecoder;
use rawzip::{CompressionMethod, Error, ZipArchive, ZipFileHeaderRecord, ZipSliceArchive};

use crate::input::text::quoted;

/// Maximum number of files in an archive. Half of it refuses models with a picture for each of their parts; twice of it
/// lets an archive of empty files take twice as long.
const MAX_FILES: u64 = 10_000;
/// Maximum inflated size of a file as a multiple of the archive's length. Deflate reaches a thousand; models of planish
/// reach 20 and those of lib3mf 15. Twice of it lets bombs take longer, and half of it refuses large flat grids.
const MAX_INFLATED: u64 = 200;
/// Bytes that a file may always inflate to, however short the archive is.
const LEAST_INFLATED: u64 = 1 << 20;

/// A ZIP archive in memory.
pub(super) struct Archive<'a> {
    zip: ZipSliceArchive<&'a [u8]>,
    /// Maximum number of bytes that a file may inflate to.
    most: u64,
}

fn broken(error: &Error) -> String {
    format!("the archive is cut off or broken: {error}; send it again")
}

impl<'a> Archive<'a> {
    /// Opens the archive in these bytes.
    ///
    /// # Errors
    /// The bytes are not a ZIP archive, or the archive is broken or has too many files.
    pub(super) fn new(bytes: &'a [u8]) -> Result<Self, String> {
        let zip = ZipArchive::from_slice(bytes).map_err(|error| broken(&error))?;
        let n = zip.entries_hint();
        if n > MAX_FILES {
            return Err(format!("the archive has {n} files; {MAX_FILES} are allowed; leave out what is no model"));
        }
        Ok(Self { zip, most: MAX_INFLATED.saturating_mul(bytes.len() as u64).max(LEAST_INFLATED) })
    }

    /// Returns a reader of the file with this name, compared without case, which inflates and verifies the bytes as it
    /// is read. Returns `None` if there is no such file.
    ///
    /// # Errors
    /// The list is broken, the file is encrypted or neither stored nor deflated, or it inflates to more than is
    /// allowed.
    pub(super) fn file(&self, name: &str) -> Result<Option<Box<dyn Read + '_>>, String> {
        let mut list = self.zip.entries();
        for _ in 0..MAX_FILES {
            let Some(file) = list.next_entry().map_err(|error| broken(&error))? else { break };
            let found = file.file_path();
            let found: &[u8] = found.as_ref();
            if found.strip_prefix(b"/").unwrap_or(found).eq_ignore_ascii_case(name.as_bytes()) {
                return self.open(name, &file).map(Some);
            }
        }
        Ok(None)
    }

    fn open(&self, name: &str, file: &ZipFileHeaderRecord<'_>) -> Result<Box<dyn Read + '_>, String> {
        let (name, length) = (quoted(name), file.uncompressed_size_hint());
        if length > self.most {
            return Err(format!(
                "{name} says that it inflates to {length} bytes, more than {MAX_INFLATED} times what the file has; \
                 send a smaller model"
            ));
        }
        if file.flags().is_encrypted() {
            return Err(format!("{name} is encrypted; save the model without a password"));
        }
        let entry = self.zip.get_entry(file.wayfinder()).map_err(|error| broken(&error))?;
        match file.compression_method() {
            CompressionMethod::STORE => Ok(Box::new(entry.verifying_reader(entry.data().take(length)))),
            CompressionMethod::DEFLATE => {
                Ok(Box::new(entry.verifying_reader(DeflateDecoder::new(entry.data()).take(length))))
            }
            other => Err(format!("{name} is compressed by {other}; stored and deflated files are read")),
        }
    }
}
