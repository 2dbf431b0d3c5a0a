//! Values of single points at an upsampling, from vertex parameters and from decaying perturbations.

use std::sync::Arc;

use super::step_error::{About, StepError};
use crate::math::expression::Expression;
use crate::shape::attributes::{Attributes, between};

/// Maximum absolute value of a compensation. Beyond it lies a pole of the function; at 1e12, four of the 16 digits of a
/// coordinate are left. Half or twice the bound leaves slightly more or fewer.
pub const MAX_COMPENSATION: f64 = 1e12;

/// A decaying perturbation at one upsampling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Amplitude at this upsampling: `c gamma^h`.
    pub amplitude: f64,
    /// The seed of the plan.
    pub seed: u64,
    /// Number h of upsamplings before this one.
    pub upsamplings: u32,
}

impl Noise {
    /// Returns the perturbation of element `i`, uniform in `[-c, c)`; `operation` is 0 for vertices, 1 for edges, 2 for
    /// faces.
    pub(super) fn at(&self, operation: u64, i: u64) -> f64 {
        let mixed = [u64::from(self.upsamplings), operation, i].iter().fold(mix(self.seed), |x, y| mix(x ^ y));
        #[expect(clippy::cast_precision_loss, reason = "53 bits are exact")]
        let unit = (mixed >> 11) as f64 / 9_007_199_254_740_992.0;
        self.amplitude * (2.0 * unit - 1.0)
    }
}

/// The output function of `SplitMix64` (Steele, Lea, Flood 2014).
fn mix(x: u64) -> u64 {
    let z = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ z >> 31
}

/// The functions and numbers from which local values are computed at an upsampling.
#[derive(Debug, Clone, Copy)]
pub struct Sources<'a> {
    /// Kernel of the first average, as a function of alpha.
    pub kernel: &'a Expression,
    /// Kernel along longitude lines, if it differs.
    pub kernel_longitude: Option<&'a Expression>,
    /// Compensation, as a function of alpha.
    pub compensation: &'a Expression,
    /// Push-back factor, as a function of the valence.
    pub delta: &'a Expression,
    /// The plan's alpha at this upsampling, in radians.
    pub alpha: f64,
    /// The alpha at which the compensation is evaluated, in radians.
    pub compensation_alpha: f64,
    /// Whether the compensation has an alpha of its own, which then also holds on latitude lines.
    pub compensates_apart: bool,
    /// The factor by which the alpha of points is multiplied at this upsampling.
    pub scale: f64,
    /// Whether a push-back follows, which uses the compensations.
    pub pushes_back: bool,
    /// The perturbation, if any.
    pub noise: Option<Noise>,
}

impl Sources<'_> {
    /// Checks the compensation of a point; `alpha` is where it was computed, or `None` if it was interpolated.
    ///
    /// # Errors
    /// If it exceeds [`MAX_COMPENSATION`] and a push-back uses it.
    pub(super) fn bounded(&self, point: usize, value: f64, alpha: Option<f64>) -> Result<f64, StepError> {
        if !self.pushes_back || value.abs() <= MAX_COMPENSATION {
            return Ok(value);
        }
        let alpha = alpha.filter(|_| !self.compensation.is_constant());
        Err(large_compensation(point, value, alpha))
    }
}

/// Values of the points that entered the last upsampling, and of the points that it made on edges.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalValues {
    /// Kernel of each vertex.
    pub kernel: Vec<f64>,
    /// Push-back factor of each vertex.
    pub delta: Vec<f64>,
    /// Compensation of each point made on an edge, edge after edge.
    compensation: Vec<f64>,
    arity: u32,
}

