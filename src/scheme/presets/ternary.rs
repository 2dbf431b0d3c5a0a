//! The blending ternary scheme and the schemes that it contains.

use crate::fault::Fault;
use crate::math::number::Number;
use crate::math::parameter::{Default, Parameter};
use crate::math::weight::Weight;
use crate::scheme::claim::Claim;
use crate::scheme::preset::{Preset, Refines, Spelling, mirrored, weight};

const HUANG_TAN: &str = "Huang and Tan, Acta Electronica Sinica 49 (2021), 90-98";

/// The parameters of rule (8).
struct TernaryRule {
    eta: Weight,
    theta: Weight,
    /// `omega delta`.
    omega_delta: Weight,
    omega: Weight,
    /// `lambda (1 + omega)`.
    lambda: Weight,
}

/// Rule (8) with the products that stay finite where delta or lambda do not:
/// `p[3i] <- (eta, theta - 2 eta, 1 + 2 eta - 2 theta, ...)`,
/// `p[3i+1] <- (-omega delta, lambda (1+omega), (1-lambda)(1+omega), -omega (1-delta))` on `i-1 .. i+2`, `p[3i+2]`
/// mirrored.
fn blend(rule: TernaryRule) -> Result<Spelling, Vec<Fault>> {
    let TernaryRule { eta, theta, omega_delta, omega, lambda } = rule;
    let middle = whole(1) + whole(2) * eta.clone() - whole(2) * theta.clone();
    let outwards = vec![
        lambda.clone(),
        whole(1) + omega.clone() - lambda,
        theta - whole(2) * eta.clone(),
        -omega_delta.clone(),
        omega_delta - omega,
        eta,
    ];
    mirrored(3, middle, &outwards)
}

fn whole(n: i64) -> Weight {
    Weight::whole(n)
}

fn ratio(a: i64, b: i64) -> Weight {
    Weight::ratio(a, b)
}

/// Declares a number of usual magnitude.
pub(super) const fn real(name: &'static str, default: Default, doc: &'static str) -> Parameter {
    Parameter::number(name, [-1e3, 1e3], default, doc)
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
    claims: &[
        Claim::new(
            "theta = 7 eta + 5/27, omega = -9 eta - 2/27, omega delta = 2 omega/3 - 1/81, lambda (1 + omega) = 2/3 - \
             omega + 3 omega delta, 0 < eta < 1/81",
            &[&[("eta", "1/243"), ("theta", "52/243"), ("omega", "-1/9"), ("delta", "7/9"), ("lambda", "7/12")]],
            ["4", "6", "1"],
        ),
        Claim::new(
            "eta = theta = 0, omega = 1/9, delta = 7/11, lambda = 38/55",
            &[&[("eta", "0"), ("theta", "0"), ("omega", "1/9"), ("delta", "7/11"), ("lambda", "38/55")]],
            ["2", "5", "2"],
        ),
    ],
    spell: |values| {
        let omega = weight(values, "omega");
        blend(TernaryRule {
            eta: weight(values, "eta"),
            theta: weight(values, "theta"),
            omega_delta: omega.clone() * weight(values, "delta"),
            lambda: weight(values, "lambda") * (whole(1) + omega.clone()),
            omega,
        })
    },
};

pub(super) const C4: Preset = Preset {
    name: "ternary-c4",
    doc: "Rule (9): the five-point ternary scheme with symbol (1+z+z^2)^5 (eta + (1/81 - 2 eta) z + eta z^2), C4 \
          exactly for 0 < eta < 1/81; eta = 1/243 is the quintic B-spline.",
    source: HUANG_TAN,
    parameters: &[real("eta", Default::Text("1/243"), "Shape; C4 for 0 < eta < 1/81.")],
    refines: Refines::Curves,
    claims: &[
        Claim::new(
            "0 < eta < 1/81",
            &[&[("eta", "1/1000000")], &[("eta", "1/243")], &[("eta", "1/82")]],
            ["4", "6", "1"],
        ),
        Claim::new("1/81 <= eta < 2/81", &[&[("eta", "1/81")], &[("eta", "1/54")]], ["3", "6", "1"]),
        Claim::new("eta = 0", &[&[("eta", "0")]], ["3", "5", "1"]),
    ],
    spell: |values| {
        let eta = || weight(values, "eta");
        let outwards = vec![
            ratio(5, 9) - whole(9) * eta(),
            ratio(10, 27),
            ratio(5, 27) + whole(5) * eta(),
            ratio(5, 81) + whole(6) * eta(),
            ratio(1, 81) + whole(3) * eta(),
            eta(),
        ];
        mirrored(3, ratio(17, 27) - whole(12) * eta(), &outwards)
    },
};

/// Declares the ternary B-spline of some degree: entries over `3^degree`, from the middle outwards.
macro_rules! b_spline {
    (
        $constant:ident, $name:literal, $degree:literal, [$smoothness:literal, $support:literal],
        $over:literal, [$middle:literal $(, $entry:literal)*]
    ) => {
        pub(super) const $constant: Preset = Preset {
            name: $name,
            doc: concat!("The uniform B-spline of degree ", $degree, " by ternary refinement; symbol ",
                "(1+z+z^2)^(degree+1) / 3^degree."),
            source: HUANG_TAN,
            parameters: &[],
            refines: Refines::Curves,
            claims: &[Claim::new("", &[&[]], [$smoothness, $support, "1"])],
    spell: |_| mirrored(3, ratio($middle, $over), &[$(ratio($entry, $over)),*]),
        };
    };
}

