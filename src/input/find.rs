//! Finds readers in the registry: by name, by file extension, and by the first bytes of a file.

use super::kind::text_start;
use super::likeness::{FileStart, Likeness};
use super::reader::Reader;
use super::registry::READERS;

/// Returns the reader with this name.
pub fn named(name: &str) -> Option<&'static Reader> {
    READERS.iter().find(|reader| reader.name == name)
}

/// Returns the reader of files with this extension, given without the dot, in any case.
pub fn of_extension(extension: &str) -> Option<&'static Reader> {
    READERS.iter().find(|reader| reader.name.eq_ignore_ascii_case(extension))
}

/// Detects the reader from the first bytes of a file; glTF as JSON and most text are not detected.
pub fn of_bytes(bytes: &[u8]) -> Option<&'static Reader> {
    like(bytes, Likeness::Is)
}

/// Returns the reader that the first bytes of a file indicate, if the file does not begin like those of the reader that
/// it was declared for (`None`: it is a mesh as JSON).
pub fn mistaken(bytes: &[u8], declared: Option<&'static Reader>) -> Option<&'static Reader> {
    let start = FileStart::of(bytes);
    let is_like = declared.is_some_and(|reader| (reader.likeness)(&start) > Likeness::Unlike);
    of_bytes(bytes).filter(|_| !is_like)
}

/// Returns the name of the reader for files that begin like these bytes.
pub fn own(bytes: &[u8]) -> Option<&'static str> {
    like(text_start(bytes), Likeness::Begins).map(|reader| reader.name)
}

/// Returns the last reader in the list whose files a file resembles at least so much. OBJ, which any text with a line
/// of a vertex may be, is the first in the list, so that all others go before it.
fn like(bytes: &[u8], least: Likeness) -> Option<&'static Reader> {
    let start = FileStart::of(bytes);
    READERS.iter().rfind(|reader| (reader.likeness)(&start) >= least)
}
