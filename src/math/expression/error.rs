//! The bounds of expressions, and why a text is none.

/// Longest text of an expression, bytes.
pub const MAX_BYTES: usize = 1024;
/// Deepest nesting of parentheses, functions and signs.
pub const MAX_DEPTH: usize = 32;
/// Most instructions of a compiled expression.
pub const MAX_INSTRUCTIONS: usize = 256;

/// Why a text is no expression, or has no value.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExpressionError {
    /// The text is longer than [`MAX_BYTES`].
    #[error("the expression has {0} bytes, at most {MAX_BYTES} are allowed; shorten it")]
    TooLong(usize),
    /// Nested deeper than [`MAX_DEPTH`].
    #[error("the expression is nested deeper than {MAX_DEPTH} at character {0}; flatten it")]
    TooDeep(usize),
    /// More than [`MAX_INSTRUCTIONS`] after folding.
    #[error("the expression has more than {MAX_INSTRUCTIONS} operations; shorten it")]
    TooLarge,
    /// Something else was expected at a character.
    #[error("expected {expected} at character {at} of \"{text}\"")]
    Expected {
        /// What would be right.
        expected: &'static str,
        /// Position in characters, from 1.
        at: usize,
        /// The text, shortened.
        text: String,
    },
    /// A name that is neither constant, variable nor function.
    #[error("unknown name \"{name}\"; known here: {known}")]
    UnknownName {
        /// The name, shortened.
        name: String,
        /// What may be used.
        known: String,
    },
    /// A value that is not finite.
    #[error(
        "the expression is not finite ({value}){}; change the expression or the parameter",
        if .variable.is_empty() { String::new() } else { format!(" at {variable} = {at}") }
    )]
    NotFinite {
        /// Infinity or NaN.
        value: f64,
        /// The variable's name.
        variable: &'static str,
        /// The value of the variable.
        at: f64,
    },
}
