//! Sums of vectors of the faces around vertices, for points that are computed on demand.

use std::ops::Range;

use super::places::{Span, spans};
use super::window::{GridWindow, OnDemand};
use crate::math::vector::plus;

/// A contribution of a face to a vertex: the index of the vertex in the range, the face, and the vector.
type FaceVector = (usize, usize, [f64; 3]);

impl OnDemand {
    /// Fills `out` with the sum, for each vertex in `range`, of the vectors of the shown faces around it, added in the
    /// order of the faces; `of_face` gives the vector of a face from its corners.
    pub(crate) fn sums(
        &self,
        range: Range<usize>,
        is_shown: impl Fn(usize) -> bool,
        of_face: impl Fn([[f64; 3]; 4]) -> [f64; 3],
        out: &mut Vec<[f64; 3]>,
    ) {
        out.clear();
        out.resize(range.len(), [0.0; 3]);
        let places = &self.places;
        let (mut inside, mut strips) = (Vec::new(), Vec::new());
        for (at, span) in spans(range, |v| places.span(v)) {
            places.divide(at, span, &mut inside, &mut strips);
        }
        let mut sums = RowSums::default();
        self.windows(&inside, [1, 1], |at, span, window| {
            if is_shown(places.face(span.patch, span.from)) {
                sums.add(span, window, &of_face, &mut out[at..at + span.len]);
            }
        });
        strips.sort_by_key(|(_, strip)| strip.patch);
        let mut given: Vec<FaceVector> = Vec::new();
        self.windows(&strips, [0, 1], |at, strip, window| {
            // each face of a strip lies between two vertices of the strip; around a corner there is a single vertex
            let n_vertices = (strip.len - 1).max(1);
            for k in 0..strip.len {
                let (cell, face) = (strip.place(k), places.face(strip.patch, strip.place(k)));
                if is_shown(face) {
                    let vector = of_face(window.cell(cell));
                    let vertices = k.saturating_sub(1)..(k + 1).min(n_vertices);
                    given.extend(vertices.map(|vertex| (at + vertex, face, vector)));
                }
            }
        });
        given.sort_unstable_by_key(|&(vertex, face, _)| (vertex, face));
        given.into_iter().for_each(|(vertex, _, vector)| out[vertex] = plus(out[vertex], vector));
    }
}

/// Sums of consecutive rows of vertices; each row shares faces with the next one.
#[derive(Default)]
struct RowSums {
    /// The vectors of the faces in the row above a span.
    above: Vec<[f64; 3]>,
    below: Vec<[f64; 3]>,
    /// The span to which `above` belongs.
    of: Option<Span>,
}

impl RowSums {
    fn add(
        &mut self,
        span: &Span,
        window: &GridWindow<'_>,
        of_face: impl Fn([[f64; 3]; 4]) -> [f64; 3],
        out: &mut [[f64; 3]],
    ) {
        let [i, j] = span.from;
        let row = |j: usize, vectors: &mut Vec<[f64; 3]>| {
            vectors.clear();
            let sides = window.row([i - 1, j]).windows(2).zip(window.row([i - 1, j + 1]).windows(2));
            let corners = sides.map(|(low, high)| [low[0], low[1], high[1], high[0]]);
            vectors.extend(corners.take(span.len + 1).map(&of_face));
        };
        if self.of == Some(Span { from: [i, j - 1], ..*span }) {
            std::mem::swap(&mut self.above, &mut self.below);
        } else {
            row(j - 1, &mut self.below);
        }
        row(j, &mut self.above);
        self.of = Some(*span);
        for ((sum, below), above) in out.iter_mut().zip(self.below.windows(2)).zip(self.above.windows(2)) {
            let vectors = [below[0], below[1], above[0], above[1]];
            *sum = vectors.into_iter().fold(*sum, plus);
        }
    }
}
