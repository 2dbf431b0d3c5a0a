//! Face corners: `v`, `v/vt`, `v//vn`, `v/vt/vn`, counted from 1, or backwards from the last entry.

use crate::input::text::quoted;
use crate::shape::topology::NONE;

/// Indices of vertex, texture coordinate and normal, counted from 0; [`NONE`] if absent.
pub(super) type ObjCorner = [u32; 3];

const INDEX_KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// Reads a corner; `counts` are the numbers of vertices, texture coordinates and normals before it.
///
/// # Errors
/// The word is not a corner, or a backward index points before the first entry. Forward indices are checked at the end
/// of the file.
pub(super) fn read(word: &str, counts: [usize; 3]) -> Result<ObjCorner, String> {
    let mut corner = [NONE; 3];
    let mut parts = word.split('/');
    for (k, slot) in corner.iter_mut().enumerate() {
        match parts.next() {
            None => break,
            Some("") if k > 0 => {}
            Some(part) => *slot = index(part, INDEX_KINDS[k], counts[k])?,
        }
    }
    if parts.next().is_some() {
        return Err(format!("{} is no corner; write v, v/vt, v//vn or v/vt/vn", quoted(word)));
    }
    Ok(corner)
}

fn index(part: &str, kind: &str, n: usize) -> Result<u32, String> {
    let beyond = |given: i64| match given {
        0 => format!("there is no {kind} 0; they are counted from 1"),
        _ => format!("there is no {kind} {given}; {n} have come before it"),
    };
    let given: i64 = part.parse().map_err(|_| format!("{} is no index of a {kind}", quoted(part)))?;
    let found = match given {
        1.. => u32::try_from(given - 1).ok().filter(|&at| at != NONE),
        0 => None,
        _ => i64::try_from(n).ok().and_then(|n| n.checked_add(given)).and_then(|at| u32::try_from(at).ok()),
    };
    found.ok_or_else(|| beyond(given))
}

/// Describes an index that is beyond the end of the file's list.
pub(super) fn beyond(kind: usize, at: u32, n: usize) -> String {
    format!("there is no {} {}; the file has {n}, counted from 1", INDEX_KINDS[kind], u64::from(at) + 1)
}
