//! OFF: reads polygons as plain text or in binary form.
//!
//! Source: The Geometry Center, Geomview Manual 1.9 (2014), section 4.2.5.

mod numbers;

use self::numbers::OffNumbers;
use super::collect::{MeshBuilder, vertex_index};
use super::reader::{CornerUvs, ReadLimits, ReadMesh, Reader, Vertices};
use super::text::{Words, at_line, count, number, quoted, text};
use crate::shape::attachments::ChannelInput;

/// Minimum number of bytes of a vertex ("0 0 0" and a line break) and of a face ("3 0 1 2") in a text file.
const LEAST_TEXT_BYTES: [u64; 2] = [6, 8];
/// Minimum number of bytes of a vertex and of a face in a binary file: three values, and five with the number of colour
/// components.
const BINARY_BYTES: [u64; 2] = [12, 20];
/// Bytes within which the first line of a binary file ends: the longest name, `BINARY`, and blanks.
const MAX_HEAD: usize = 64;

/// The reader of OFF with the prefixes `ST` (texture coordinates), `C` (colours) and `N` (normals), with each vertex
/// and face on a line of its own and `#` before comments; if `BINARY` follows the name, values of 32 bits in big-endian
/// order. Normals are ignored; colours of faces are left out with a note. The prefixes `4` and `n` are refused.
pub(super) const OFF: Reader = Reader {
    name: "off",
    media_type: "model/off",
    doc: "Geomview OFF, COFF, NOFF, STOFF: polygons as text or binary",
    vertices: Vertices::Shared,
    likeness: |file| file.first_word().ends_with(b"OFF").into(),
    read: |file, limits| read(file.bytes, limits).map_err(|detail| vec![detail]),
};

/// The vertex data that the prefix declares.
#[derive(Debug, Clone, Copy, Default)]
struct VertexFields {
    uvs: bool,
    colors: bool,
    normals: bool,
}

impl VertexFields {
    fn read(word: &str) -> Result<Self, String> {
        let wrong = || format!("{} stands where OFF, COFF, NOFF or STOFF should", quoted(word));
        let prefix = word.strip_suffix("OFF").ok_or_else(wrong)?;
        let (uvs, rest) = prefix.strip_prefix("ST").map_or((false, prefix), |rest| (true, rest));
        let (colors, rest) = rest.strip_prefix('C').map_or((false, rest), |rest| (true, rest));
        let (normals, rest) = rest.strip_prefix('N').map_or((false, rest), |rest| (true, rest));
        match rest {
            "" => Ok(Self { uvs, colors, normals }),
            "4" | "n" | "4n" => Err(format!("{} has points of other than 3 coordinates; send OFF", quoted(word))),
            _ => Err(wrong()),
        }
    }
}

