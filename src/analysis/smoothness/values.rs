//! Values of the basic limit function, the limit of the data 1 at one point and 0 at all others.

use num_traits::ToPrimitive;

use super::local::Neighbourhood;
use super::symbol::Symbol;
use crate::math::exact::{Exact, ExactSequence, rounded};
use crate::math::number::Number;
use crate::watch::{Stopped, Watch};

/// Values of a function at `(first + k) / d^grid`, k = 0, 1, ...
#[derive(Debug, Clone, PartialEq)]
pub struct BasicFunction {
    /// The number g of refinement steps of the grid, whose points are `d^-g` apart.
    pub grid: u32,
    /// The index of the first point of the grid.
    pub first: i64,
    /// The values from `first` on.
    pub values: Vec<f64>,
}

impl BasicFunction {
    /// Returns the number of values on a grid; `None` if it overflows.
    pub fn count(symbol: &Symbol, grid: u32) -> Option<u64> {
        let [from, to] = symbol.support();
        let steps = u64::try_from(symbol.arity).ok()?.checked_pow(grid)?;
        steps.checked_mul((to - from).ceil().to_integer().to_u64()?)?.checked_add(1)
    }

    /// Returns the k-th derivative, which is the k-th difference at integer distances of the basic limit function with
    /// mask `d (sigma/d)^(K-k) b`; `None` if the derivative is not known to be continuous.
    ///
    /// # Errors
    /// [`Stopped`].
    pub(super) fn derivative(symbol: &Symbol, k: usize, grid: u32, watch: &Watch) -> Result<Option<Self>, Stopped> {
        let d = Exact::whole(symbol.arity);
        let mask = k.checked_sub(1).and_then(|before| symbol.difference(before));
        let mask: Option<Vec<Exact>> = mask.map(|mask| mask.iter().map(|b| b * &d).collect());
        let Some(symbol) = mask.and_then(|mask| Symbol::exact(symbol.arity, symbol.first, &mask)) else {
            return Ok(None);
        };
        let Some(limit) = Neighbourhood::new(&symbol).limit_mask() else { return Ok(None) };
        let mut function = Self::of(&symbol, &limit, grid, watch)?;
        let steps = usize::try_from(symbol.arity.pow(grid)).unwrap_or(0);
        for _ in 0..k {
            watch.check()?;
            function.values.extend(std::iter::repeat_n(0.0, steps));
            for place in (steps..function.values.len()).rev() {
                function.values[place] -= function.values[place - steps];
            }
        }
        Ok(Some(function))
    }

    /// Computes the values: the impulse is refined `grid` times, and its points are then moved to their limits by the
    /// weights of limit points.
    ///
    /// # Errors
    /// [`Stopped`].
    pub(super) fn of(symbol: &Symbol, limit: &ExactSequence, grid: u32, watch: &Watch) -> Result<Self, Stopped> {
        let mask: Vec<f64> = symbol.mask.iter().map(rounded).collect();
        let d = usize::try_from(symbol.arity).unwrap_or(1);
        let (mut first, mut points) = (0, vec![1.0]);
        for _ in 0..grid {
            watch.check()?;
            let mut next = vec![0.0; d * (points.len() - 1) + mask.len()];
            for (i, p) in points.iter().enumerate() {
                mask.iter().enumerate().for_each(|(j, a)| next[d * i + j] += a * p);
            }
            (first, points) = (symbol.arity * first + symbol.first, next);
        }
        // the limit of point k is the sum of weights[i] p[k + first of the weights + i]
        let weights: Vec<f64> = limit.values.iter().map(rounded).collect();
        let reach = weights.len() - 1;
        let at = |place: usize| place.checked_sub(reach).and_then(|place| points.get(place)).copied().unwrap_or(0.0);
        let sum = |k: usize| weights.iter().enumerate().map(|(i, w)| w * at(k + i)).sum();
        let values: Vec<f64> = (0..points.len() + reach).map(sum).collect();
        let width = i64::try_from(reach).unwrap_or(0);
        Ok(Self { grid, first: first - limit.first - width, values })
    }
}