b_spline!(LINEAR, "ternary-linear", "1", ["0", "2"], 3, [3, 2, 1]);
b_spline!(QUADRATIC, "ternary-quadratic", "2", ["1", "3"], 9, [7, 6, 3, 1]);
b_spline!(CUBIC, "ternary-cubic", "3", ["2", "4"], 27, [19, 16, 10, 4, 1]);
b_spline!(QUARTIC, "ternary-quartic", "4", ["3", "5"], 81, [51, 45, 30, 15, 5, 1]);
b_spline!(QUINTIC, "ternary-quintic", "5", ["4", "6"], 243, [141, 126, 90, 50, 21, 6, 1]);

pub(super) const THREE_POINT: Preset = Preset {
    name: "ternary-three-point",
    doc: "The interpolating ternary three-point scheme: p[3i+1] = (alpha - 1/3) p[i-1] + (4/3 - 2 alpha) p[i] + alpha \
          p[i+1]. C1 exactly for 2/9 < alpha < 1/3.",
    source: "Hassan and Dodgson, Curve and Surface Fitting, Saint-Malo 2002 (2003), 199-208",
    parameters: &[real("alpha", Default::Number(0.25), "Shape; C1 for 2/9 < alpha < 1/3.")],
    refines: Refines::Curves,
    claims: &[Claim::new(
        "2/9 < alpha < 1/3",
        &[&[("alpha", "0.2233")], &[("alpha", "1/4")], &[("alpha", "0.332")]],
        ["1", "4", "1"],
    )],
    spell: |values| {
        let alpha = weight(values, "alpha");
        let omega = ratio(1, 3) - alpha.clone();
        let lambda = ratio(4, 3) - whole(2) * alpha;
        blend(TernaryRule { eta: whole(0), theta: whole(0), omega_delta: omega.clone(), omega, lambda })
    },
};

pub(super) const TERNARY_FOUR_POINT: Preset = Preset {
    name: "ternary-four-point",
    doc: "The interpolating ternary four-point scheme: p[3i+1] = (-1/18 - mu/6) p[i-1] + (13/18 + mu/2) p[i] + (7/18 - \
          mu/2) p[i+1] + (-1/18 + mu/6) p[i+2]. C2 exactly for 1/15 < mu < 1/9.",
    source: "Hassan, Ivrissimtzis, Dodgson and Sabin, CAGD 19 (2002), 1-18",
    parameters: &[real("mu", Default::Number(0.1), "Shape; C2 for 1/15 < mu < 1/9.")],
    refines: Refines::Curves,
    claims: &[Claim::new(
        "1/15 < mu < 1/9",
        &[&[("mu", "0.068")], &[("mu", "1/11")], &[("mu", "0.11")]],
        ["2", "5", "2"],
    )],
    spell: |values| {
        let mu = || weight(values, "mu");
        let (omega_delta, lambda) = (ratio(1, 18) + mu() / whole(6), ratio(13, 18) + mu() / whole(2));
        blend(TernaryRule { eta: whole(0), theta: whole(0), omega_delta, omega: ratio(1, 9), lambda })
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
    claims: &[
        Claim::new(
            "beta = 1/9, 1 < alpha < 7/4",
            &[&[("alpha", "9/8"), ("beta", "1/9")], &[("alpha", "3/2"), ("beta", "1/9")]],
            ["3", "5", "1"],
        ),
        Claim::new("alpha = 1", &[&[("alpha", "1"), ("beta", "1/5")]], ["2", "4", "1"]),
    ],
    spell: |values| {
        let (alpha, beta) = (|| weight(values, "alpha"), || weight(values, "beta"));
        let omega = (whole(3) - whole(4) * alpha()) / whole(27);
        let omega_delta = (whole(-2) + (whole(1) - alpha()) * (whole(5) + whole(3) * beta())) / whole(54);
        let lambda = (whole(32) + (whole(1) - alpha()) * (whole(7) + whole(9) * beta())) / whole(54);
        blend(TernaryRule { eta: whole(0), theta: whole(4) * alpha() / whole(27), omega_delta, omega, lambda })
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
    claims: &[
        Claim::new("beta = 0, 4/243 < alpha < 7/405", &[&[("alpha", "1/60"), ("beta", "0")]], ["3", "6", "3"]),
        Claim::new("alpha = beta = 0", &[&[("alpha", "0"), ("beta", "0")]], ["1", "5", "3"]),
    ],
    spell: |values| {
        let alpha = || weight(values, "alpha");
        let bend = (whole(1) - alpha()) * weight(values, "beta");
        blend(TernaryRule {
            eta: -alpha(),
            theta: whole(2) * alpha(),
            omega_delta: ratio(5, 81) + bend.clone(),
            omega: ratio(1, 9) + whole(2) * bend.clone(),
            lambda: ratio(20, 27) + bend,
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
    claims: &[Claim::new(
        "alpha = -2/27, beta = 5/81, gamma = 1/81",
        &[&[("alpha", "-2/27"), ("beta", "5/81"), ("gamma", "1/81")]],
        ["3", "5", "1"],
    )],
    spell: |values| {
        let (beta, gamma) = (|| weight(values, "beta"), || weight(values, "gamma"));
        blend(TernaryRule {
            eta: whole(0),
            theta: ratio(1, 9) - weight(values, "alpha"),
            omega_delta: -beta(),
            omega: -beta() - gamma(),
            lambda: (whole(2) + whole(3) * gamma() - whole(6) * beta()) / whole(3),
        })
    },
};
