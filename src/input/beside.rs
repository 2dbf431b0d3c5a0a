//! Access to the companion files of a mesh file, for formats that split a model over several files.

use std::fmt;

/// The companion files of a file that is being read.
pub trait Beside: fmt::Debug + Send + Sync {
    /// Reads the bytes of a companion file, at most `most`. The name is relative to the folder of the main file, with
    /// `/` between folders.
    ///
    /// # Errors
    /// A sentence that names the file and says why it is not read: it lies outside of the folder, does not exist, is
    /// too large, or is not a file.
    fn read(&self, name: &str, most: u64) -> Result<Vec<u8>, String>;

    /// Returns the bytes of memory that reading may take beyond the weight of the files; scenes that instance a mesh
    /// many times take more than their length suggests.
    fn spare(&self) -> u64 {
        0
    }

    /// Returns the material library that came with the file, whatever its name.
    fn library(&self) -> Option<&[u8]> {
        None
    }
}

/// A file without companion files.
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

/// A file that came with its material library and no other companion.
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

/// A file to be read, with access to its companion files.
#[derive(Debug, Clone, Copy)]
pub struct InputFile<'a> {
    /// The contents of the file.
    pub bytes: &'a [u8],
    /// The companion files.
    pub beside: &'a dyn Beside,
}

impl<'a> From<&'a [u8]> for InputFile<'a> {
    fn from(bytes: &'a [u8]) -> Self {
        Self { bytes, beside: &Alone }
    }
}
