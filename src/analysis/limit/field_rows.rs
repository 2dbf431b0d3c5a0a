//! The rows of a field, one for each vertex or sector of one.

use std::ops::Range;

use super::field::{Field, Functional};
use crate::math::rows::{RowSource, Rows};

/// The rows of a field.
#[derive(Debug)]
pub(super) struct FieldRows<'a> {
    /// The field.
    pub(super) field: &'a Field<'a>,
    /// Vertices and sectors of them, one for each row.
    pub(super) places: &'a [(u32, usize)],
    /// What the rows are for.
    pub(super) functional: Functional,
}

impl RowSource for FieldRows<'_> {
    fn n_rows(&self) -> usize {
        self.places.len()
    }

    fn n_columns(&self) -> usize {
        self.field.n_points()
    }

    fn make(&self, range: Range<usize>, out: &mut Rows) {
        for &(v, sector) in &self.places[range] {
            self.field.row(v as usize, sector, self.functional, out);
            out.end_row();
        }
    }
}
