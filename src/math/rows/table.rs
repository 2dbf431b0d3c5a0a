//! The table of weights.

use super::group::symmetric_sum;

/// A table of weights in flat sparse form: row `r` has the entries `starts[r]..starts[r + 1]`.
///
/// Entries of one row are summed in the order they were added, those of a [group](Rows::group) as one term that does
/// not depend on where the group begins; an index may occur more than once.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    starts: Vec<usize>,
    indices: Vec<u32>,
    weights: Vec<f64>,
    /// The groups of more than one entry, ascending.
    groups: Vec<RowTerm>,
}

/// Entries of a row that are summed as one term.
#[derive(Debug, Clone, Copy, PartialEq)]
struct RowTerm {
    /// Index of its first entry.
    start: usize,
    /// Number of entries.
    len: usize,
    /// Whether all entries have the same weight.
    alike: bool,
}

/// One term of a row: a single entry or a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term<'a> {
    /// The old points.
    pub indices: &'a [u32],
    /// The weight of each.
    pub weights: &'a [f64],
    /// Whether all weights are equal, so that the sum of the points is multiplied by the weight.
    pub alike: bool,
}

impl Default for Rows {
    fn default() -> Self {
        Self { starts: vec![0], indices: Vec::new(), weights: Vec::new(), groups: Vec::new() }
    }
}

impl Rows {
    /// Returns the number of complete rows.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Removes all rows and keeps the memory.
    pub fn clear(&mut self) {
        self.starts.truncate(1);
        self.indices.clear();
        self.weights.clear();
        self.groups.clear();
    }

    /// Adds an entry to the current row.
    #[inline]
    pub fn add(&mut self, index: u32, weight: f64) {
        self.indices.push(index);
        self.weights.push(weight);
    }

    /// Groups the entries that `fill` adds to the current row: with a single weight w the term is
    /// `w x symmetric sum of the points`, otherwise the symmetric sum of `weight x point`. A symmetric sum of 2, 4 or 6
    /// members around a centre has the same bits wherever the walk around the centre begins; others are summed in
    /// order.
    #[inline]
    pub fn group(&mut self, fill: impl FnOnce(&mut Self)) {
        let start = self.indices.len();
        fill(self);
        let weights = &self.weights[start..];
        let alike = weights.array_windows().all(|[a, b]| a.to_bits() == b.to_bits());
        if weights.len() > 1 {
            self.groups.push(RowTerm { start, len: weights.len(), alike });
        }
    }

    /// Adds row `r` of another table to the current row, in the same groups, with indices mapped by `number`.
    pub fn copy_row(&mut self, other: &Self, r: usize, number: impl Fn(u32) -> u32) {
        for term in other.terms(r) {
            self.group(|rows| {
                for (&at, &weight) in term.indices.iter().zip(term.weights) {
                    rows.add(number(at), weight);
                }
            });
        }
    }

    /// Removes the rows from row `r` on and returns them as a table.
    #[must_use]
    pub fn split_off(&mut self, r: usize) -> Self {
        let at = self.starts[r];
        let starts = self.starts[r..].iter().map(|start| start - at).collect();
        self.starts.truncate(r + 1);
        let groups = self.groups.split_off(self.groups.partition_point(|group| group.start < at));
        Self {
            starts,
            indices: self.indices.split_off(at),
            weights: self.weights.split_off(at),
            groups: groups.into_iter().map(|group| RowTerm { start: group.start - at, ..group }).collect(),
        }
    }

    /// Appends the rows of another table over the same points.
    pub fn append(&mut self, other: &Self) {
        let at = self.indices.len();
        self.starts.extend(other.starts[1..].iter().map(|start| start + at));
        self.indices.extend_from_slice(&other.indices);
        self.weights.extend_from_slice(&other.weights);
        self.groups.extend(other.groups.iter().map(|group| RowTerm { start: group.start + at, ..*group }));
    }

