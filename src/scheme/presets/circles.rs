//! d-ary schemes that keep circles.

use super::ternary::real;
use crate::fault::Fault;
use crate::math::parameter::{Default, Parameter, Value, Values};
use crate::scheme::claim::Claim;
use crate::scheme::letter::Letter;
use crate::scheme::ops::{CIRCULAR_PUSH_BACK, Circle};
use crate::scheme::parameters::{ARITY, AVERAGES};
use crate::scheme::preset::{Preset, Refines, Spelling, constant, weight};

pub(super) const D_ARY_CIRCLE: Preset = Preset {
    name: "d-ary-circle",
    doc: "The d-ary scheme with m averages that keeps circles of angle alpha a point, with mask d sigma^m E / \
          (sigma(1)^m E(1)), e[j] = sin((j+1) alpha/d) / sin(alpha/d), followed by a push-back that keeps them, too. \
          alpha = 2 pi / K turns regular K-gons into circles; alpha = 0 is the linear limit.",
    source: "after Zhang and Wang 2002, section 4.2",
    parameters: &[
        Parameter { default: Default::Number(3.0), ..ARITY },
        AVERAGES,
        angle("Angle from one point to the next; 2 pi / K for a regular K-gon."),
        real("delta", Default::Number(0.0), "Push-back factor: 0 approximates, 1 interpolates."),
    ],
    refines: Refines::Curves,
    claims: &[Claim::new(
        "delta = 0",
        &[&[("averages", "1"), ("arity", "3"), ("alpha", "0")], &[("averages", "2"), ("arity", "4"), ("alpha", "1")]],
        ["averages", "averages + 2", "1"],
    )],
    spell,
};

/// Declares the alpha of a scheme that reproduces circles.
pub(super) const fn angle(doc: &'static str) -> Parameter {
    Parameter { unit: "radians", ..Parameter::number("alpha", [-1e6, 1e6], Default::Required, doc) }
}

fn spell(values: &Values) -> Result<Spelling, Vec<Fault>> {
    let whole = |name: &str| values.integer(name).and_then(|n| u32::try_from(n).ok()).unwrap_or(1);
    let (arity, averages) = (whole("arity"), whole("averages"));
    let delta = weight(values, "delta");
    let circle = Letter::plain(&Circle).with(&ARITY, Value::Integer(arity.into()));
    let mut cycle = vec![circle.with(&AVERAGES, Value::Integer(averages.into()))];
    if delta.value != 0.0 {
        if averages * (arity - 1) % 2 == 1 {
            let detail = "an odd number of averages of an even arity leaves no point for the push-back; choose another \
                          number of averages, or delta 0";
            return Err(vec![Fault::new("/delta", detail)]);
        }
        cycle.push(Letter::plain(&CIRCULAR_PUSH_BACK));
    }
    let alpha = values.number("alpha").unwrap_or(0.0);
    Ok(Spelling { alpha, delta: constant(&delta), ..Spelling::of(cycle) })
}
