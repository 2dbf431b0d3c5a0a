//! The blending ternary scheme and the schemes that it contains.

use crate::fault::Fault;
use crate::math::mask::Mask;
use crate::math::parameter::{Default, Parameter, Values};
use crate::scheme::preset::{Preset, Refines, Spelling, masked};

const HUANG_TAN: &str = "Huang and Tan, Acta Electronica Sinica 49 (2021), 90-98";

/// Parameters of rule (8).
struct Blend {
    eta: f64,
    theta: f64,
    /// `omega delta`.
    omega_delta: f64,
    omega: f64,
    /// `lambda (1 + omega)`.
    lambda: f64,
}

/// Rule (8) with the products that stay finite where delta or lambda do not:
/// `p[3i] <- (eta, theta - 2 eta, 1 + 2 eta - 2 theta, ...)`,
/// `p[3i+1] <- (-omega delta, lambda (1+omega), (1-lambda)(1+omega), -omega (1-delta))` on `i-1 .. i+2`, `p[3i+2]`
/// mirrored.
fn blend(rule: &Blend) -> Result<Spelling, Vec<Fault>> {
    let Blend { eta, theta, omega_delta, omega, lambda } = *rule;
    let outwards = [lambda, 1.0 + omega - lambda, theta - 2.0 * eta, -omega_delta, omega_delta - omega, eta];
    masked(3, Mask::symmetric(1.0 + 2.0 * eta - 2.0 * theta, &outwards))
}

/// A number of usual size.
pub(super) const fn real(name: &'static str, default: Default, doc: &'static str) -> Parameter {
    Parameter::number(name, [-1e3, 1e3], default, doc)
}

fn number(values: &Values, name: &str) -> f64 {
    values.number(name).unwrap_or(0.0)
}

pub(super) const BLENDING: Preset = Preset {
    name: "ternary-blending",
    doc: "Rule (8): five parameters that contain interpolating and approximating ternary schemes. Interpolates when \
          eta and theta are 0.",
    source: HUANG_TAN,
    parameters: &[
        real("eta", Default::Required, "Weight of the second neighbours of a vertex."),
        real("theta", Default::Required, "Pull of the first neighbours of a vertex."),
        real("omega", Default::Required, "Tension."),
        real("delta", Default::Required, "Place of the outer points."),
        real("lambda", Default::Required, "Place of the inner points."),
    ],
    refines: Refines::Curves,
    spell: |values| {
        let omega = number(values, "omega");
        blend(&Blend {
            eta: number(values, "eta"),
            theta: number(values, "theta"),
            omega_delta: omega * number(values, "delta"),
            omega,
            lambda: number(values, "lambda") * (1.0 + omega),
        })
    },
};

pub(super) const C4: Preset = Preset {
    name: "ternary-c4",
    doc: "Rule (9): the five-point ternary scheme with symbol (1+z+z^2)^5 (eta + (1/81 - 2 eta) z + eta z^2), C4 \
          exactly for 0 < eta < 1/81; eta = 1/243 is the quintic B-spline.",
    source: HUANG_TAN,
    parameters: &[real("eta", Default::Number(1.0 / 243.0), "Shape; C4 for 0 < eta < 1/81.")],
    refines: Refines::Curves,
    spell: |values| {
        let eta = number(values, "eta");
        let outwards = [
            5.0 / 9.0 - 9.0 * eta,
            10.0 / 27.0,
            5.0 / 27.0 + 5.0 * eta,
            5.0 / 81.0 + 6.0 * eta,
            1.0 / 81.0 + 3.0 * eta,
            eta,
        ];
        masked(3, Mask::symmetric(17.0 / 27.0 - 12.0 * eta, &outwards))
    },
};

/// The ternary B-spline of some degree: entries over `3^degree`, from the middle outwards.
macro_rules! b_spline {
    ($constant:ident, $name:literal, $degree:literal, $over:literal, [$middle:literal $(, $entry:literal)*]) => {
        pub(super) const $constant: Preset = Preset {
            name: $name,
            doc: concat!("The uniform B-spline of degree ", $degree, " by ternary refinement; symbol ",
                "(1+z+z^2)^(degree+1) / 3^degree."),
            source: HUANG_TAN,
            parameters: &[],
            refines: Refines::Curves,
            spell: |_| masked(3, Mask::symmetric($middle / $over, &[$($entry / $over),*])),
        };
    };
}

b_spline!(LINEAR, "ternary-linear", "1", 3.0, [3.0, 2.0, 1.0]);
b_spline!(QUADRATIC, "ternary-quadratic", "2", 9.0, [7.0, 6.0, 3.0, 1.0]);
b_spline!(CUBIC, "ternary-cubic", "3", 27.0, [19.0, 16.0, 10.0, 4.0, 1.0]);
b_spline!(QUARTIC, "ternary-quartic", "4", 81.0, [51.0, 45.0, 30.0, 15.0, 5.0, 1.0]);
b_spline!(QUINTIC, "ternary-quintic", "5", 243.0, [141.0, 126.0, 90.0, 50.0, 21.0, 6.0, 1.0]);

