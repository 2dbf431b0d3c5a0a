//! The segments in which a plane crosses triangles, joined to chains.

use rayon::prelude::*;

use crate::output::scene::ROWS_PER_CHUNK;
use crate::shape::topology::{NONE, index};
use crate::watch::{Stopped, Watch};

/// The crossing of a plane and a line between two vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Crossing {
    /// The vertices, the lower one first.
    pub(super) ends: [u32; 2],
    /// [`NONE`] for an edge of the mesh, the face for a diagonal inside it.
    pub(super) inside: u32,
}

/// The crossing of a plane and a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct CutSegment {
    /// The crossing on the side that runs from before the plane to behind it.
    pub(super) from: Crossing,
    /// The crossing on the side that runs from behind the plane to before it.
    pub(super) to: Crossing,
}

/// Joins segments to chains. Returns the crossings along each chain, and whether it is closed.
///
/// A segment continues with the segment that starts where it ends. If a side has more than two triangles, as in meshes
/// with two edges between the same vertices, the first end continues with the first start, and so on; so chains are
/// closed wherever sides have as many ends as starts.
pub(super) fn chains(mut segments: Vec<CutSegment>, watch: &Watch) -> Result<Vec<(Vec<Crossing>, bool)>, Stopped> {
    watch.check()?;
    segments.par_sort_by_key(|segment| segment.from);
    watch.check()?;
    let (next, is_start) = links(&segments);
    let mut chains = Vec::new();
    let mut done = vec![false; segments.len()];
    let mut steps = 0_usize;
    let opens = (0..segments.len()).filter(|&i| is_start[i]);
    for start in opens.chain(0..segments.len()) {
        let mut crossings = Vec::new();
        let mut at = start;
        while !done[at] {
            steps += 1;
            if steps.is_multiple_of(ROWS_PER_CHUNK) {
                watch.check()?;
            }
            done[at] = true;
            crossings.push(segments[at].from);
            if next[at] == NONE {
                crossings.push(segments[at].to);
                break;
            }
            at = next[at] as usize;
        }
        if !crossings.is_empty() {
            chains.push((crossings, !is_start[start]));
        }
    }
    Ok(chains)
}

/// Returns for each segment its successor, or [`NONE`], and whether it has no predecessor.
fn links(segments: &[CutSegment]) -> (Vec<u32>, Vec<bool>) {
    let mut ends: Vec<u32> = (0..index(segments.len())).collect();
    ends.par_sort_by_key(|&i| segments[i as usize].to);
    let (mut next, mut is_start) = (vec![NONE; segments.len()], vec![true; segments.len()]);
    let mut ends = ends.into_iter().peekable();
    for (i, segment) in segments.iter().enumerate() {
        while ends.next_if(|&end| segments[end as usize].to < segment.from).is_some() {}
        if let Some(end) = ends.next_if(|&end| segments[end as usize].to == segment.from) {
            next[end as usize] = index(i);
            is_start[i] = false;
        }
    }
    (next, is_start)
}
