//! The old points from which an operator with a mask makes the points of a polygon.

/// The sources of the stored points of a net.
#[derive(Debug, Clone, Copy)]
pub(super) struct Preimages {
    pub(super) n: usize,
    /// The last stored point of the old net, if both ends keep their position.
    pub(super) ends: Option<usize>,
    pub(super) start: isize,
}

/// The source of one stored point.
#[derive(Debug, Clone, Copy)]
pub(super) enum Preimage {
    /// The stored end point of the old net with this index.
    End(usize),
    /// The point with this index `j`, counted as in [`MaskRange`](super::mask_range::MaskRange).
    Point(isize),
}

impl Preimages {
    /// Returns the source of the stored point of a row.
    pub(super) fn of(&self, row: usize) -> Preimage {
        match self.ends {
            Some(_) if row == 0 => Preimage::End(0),
            Some(last) if row + 1 == self.n => Preimage::End(last),
            _ => Preimage::Point(self.start + row.cast_signed()),
        }
    }
}
