//! Mesh files as clients send them.

use std::sync::Arc;

use serde::Deserialize;
use utoipa::ToSchema;

use super::choice::choice;
use super::mesh::MeshRequest;
use super::read::{ReadError, read};
use super::schema;
use crate::fault::{Fault, did_you_mean, shortened};
use crate::input::{self, Alone, Beside, InputFile, ReadLimits, Vertices, WithLibrary};
use crate::scheme::tags::Boundary;
use crate::shape::check::Winding;
use crate::shape::coordinate_system::{Unit, Up};
use crate::shape::mesh::MeshInput;

/// A mesh file within the job.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TextRequest {
    /// The format of the file, see [`input::READERS`], or `json` for a mesh as `input.mesh` has it.
    #[schema(schema_with = schema::file_format)]
    pub format: String,
    /// What the file holds.
    pub data: String,
    /// How `data` holds it: `text` (default), or `base64` for files that are no text.
    pub encoding: Option<EncodingRequest>,
    /// The library of materials (MTL) of an OBJ file, whatever name the file gives it.
    pub mtl: Option<String>,
}

choice! {
    /// How bytes stand in a text.
    pub enum EncodingRequest {
        /// As they are.
        Text = "text",
        /// In base64.
        Base64 = "base64",
    }
}

/// A mesh file sent by itself.
#[derive(Debug, Clone)]
pub struct MeshFile {
    /// The name of the format.
    pub format: String,
    /// The content of the file.
    pub bytes: Vec<u8>,
    /// The files beside it.
    pub beside: Arc<dyn Beside>,
}

/// The content of a mesh file.
#[derive(Debug)]
pub(super) struct MeshFileContent {
    /// The mesh, unchecked.
    pub(super) mesh: MeshInput,
    /// The boundary rule that the file states, if any.
    pub(super) boundary: Option<Boundary>,
    /// The line of each face, for formats that have lines; else empty.
    pub(super) lines: Vec<u32>,
    /// The corners that share a vertex in the file.
    pub(super) vertices: Vertices,
    /// The unit and the up axis that the file states, if any.
    pub(super) stated_system: (Option<Unit>, Option<Up>),
}

impl TextRequest {
    /// Returns the file.
    ///
    /// # Errors
    /// Invalid base64, or a material library beside a file that is not OBJ.
    pub fn file(self) -> Result<MeshFile, Fault> {
        let bytes = match self.encoding {
            None | Some(EncodingRequest::Text) => self.data.into_bytes(),
            Some(EncodingRequest::Base64) => {
                input::from_base64(&self.data).map_err(|detail| Fault::new("/data", detail))?
            }
        };
        let is_known = self.format == "json" || input::named(&self.format).is_some();
        let beside: Arc<dyn Beside> = match self.mtl {
            Some(library) if self.format == "obj" => Arc::new(WithLibrary(library.into_bytes())),
            Some(_) if is_known => {
                return Err(Fault::new("/mtl", "only OBJ files have a library of materials; leave it out"));
            }
            _ => Arc::new(Alone),
        };
        Ok(MeshFile { format: self.format, bytes, beside })
    }
}

impl MeshFile {
    /// Returns the faults of a file that could not be read in its stated format: the format that its first bytes
    /// indicate, else `details`.
    fn unread(&self, name: &str, details: Vec<String>) -> Vec<Fault> {
        let is_own = input::own(&self.bytes) == Some(name);
        if let Some(what) = input::foreign(&self.bytes).filter(|_| !is_own) {
            let known: Vec<&str> = input::READERS.iter().map(|reader| reader.name).collect();
            let detail = format!("the file is {what}; meshes are read from {} and json", known.join(", "));
            return vec![Fault::new("/data", detail)];
        }
        if let Some(own) = input::own(&self.bytes).filter(|own| *own != name) {
            return vec![Fault::new(
                "/format",
                format!("the file begins like {own}, not like {name}; read it as {own}"),
            )];
        }
        details.into_iter().map(|detail| Fault::new("/data", detail)).collect()
    }

    /// Reads the file.
    ///
    /// # Errors
    /// All faults, at `/format` or `/data`.
    pub(super) fn read(&self, winding: Winding, limits: &ReadLimits) -> Result<MeshFileContent, Vec<Fault>> {
        let at_data = |found: Vec<Fault>| within(found, &[]);
        if self.format == "json" {
            let request: MeshRequest = read(&self.bytes).map_err(|error| match error {
                ReadError::NotJson(detail) => vec![Fault::new("/data", detail.replace("the body", "the mesh"))],
                ReadError::Unfit(faults) => at_data(faults),
            })?;
            let mesh = request.input(winding).map_err(at_data)?;
            return Ok(MeshFileContent {
                mesh,
                boundary: None,
                lines: Vec::new(),
                vertices: Vertices::Shared,
                stated_system: (None, None),
            });
        }
        let Some(reader) = input::named(&self.format) else {
            let known: Vec<&str> = input::READERS.iter().map(|reader| reader.name).chain(["json"]).collect();
            let meant = did_you_mean(&self.format, known.iter().copied());
            let detail =
                format!("there is no reader \"{}\"; {meant}known are {}", shortened(&self.format), known.join(", "));
            return Err(vec![Fault::new("/format", detail)]);
        };
        let refused = |details: Vec<String>| self.unread(reader.name, details);
        let file = InputFile { bytes: &self.bytes, beside: &*self.beside };
        let mut mesh = (reader.read)(&file, limits).map_err(refused)?;
        if mesh.faces.is_empty() {
            return Err(vec![Fault::new("/data", without_faces(mesh.positions.len(), &mesh.notes))]);
        }
        let (boundary, lines) = (mesh.boundary, std::mem::take(&mut mesh.lines));
        let vertices = mesh.vertices.unwrap_or(reader.vertices);
        let stated_system = (mesh.unit, mesh.up);
        Ok(MeshFileContent { mesh: mesh.into_input(winding), boundary, lines, vertices, stated_system })
    }
}

/// Returns the reason why a file without faces is refused.
fn without_faces(n_points: usize, notes: &[String]) -> String {
    let others = if notes.is_empty() { String::new() } else { format!(" ({})", notes.join("; ")) };
    match n_points {
        0 => format!("the file holds no mesh: neither vertices nor faces{others}"),
        n => format!(
            "the file is a point cloud: {n} points and no faces{others}; make a surface of them first, as MeshLab does"
        ),
    }
}

/// Moves faults within a file to `/data`, as no JSON pointer leads into a file: their pointers become part of the
/// sentences, for faces with the line in the file.
pub(super) fn within(faults: Vec<Fault>, lines: &[u32]) -> Vec<Fault> {
    let line = |pointer: &str| {
        let face = pointer.strip_prefix("/faces/")?.split('/').next()?.parse::<usize>().ok()?;
        Some(format!("line {}, ", lines.get(face)?))
    };
    let within = |fault: Fault| match fault.pointer.as_str() {
        "" => Fault::new("/data", fault.detail),
        inside => {
            let line = line(inside).unwrap_or_default();
            Fault::new("/data", format!("{line}in the mesh, {inside}: {}", fault.detail))
        }
    };
    faults.into_iter().map(within).collect()
}
