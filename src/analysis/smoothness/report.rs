//! The full report on one scheme.

use super::local::Neighbourhood;
use super::symbol::Symbol;
use super::values::BasicFunction;
use super::verdict::Smoothness;
use crate::math::exact::ExactSequence;
use crate::math::spectrum::Eigenvalue;
use crate::watch::{Stopped, Watch};

/// Maximum number of derivatives whose values are reported. Half of it hides curvature; twice of it plots what nobody
/// looks at, and makes answers twice as long.
const MAX_DERIVATIVES: usize = 3;

/// The full report on one scheme.
#[derive(Debug, Clone, PartialEq)]
pub struct SmoothnessReport {
    /// The mask and its factors.
    pub symbol: Symbol,
    /// The proved smoothness of limits.
    pub smoothness: Smoothness,
    /// Weights of the limit point at a point, if limits are proved to be continuous.
    pub limit_mask: Option<ExactSequence>,
    /// Weights of the tangent at a point per unit of the parameter, if limits are proved to be C^1.
    pub tangent_mask: Option<ExactSequence>,
    /// The eigenvalues of the local matrix, the largest first; `None` if the computation failed.
    pub local_eigenvalues: Option<Vec<Eigenvalue>>,
}

impl SmoothnessReport {
    /// Computes the report on a scheme with at most `budget` matrix products in the search for bounds.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn of(symbol: Symbol, budget: u64, watch: &Watch) -> Result<Self, Stopped> {
        let smoothness = Smoothness::of(&symbol, budget, watch)?;
        watch.check()?;
        let around = Neighbourhood::new(&symbol);
        let limit_mask = if smoothness.proved_c >= 0 { around.limit_mask() } else { None };
        watch.check()?;
        let tangent_mask = if smoothness.proved_c >= 1 { around.tangent_mask() } else { None };
        let local_eigenvalues = Neighbourhood::reached(&symbol).eigenvalues();
        Ok(Self { symbol, smoothness, limit_mask, tangent_mask, local_eigenvalues })
    }

    /// Evaluates the derivatives of the basic limit function, the first derivative first, as far as they are proved to
    /// be continuous.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn derivatives(&self, grid: u32, watch: &Watch) -> Result<Vec<BasicFunction>, Stopped> {
        let most = usize::try_from(self.smoothness.proved_c).unwrap_or(0).min(MAX_DERIVATIVES);
        let found = (1..=most).map(|k| BasicFunction::derivative(&self.symbol, k, grid, watch));
        Ok(found.collect::<Result<Vec<_>, _>>()?.into_iter().map_while(|found| found).collect())
    }

    /// Evaluates the basic limit function, if it is proved to exist.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn basic_function(&self, grid: u32, watch: &Watch) -> Result<Option<BasicFunction>, Stopped> {
        self.limit_mask.as_ref().map(|limit| BasicFunction::of(&self.symbol, limit, grid, watch)).transpose()
    }
}