pub(super) const THREE_POINT: Preset = Preset {
    name: "ternary-three-point",
    doc: "The interpolating ternary three-point scheme: p[3i+1] = (alpha - 1/3) p[i-1] + (4/3 - 2 alpha) p[i] + alpha \
          p[i+1]. C1 exactly for 2/9 < alpha < 1/3.",
    source: "Hassan and Dodgson, Curve and Surface Fitting, Saint-Malo 2002 (2003), 199-208",
    parameters: &[real("alpha", Default::Number(0.25), "Shape; C1 for 2/9 < alpha < 1/3.")],
    refines: Refines::Curves,
    spell: |values| {
        let alpha = number(values, "alpha");
        let omega = 1.0 / 3.0 - alpha;
        blend(&Blend { eta: 0.0, theta: 0.0, omega_delta: omega, omega, lambda: 4.0 / 3.0 - 2.0 * alpha })
    },
};

pub(super) const FOUR_POINT: Preset = Preset {
    name: "ternary-four-point",
    doc: "The interpolating ternary four-point scheme: p[3i+1] = (-1/18 - mu/6) p[i-1] + (13/18 + mu/2) p[i] + (7/18 - \
          mu/2) p[i+1] + (-1/18 + mu/6) p[i+2]. C2 exactly for 1/15 < mu < 1/9.",
    source: "Hassan, Ivrissimtzis, Dodgson and Sabin, CAGD 19 (2002), 1-18",
    parameters: &[real("mu", Default::Number(0.1), "Shape; C2 for 1/15 < mu < 1/9.")],
    refines: Refines::Curves,
    spell: |values| {
        let mu = number(values, "mu");
        let (omega_delta, lambda) = (1.0 / 18.0 + mu / 6.0, 13.0 / 18.0 + mu / 2.0);
        blend(&Blend { eta: 0.0, theta: 0.0, omega_delta, omega: 1.0 / 9.0, lambda })
    },
};

pub(super) const PAN: Preset = Preset {
    name: "ternary-combined-pan",
    doc: "The combined scheme with p[3i] = (4 alpha, 27 - 8 alpha, 4 alpha)/27; alpha = 0 interpolates (mu = beta/3), \
          alpha = 1 is the cubic B-spline; C3 for beta = 1/9, 1 < alpha < 7/4.",
    source: "Pan, Lin and Luo, Applied Mathematics Letters 25 (2012), 2140-2146, as row [11] of Huang and Tan 2021",
    parameters: &[
        real("alpha", Default::Required, "From interpolating (0) to approximating (1)."),
        real("beta", Default::Required, "Shape."),
    ],
    refines: Refines::Curves,
    spell: |values| {
        let (alpha, beta) = (number(values, "alpha"), number(values, "beta"));
        let omega = (3.0 - 4.0 * alpha) / 27.0;
        let omega_delta = (-2.0 + (1.0 - alpha) * (5.0 + 3.0 * beta)) / 54.0;
        let lambda = (32.0 + (1.0 - alpha) * (7.0 + 9.0 * beta)) / 54.0;
        blend(&Blend { eta: 0.0, theta: 4.0 * alpha / 27.0, omega_delta, omega, lambda })
    },
};

pub(super) const REHAN: Preset = Preset {
    name: "ternary-combined-rehan",
    doc: "The combined scheme with p[3i] = (-alpha, 4 alpha, 1 - 6 alpha, 4 alpha, -alpha); C3 only for beta = 0 and \
          4/243 < alpha < 7/405.",
    source: "Rehan and Sabri, Applied Mathematics and Computation 276 (2016), 278-283, as row [13] of Huang and Tan \
          2021",
    parameters: &[real("alpha", Default::Required, "Shape."), real("beta", Default::Required, "Shape.")],
    refines: Refines::Curves,
    spell: |values| {
        let (alpha, beta) = (number(values, "alpha"), number(values, "beta"));
        let bend = (1.0 - alpha) * beta;
        blend(&Blend {
            eta: -alpha,
            theta: 2.0 * alpha,
            omega_delta: 5.0 / 81.0 + bend,
            omega: 1.0 / 9.0 + 2.0 * bend,
            lambda: 20.0 / 27.0 + bend,
        })
    },
};

pub(super) const NOVARA: Preset = Preset {
    name: "ternary-combined-novara",
    doc: "The combined four-point scheme with mask (gamma, beta, 1/9 - alpha, ...); three sum rules exactly when alpha \
          + beta + gamma = 0, up to C3.",
    source: "Novara and Romani, Applied Mathematics Letters 62 (2016), 84-91, as row [14] of Huang and Tan 2021",
    parameters: &[
        real("alpha", Default::Required, "Pull of the vertices."),
        real("beta", Default::Required, "Near outer weight."),
        real("gamma", Default::Required, "Far outer weight."),
    ],
    refines: Refines::Curves,
    spell: |values| {
        let (alpha, beta, gamma) = (number(values, "alpha"), number(values, "beta"), number(values, "gamma"));
        blend(&Blend {
            eta: 0.0,
            theta: 1.0 / 9.0 - alpha,
            omega_delta: -beta,
            omega: -beta - gamma,
            lambda: (2.0 + 3.0 * gamma - 6.0 * beta) / 3.0,
        })
    },
};
