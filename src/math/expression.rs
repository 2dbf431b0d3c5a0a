//! Expressions in one variable: text to a short bytecode, bounded in length, depth and size.

mod error;

use std::sync::Arc;

use crate::fault::shortened;
use crate::math::functions as f;

pub use error::{ExpressionError, MAX_EXPRESSION_BYTES, MAX_EXPRESSION_DEPTH, MAX_INSTRUCTIONS};

/// A compiled expression in at most one variable; constant parts are folded.
///
/// Grammar: `sum := product (('+'|'-') product)*`, `product := sign (('*'|'/') sign)*`,
/// `sign := ('-'|'+') sign | power`, `power := atom ['^' sign]` (right-associative, tighter than the sign before it),
/// `atom := number | name | name '(' sum (',' sum)* ')' | '(' sum ')'`.
#[derive(Debug, Clone)]
pub struct Expression {
    code: Vec<Instruction>,
    /// The name of the variable; empty if it does not occur.
    variable: &'static str,
    /// The text as written, for exact evaluation.
    text: Arc<str>,
}

impl PartialEq for Expression {
    /// Expressions with the same instructions are equal, however they were written.
    fn eq(&self, other: &Self) -> bool {
        self.code == other.code && self.variable == other.variable
    }
}

/// One instruction of the stack machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Instruction {
    /// Pushes a number.
    Constant(f64),
    /// Pushes the variable.
    Variable,
    /// Replaces the top by a function of it.
    Unary(Unary),
    /// Replaces the top two by a function of them.
    Binary(Binary),
}

// Each entry is `Variant = "name" => value of the operands`.
macro_rules! operations {
    ($(#[$doc:meta])* $type:ident($($operand:ident),+) { $($variant:ident = $name:literal => $value:expr,)* }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $type { $(#[doc = concat!("`", $name, "`.")] $variant),* }
        impl $type {
            const ALL: &'static [(&'static str, Self)] = &[$(($name, Self::$variant)),*];
            /// Returns the name of the operation in expressions.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }
            fn named(name: &str) -> Option<Self> {
                Self::ALL.iter().find(|(n, _)| *n == name).map(|(_, x)| *x)
            }
            fn apply(self, $($operand: f64),+) -> f64 {
                match self { $(Self::$variant => $value),* }
            }
        }
    };
}

operations! {
    /// Functions of one number.
    Unary(x) {
        Negate = "negate" => -x,
        Sin = "sin" => f::sin(x), Cos = "cos" => f::cos(x), Tan = "tan" => f::tan(x),
        Asin = "asin" => f::asin(x), Acos = "acos" => f::acos(x), Atan = "atan" => f::atan(x),
        Sinh = "sinh" => f::sinh(x), Cosh = "cosh" => f::cosh(x), Tanh = "tanh" => f::tanh(x),
        Exp = "exp" => f::exp(x), Ln = "ln" => f::ln(x), Sqrt = "sqrt" => f::sqrt(x), Abs = "abs" => x.abs(),
    }
}

operations! {
    /// Functions of two numbers. Comparisons propagate NaN.
    Binary(x, y) {
        Add = "+" => x + y, Subtract = "-" => x - y, Multiply = "*" => x * y, Divide = "/" => x / y,
        Power = "pow" => f::pow(x, y),
        Min = "min" => if !x.is_nan() && (y.is_nan() || y <= x) { y } else { x },
        Max = "max" => if !x.is_nan() && (y.is_nan() || y >= x) { y } else { x },
    }
}

impl Expression {
    /// Creates a constant expression.
    pub fn constant(value: f64) -> Self {
        Self { code: vec![Instruction::Constant(value + 0.0)], variable: "", text: format!("{:?}", value + 0.0).into() }
    }

    /// Creates a constant expression that was written as `text`.
    pub fn written(value: f64, text: &str) -> Self {
        Self { text: text.into(), ..Self::constant(value) }
    }

    /// Compiles `text`, in which `variable` may occur (none when empty).
    ///
    /// # Errors
    /// [`ExpressionError`] when a bound is exceeded or the text does not follow the grammar.
    pub fn parse(text: &str, variable: &'static str) -> Result<Self, ExpressionError> {
        if text.len() > MAX_EXPRESSION_BYTES {
            return Err(ExpressionError::TooLong(text.len()));
        }
        let mut code: Vec<Instruction> = Vec::new();
        read(text, variable, &mut code)?;
        let occurs = code.contains(&Instruction::Variable);
        Ok(Self { code, variable: if occurs { variable } else { "" }, text: text.into() })
    }

