//! Weights in f64, together with their exact value if it is known.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_traits::Zero;

use crate::math::exact::{Exact, bounded};
use crate::math::number::Number;

/// A number in f64, rounded at every operation, and its exact value as long as that is a known fraction.
#[derive(Debug, Clone)]
pub struct Weight {
    /// The value in f64.
    pub value: f64,
    /// The exact value, if known.
    pub exact: Option<Exact>,
}

impl PartialEq for Weight {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl Number for Weight {
    fn ratio(a: i64, b: i64) -> Self {
        Self { value: f64::ratio(a, b), exact: Some(Exact::ratio(a, b)) }
    }

    fn real(&self) -> f64 {
        self.value
    }
}

impl Neg for Weight {
    type Output = Self;

    fn neg(self) -> Self {
        Self { value: -self.value, exact: self.exact.map(|x| -x) }
    }
}

macro_rules! operation {
    ($trait:ident, $function:ident) => {
        impl $trait for Weight {
            type Output = Self;

            fn $function(self, other: Self) -> Self {
                let value = self.value.$function(other.value);
                let pair = self.exact.zip(other.exact);
                // a divisor of 0 yields no fraction
                let pair = pair.filter(|(_, y)| stringify!($function) != "div" || !y.is_zero());
                Self { value, exact: pair.and_then(|(x, y)| bounded(x.$function(y))) }
            }
        }
    };
}

operation!(Add, add);
operation!(Sub, sub);
operation!(Mul, mul);
operation!(Div, div);
