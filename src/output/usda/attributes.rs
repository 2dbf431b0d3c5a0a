//! Attributes whose values are lists, written block by block.

use crate::output::bytes::Bytes;
use crate::output::error::FormatError;
use crate::output::numbers::{real, whole};
use crate::output::scene::{FaceChunk, MeshSource};
use crate::output::stream::Stream;
use crate::shape::source::PlaceSource;

/// The indentation of the attributes of the mesh.
pub(super) const INDENT: &str = "        ";

/// The elements of a mesh to which values belong.
#[derive(Debug, Clone, Copy)]
pub(super) enum On {
    /// One value for each vertex.
    Vertices,
    /// One value for each corner.
    Corners,
    /// The elements are not written, as the attribute implies them.
    Untold,
}

impl On {
    fn metadata(self) -> &'static str {
        match self {
            Self::Vertices => " (\n            interpolation = \"vertex\"\n        )",
            Self::Corners => " (\n            interpolation = \"faceVarying\"\n        )",
            Self::Untold => "",
        }
    }
}

/// Writes an attribute, given as its type and name, whose list `body` writes.
pub(super) fn attribute<'a>(
    declared: &str,
    on: On,
    stream: &mut Stream<'a>,
    body: impl FnOnce(&mut Stream<'a>) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    stream.bytes(format!("{INDENT}{declared} = [").as_bytes())?;
    body(stream)?;
    stream.bytes(format!("]{}\n", on.metadata()).as_bytes())
}

/// Writes an attribute with one number for each entry of `of`.
pub(super) fn numbers<T: Sync>(
    declared: &str,
    of: &[T],
    stream: &mut Stream<'_>,
    write: impl Fn(&T, &mut Vec<u8>) + Sync,
) -> Result<(), FormatError> {
    attribute(declared, On::Untold, stream, |stream| {
        stream.each(0..of.len(), |i, out| {
            comma(i, out);
            write(&of[i], out);
        })
    })
}

/// Appends the separator before entry `i` of a list.
pub(super) fn comma(i: usize, out: &mut Vec<u8>) {
    if i > 0 {
        out.extend_from_slice(b", ");
    }
}

/// Appends one entry: a number, or a tuple of several.
pub(super) fn entry(row: &[f64], out: &mut Vec<u8>) {
    if let [one] = row {
        return real(out, *one);
    }
    out.push(b'(');
    for (k, &x) in row.iter().enumerate() {
        comma(k, out);
        real(out, x);
    }
    out.push(b')');
}

/// Makes consecutive entries of `width` numbers each; `start` is the index of the first of them.
pub(super) fn entries(start: usize, values: &[f64], width: usize, out: &mut Bytes) {
    out.append(|out| {
        for (i, row) in (start..).zip(values.chunks_exact(width)) {
            comma(i, out);
            entry(row, out);
        }
    });
}

/// Writes the sizes of the faces, and their vertices.
pub(super) fn faces(mesh: &dyn MeshSource, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    attribute("int[] faceVertexCounts", On::Untold, stream, |stream| {
        stream.faces(mesh, |start, faces, out| {
            out.append(|out| {
                for i in 0..faces.len() {
                    comma(start + i, out);
                    whole(out, faces.size(i) as u64);
                }
            });
        })
    })?;
    attribute("int[] faceVertexIndices", On::Untold, stream, |stream| stream.faces(mesh, corners))
}

/// Writes the places of values at the corners of all faces.
pub(super) fn places(
    name: &str,
    mesh: &dyn MeshSource,
    places: &dyn PlaceSource,
    stream: &mut Stream<'_>,
) -> Result<(), FormatError> {
    let declared = format!("int[] {name}:indices");
    attribute(&declared, On::Untold, stream, |stream| stream.place_faces(mesh, places, corners))
}

/// Makes the corners of consecutive faces; `start` is the index of the first corner.
pub(super) fn corners(start: usize, faces: &FaceChunk, out: &mut Bytes) {
    out.append(|out| {
        for (i, &corner) in faces.vertices.iter().enumerate() {
            comma(start + i, out);
            whole(out, corner.into());
        }
    });
}