impl LocalValues {
    /// Returns the local values at an upsampling of a polygon with `n` control points and `edges` edges; `None` if all
    /// points have the values of the plan.
    pub(super) fn of(
        [n, edges]: [usize; 2],
        attributes: Option<&Attributes>,
        arity: u32,
        sources: &Sources<'_>,
    ) -> Result<Option<Arc<Self>>, StepError> {
        if attributes.is_none() && sources.noise.is_none() {
            return Ok(None);
        }
        let attributes = attributes.cloned().unwrap_or_default();
        let own = |array: &Option<Vec<f64>>, i: usize| array.as_ref().map(|array| array[i]);
        let noise = |operation, i: usize| sources.noise.map_or(0.0, |noise| noise.at(operation, i as u64));
        let kernel = (0..n).map(|i| {
            let alpha = own(&attributes.alpha, i).map_or(sources.alpha, |alpha| alpha * sources.scale);
            let value = own(&attributes.kernel, i).map_or_else(|| sources.kernel.value(alpha), Ok);
            finite("kernel", i, value.map(|value| value + noise(0, i)))
        });
        let delta = (0..n).map(|i| {
            let value = own(&attributes.delta, i).map_or_else(|| sources.delta.value(f64::NAN), Ok);
            finite("delta", i, value)
        });
        let places = (0..edges).flat_map(|e| (1..arity).map(move |j| (e, j)));
        let compensation = places.map(|(e, j)| {
            let own = |array: &Option<Vec<f64>>| array.as_ref().map(|array| between(array, e, j, arity));
            let alpha = own(&attributes.alpha).map_or(sources.compensation_alpha, |alpha| alpha * sources.scale);
            let carried = own(&attributes.compensation);
            let value = carried.map_or_else(|| sources.compensation.value(alpha), Ok);
            let value = finite("compensation", e, value.map(|value| value + noise(1, e)))?;
            sources.bounded(e * arity as usize + j as usize, value, carried.is_none().then_some(alpha))
        });
        let kernel: Vec<f64> = kernel.collect::<Result<_, _>>()?;
        if let Some(point) = kernel.iter().position(|&f| !has_average(f)) {
            return Err(no_average("kernel", point, kernel[point]));
        }
        let (delta, compensation) = (delta.collect::<Result<_, _>>()?, compensation.collect::<Result<_, _>>()?);
        Ok(Some(Arc::new(Self { kernel, delta, compensation, arity })))
    }

    /// Returns the compensation of the point at `j / d` of edge `e`; beyond the ends, that of the last edge.
    pub(super) fn compensation(&self, e: isize, j: isize) -> f64 {
        let inner = self.arity as usize - 1;
        let edges = self.compensation.len() / inner;
        let e = e.clamp(0, edges.cast_signed() - 1).unsigned_abs();
        self.compensation[e * inner + j.unsigned_abs() - 1]
    }
}

/// Absolute value below which a sum of weights counts as 0, where weights are about 1. Half and twice of it refuse
/// nearly the same kernels; far below it, points would be divided by what rounding leaves of a sum.
pub const VANISHING_SUM: f64 = 1e-9;

/// Returns whether an average exists with this kernel; its weights add up to a multiple of `1 + f`.
pub fn has_average(kernel: f64) -> bool {
    (1.0 + kernel).abs() >= VANISHING_SUM
}

pub(super) fn finite<E: std::fmt::Display>(name: &str, i: usize, value: Result<f64, E>) -> Result<f64, StepError> {
    match value {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(value) => Err(StepError::new(format!("the {name} of point {i} is {value}; choose other values"))),
        Err(error) => Err(StepError::new(format!("{name} of point {i}: {error}; choose other values"))),
    }
}

/// Returns the error for a kernel value of a point with which no average exists. `point` is an index in the net that
/// entered the last upsampling or, beyond its points, in the net after it.
pub(super) fn no_average(name: &'static str, point: usize, value: f64) -> StepError {
    let why = "where no average exists, as its weights add up to 0; it is any number but -1";
    StepError::about(About::Point { name, point, from: Vec::new() }, format!("{value}, {why}"))
}

/// Returns the error for a compensation beyond its bound, of a point in the net after the last upsampling; with its
/// alpha if the compensation is a function of it.
fn large_compensation(point: usize, value: f64, alpha: Option<f64>) -> StepError {
    let (why, remedy) = match alpha {
        Some(alpha) => (format!(" (alpha = {alpha}), a pole of the function"), "choose another alpha there"),
        None => (String::new(), "choose smaller ones"),
    };
    let detail = format!("{value}{why}; at most {MAX_COMPENSATION} in size is allowed: {remedy}");
    StepError::about(About::Point { name: "compensation", point, from: Vec::new() }, detail)
}