    /// Returns the text as written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the value of the expression at `x`.
    ///
    /// # Errors
    /// [`ExpressionError::NotFinite`].
    pub fn value(&self, x: f64) -> Result<f64, ExpressionError> {
        let mut stack = [0.0; MAX_INSTRUCTIONS];
        let mut top = 0;
        for instruction in &self.code {
            match instruction {
                Instruction::Constant(c) => {
                    stack[top] = *c;
                    top += 1;
                }
                Instruction::Variable => {
                    stack[top] = x;
                    top += 1;
                }
                Instruction::Unary(op) => stack[top - 1] = op.apply(stack[top - 1]),
                Instruction::Binary(op) => {
                    top -= 1;
                    stack[top - 1] = op.apply(stack[top - 1], stack[top]);
                }
            }
        }
        let value = stack[0] + 0.0;
        let not_finite = ExpressionError::NotFinite { value, variable: self.variable, at: x };
        if value.is_finite() { Ok(value) } else { Err(not_finite) }
    }

    /// Returns the instructions, for the key.
    pub fn code(&self) -> &[Instruction] {
        &self.code
    }

    /// Returns whether the variable does not occur.
    pub fn is_constant(&self) -> bool {
        self.variable.is_empty()
    }
}

/// Receives the numbers and operations of a text that is parsed, in the order of a stack machine.
pub trait Sink {
    /// Receives a number: its digits as written, or `None` for a constant that is given by name, and its rounded value.
    ///
    /// # Errors
    /// [`ExpressionError`].
    fn constant(&mut self, digits: Option<&str>, value: f64) -> Result<(), ExpressionError>;
    /// Receives the variable.
    ///
    /// # Errors
    /// [`ExpressionError`].
    fn variable(&mut self) -> Result<(), ExpressionError>;
    /// Receives a function of the top of the stack.
    ///
    /// # Errors
    /// [`ExpressionError`].
    fn unary(&mut self, op: Unary) -> Result<(), ExpressionError>;
    /// Receives a function of the top two entries of the stack.
    ///
    /// # Errors
    /// [`ExpressionError`].
    fn binary(&mut self, op: Binary) -> Result<(), ExpressionError>;
}

/// Parses a text whose length was checked.
///
/// # Errors
/// [`ExpressionError`].
pub fn read<S: Sink>(text: &str, variable: &str, sink: &mut S) -> Result<(), ExpressionError> {
    let mut parser = ExpressionParser { text, at: 0, depth: 0, variable, sink };
    parser.sum()?;
    parser.skip_space();
    if parser.at < text.len() { Err(parser.expected("an operator or the end")) } else { Ok(()) }
}

impl Sink for Vec<Instruction> {
    fn constant(&mut self, _: Option<&str>, value: f64) -> Result<(), ExpressionError> {
        emit(self, Instruction::Constant(value))
    }

    fn variable(&mut self) -> Result<(), ExpressionError> {
        emit(self, Instruction::Variable)
    }

    fn unary(&mut self, op: Unary) -> Result<(), ExpressionError> {
        emit(self, Instruction::Unary(op))
    }

    fn binary(&mut self, op: Binary) -> Result<(), ExpressionError> {
        emit(self, Instruction::Binary(op))
    }
}

/// Appends an instruction; folds it if its operands are constants.
fn emit(code: &mut Vec<Instruction>, instruction: Instruction) -> Result<(), ExpressionError> {
    let folded = match (instruction, code.as_slice()) {
        (Instruction::Unary(op), [.., Instruction::Constant(x)]) => Some((1, op.apply(*x))),
        (Instruction::Binary(op), [.., Instruction::Constant(x), Instruction::Constant(y)]) => {
            Some((2, op.apply(*x, *y)))
        }
        _ => None,
    };
    if let Some((operands, value)) = folded {
        code.truncate(code.len() - operands);
        code.push(Instruction::Constant(value));
    } else {
        code.push(instruction);
    }
    // the stack never holds more values than there are instructions, so this bounds it, too
    if code.len() > MAX_INSTRUCTIONS { Err(ExpressionError::TooLarge) } else { Ok(()) }
}

struct ExpressionParser<'a, S> {
    text: &'a str,
    at: usize,
    depth: usize,
    variable: &'a str,
    sink: &'a mut S,
}

