//! Files beside the one that is read, for formats that keep a model in several.

use std::fmt;

/// The files beside one that is read.
pub trait Beside: fmt::Debug + Send + Sync {
    /// The bytes of a file by its name relative to the folder of the first one, with `/` between folders; of at most
    /// so many bytes.
    ///
    /// # Errors
    /// A sentence that names the file and says why it is not read: a place outside of the folder, a file that is not
    /// there, too large, or no file.
    fn read(&self, name: &str, most: u64) -> Result<Vec<u8>, String>;

    /// The library of materials that came along, whatever its name.
    fn library(&self) -> Option<&[u8]> {
        None
    }
}

/// A file that came by itself: nothing is beside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Alone;

impl Beside for Alone {
    fn read(&self, name: &str, _: u64) -> Result<Vec<u8>, String> {
        let name = super::text::quoted(name);
        Err(format!(
            "{name} lies outside the file, which came by itself: save all in one file, or render it from its \
                     folder on the command line"
        ))
    }
}

/// A file that came with its library of materials, and nothing else.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WithLibrary(pub Vec<u8>);

impl Beside for WithLibrary {
    fn read(&self, name: &str, most: u64) -> Result<Vec<u8>, String> {
        Alone.read(name, most)
    }

    fn library(&self) -> Option<&[u8]> {
        Some(&self.0)
    }
}

/// A file to be read, and those beside it.
#[derive(Debug, Clone, Copy)]
pub struct File<'a> {
    /// What the file holds.
    pub bytes: &'a [u8],
    /// The files beside it.
    pub beside: &'a dyn Beside,
}

impl<'a> From<&'a [u8]> for File<'a> {
    fn from(bytes: &'a [u8]) -> Self {
        Self { bytes, beside: &Alone }
    }
}
