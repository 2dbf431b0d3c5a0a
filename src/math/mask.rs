//! Masks: the weights with which a linear scheme of some arity distributes each point.

/// A mask `a`: `q[j] = sum over i of a[j - d i] p[i]`; entry `k` of `values` is `a[first + k]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    /// Index of the first entry.
    pub first: i32,
    /// Entries; the first and the last are not 0.
    pub values: Vec<f64>,
}

impl Mask {
    /// Creates a mask without zeros at its ends; `None` if all entries are 0.
    pub fn new(first: i32, values: &[f64]) -> Option<Self> {
        let from = values.iter().position(|&a| a != 0.0)?;
        let to = values.iter().rposition(|&a| a != 0.0)?;
        let first = first.checked_add(i32::try_from(from).ok()?)?;
        Some(Self { first, values: values[from..=to].to_vec() })
    }

    /// Returns the index of the last entry.
    pub fn last(&self) -> i32 {
        let width = i32::try_from(self.values.len() - 1).expect("masks have at most a few hundred entries");
        self.first + width
    }

    /// Returns whether the mask is symmetric about its middle.
    pub fn is_symmetric(&self) -> bool {
        self.values.iter().eq(self.values.iter().rev())
    }

    /// Returns the entry `a[k]`; 0 outside the mask.
    pub fn at(&self, k: isize) -> f64 {
        let place = k.checked_sub(self.first as isize).and_then(|place| usize::try_from(place).ok());
        place.and_then(|place| self.values.get(place)).copied().unwrap_or(0.0)
    }

    /// Returns the sums of the entries of each residue class modulo the arity; all are 1 for a convergent scheme.
    pub fn residue_sums(&self, arity: u32) -> Vec<f64> {
        let mut sums = vec![0.0; arity as usize];
        for (k, value) in (self.first..).zip(&self.values) {
            let residue = k.rem_euclid(i32::try_from(arity).expect("arities are small"));
            sums[residue.unsigned_abs() as usize] += value;
        }
        sums
    }
}
