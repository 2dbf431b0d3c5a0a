//! Parts of lines, as shares of the way from their start to their end.

use crate::raster::ProjectedPoint;

/// Pieces and gaps shorter than this are ignored, pixels. Half of it shows pieces cut by rounding only; twice of it can
/// be seen.
const LEAST_PIECE_PX: f64 = 0.1;

/// The hidden or the visible parts of a line, ascending.
pub(super) type LineIntervals = Vec<[f64; 2]>;

/// Returns the hidden parts without gaps and parts too short to be seen.
pub(super) fn tidied(hidden: &[[f64; 2]], [a, b]: [ProjectedPoint; 2]) -> LineIntervals {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length = (dx * dx + dy * dy).sqrt();
    if length < LEAST_PIECE_PX {
        let middle = hidden.iter().any(|[from, to]| (*from..=*to).contains(&0.5));
        return if middle { vec![[0.0, 1.0]] } else { Vec::new() };
    }
    let least = LEAST_PIECE_PX / length;
    let mut found: LineIntervals = Vec::new();
    for [from, to] in hidden {
        let from = if *from < least { 0.0 } else { *from };
        let to = if *to > 1.0 - least { 1.0 } else { *to };
        match found.last_mut().filter(|last| from - last[1] < least) {
            Some(last) => last[1] = to,
            None => found.push([from, to]),
        }
    }
    found.retain(|[from, to]| to - from >= least);
    found
}

/// Returns the complement of the parts in the whole line.
pub(super) fn rest(parts: &[[f64; 2]]) -> LineIntervals {
    let starts = std::iter::once(0.0).chain(parts.iter().map(|part| part[1]));
    let ends = parts.iter().map(|part| part[0]).chain([1.0]);
    starts.zip(ends).filter(|(from, to)| from < to).map(|(from, to)| [from, to]).collect()
}
