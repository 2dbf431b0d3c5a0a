//! The table of weights.

/// A table of weights in flat sparse form: row `r` has the entries `starts[r]..starts[r + 1]`.
///
/// Entries of one row are summed in the order they were added; an index may occur more than once.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    starts: Vec<usize>,
    indices: Vec<u32>,
    weights: Vec<f64>,
}

impl Default for Rows {
    fn default() -> Self {
        Self { starts: vec![0], indices: Vec::new(), weights: Vec::new() }
    }
}

impl Rows {
    /// Number of complete rows.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Drops all rows, keeps the memory.
    pub fn clear(&mut self) {
        self.starts.truncate(1);
        self.indices.clear();
        self.weights.clear();
    }

    /// Adds an entry to the row being made.
    #[inline]
    pub fn add(&mut self, index: u32, weight: f64) {
        self.indices.push(index);
        self.weights.push(weight);
    }

    /// Completes the row being made.
    #[inline]
    pub fn end_row(&mut self) {
        self.starts.push(self.indices.len());
    }

    /// Indices and weights of row `r`.
    #[inline]
    pub fn row(&self, r: usize) -> (&[u32], &[f64]) {
        let range = self.starts[r]..self.starts[r + 1];
        (&self.indices[range.clone()], &self.weights[range])
    }

    /// `x R` for a row `x`: the weights of the `n` old points in a functional that has the weights `x` over the new
    /// ones.
    pub fn times_row(&self, x: &[f64], n: usize) -> Vec<f64> {
        let mut product = vec![0.0; n];
        for (r, &factor) in x.iter().enumerate() {
            let (indices, weights) = self.row(r);
            indices.iter().zip(weights).for_each(|(&index, &weight)| product[index as usize] += factor * weight);
        }
        product
    }

    /// `R y` for a column `y`: the new values for the old ones.
    pub fn times_column(&self, y: &[f64]) -> Vec<f64> {
        let value = |r: usize| {
            let (indices, weights) = self.row(r);
            indices.iter().zip(weights).map(|(&index, &weight)| weight * y[index as usize]).sum()
        };
        (0..self.len()).map(value).collect()
    }

    /// `out[r] = sum of weight x points[index]`, for points of `W` coordinates each.
    pub(super) fn apply<const W: usize>(&self, points: &[[f64; W]], out: &mut [[f64; W]]) {
        for (r, target) in out.iter_mut().enumerate() {
            let (indices, weights) = self.row(r);
            *target = weighted(weights.iter().zip(indices.iter().map(|&index| &points[index as usize])));
        }
    }
}

/// `sum of weight x point`, in order.
#[inline]
pub(super) fn weighted<'a, const W: usize>(pairs: impl Iterator<Item = (&'a f64, &'a [f64; W])>) -> [f64; W] {
    let mut sum = [0.0; W];
    for (weight, point) in pairs {
        sum = std::array::from_fn(|c| sum[c] + weight * point[c]);
    }
    sum
}
