//! The files beside an OBJ file: its material library and the textures.

use std::io::{self, Write};
use std::path::Path;

use super::files::Files;
use crate::job::limits::Admitted;
use crate::output::{WITHOUT_LIBRARY, mtl};
use crate::shape::attachments::Attachments;
use crate::shape::looks::images;

/// The files beside one OBJ file.
#[derive(Debug)]
pub(super) struct CompanionFiles<'a> {
    carried: &'a Attachments,
    target: &'a Path,
    /// The common prefix of the file names.
    stem: String,
}

impl<'a> CompanionFiles<'a> {
    /// Returns the files beside the first output of a job, if the output is an OBJ that names no library itself and the
    /// job has materials.
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

    /// Returns the line of the OBJ file that names the library.
    pub(super) fn line(&self) -> String {
        format!("mtllib {}.mtl\n", self.stem)
    }

    /// Replaces the warning about a missing library by warnings about what the library cannot hold.
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
