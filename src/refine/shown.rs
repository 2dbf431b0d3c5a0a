//! The faces of a refined mesh that are shown, that is, not in holes.

use std::ops::Range;

use crate::shape::order::Order;
use crate::shape::topology::Topology;

/// The shown faces, stored as runs of consecutive faces.
#[derive(Debug)]
pub(super) struct ShownFaces {
    /// For each run, its first index among the shown faces, and its first face.
    runs: Vec<(usize, usize)>,
    /// Number of shown faces.
    pub(super) n: usize,
    /// Sum of the sizes of the shown faces.
    pub(super) n_half_edges: usize,
}

impl ShownFaces {
    /// Collects all faces but those that refine a face in `holes`; `holes` lists faces of the base, ascending.
    pub(super) fn new(base: &Topology, order: Option<&Order>, holes: &[u32]) -> Self {
        let all = order.map_or(base.n_faces(), Order::n_faces);
        let first = |f: usize| if f == base.n_faces() { all } else { order.map_or(f, |order| order.first_face(f)) };
        let size = |f: usize| base.face(f).len();
        let mut runs = Vec::new();
        let (mut n, mut n_half_edges, mut from) = (0, 0, 0);
        let hidden = holes.iter().map(|&f| f as usize).chain([base.n_faces()]);
        for hole in hidden {
            if hole > from {
                runs.push((n, first(from)));
                n += first(hole) - first(from);
                n_half_edges += (from..hole).map(size).sum::<usize>();
            }
            from = hole + 1;
        }
        let n_half_edges = order.map_or(n_half_edges, |order| order.face_size() * n);
        Self { runs, n, n_half_edges }
    }

    /// Returns the index of `face` among the shown faces, or that of the next shown face if it is hidden.
    pub(super) fn number(&self, face: usize) -> usize {
        let run = self.runs.partition_point(|(_, first)| *first <= face);
        let end = self.runs.get(run).map_or(self.n, |(number, _)| *number);
        let number = run.checked_sub(1).map_or(0, |run| self.runs[run].0 + face - self.runs[run].1);
        number.min(end)
    }

    /// Returns the faces that are shown as `range`, in runs of consecutive faces.
    pub(super) fn runs(&self, range: Range<usize>) -> impl Iterator<Item = Range<usize>> + Clone {
        let first = self.runs.partition_point(|(number, _)| *number <= range.start).saturating_sub(1);
        let ends = self.runs.iter().skip(first + 1).map(|(number, _)| *number).chain([self.n]);
        let runs = self.runs[first..].iter().zip(ends);
        runs.take_while(move |((number, _), _)| *number < range.end).map(move |(&(number, face), end)| {
            let of = |shown: usize| face + shown - number;
            of(range.start.max(number))..of(range.end.min(end))
        })
    }

    /// Returns whether a face is shown.
    pub(super) fn has(&self, face: usize) -> bool {
        let number = self.number(face);
        number < self.n && self.face(number) == face
    }

    /// Returns the face that has index `shown` among the shown ones.
    pub(super) fn face(&self, shown: usize) -> usize {
        let run = self.runs.partition_point(|(first, _)| *first <= shown) - 1;
        let (first_shown, first) = self.runs[run];
        first + shown - first_shown
    }
}
