//! The limits of expressions, and the errors of parsing and evaluating them.

/// Maximum length of an expression's text, in bytes.
pub const MAX_EXPRESSION_BYTES: usize = 1024;
/// Maximum nesting depth of parentheses, functions and signs.
pub const MAX_EXPRESSION_DEPTH: usize = 32;
/// Maximum number of instructions of a compiled expression.
pub const MAX_INSTRUCTIONS: usize = 256;

/// The reason for which a text is not an expression, or has no value.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExpressionError {
    /// The text is longer than [`MAX_EXPRESSION_BYTES`].
    #[error("the expression has {0} bytes, at most {MAX_EXPRESSION_BYTES} are allowed; shorten it")]
    TooLong(usize),
    /// Nested deeper than [`MAX_EXPRESSION_DEPTH`].
    #[error("the expression is nested deeper than {MAX_EXPRESSION_DEPTH} at character {0}; flatten it")]
    TooDeep(usize),
    /// More than [`MAX_INSTRUCTIONS`] after folding.
    #[error("the expression has more than {MAX_INSTRUCTIONS} operations; shorten it")]
    TooLarge,
    /// A different character was expected.
    #[error("expected {expected} at character {at} of \"{text}\"")]
    Expected {
        /// The expected text.
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
        /// The names that may be used.
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
