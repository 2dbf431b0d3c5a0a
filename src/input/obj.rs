//! Wavefront OBJ: reads polygons of any size, with the tags of subdivision surfaces.
//!
//! Sources: Wavefront Technologies, Advanced Visualizer Manual (1995), appendix B1; for the tags (`t`) the shape files
//! of OpenSubdiv, `regression/common/shape_utils`.

mod corner;
mod faces;
mod library;
mod tags;

use std::collections::BTreeMap;

use self::faces::{MAX_FACE_FAULTS, ObjFaces};
use self::library::MaterialLibrary;
use super::beside::InputFile;
use super::collect::MeshBuilder;
use super::reader::{ReadLimits, ReadMesh, Reader, Vertices};
use super::text::{at_line, number, numbers, quoted, text, without_comment};
use crate::shape::attachments::ChannelInput;

/// Statements for display or naming that do not affect a mesh.
const IGNORED_STATEMENTS: &[&str] =
    &["s", "mg", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj", "ctech", "stech"];

/// Maximum number of material libraries that are read.
const MAX_LIBRARIES: usize = 16;

/// Statements of free-form curves and surfaces.
const FREE_FORM: &[&str] = &[
    "vp", "cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv", "sp", "end", "con",
];

/// Statements that begin a free-form curve or surface.
const FREE_FORM_STATEMENTS: &[&str] = &["curv", "curv2", "surf"];

/// The reader of OBJ. Faces keep their size; indices may be negative; normals are checked and ignored. Objects and
/// groups (`o`, `g`) become groups, `usemtl` makes materials, and three or four numbers after a position are a colour.
/// `g default` is the format's way to put faces in no group, and `usemtl default` is read alike: faces after it have no
/// material. The looks of materials are read from the libraries that `mtllib` names, if they are available. Tags:
/// `crease`, `corner`, `hole`, `interpolateboundary`. Points, lines and free-form geometry are left out with a note.
pub(super) const OBJ: Reader = Reader {
    name: "obj",
    media_type: "model/obj",
    doc: "Wavefront OBJ: polygons, with crease, corner, hole and boundary tags",
    vertices: Vertices::Shared,
    likeness: |file| file.text.split(|&byte| byte == b'\n').take(MAX_SEARCHED_LINES).any(is_statement).into(),
    read,
};

/// Maximum number of lines of a text that are searched for a statement. Half of it misses files with longer licences
/// before their first vertex; twice of it searches more of other files in vain.
const MAX_SEARCHED_LINES: usize = 100;

/// Returns whether a line is a statement that begins most files.
fn is_statement(line: &[u8]) -> bool {
    let mut words = line.trim_ascii().split(u8::is_ascii_whitespace);
    let key = words.next().unwrap_or_default();
    let follows = words.next().is_some();
    follows && [&b"v"[..], b"vn", b"vt", b"f", b"mtllib", b"o", b"g"].contains(&key)
}

fn read(file: &InputFile<'_>, limits: &ReadLimits) -> Result<ReadMesh, Vec<String>> {
    let text = text(file.bytes);
    let mut state = ObjReader::new(limits);
    let mut lines = text.lines().enumerate();
    let mut joined = String::new();
    while let Some((i, line)) = lines.next() {
        let mut line = line;
        if line.trim_end().ends_with('\\') {
            joined.clear();
            let mut part = Some(line);
            while let Some(more) = part {
                let piece = more.trim_end();
                joined.push_str(piece.strip_suffix('\\').unwrap_or(piece));
                joined.push(' ');
                part = if piece.ends_with('\\') { lines.next().map(|(_, next)| next) } else { None };
            }
            line = &joined;
        }
        let line = without_comment(line);
        if let Err(detail) = state.line(i + 1, line) {
            state.faults.push(at_line(i + 1, detail));
            if state.faults.len() == MAX_FACE_FAULTS {
                state.faults.push("there may be more faults behind these".to_owned());
                return Err(state.faults);
            }
        }
    }
    let libraries = std::mem::take(&mut state.libraries);
    let beyond = state.libraries_beyond;
    let mut mesh = state.finish()?;
    let library = MaterialLibrary::beside(file.beside, &libraries);
    if beyond > 0 {
        mesh.notes.push(format!("libraries of materials are left out beyond the first {MAX_LIBRARIES}: {beyond}"));
    }
    mesh.looks = library.looks(&mesh.materials, mesh.uvs.is_some(), file.beside, &mut mesh.notes);
    Ok(mesh)
}

/// The state of the reader.
#[derive(Debug, Default)]
struct ObjReader {
    mesh: MeshBuilder,
    faces: ObjFaces,
    uvs: Vec<[f64; 2]>,
    n_normals: usize,
    /// Red, green, blue and alpha of the coloured vertices, and the number of components in the file.
    colors: Vec<f64>,
    color_width: usize,
    tags: tags::ObjTags,
    /// Names of material libraries.
    libraries: Vec<String>,
    /// Number of further libraries that are not read.
    libraries_beyond: usize,
    /// The number of elements left out, by kind.
    left_out: BTreeMap<String, usize>,
    faults: Vec<String>,
}

impl ObjReader {
    fn new(limits: &ReadLimits) -> Self {
        Self { mesh: MeshBuilder::new(limits), ..Self::default() }
    }

    fn line(&mut self, line: usize, text: &str) -> Result<(), String> {
        let mut words = text.split_ascii_whitespace();
        let Some(keyword) = words.next() else { return Ok(()) };
        match keyword {
            // an invalid entry is stored all the same, because faces refer to entries by their number
            "v" => self.vertex(&words.collect::<Vec<_>>()).inspect_err(|_| self.mesh.mesh.positions.push([0.0; 3])),
            "vt" => {
                let found = texture_coordinate(words);
                self.uvs.push(found.clone().unwrap_or_default());
                found.map(drop)
            }
            "vn" => {
                self.n_normals += 1;
                numbers::<3>(&mut words, "a normal")?;
                ended(words.next(), "a normal of three numbers")
            }
            "f" | "fo" => {
                let counts = [self.mesh.mesh.positions.len(), self.uvs.len(), self.n_normals];
                self.faces.push(line, words, counts, &mut self.mesh)
            }
            "g" => self.faces.groups.enter(words),
            "o" => self.faces.objects.enter(std::iter::once(text.trim()[1..].trim())),
            "usemtl" => self.faces.materials.enter(std::iter::once(text.trim()[6..].trim())),
            "mtllib" => {
                let name = text.trim()[6..].trim();
                if self.libraries.len() == MAX_LIBRARIES {
                    self.libraries_beyond += 1;
                } else if !name.is_empty() {
                    self.libraries.push(name.to_owned());
                }
                Ok(())
            }
            "t" => self.tags.push(line, words, &mut self.left_out),
            "l" | "p" => {
                let what = if keyword == "l" { "lines" } else { "points" };
                *self.left_out.entry(what.to_owned()).or_default() += 1;
                Ok(())
            }
            "usemap" | "maplib" => {
                *self.left_out.entry("textures outside of materials".to_owned()).or_default() += 1;
                Ok(())
            }
            _ if IGNORED_STATEMENTS.contains(&keyword) => Ok(()),
            _ if FREE_FORM.contains(&keyword) => {
                if FREE_FORM_STATEMENTS.contains(&keyword) {
                    *self.left_out.entry("free-form curves and surfaces".to_owned()).or_default() += 1;
                }
                Ok(())
            }
            _ => Err(format!(
                "{} is no statement of OBJ; known are v, vt, vn, f, g, o, usemtl, t, l, p",
                quoted(keyword)
            )),
        }
    }

    /// Reads a vertex of 3 coordinates, optionally with a weight or a colour of 3 or 4 numbers.
    fn vertex(&mut self, words: &[&str]) -> Result<(), String> {
        if !matches!(words.len(), 3 | 4 | 6 | 7) {
            let n = words.len();
            return Err(format!("a vertex of {n} numbers; it has 3, with a weight 4, with a colour 6 or 7"));
        }
        let found = words.iter().map(|word| number(word)).collect::<Result<Vec<f64>, _>>()?;
        if found.len() == 4 && found[3].to_bits() != 1.0_f64.to_bits() {
            return Err(format!("the weight {} of a vertex; polygons have the weight 1", found[3]));
        }
        self.mesh.vertex([found[0], found[1], found[2]])?;
        if found.len() > 4 {
            self.color_width = self.color_width.max(found.len() - 3);
            let alpha = found.get(6).copied().unwrap_or(1.0);
            self.colors.extend([found[3], found[4], found[5], alpha]);
        }
        Ok(())
    }

    fn finish(mut self) -> Result<ReadMesh, Vec<String>> {
        let counts = [self.mesh.mesh.positions.len(), self.uvs.len(), self.n_normals];
        self.faults.extend(self.faces.beyond(counts, &self.mesh.mesh.faces));
        if !self.faults.is_empty() {
            self.faults.truncate(MAX_FACE_FAULTS);
            return Err(self.faults);
        }
        let mut mesh = self.mesh.mesh;
        let n = mesh.positions.len();
        if self.color_width > 0 && self.colors.len() == 4 * n {
            let values = self.colors.chunks_exact(4).flat_map(|color| &color[..self.color_width]).copied().collect();
            mesh.channels.push(ChannelInput::of_vertices("color", self.color_width, values));
        } else if self.color_width > 0 {
            mesh.notes.push(format!("colours are left out: {} of {n} vertices have one", self.colors.len() / 4));
        }
        self.faces.finish(self.uvs, &mut mesh);
        self.tags.finish(&mut mesh).map_err(|detail| vec![detail])?;
        mesh.notes.extend(self.left_out.iter().map(|(what, n)| format!("{what} are left out: {n}")));
        Ok(mesh)
    }
}

/// Reads a texture coordinate of one to three numbers; the third is ignored.
fn texture_coordinate<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<[f64; 2], String> {
    let [u] = numbers(&mut words, "a texture coordinate")?;
    let v = words.next().map_or(Ok(0.0), number)?;
    words.next().map_or(Ok(0.0), number)?;
    ended(words.next(), "a texture coordinate of at most three numbers")?;
    Ok([u, v])
}

/// Checks that no word follows.
fn ended(word: Option<&str>, what: &str) -> Result<(), String> {
    word.map_or(Ok(()), |word| Err(format!("{} follows {what}", quoted(word))))
}
