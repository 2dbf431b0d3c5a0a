//! Joins pieces of lines that meet at a vertex.

use std::collections::BTreeMap;

use crate::drawing::{Point, PolylinePoints};
use crate::output::picture::easel::MAX_POLYLINE_POINTS;

/// A straight piece of a line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LineSegment {
    /// The places of its ends.
    pub(super) places: [Point; 2],
    /// The vertices at its ends, where it reaches them.
    pub(super) vertices: [Option<u32>; 2],
}

/// Joins pieces at vertices where exactly two pieces end. Returns the polylines in the order of their first pieces.
pub(super) fn chains(pieces: &[LineSegment]) -> Vec<PolylinePoints> {
    let mut around: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (i, piece) in pieces.iter().enumerate() {
        for vertex in piece.vertices.iter().flatten() {
            around.entry(*vertex).or_default().push(i);
        }
    }
    let mut used = vec![false; pieces.len()];
    let mut runs = Vec::new();
    for first in 0..pieces.len() {
        if std::mem::replace(&mut used[first], true) {
            continue;
        }
        let mut run: PolylinePoints = pieces[first].places.to_vec();
        extend(&mut run, pieces[first].vertices[1], (pieces, &around), &mut used);
        run.reverse();
        extend(&mut run, pieces[first].vertices[0], (pieces, &around), &mut used);
        runs.push(run);
    }
    runs
}

/// Continues a run from the vertex at its end.
fn extend(
    run: &mut PolylinePoints,
    from: Option<u32>,
    (pieces, around): (&[LineSegment], &BTreeMap<u32, Vec<usize>>),
    used: &mut [bool],
) {
    let mut at = from;
    while let Some(vertex) = at.filter(|_| run.len() < MAX_POLYLINE_POINTS) {
        let [a, b] = around[&vertex][..] else { return };
        let Some(next) = [a, b].into_iter().find(|i| !used[*i]) else { return };
        used[next] = true;
        let far = usize::from(pieces[next].vertices[0] == Some(vertex));
        run.push(pieces[next].places[far]);
        at = pieces[next].vertices[far];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(from: u32, to: u32) -> LineSegment {
        let place = |v: u32| [f32::from(u16::try_from(v).expect("a small number")), 0.0];
        LineSegment { places: [place(from), place(to)], vertices: [Some(from), Some(to)] }
    }

    #[test]
    fn pieces_are_joined_where_two_meet_whatever_their_directions() {
        let runs = chains(&[piece(2, 1), piece(2, 3), piece(0, 1), piece(3, 4), piece(3, 5)]);
        let xs: Vec<Vec<f32>> = runs.iter().map(|run| run.iter().map(|place| place[0]).collect()).collect();
        assert_eq!(xs, vec![vec![0.0, 1.0, 2.0, 3.0], vec![4.0, 3.0], vec![5.0, 3.0]]);
    }
}
