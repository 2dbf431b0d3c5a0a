//! A list in a list of lists.

/// One list in a list of lists, with a comma before all but the first.
pub(super) fn row(index: usize, out: &mut Vec<u8>, items: impl FnOnce(&mut Vec<u8>)) {
    if index > 0 {
        out.push(b',');
    }
    out.push(b'[');
    items(out);
    out.push(b']');
}