fn read(bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, String> {
    if let Some((name, start)) = binary(bytes) {
        let kind = VertexFields::read(name).map_err(|detail| at_line(1, detail))?;
        return read_binary(kind, OffNumbers::new(bytes, start), bytes.len() as u64, limits);
    }
    let text = text(bytes);
    let mut words = Words::new(&text, 1, Some('#'));
    let mut line = words.expect_line("\"OFF\"")?;
    let kind = VertexFields::read(line.next().unwrap_or_default()).map_err(|detail| at_line(words.line, detail))?;
    let mut counts: Vec<&str> = line.collect();
    if counts.is_empty() {
        counts = words.expect_line("the numbers of vertices, faces and edges")?.collect();
    }
    let mut off = OffReader::new(kind, limits);
    let [n_vertices, n_faces] =
        off.counts(&counts, bytes.len() as u64).map_err(|detail| at_line(words.line, detail))?;
    for i in 0..n_vertices {
        let mut line = words.expect_line(&format!("vertex {i} of {n_vertices}"))?;
        off.vertex(&mut line).map_err(|detail| at_line(words.line, format!("vertex {i}: {detail}")))?;
    }
    for i in 0..n_faces {
        let line = words.expect_line(&format!("face {i} of {n_faces}"))?;
        off.face(line).map_err(|detail| at_line(words.line, format!("face {i}: {detail}")))?;
    }
    if let Some(word) = words.next() {
        return Err(at_line(words.line, format!("{} follows the last of {n_faces} faces", quoted(word))));
    }
    Ok(off.finish())
}

/// Returns the name in the first line of a binary file, and the byte at which its values begin.
fn binary(bytes: &[u8]) -> Option<(&str, usize)> {
    let line = bytes.iter().take(MAX_HEAD).position(|byte| *byte == b'\n')?;
    let words: Vec<&str> = std::str::from_utf8(&bytes[..line]).ok()?.split_ascii_whitespace().collect();
    let [name, word] = words.as_slice() else { return None };
    word.eq_ignore_ascii_case("binary").then_some((name, line + 1))
}

fn read_binary(
    kind: VertexFields,
    mut file: OffNumbers<'_>,
    bytes: u64,
    limits: &ReadLimits,
) -> Result<ReadMesh, String> {
    let mut off = OffReader::new(kind, limits);
    let mut counts = [0; 3];
    for count in &mut counts {
        *count = file.count("the numbers of vertices, faces and edges")?;
    }
    let [n_vertices, n_faces, _] = counts;
    off.expect(n_vertices, n_faces, BINARY_BYTES, bytes).map_err(|detail| file.at_offset(detail))?;
    let width = 3 + if kind.normals { 3 } else { 0 } + if kind.colors { 4 } else { 0 } + if kind.uvs { 2 } else { 0 };
    for i in 0..n_vertices {
        let what = format!("vertex {i} of {n_vertices}");
        let found = (0..width).map(|_| file.number(&what)).collect::<Result<Vec<f64>, _>>()?;
        off.keep(&found, 1.0).map_err(|detail| file.at_offset(format!("vertex {i}: {detail}")))?;
    }
    for i in 0..n_faces {
        let what = format!("face {i} of {n_faces}");
        let mut face = Vec::new();
        for _ in 0..file.count(&what)? {
            let vertex = vertex_index(file.count(&what)?, off.mesh.mesh.positions.len());
            face.push(vertex.map_err(|detail| file.at_offset(format!("face {i}: {detail}")))?);
        }
        off.mesh.face(&face).map_err(|detail| file.at_offset(format!("face {i}: {detail}")))?;
        let components = file.count(&what)?;
        (0..components).try_for_each(|_| file.number(&what).map(drop))?;
        off.face_colors += usize::from(components > 0);
    }
    if file.is_at_end() {
        Ok(off.finish())
    } else {
        Err(file.at_offset(format!("more follows the last of {n_faces} faces")))
    }
}

struct OffReader {
    mesh: MeshBuilder,
    kind: VertexFields,
    /// Four colour components per vertex, from 0 to 1.
    colors: Vec<f64>,
    uvs: Vec<[f64; 2]>,
    face_colors: usize,
}

impl OffReader {
    fn new(kind: VertexFields, limits: &ReadLimits) -> Self {
        Self { mesh: MeshBuilder::new(limits), kind, colors: Vec::new(), uvs: Vec::new(), face_colors: 0 }
    }

    /// Reads the numbers of vertices and faces, and checks that the bytes can hold them.
    fn counts(&self, words: &[&str], bytes: u64) -> Result<[u64; 2], String> {
        let &([vertices, faces] | [vertices, faces, _]) = words else {
            return Err(format!("{} numbers; give those of vertices, faces and edges", words.len()));
        };
        let [vertices, faces] = [count(vertices)?, count(faces)?];
        words.get(2).map_or(Ok(0), |edges| count(edges))?;
        self.expect(vertices, faces, LEAST_TEXT_BYTES, bytes)?;
        Ok([vertices, faces])
    }

    /// Refuses more vertices and faces than are allowed, or than the bytes can hold.
    fn expect(&self, vertices: u64, faces: u64, least_of: [u64; 2], bytes: u64) -> Result<(), String> {
        self.mesh.expect_vertices(vertices)?;
        self.mesh.expect_faces(faces)?;
        let least = vertices.saturating_mul(least_of[0]).saturating_add(faces.saturating_mul(least_of[1]));
        // the last line may lack its break
        if least <= bytes + least_of[0] {
            return Ok(());
        }
        Err(format!(
            "{vertices} vertices and {faces} faces take {least} bytes at least, the file has {bytes}; send it whole"
        ))
    }

    fn vertex<'a>(&mut self, line: &mut (impl Iterator<Item = &'a str> + Clone)) -> Result<(), String> {
        let words: Vec<&str> = line.collect();
        let VertexFields { uvs, colors, normals } = self.kind;
        let others = 3 + if normals { 3 } else { 0 } + if uvs { 2 } else { 0 };
        let color = words.len().checked_sub(others).unwrap_or(usize::MAX);
        if !(if colors { color == 3 || color == 4 } else { color == 0 }) {
            let wanted = if colors { format!("{} or {}", others + 3, others + 4) } else { others.to_string() };
            return Err(format!("{} numbers; it needs {wanted}", words.len()));
        }
        let found = words.iter().map(|word| number(word)).collect::<Result<Vec<f64>, _>>()?;
        let start = if normals { 6 } else { 3 };
        // integer components range from 0 to 255
        let is_whole = words[start..start + color].iter().all(|word| word.bytes().all(|byte| byte.is_ascii_digit()));
        self.keep(&found, if is_whole { 255.0 } else { 1.0 })
    }

    /// Adds a vertex with the data that the prefix declares; colour components range from 0 to `scale`.
    fn keep(&mut self, found: &[f64], scale: f64) -> Result<(), String> {
        let VertexFields { uvs, colors, normals } = self.kind;
        self.mesh.vertex([found[0], found[1], found[2]])?;
        if colors {
            let start = if normals { 6 } else { 3 };
            let given = &found[start..found.len() - if uvs { 2 } else { 0 }];
            let alpha = given.get(3).map_or(1.0, |alpha| alpha / scale);
            self.colors.extend(given[..3].iter().map(|x| x / scale).chain([alpha]));
        }
        if uvs {
            self.uvs.push([found[found.len() - 2], found[found.len() - 1]]);
        }
        Ok(())
    }

    fn face<'a>(&mut self, mut line: impl Iterator<Item = &'a str>) -> Result<(), String> {
        let size = count(line.next().unwrap_or_default())?;
        let n = self.mesh.mesh.positions.len();
        let mut face = Vec::new();
        for j in 0..size {
            let word = line.next().ok_or_else(|| format!("{j} vertices; it says {size}"))?;
            face.push(vertex_index(count(word)?, n)?);
        }
        self.mesh.face(&face)?;
        let rest = line.map(number).collect::<Result<Vec<f64>, _>>()?;
        match rest.len() {
            0 => {}
            1..=4 => self.face_colors += 1,
            more => return Err(format!("{more} numbers after its vertices; a colour has at most 4")),
        }
        Ok(())
    }

    fn finish(self) -> ReadMesh {
        let mut mesh = self.mesh.mesh;
        if self.kind.colors {
            mesh.channels.push(ChannelInput::of_vertices("color", 4, self.colors));
        }
        if self.kind.uvs {
            mesh.uvs = Some(CornerUvs::new(self.uvs, mesh.faces.vertices().to_vec()));
        }
        if self.face_colors > 0 {
            mesh.notes.push(format!("colours of faces are left out: {}", self.face_colors));
        }
        mesh
    }
}
