//! Conclusions on smoothness from bounds and certificates.

use num_traits::{One, Signed};

use super::lower::{self, Lower, Search};
use super::matrices::of_residual;
use super::norms::{Certificate, certificates};
use super::reduction::Reduction;
use super::stability::is_stable;
use super::symbol::Symbol;
use super::upper::{self, Upper};
use crate::math::exact::{Exact, binary, rounded};
use crate::math::functions::ln;
use crate::math::number::Number;
use crate::watch::{Stopped, Watch};

/// By what share the radius of a rounded scheme has to lie above a threshold before something is disproved.
/// It is a million times what rounding changes of short masks. Half and twice of it only matter to schemes that lie so
/// close to the end of a range.
const MARGIN: f64 = 1e-6;

/// The conclusion on the smoothness of limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothness {
    /// Certificates by norms.
    pub certificates: Vec<Certificate>,
    /// The largest k for which limits are proved to be C^k, -1 where not even convergence is.
    pub proved_c: i64,
    /// The largest k for which that is proved by the scheme's own differences, which shrink: such proofs carry over to
    /// schemes that come close to it.
    pub contracts_c: i64,
    /// The smallest k for which it is disproved that limits are C^k.
    pub disproved_c: Option<i64>,
    /// Whether the integer shifts of the basic limit function are proved to be stable.
    pub is_stable: bool,
    /// The scheme with stable shifts whose basic limit function it is a combination of, where its own are not.
    pub reduction: Option<Reduction>,
    /// The joint spectral radius of the residual's matrices; `None` without sum rules.
    pub radius: Option<Radius>,
}

/// Bounds of the joint spectral radius and of the exponent that follows.
#[derive(Debug, Clone, PartialEq)]
pub struct Radius {
    /// From below.
    pub lower: Lower,
    /// From above.
    pub upper: Upper,
    /// The Hoelder exponent lies between; the upper end needs stable shifts, or a reduction to such.
    pub holder: [f64; 2],
}

impl Smoothness {
    /// What can be proved with so many products of matrices.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn of(symbol: &Symbol, budget: u64, watch: &Watch) -> Result<Self, Stopped> {
        let Some(most) = i64::try_from(symbol.order).ok().filter(|order| *order > 0) else {
            let (certificates, reduction, radius) = (Vec::new(), None, None);
            let (proved_c, contracts_c, disproved_c) = (-1, -1, Some(0));
            return Ok(Self { certificates, proved_c, contracts_c, disproved_c, is_stable: false, reduction, radius });
        };
        let is_stable = is_stable(symbol);
        let certificates = certificates(symbol);
        watch.check()?;
        let matrices = of_residual(&symbol.residual, symbol.arity);
        // limits are C^k when the radius is below d^(K-1-k)
        let threshold = |k: i64| threshold(symbol, most - 1 - k);
        let Search { first, best, nodes } = lower::search(&matrices, budget, watch)?;
        let first = first.unwrap_or_else(|| lower::of_mean(&matrices));
        let lower = best.unwrap_or_else(|| first.clone());
        let thresholds: Vec<Exact> = (0..most).map(threshold).collect();
        let upper = upper::bound(&matrices, &first, &thresholds, budget - nodes, watch)?.after(nodes);
        let by_radius = (0..most).rev().find(|&k| upper.stays_below(&threshold(k)));
        let by_norms = certificates.iter().filter_map(|c| i64::try_from(c.k).ok()).max();
        let proved_c = by_radius.max(by_norms).unwrap_or(-1);
        let disproved_c = disproved(symbol, &lower, most);
        let holder = [exponent(symbol, &over(&upper), -1.0), exponent(symbol, &binary(lower.value), 1.0)];
        // where differences do not shrink a scheme diverges, whether its shifts are stable or not
        let diverges = disproved_c == Some(0);
        let disproved_c = disproved_c.filter(|_| is_stable || diverges);
        let left = budget.saturating_sub(upper.nodes);
        let radius = Some(Radius { lower, upper, holder });
        let (contracts_c, reduction) = (proved_c, None);
        let found = Self { certificates, proved_c, contracts_c, disproved_c, is_stable, reduction, radius };
        match if is_stable || diverges { None } else { Reduction::of(symbol) } {
            Some(reduction) => found.with(reduction, left, watch),
            None => Ok(found),
        }
    }

    /// What the scheme with stable shifts adds: the two basic limit functions are C^k for the same k. That a scheme
    /// converges is its own affair, and has to be proved by its own matrices.
    fn with(self, reduction: Reduction, budget: u64, watch: &Watch) -> Result<Self, Stopped> {
        let stable = Self::of(&reduction.symbol, budget, watch)?;
        let proved_c = if self.proved_c < 0 { -1 } else { self.proved_c.max(stable.proved_c) };
        let radius = self.radius.zip(stable.radius).map(|(own, of_stable)| {
            let Radius { lower, upper, holder: [least, _] } = own;
            let upper = upper.after(of_stable.upper.nodes);
            Radius { lower, upper, holder: [least.max(of_stable.holder[0]), of_stable.holder[1]] }
        });
        Ok(Self { proved_c, disproved_c: stable.disproved_c, reduction: Some(reduction), radius, ..self })
    }
}

/// The smallest k for which limits are not C^k, given stable shifts: the radius is `d^(K-1-k)` at least, or there are
/// no K + 1 sum rules. Where the mask is rounded, the radius has to be larger by far more than that can make it, and a
/// missing sum rule says nothing.
fn disproved(symbol: &Symbol, lower: &Lower, most: i64) -> Option<i64> {
    let margin = if symbol.is_exact { Exact::one() } else { Exact::one() + binary(MARGIN) };
    let found = (0..most).find(|&k| lower.reaches(&(threshold(symbol, most - 1 - k) * &margin)));
    found.or_else(|| symbol.is_exact.then_some(most))
}

/// `d^n`.
fn threshold(symbol: &Symbol, n: i64) -> Exact {
    Exact::whole(symbol.arity).pow(i32::try_from(n).unwrap_or(0))
}

fn over(upper: &Upper) -> Exact {
    upper.exact.clone().unwrap_or_else(|| binary(upper.value))
}

/// `(K - 1) - log_d(rho)`, rounded in a direction unless it is a whole number.
fn exponent(symbol: &Symbol, radius: &Exact, direction: f64) -> f64 {
    let (d, most) = (Exact::whole(symbol.arity), f64::whole(i64::try_from(symbol.order).unwrap_or(1) - 1));
    let mut power = Exact::one();
    for whole in 0..64 {
        if *radius == power {
            return most - f64::whole(whole);
        }
        if *radius == power.recip() {
            return most + f64::whole(whole);
        }
        power *= &d;
    }
    debug_assert!(radius.is_positive(), "bounds are above 0");
    let exponent = most - ln(rounded(radius)) / ln(rounded(&d));
    // some roundings of logarithms and their quotient
    exponent + direction * 8.0 * f64::EPSILON * (1.0 + exponent.abs() + most)
}
