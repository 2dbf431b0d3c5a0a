//! The positions of the jobs in the text of a batch.

use std::ops::Range;

/// The jobs of a batch as parts of its text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BatchLayout {
    /// A list: the range of the text of each job.
    List(Vec<Range<usize>>),
    /// A grid: a template filled with a value of each axis, row by row, the last axis fastest.
    Grid {
        /// The template in pieces.
        template: Vec<TemplatePiece>,
        /// The axes in order.
        axes: Vec<GridAxis>,
    },
}

/// A piece of a template.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TemplatePiece {
    /// A range of the text of the batch.
    Text(Range<usize>),
    /// Text that does not occur in the batch.
    Written(String),
    /// The value of the axis with this index.
    Value(usize),
}

/// An axis of a grid.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GridAxis {
    /// JSON pointer to the place in the template that the axis fills.
    pub pointer: String,
    /// The range of the text of each value.
    pub values: Vec<Range<usize>>,
}

impl BatchLayout {
    /// Returns the number of jobs, saturating.
    pub fn n(&self) -> u128 {
        match self {
            Self::List(jobs) => jobs.len() as u128,
            Self::Grid { axes, .. } => axes.iter().fold(1, |n, axis| n.saturating_mul(axis.values.len() as u128)),
        }
    }

    /// Returns the total length of the texts of all jobs in bytes, saturating.
    pub fn bytes(&self) -> u128 {
        let (n, length) = (self.n(), |range: &Range<usize>| range.len() as u128);
        match self {
            Self::List(jobs) => jobs.iter().map(length).sum(),
            Self::Grid { template, axes } => {
                let of_piece = |piece: &TemplatePiece| match piece {
                    TemplatePiece::Text(range) => n.saturating_mul(length(range)),
                    TemplatePiece::Written(text) => n.saturating_mul(text.len() as u128),
                    TemplatePiece::Value(at) => axes.get(*at).map_or(0, |axis| {
                        let all: u128 = axis.values.iter().map(length).sum();
                        (n / axis.values.len().max(1) as u128).saturating_mul(all)
                    }),
                };
                template.iter().map(of_piece).fold(0, u128::saturating_add)
            }
        }
    }

    /// Returns the index of the value of each axis in a job; empty for a list.
    pub fn coordinates(&self, job: usize) -> Vec<usize> {
        let Self::Grid { axes, .. } = self else { return Vec::new() };
        let (mut left, mut found) = (job, vec![0; axes.len()]);
        for (place, axis) in found.iter_mut().zip(axes).rev() {
            let n = axis.values.len().max(1);
            (*place, left) = (left % n, left / n);
        }
        found
    }

    /// Returns the text of a job.
    pub fn text(&self, batch: &[u8], job: usize) -> Vec<u8> {
        let of = |range: &Range<usize>| batch.get(range.clone()).unwrap_or_default();
        match self {
            Self::List(jobs) => jobs.get(job).map(of).unwrap_or_default().to_vec(),
            Self::Grid { template, axes } => {
                let coordinates = self.coordinates(job);
                let parts = template.iter().map(|piece| match piece {
                    TemplatePiece::Text(range) => of(range),
                    TemplatePiece::Written(text) => text.as_bytes(),
                    TemplatePiece::Value(axis) => of(&axes[*axis].values[coordinates[*axis]]),
                });
                parts.collect::<Vec<_>>().concat()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_axis_of_a_grid_is_the_fastest() {
        let axis = |values: &[Range<usize>]| GridAxis { pointer: String::new(), values: values.to_vec() };
        let template = vec![
            TemplatePiece::Value(0),
            TemplatePiece::Written("-".to_owned()),
            TemplatePiece::Value(1),
            TemplatePiece::Text(5..6),
        ];
        let layout = BatchLayout::Grid { template, axes: vec![axis(&[0..1, 1..2]), axis(&[2..3, 3..4, 3..5])] };
        let texts: Vec<_> = (0..6).map(|at| String::from_utf8(layout.text(b"abxyz!", at)).expect("text")).collect();
        assert_eq!(texts, ["a-x!", "a-y!", "a-yz!", "b-x!", "b-y!", "b-yz!"]);
        assert_eq!((layout.n(), layout.bytes()), (6, texts.concat().len() as u128));
        assert_eq!(layout.coordinates(4), [1, 1]);
    }
}
