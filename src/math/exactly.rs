//! Exact evaluation of expressions whose value is a fraction.

use num_traits::{One, Signed, ToPrimitive, Zero};

use crate::math::exact::{self, Exact, bounded};
use crate::math::expression::{Binary, Expression, ExpressionError, Sink, Unary, read};
use crate::math::parameter::Literal;

/// Returns the exact value of an expression at `x`; `None` if it is not a fraction, or one with too many digits.
pub fn value(expression: &Expression, variable: &str, x: &Exact) -> Option<Exact> {
    of_text(expression.text(), variable, x)
}

/// Returns the exact value of a literal number: of the shortest decimal of a JSON number, or of an expression.
pub fn literal(written: &Literal) -> Option<Exact> {
    match written {
        Literal::Number(x) => exact::written(*x),
        Literal::Text(text) => of_text(text, "", &Exact::zero()),
        _ => None,
    }
}

fn of_text(text: &str, variable: &str, x: &Exact) -> Option<Exact> {
    let mut stack = Stack { x, values: Vec::new() };
    read(text, variable, &mut stack).ok()?;
    stack.values.pop()?
}

/// A stack of values, each known exactly or not.
struct Stack<'a> {
    x: &'a Exact,
    values: Vec<Option<Exact>>,
}

impl Sink for Stack<'_> {
    fn constant(&mut self, digits: Option<&str>, _: f64) -> Result<(), ExpressionError> {
        self.values.push(digits.and_then(exact::decimal));
        Ok(())
    }

    fn variable(&mut self) -> Result<(), ExpressionError> {
        self.values.push(Some(self.x.clone()));
        Ok(())
    }

    fn unary(&mut self, op: Unary) -> Result<(), ExpressionError> {
        let x = self.values.pop().flatten();
        self.values.push(x.and_then(|x| of_one(op, x)));
        Ok(())
    }

    fn binary(&mut self, op: Binary) -> Result<(), ExpressionError> {
        let (y, x) = (self.values.pop().flatten(), self.values.pop().flatten());
        self.values.push(x.zip(y).and_then(|(x, y)| of_two(op, x, y)).and_then(bounded));
        Ok(())
    }
}

/// Returns the value of a function at a fraction if it is a fraction, too.
fn of_one(op: Unary, x: Exact) -> Option<Exact> {
    let at_zero = |value: Exact| x.is_zero().then_some(value);
    let at_one = |value: Exact| x.is_one().then_some(value);
    match op {
        Unary::Negate => Some(-x),
        Unary::Abs => Some(x.abs()),
        Unary::Sqrt => exact::square_root(&x),
        Unary::Sin | Unary::Tan | Unary::Asin | Unary::Atan | Unary::Sinh | Unary::Tanh => at_zero(Exact::zero()),
        Unary::Cos | Unary::Cosh | Unary::Exp => at_zero(Exact::one()),
        Unary::Acos | Unary::Ln => at_one(Exact::zero()),
    }
}

fn of_two(op: Binary, x: Exact, y: Exact) -> Option<Exact> {
    match op {
        Binary::Add => Some(x + y),
        Binary::Subtract => Some(x - y),
        Binary::Multiply => Some(x * y),
        Binary::Divide => (!y.is_zero()).then(|| x / y),
        Binary::Power => y.is_integer().then(|| y.to_integer().to_i64()).flatten().and_then(|n| exact::power(&x, n)),
        Binary::Min => Some(x.min(y)),
        Binary::Max => Some(x.max(y)),
    }
}
