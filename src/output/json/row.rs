//! Lists in a list of lists.

use crate::output::bytes::Bytes;
use crate::output::scene::FaceChunk;
use crate::output::text::RowStyle;

/// A list with a comma before it, which the caller removes from the first list.
const LIST_ROW: RowStyle = RowStyle { start: b",", open: b'[', between: b',', end: b"]" };

/// Appends a comma before all but the first entry of a list.
pub(super) fn comma(index: usize, out: &mut Vec<u8>) {
    if index > 0 {
        out.push(b',');
    }
}

/// Appends a list to a list of lists, with a comma before all but the first.
pub(super) fn row(index: usize, out: &mut Vec<u8>, items: impl FnOnce(&mut Vec<u8>)) {
    comma(index, out);
    out.push(b'[');
    items(out);
    out.push(b']');
}

/// Makes lists of numbers in a list of lists; `start` is the index of the first of them.
pub(super) fn vectors(start: usize, rows: &[impl AsRef<[f64]>], out: &mut Bytes) {
    LIST_ROW.vectors(rows.iter().map(AsRef::as_ref), out);
    if start == 0 {
        out.drop_first();
    }
}

/// Makes lists of indices in a list of lists; `start` is the index of the first of them.
pub(super) fn faces(start: usize, faces: &FaceChunk, out: &mut Bytes) {
    LIST_ROW.faces(faces, 0, out);
    if start == 0 {
        out.drop_first();
    }
}