impl<S: Sink> ExpressionParser<'_, S> {
    fn rest(&self) -> &[u8] {
        &self.text.as_bytes()[self.at..]
    }

    fn skip_space(&mut self) {
        self.at += self.rest().iter().take_while(|b| b.is_ascii_whitespace()).count();
    }

    /// Consumes the next byte if it is one of `wanted`.
    fn take(&mut self, wanted: &[u8]) -> Option<u8> {
        self.skip_space();
        let byte = *self.rest().first().filter(|b| wanted.contains(b))?;
        self.at += 1;
        Some(byte)
    }

    fn expected(&self, expected: &'static str) -> ExpressionError {
        let at = self.text.get(..self.at).map_or(self.at, |before| before.chars().count()) + 1;
        ExpressionError::Expected { expected, at, text: shortened(self.text) }
    }

    fn sum(&mut self) -> Result<(), ExpressionError> {
        self.product()?;
        while let Some(sign) = self.take(b"+-") {
            self.product()?;
            self.sink.binary(if sign == b'+' { Binary::Add } else { Binary::Subtract })?;
        }
        Ok(())
    }

    fn product(&mut self) -> Result<(), ExpressionError> {
        self.sign()?;
        while let Some(sign) = self.take(b"*/") {
            self.sign()?;
            self.sink.binary(if sign == b'*' { Binary::Multiply } else { Binary::Divide })?;
        }
        Ok(())
    }

    fn sign(&mut self) -> Result<(), ExpressionError> {
        self.depth += 1;
        if self.depth > MAX_EXPRESSION_DEPTH {
            return Err(ExpressionError::TooDeep(self.at + 1));
        }
        match self.take(b"+-") {
            Some(b'-') => {
                self.sign()?;
                self.sink.unary(Unary::Negate)?;
            }
            Some(_) => self.sign()?,
            None => self.power()?,
        }
        self.depth -= 1;
        Ok(())
    }

    fn power(&mut self) -> Result<(), ExpressionError> {
        self.atom()?;
        if self.take(b"^").is_some() {
            self.sign()?;
            self.sink.binary(Binary::Power)?;
        }
        Ok(())
    }

    fn atom(&mut self) -> Result<(), ExpressionError> {
        self.skip_space();
        match self.rest().first() {
            Some(b'(') => {
                self.at += 1;
                self.sum()?;
                self.close()
            }
            Some(b'0'..=b'9' | b'.') => self.number(),
            Some(b'a'..=b'z' | b'A'..=b'Z' | b'_') => self.name(),
            _ => Err(self.expected("a number, a name or \"(\"")),
        }
    }

    fn close(&mut self) -> Result<(), ExpressionError> {
        if self.take(b")").is_some() { Ok(()) } else { Err(self.expected("\")\"")) }
    }

    fn number(&mut self) -> Result<(), ExpressionError> {
        let rest = self.rest();
        let digits = |from: usize| rest[from..].iter().take_while(|b| b.is_ascii_digit()).count();
        let mut end = digits(0);
        if rest.get(end) == Some(&b'.') {
            end += 1 + digits(end + 1);
        }
        if matches!(rest.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(rest.get(end + 1), Some(b'+' | b'-')));
            let exponent = digits(end + 1 + sign);
            if exponent > 0 {
                end += 1 + sign + exponent;
            }
        }
        let value: f64 = self.text[self.at..self.at + end].parse().map_err(|_| self.expected("a number"))?;
        if !value.is_finite() {
            return Err(ExpressionError::NotFinite { value, variable: "", at: 0.0 });
        }
        let digits = &self.text[self.at..self.at + end];
        self.at += end;
        self.sink.constant(Some(digits), value)
    }

    fn name(&mut self) -> Result<(), ExpressionError> {
        let length = self.rest().iter().take_while(|b| b.is_ascii_alphanumeric() || **b == b'_').count();
        let name = &self.text[self.at..self.at + length];
        if name == self.variable {
            self.at += length;
            return self.sink.variable();
        }
        let constant = match name {
            "pi" => Some(std::f64::consts::PI),
            "e" => Some(std::f64::consts::E),
            _ => None,
        };
        if let Some(value) = constant {
            self.at += length;
            return self.sink.constant(None, value);
        }
        let unary = Unary::named(name).filter(|op| *op != Unary::Negate);
        let binary = Binary::named(name);
        if unary.is_none() && binary.is_none() {
            return Err(self.unknown(name));
        }
        self.at += length;
        if self.take(b"(").is_none() {
            return Err(self.expected("\"(\""));
        }
        self.sum()?;
        if let Some(op) = unary {
            self.close()?;
            return self.sink.unary(op);
        }
        if self.take(b",").is_none() {
            return Err(self.expected("\",\" and a second argument"));
        }
        self.sum()?;
        self.close()?;
        binary.map_or(Ok(()), |op| self.sink.binary(op))
    }

    fn unknown(&self, name: &str) -> ExpressionError {
        let functions = Unary::ALL.iter().skip(1).map(|(n, _)| *n);
        let functions = functions.chain(["min", "max", "pow"]);
        let names = ["pi", "e"].into_iter().chain(Some(self.variable).filter(|v| !v.is_empty()));
        let known = names.chain(functions).collect::<Vec<_>>().join(", ");
        ExpressionError::UnknownName { name: shortened(name), known }
    }
}