    /// Returns the index of the first entry of each row, then the number of entries.
    pub fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// Returns the indices of the old points of all entries, row after row.
    pub fn indices(&self) -> &[u32] {
        &self.indices
    }

    /// Returns the weights of all entries, row after row.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Returns whether any entries are summed as a group.
    pub fn has_groups(&self) -> bool {
        !self.groups.is_empty()
    }

    /// Completes the current row.
    #[inline]
    pub fn end_row(&mut self) {
        self.starts.push(self.indices.len());
    }

    /// Returns indices and weights of row `r`.
    #[inline]
    pub fn row(&self, r: usize) -> (&[u32], &[f64]) {
        let range = self.starts[r]..self.starts[r + 1];
        (&self.indices[range.clone()], &self.weights[range])
    }

    /// Returns `x R` for a row `x`: the weights over the `n` old points of the functional with weights `x` over the new
    /// points.
    pub fn times_row(&self, x: &[f64], n: usize) -> Vec<f64> {
        let mut product = vec![0.0; n];
        for (r, &factor) in x.iter().enumerate() {
            let (indices, weights) = self.row(r);
            indices.iter().zip(weights).for_each(|(&index, &weight)| product[index as usize] += factor * weight);
        }
        product
    }

    /// Returns `R y` for a column `y`: the new values computed from the old ones.
    pub fn times_column(&self, y: &[f64]) -> Vec<f64> {
        let value = |r: usize| {
            let (indices, weights) = self.row(r);
            indices.iter().zip(weights).map(|(&index, &weight)| weight * y[index as usize]).sum()
        };
        (0..self.len()).map(value).collect()
    }

    /// Returns the terms of row `r`, in the order of summation.
    pub fn terms(&self, r: usize) -> impl Iterator<Item = Term<'_>> {
        let groups = &self.groups[self.groups.partition_point(|group| group.start < self.starts[r])..];
        let (mut at, end, mut groups) = (self.starts[r], self.starts[r + 1], groups.iter().peekable());
        std::iter::from_fn(move || {
            if at == end {
                return None;
            }
            let group = groups.next_if(|group| group.start == at);
            let (len, alike) = group.map_or((1, true), |group| (group.len, group.alike));
            let range = at..at + len;
            at += len;
            Some(Term { indices: &self.indices[range.clone()], weights: &self.weights[range], alike })
        })
    }

    /// Computes `out[r] = sum of weight x points[index]` for points of `W` coordinates each.
    pub fn apply<const W: usize>(&self, points: &[[f64; W]], out: &mut [[f64; W]]) {
        let mut groups = self.groups.iter();
        let mut group = groups.next();
        for (target, range) in out.iter_mut().zip(self.starts.array_windows()) {
            let [mut at, end] = *range;
            let mut sum = [-0.0; W];
            while at < end {
                let next = group.filter(|group| group.start == at);
                let len = next.map_or(1, |group| group.len);
                let (indices, weights) = (&self.indices[at..at + len], &self.weights[at..at + len]);
                at += len;
                let term: [f64; W] = match next {
                    None => points[indices[0] as usize].map(|x| weights[0] * x),
                    Some(group_here) => {
                        group = groups.next();
                        if group_here.alike {
                            symmetric_sum(len, |k| points[indices[k] as usize]).map(|x| weights[0] * x)
                        } else {
                            symmetric_sum(len, |k| points[indices[k] as usize].map(|x| weights[k] * x))
                        }
                    }
                };
                sum = std::array::from_fn(|c| sum[c] + term[c]);
            }
            *target = sum;
        }
    }
}

/// Returns `sum of weight x point`, in order. The sum starts with -0, which changes no number that is added to it.
#[inline]
pub(super) fn weighted<'a, const W: usize>(pairs: impl Iterator<Item = (&'a f64, &'a [f64; W])>) -> [f64; W] {
    let mut sum = [-0.0; W];
    for (weight, point) in pairs {
        sum = std::array::from_fn(|c| sum[c] + weight * point[c]);
    }
    sum
}
