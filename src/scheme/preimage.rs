//! Where the points of a polygon come from under an operator with a window.

/// Of what the stored points of a net are made.
#[derive(Debug, Clone, Copy)]
pub(super) struct Preimages {
    pub(super) n: usize,
    /// The last stored point of the old net, when the two ends stay where they are.
    pub(super) ends: Option<usize>,
    pub(super) start: isize,
}

/// Of what one stored point is made.
#[derive(Debug, Clone, Copy)]
pub(super) enum Preimage {
    /// It is this stored end point of the old net.
    End(usize),
    /// It has this index `j` in the window.
    Point(isize),
}

impl Preimages {
    /// Of what the stored point of this row is made.
    pub(super) fn of(&self, row: usize) -> Preimage {
        match self.ends {
            Some(_) if row == 0 => Preimage::End(0),
            Some(last) if row + 1 == self.n => Preimage::End(last),
            _ => Preimage::Point(self.start + row.cast_signed()),
        }
    }
}
