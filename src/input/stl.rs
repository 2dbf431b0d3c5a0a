//! STL: reads separate triangles and joins their equal corners.
//!
//! Source: 3D Systems, Stereolithography Interface Specification (1988), section 6.5.

use super::collect::MeshBuilder;
use super::reader::{ReadLimits, ReadMesh, Reader, Vertices};
use super::text::{Words, at_line, number, quoted, text};
use crate::shape::labels::FaceSet;
use crate::shape::topology::index;
use crate::shape::weld::{weld, weld_faces};

/// Bytes before the number of triangles, before the first triangle, and of a triangle.
const STL_HEADER_BYTES: usize = 80;
pub(super) const STL_START: usize = 84;
pub(super) const STL_TRIANGLE_BYTES: usize = 50;
/// Bytes of the normal of a triangle.
const STL_NORMAL_BYTES: usize = 12;

/// The reader of STL, text or binary. Equal corners become one vertex, in the order of first appearance; triangles with
/// two equal corners are left out, with a note. Normals and attribute bytes are ignored; several solids become groups.
/// Lines of a text may be broken anywhere; only names end with their lines.
pub(super) const STL: Reader = Reader {
    name: "stl",
    media_type: "model/stl",
    doc: "STL, text or binary; equal corners are joined",
    vertices: Vertices::Joined,
    likeness: |file| (is_binary(file.bytes) || file.first_word() == b"solid").into(),
    read: |file, limits| read(file.bytes, limits).map_err(|detail| vec![detail]),
};

/// Returns the number of triangles that a binary file announces, and its length in bytes with so many.
fn announced(bytes: &[u8]) -> Option<(u32, usize)> {
    let n = u32::from_le_bytes(bytes.get(STL_HEADER_BYTES..STL_START)?.try_into().ok()?);
    Some((n, (n as usize).checked_mul(STL_TRIANGLE_BYTES)?.checked_add(STL_START)?))
}

/// Returns whether a file has the length that it announces as a binary file.
fn is_binary(bytes: &[u8]) -> bool {
    announced(bytes).is_some_and(|(_, length)| length == bytes.len())
}

