//! OFF: polygons as plain text.
//!
//! Source: The Geometry Center, Geomview Manual 1.9 (2014), section 4.2.5.

use super::collect::{Collected, vertex_index};
use super::reader::{ReadLimits, ReadMesh, Reader, Uvs, Vertices};
use super::text::{Words, at_line, count, number, quoted, text};
use crate::shape::attachments::ChannelInput;

/// Least bytes of a vertex ("0 0 0" and a line break) and of a face ("3 0 1 2").
const VERTEX_BYTES: u64 = 6;
const FACE_BYTES: u64 = 8;

/// OFF with its prefixes `ST` (texture coordinates), `C` (colours), `N` (normals), each vertex and face on a line of
/// its own, `#` before comments. Normals are ignored; colours of faces are left out with a note. `4`, `n` and `BINARY`
/// are refused.
pub(super) const OFF: Reader = Reader {
    name: "off",
    media_type: "model/off",
    doc: "Geomview OFF, COFF, NOFF, STOFF: polygons as text",
    vertices: Vertices::Shared,
    read: |file, limits| read(file.bytes, limits).map_err(|detail| vec![detail]),
};

/// What the prefix says of vertices.
#[derive(Debug, Clone, Copy, Default)]
struct Kind {
    uvs: bool,
    colors: bool,
    normals: bool,
}

impl Kind {
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
    let text = text(bytes);
    let mut words = Words::new(&text, 1, Some('#'));
    let mut line = words.expect_line("\"OFF\"")?;
    let kind = Kind::read(line.next().unwrap_or_default()).map_err(|detail| at_line(words.line, detail))?;
    let mut counts: Vec<&str> = line.collect();
    if counts.is_empty() {
        counts = words.expect_line("the numbers of vertices, faces and edges")?.collect();
    }
    if counts.first().is_some_and(|word| word.eq_ignore_ascii_case("binary")) {
        return Err(at_line(words.line, "binary OFF is not read; save it as text"));
    }
    let mut off = Reading { mesh: Collected::new(limits), kind, colors: Vec::new(), uvs: Vec::new(), face_colors: 0 };
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

struct Reading {
    mesh: Collected,
    kind: Kind,
    /// Four numbers a vertex, from 0 to 1.
    colors: Vec<f64>,
    uvs: Vec<[f64; 2]>,
    face_colors: usize,
}

impl Reading {
    /// Numbers of vertices and faces, as far as the bytes can hold them.
    fn counts(&self, words: &[&str], bytes: u64) -> Result<[u64; 2], String> {
        let &([vertices, faces] | [vertices, faces, _]) = words else {
            return Err(format!("{} numbers; give those of vertices, faces and edges", words.len()));
        };
        let [vertices, faces] = [count(vertices)?, count(faces)?];
        words.get(2).map_or(Ok(0), |edges| count(edges))?;
        self.mesh.expect_vertices(vertices)?;
        self.mesh.expect_faces(faces)?;
        let least = vertices.saturating_mul(VERTEX_BYTES).saturating_add(faces.saturating_mul(FACE_BYTES));
        if least > bytes + VERTEX_BYTES {
            return Err(format!(
                "{vertices} vertices and {faces} faces take {least} bytes at least, the file has {bytes}; send it whole"
            ));
        }
        Ok([vertices, faces])
    }

    fn vertex<'a>(&mut self, line: &mut (impl Iterator<Item = &'a str> + Clone)) -> Result<(), String> {
        let words: Vec<&str> = line.collect();
        let Kind { uvs, colors, normals } = self.kind;
        let others = 3 + if normals { 3 } else { 0 } + if uvs { 2 } else { 0 };
        let color = words.len().checked_sub(others).unwrap_or(usize::MAX);
        if !(if colors { color == 3 || color == 4 } else { color == 0 }) {
            let wanted = if colors { format!("{} or {}", others + 3, others + 4) } else { others.to_string() };
            return Err(format!("{} numbers; it needs {wanted}", words.len()));
        }
        let found = words.iter().map(|word| number(word)).collect::<Result<Vec<f64>, _>>()?;
        self.mesh.vertex([found[0], found[1], found[2]])?;
        let start = if normals { 6 } else { 3 };
        if colors {
            let given = &found[start..start + color];
            // whole numbers count to 255
            let is_whole =
                words[start..start + color].iter().all(|word| word.bytes().all(|byte| byte.is_ascii_digit()));
            let scale = if is_whole { 255.0 } else { 1.0 };
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
            mesh.uvs = Some(Uvs { values: self.uvs, corners: mesh.faces.vertices().to_vec() });
        }
        if self.face_colors > 0 {
            mesh.notes.push(format!("colours of faces are left out: {}", self.face_colors));
        }
        mesh
    }
}
