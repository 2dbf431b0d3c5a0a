//! The files beside an OBJ file: the library of its materials, and their textures.

use std::io::{self, Write};
use std::path::Path;

use super::files::Files;
use crate::job::limits::Admitted;
use crate::output::{WITHOUT_LIBRARY, mtl};
use crate::shape::attachments::Attachments;
use crate::shape::looks::images;

/// What goes beside an OBJ file.
#[derive(Debug)]
pub(super) struct Library<'a> {
    carried: &'a Attachments,
    target: &'a Path,
    /// What the names of all files begin with.
    stem: String,
}

impl<'a> Library<'a> {
    /// That of the first output of a job, where it is an OBJ that names none and whose materials look like something.
    pub(super) fn of(admitted: &'a Admitted, target: &'a Path) -> Option<Self> {
        let job = admitted.job();
        let output = &job.outputs[0];
        let carried = job.input.attachments();
        if output.format.name() != "obj" || output.options.name("mtllib").is_some() || carried.looks.is_empty() {
            return None;
        }
        let stem = target.file_stem()?.to_string_lossy();
        let letter = |c: char| if c.is_whitespace() || c.is_control() || c == '#' { '_' } else { c };
        Some(Self { carried, target, stem: stem.chars().map(letter).collect() })
    }

    /// The line that names the library.
    pub(super) fn line(&self) -> String {
        format!("mtllib {}.mtl\n", self.stem)
    }

    /// The warnings of an OBJ file with this library beside it.
    pub(super) fn warnings(&self, mut warnings: Vec<String>) -> Vec<String> {
        warnings.retain(|warning| warning != WITHOUT_LIBRARY);
        warnings.extend(mtl::unheld(self.carried));
        warnings
    }

    /// Writes the library and the textures.
    pub(super) fn write(&self, files: &mut Files) -> io::Result<()> {
        let mut file = |name: &str, bytes: &[u8]| files.create(&self.target.with_file_name(name))?.write_all(bytes);
        file(&format!("{}.mtl", self.stem), &mtl::library(self.carried, Some(&self.stem)))?;
        for (number, image) in images(&self.carried.looks).iter().enumerate() {
            file(&mtl::file_name(&self.stem, number, image), image.bytes())?;
        }
        Ok(())
    }
}
