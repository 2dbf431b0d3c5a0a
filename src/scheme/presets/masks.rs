//! Schemes given by their masks: a client's own, and the 2n-point interpolation of Deslauriers and Dubuc.

use crate::fault::Fault;
use crate::math::exact::Exact;
use crate::math::exactly;
use crate::math::number::Number;
use crate::math::parameter::{Literal, Parameter, Value, Values};
use crate::math::weight::Weight;
use crate::scheme::claim::Claim;
use crate::scheme::parameters;
use crate::scheme::preset::{Preset, Refines, Spelling, masked, mirrored};

pub(super) const TWO_N_POINT: Preset = Preset {
    name: "two-n-point",
    doc: "The interpolating 2n-point scheme: odd points by the polynomial of degree 2n - 1 through the 2n neighbours, \
          a[+-(2j-1)] = (-1)^(j-1) ((2n-1)!!)^2 / (2^(2n-1) (n+j-1)! (n-j)! (2j-1)). C1 for n = 2, then C2, C3, C4, \
          C4.",
    source: "Deslauriers and Dubuc, Constructive Approximation 5 (1989), 49-68",
    parameters: &[Parameter::integer("n", [1, 16], 2.0, "Half the number of points that make a new one.")],
    refines: Refines::Curves,
    claims: &[
        Claim::new(
            "n = 1 to 5",
            &[&[("n", "1")], &[("n", "2")], &[("n", "3")], &[("n", "5")]],
            ["n - 1", "4*n - 2", "2*n - 1"],
        ),
        Claim::new("n = 6", &[&[("n", "6")]], ["4", "4*n - 2", "2*n - 1"]),
    ],
    spell: |values| {
        let n = values.integer("n").and_then(|n| u128::try_from(n).ok()).unwrap_or(2);
        let outwards: Vec<Weight> = (1..=n).flat_map(|j| [deslauriers_dubuc(n, j), Weight::whole(0)]).collect();
        mirrored(2, Weight::whole(1), &outwards)
    },
};

/// Returns the weight at offset 2j - 1, computed from exact integers and rounded once.
fn deslauriers_dubuc(n: u128, j: u128) -> Weight {
    let odds = (1..=n).flat_map(|i| [2 * i - 1, 2 * i - 1]);
    let twos = std::iter::repeat_n(2, usize::try_from(2 * n - 1).unwrap_or(0));
    let factorials = (1..n + j).chain(1..=n - j);
    let denominators: Vec<u128> = twos.chain(factorials).chain([2 * j - 1]).collect();
    let (mut numerator, mut denominator) = (1_u128, 1_u128);
    let mut odds = odds.chain(std::iter::repeat(1));
    for d in denominators {
        numerator *= odds.next().unwrap_or(1);
        denominator *= d;
        let common = gcd(numerator, denominator);
        numerator /= common;
        denominator /= common;
    }
    // the denominator is a power of two, so that the quotient is rounded once
    #[expect(clippy::cast_precision_loss, reason = "this is the one rounding")]
    let value = numerator as f64 / denominator as f64;
    let weight = Weight { value, exact: Some(Exact::new(numerator.into(), denominator.into())) };
    if j % 2 == 1 { weight } else { -weight }
}

fn gcd(a: u128, b: u128) -> u128 {
    if b == 0 { a } else { gcd(b, a % b) }
}

pub(super) const ANY_MASK: Preset = Preset {
    name: "mask",
    doc: "Any linear scheme: q[j] = sum over i of a[j - d i] p[i] with arity d and the mask a. Schemes that converge \
          have entries that sum to 1 in each residue class modulo d.",
    source: "Dyn, Subdivision schemes in CAGD, 1992, section 2",
    parameters: &[parameters::ARITY, parameters::MASK, parameters::FIRST],
    refines: Refines::Curves,
    claims: &[],
    spell: own,
};

fn own(values: &Values) -> Result<Spelling, Vec<Fault>> {
    let arity = values.integer("arity").and_then(|d| u32::try_from(d).ok()).unwrap_or(2);
    let first = values.integer("first").and_then(|first| i32::try_from(first).ok()).unwrap_or(0);
    let Value::Numbers(entries) = values.get("mask") else { return masked(arity, first, &[]) };
    let written = if let Some(Literal::List(items)) = values.written("mask") { items.as_slice() } else { &[] };
    let exact = |i: usize| written.get(i).and_then(exactly::literal);
    let weights: Vec<Weight> =
        entries.iter().enumerate().map(|(i, &value)| Weight { value, exact: exact(i) }).collect();
    masked(arity, first, &weights)
}