fn read(bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, String> {
    let mut soup = Soup { mesh: MeshBuilder::new(limits), solids: Vec::new() };
    // a binary file may also start with "solid", but its number of triangles has zero bytes, which no text has
    let is_text = bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
        && !bytes.get(STL_HEADER_BYTES..STL_START).is_some_and(|n| n.contains(&0));
    let n_bytes = bytes.len();
    match announced(bytes) {
        Some((_, length)) if length == n_bytes => soup.read_binary(&bytes[STL_START..])?,
        _ if is_text => soup.read_text(bytes)?,
        Some((n, length)) => {
            return Err(format!(
                "byte {STL_HEADER_BYTES}: {n} triangles take {length} bytes, the file has {n_bytes}; send it whole, or \
                 as text that starts with \"solid\""
            ));
        }
        None => {
            return Err(format!(
                "{n_bytes} bytes; a binary STL has at least {STL_START}, a text starts with \"solid\""
            ));
        }
    }
    soup.joined()
}

/// Triangles that do not share vertices.
struct Soup {
    mesh: MeshBuilder,
    /// The name of each solid with the index of its first triangle.
    solids: Vec<(String, usize)>,
}

impl Soup {
    fn triangle(&mut self, corners: [[f64; 3]; 3]) -> Result<(), String> {
        let first = index(self.mesh.mesh.positions.len());
        self.mesh.mesh.positions.extend(corners);
        self.mesh.face(&[first, first + 1, first + 2])
    }

    fn read_binary(&mut self, triangles: &[u8]) -> Result<(), String> {
        let (triangles, _) = triangles.as_chunks::<STL_TRIANGLE_BYTES>();
        self.mesh.expect_faces(triangles.len() as u64)?;
        for (i, triangle) in triangles.iter().enumerate() {
            let (numbers, _) = triangle[STL_NORMAL_BYTES..].as_chunks::<4>();
            let number = |k: usize| f64::from(f32::from_le_bytes(numbers[k]));
            let corners: [[f64; 3]; 3] = std::array::from_fn(|j| std::array::from_fn(|k| number(3 * j + k)));
            let wrong = corners.as_flattened().iter().position(|x| !x.is_finite());
            if let Some(k) = wrong {
                let at = STL_START + i * STL_TRIANGLE_BYTES + STL_NORMAL_BYTES + 4 * k;
                return Err(format!("byte {at}: a coordinate of triangle {i} is not finite"));
            }
            self.triangle(corners).map_err(|detail| format!("triangle {i}: {detail}"))?;
        }
        Ok(())
    }

    fn read_text(&mut self, bytes: &[u8]) -> Result<(), String> {
        let text = text(bytes);
        let mut words = Words::new(&text, 1, None);
        while let Some(word) = words.next() {
            if !is(word, "solid") {
                return Err(instead(word, &words, "\"solid\""));
            }
            let name = name(&mut words);
            self.solids.push((name, self.mesh.mesh.faces.len()));
            while self.facet(&mut words)? {}
            pass_over_name(&mut words);
        }
        Ok(())
    }

    /// Reads a facet, or the end of the solid.
    fn facet(&mut self, words: &mut Words<'_>) -> Result<bool, String> {
        const FACET_OR_END: &str = "\"facet\" or \"endsolid\"";
        let word = words.expect(FACET_OR_END)?;
        if is(word, "endsolid") {
            return Ok(false);
        }
        if !is(word, "facet") {
            return Err(instead(word, words, FACET_OR_END));
        }
        keyword(words, "normal")?;
        for _ in 0..3 {
            // many programs write no valid number for triangles without area
            let word = words.expect("a normal of three numbers")?;
            if !is_normal(word) {
                return Err(instead(word, words, "a normal of three numbers"));
            }
        }
        keyword(words, "outer")?;
        keyword(words, "loop")?;
        let mut corners = [[0.0; 3]; 3];
        for corner in &mut corners {
            keyword(words, "vertex")?;
            for (n, x) in corner.iter_mut().enumerate() {
                *x = coordinate(words, n)?;
            }
        }
        keyword(words, "endloop")?;
        keyword(words, "endfacet")?;
        self.triangle(corners).map_err(|detail| at_line(words.line, detail))?;
        Ok(true)
    }

    /// Joins equal corners and returns the mesh.
    fn joined(mut self) -> Result<ReadMesh, String> {
        let mut mesh = std::mem::take(&mut self.mesh.mesh);
        let welded = weld(&mesh.positions, 0.0)?;
        self.mesh.expect_vertices(welded.kept.len() as u64)?;
        let result = weld_faces(&mesh.faces, &welded)
            .map_err(|(f, _)| format!("triangle {f} meets a corner twice; no triangle of three corners does"))?;
        if !result.gone.is_empty() {
            let first = result.gone[0];
            mesh.notes.push(format!(
                "triangles left out because two of their corners are equal: {}, the first is triangle {first}",
                result.gone.len()
            ));
        }
        if self.solids.len() > 1 {
            mesh.groups = groups(&self.solids, &result.kept);
        }
        mesh.positions = welded.kept.iter().map(|&v| mesh.positions[v as usize]).collect();
        mesh.faces = result.faces;
        Ok(mesh)
    }
}

/// Creates a group per solid from the faces that were kept.
fn groups(solids: &[(String, usize)], kept: &[u32]) -> Vec<FaceSet> {
    let end = |i: usize| solids.get(i + 1).map_or(usize::MAX, |next| next.1);
    let group = |(i, (name, start)): (usize, &(String, usize))| {
        let first = kept.partition_point(|&old| (old as usize) < *start);
        let last = kept.partition_point(|&old| (old as usize) < end(i));
        FaceSet { name: name.clone(), faces: (first as u64..last as u64).collect() }
    };
    solids.iter().enumerate().map(group).filter(|group| !group.faces.is_empty()).collect()
}

/// Keywords of the format that may follow in place of a missing number.
const KEYWORDS: &[&str] = &["vertex", "endloop", "endfacet", "endsolid"];

/// Compares a word with a keyword, ignoring case.
fn is(word: &str, keyword: &str) -> bool {
    word.eq_ignore_ascii_case(keyword)
}

/// Whether a word may be a component of a normal: a number, or one of the forms in which C prints NaN.
fn is_normal(word: &str) -> bool {
    let unsigned = word.trim_start_matches(['+', '-']);
    let says_nan = unsigned.get(..3).is_some_and(|start| is(start, "nan") || start == "1.#");
    says_nan || word.parse::<f64>().is_ok()
}

/// Reads coordinate number `n` of a vertex.
fn coordinate(words: &mut Words<'_>, n: usize) -> Result<f64, String> {
    let line = words.line;
    let short = || at_line(line, format!("a vertex has {n} numbers; it needs 3"));
    let word = words.next().ok_or_else(short)?;
    number(word).map_err(|detail| {
        let is_next = KEYWORDS.iter().any(|keyword| is(word, keyword));
        if is_next { short() } else { at_line(words.line, detail) }
    })
}

/// Reads a keyword.
fn keyword(words: &mut Words<'_>, expected: &str) -> Result<(), String> {
    match words.next() {
        Some(word) if is(word, expected) => Ok(()),
        Some(word) => Err(instead(word, words, &format!("\"{expected}\""))),
        None => words.expect(&format!("\"{expected}\"")).map(drop),
    }
}

/// Formats the fault of an unexpected word.
fn instead(word: &str, words: &Words<'_>, what: &str) -> String {
    at_line(words.line, format!("{} stands where {what} should", quoted(word)))
}

/// Reads the name of a solid: the rest of its line, up to a `facet normal` or `endsolid` on the same line.
fn name(words: &mut Words<'_>) -> String {
    let mut name: Vec<&str> = Vec::new();
    let mut rest = words.rest_of_line();
    while let Some(word) = rest.next() {
        let is_facet = is(word, "facet") && rest.clone().next().is_some_and(|next| is(next, "normal"));
        if is_facet || is(word, "endsolid") {
            break;
        }
        name.push(word);
    }
    words.pass(name.len());
    name.join(" ")
}

/// Skips the name after the end of a solid: the rest of its line, up to a solid that begins on the same line.
fn pass_over_name(words: &mut Words<'_>) {
    let mut length = 0;
    let mut solid = None;
    for (n, word) in words.rest_of_line().enumerate() {
        length = n + 1;
        if solid.is_none() && is(word, "solid") {
            solid = Some(n);
        } else if let Some(start) = solid.filter(|_| is(word, "facet") || is(word, "endsolid")) {
            length = start;
            break;
        }
    }
    words.pass(length);
}
