//! Rows of a PLY file that are all alike, many at a time.

use super::layout::{PlyEncoding, PlyLayout};
use crate::output::bytes::Bytes;
use crate::output::normals::or_up;
use crate::output::numbers::{f32_bytes, f64_bytes};
use crate::output::scene::FaceChunk;
use crate::output::text::RowStyle;

/// Makes binary rows of positions, each with its normal if there are normals.
pub(super) fn vertices(positions: &[[f64; 3]], normals: &[[f64; 3]], layout: PlyLayout, out: &mut Bytes) {
    if layout.float { vectors(positions, normals, f32_bytes, out) } else { vectors(positions, normals, f64_bytes, out) }
}

fn vectors<const B: usize>(
    positions: &[[f64; 3]],
    normals: &[[f64; 3]],
    bytes: impl Fn([f64; 3]) -> [u8; B],
    out: &mut Bytes,
) {
    if normals.is_empty() {
        let slots = out.rows(positions.len()).iter_mut();
        slots.zip(positions).for_each(|(slot, &position)| *slot = bytes(position));
    } else {
        let pairs = out.rows(2 * positions.len()).as_chunks_mut::<2>().0.iter_mut();
        let rows = positions.iter().zip(normals);
        pairs.zip(rows).for_each(|(pair, (&position, &normal))| *pair = [position, or_up(normal)].map(&bytes));
    }
}

/// Makes rows of faces that are all quads or all triangles. Returns whether they are.
pub(super) fn faces(faces: &FaceChunk, layout: PlyLayout, out: &mut Bytes) -> bool {
    match (faces.rows(), faces.rows()) {
        (Some(quads), _) => match layout.encoding {
            PlyEncoding::Ascii => text(b"4").faces(faces, 0, out),
            PlyEncoding::Uchar => polygons::<4, 17>(quads, out),
            PlyEncoding::Uint => polygons::<4, 20>(quads, out),
        },
        (None, Some(triangles)) => match layout.encoding {
            PlyEncoding::Ascii => text(b"3").faces(faces, 0, out),
            PlyEncoding::Uchar => polygons::<3, 13>(triangles, out),
            PlyEncoding::Uint => polygons::<3, 16>(triangles, out),
        },
        (None, None) => return false,
    }
    true
}

/// Makes rows of `B` bytes: the number `N`, little endian, in the bytes that four bytes per index leave, then the
/// indices.
fn polygons<const N: usize, const B: usize>(faces: &[[u32; N]], out: &mut Bytes) {
    let size = (N as u64).to_le_bytes();
    for (slot, face) in out.rows::<B>(faces.len()).iter_mut().zip(faces) {
        let (head, indices) = slot.split_at_mut(B - 4 * N);
        head.copy_from_slice(&size[..B - 4 * N]);
        indices.as_chunks_mut().0.iter_mut().zip(face).for_each(|(place, vertex)| *place = vertex.to_le_bytes());
    }
}

fn text(size: &'static [u8]) -> RowStyle {
    RowStyle { start: size, open: b' ', between: b' ', end: b"\n" }
}
