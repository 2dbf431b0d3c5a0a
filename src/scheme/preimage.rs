//! The old points from which an operator with a mask makes the points of a polygon.

use crate::math::rows::{Rows, RowsBy};
use crate::shape::topology::index;

/// The sources of the stored points of a net.
#[derive(Debug, Clone, Copy)]
pub(super) struct Preimages {
    pub(super) n: usize,
    /// The last stored point of the old net, if both ends keep their position.
    pub(super) ends: Option<usize>,
    pub(super) start: isize,
}

impl Preimages {
    /// Returns the rows of all stored points over `n_old` points. Ends that keep their position are copied; `add` makes
    /// the row of any other point of its index `j`, counted as in [`MaskRange`](super::mask_range::MaskRange).
    pub(super) fn rows(
        self,
        n_old: usize,
        add: impl Fn(isize, &mut Rows) + Send + Sync,
    ) -> RowsBy<impl Fn(usize, &mut Rows) + Send + Sync> {
        RowsBy::new(self.n, n_old, move |row, out: &mut Rows| match self.ends {
            Some(_) if row == 0 => out.add(0, 1.0),
            Some(last) if row + 1 == self.n => out.add(index(last), 1.0),
            _ => add(self.start + row.cast_signed(), out),
        })
    }
}
