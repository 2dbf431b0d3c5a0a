//! The powers of the local matrix, whose rows converge to the limit mask.

use super::local::Neighbourhood;
use super::matrices::{ExactMatrix, product};
use super::symbol::Symbol;
use crate::math::exact::{Exact, ExactSequence};

/// The local matrix of a scheme and its powers.
#[derive(Debug, Clone, PartialEq)]
pub struct Powers {
    /// The index of the first point around the place, for rows and for columns.
    pub first: i64,
    /// The first power, the second, and so on: row j of a power has the weights of point j after as many steps.
    pub powers: Vec<Vec<Vec<Exact>>>,
    /// The limit of the powers, if convergence is proved: every row is the limit mask.
    pub limit: Option<Vec<Vec<Exact>>>,
}

impl Powers {
    /// Returns the number of rows of the local matrix of a scheme.
    pub fn size(symbol: &Symbol) -> usize {
        Neighbourhood::new(symbol).matrix().len()
    }

    /// Computes the first `count` powers of the local matrix; `limit` is the limit mask.
    pub fn of(symbol: &Symbol, limit: Option<&ExactSequence>, count: u32) -> Self {
        let around = Neighbourhood::new(symbol);
        let matrix = around.matrix();
        let powers = std::iter::successors(Some(matrix.clone()), |power| Some(product(&matrix, power)));
        let powers: Vec<ExactMatrix> = powers.take(count as usize).collect();
        let row = |weights: &ExactSequence| -> Vec<Exact> {
            (around.first()..).take(matrix.len()).map(|i| weights.at(i)).collect()
        };
        let limit = limit.map(|weights| vec![row(weights); matrix.len()]);
        Self { first: around.first(), powers, limit }
    }
}
