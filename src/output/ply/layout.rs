//! The encodings of rows of a PLY file.

use crate::math::parameter::Values;
use crate::output::numbers::{REAL_BYTES, real, real_f32, rounded, whole};
use crate::output::surface::with_normals;

/// The encoding and the columns of rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlyLayout {
    pub(super) encoding: PlyEncoding,
    pub(super) float: bool,
    pub(super) normals: bool,
    pub(super) ids: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PlyEncoding {
    Ascii,
    /// Binary, one byte for the size of a face.
    Uchar,
    /// Binary, four bytes for the size of a face.
    Uint,
}

impl PlyLayout {
    pub(super) fn of(options: &Values) -> Self {
        Self {
            encoding: match (options.flag("ascii"), options.choice("face_sizes")) {
                (true, _) => PlyEncoding::Ascii,
                (false, Some("uint")) => PlyEncoding::Uint,
                (false, _) => PlyEncoding::Uchar,
            },
            float: options.choice("precision") == Some("f32"),
            normals: with_normals(options),
            ids: options.flag("ids"),
        }
    }

    /// Returns the layout of curves, which have no normals and no origins.
    pub(super) fn of_curves(options: &Values) -> Self {
        Self { normals: false, ids: false, ..Self::of(options) }
    }

    /// Returns the number of coordinates per vertex.
    pub(super) fn numbers(self) -> usize {
        if self.normals { 6 } else { 3 }
    }

    /// Returns the number of bytes per vertex; for text, its maximum.
    pub(super) fn vertex_bytes(self) -> u128 {
        let number = match (self.encoding, self.float) {
            (PlyEncoding::Ascii, _) => REAL_BYTES + 1,
            (_, true) => 4,
            (_, false) => 8,
        };
        self.numbers() as u128 * number
    }

    pub(super) fn vertex(self, numbers: &[f64], out: &mut Vec<u8>) {
        for (k, &x) in numbers.iter().enumerate() {
            if k > 0 {
                self.separate(out);
            }
            self.number(x, out);
        }
    }

    /// Appends the separator between two numbers.
    pub(super) fn separate(self, out: &mut Vec<u8>) {
        if self.encoding == PlyEncoding::Ascii {
            out.push(b' ');
        }
    }

    pub(super) fn number(self, x: f64, out: &mut Vec<u8>) {
        match (self.encoding, self.float) {
            (PlyEncoding::Ascii, true) => real_f32(out, x),
            (PlyEncoding::Ascii, false) => real(out, x),
            (_, true) => out.extend_from_slice(&rounded(x).to_le_bytes()),
            (_, false) => out.extend_from_slice(&x.to_le_bytes()),
        }
    }

    pub(super) fn byte(self, x: u8, out: &mut Vec<u8>) {
        if self.encoding == PlyEncoding::Ascii { whole(out, x.into()) } else { out.push(x) }
    }

    pub(super) fn face(self, face: &[u32], out: &mut Vec<u8>) {
        let size = face.len() as u64;
        match self.encoding {
            PlyEncoding::Ascii => whole(out, size),
            PlyEncoding::Uchar => out.extend_from_slice(&size.to_le_bytes()[..1]),
            PlyEncoding::Uint => out.extend_from_slice(&size.to_le_bytes()[..4]),
        }
        for &vertex in face {
            self.separate(out);
            self.index(vertex, out);
        }
    }

    pub(super) fn edge(self, [a, b]: [u32; 2], out: &mut Vec<u8>) {
        self.index(a, out);
        self.separate(out);
        self.index(b, out);
        self.end_row(out);
    }

    pub(super) fn index(self, vertex: u32, out: &mut Vec<u8>) {
        match self.encoding {
            PlyEncoding::Ascii => whole(out, u64::from(vertex)),
            PlyEncoding::Uchar | PlyEncoding::Uint => out.extend_from_slice(&vertex.to_le_bytes()),
        }
    }

    pub(super) fn end_row(self, out: &mut Vec<u8>) {
        if self.encoding == PlyEncoding::Ascii {
            out.push(b'\n');
        }
    }
}
