//! Entities of ISO 10303-21, numbered in the order in which they are written.

use std::fmt::{self, Write as _};
use std::io::{self, Write};

use crate::output::error::FormatError;
use crate::output::numbers::real;

/// Number of bytes that are buffered before they are written.
const STEP_BUFFER_BYTES: usize = 1 << 16;

/// The number of an entity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Id(u64);

impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{}", self.0)
    }
}

/// A number in the notation of STEP: the shortest decimal that reads back, always with a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Real(pub(super) f64);

impl fmt::Display for Real {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = Vec::with_capacity(24);
        real(&mut text, self.0);
        let text = String::from_utf8_lossy(&text);
        let (mantissa, exponent) = text.split_once('e').map_or((&*text, None), |(m, e)| (m, Some(e)));
        f.write_str(mantissa)?;
        if !mantissa.contains('.') {
            f.write_char('.')?;
        }
        exponent.map_or(Ok(()), |exponent| write!(f, "E{exponent}"))
    }
}

/// A list in parentheses.
#[derive(Debug, Clone, Copy)]
pub(super) struct List<'a, T>(pub(super) &'a [T]);

impl<T: fmt::Display> fmt::Display for List<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_char('(')?;
        for (i, one) in self.0.iter().enumerate() {
            if i > 0 {
                f.write_char(',')?;
            }
            write!(f, "{one}")?;
        }
        f.write_char(')')
    }
}

/// A text in apostrophes: apostrophes and backslashes are doubled, and other characters than printable ASCII are
/// escaped by their code.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepText<'a>(pub(super) &'a str);

impl fmt::Display for StepText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_char('\'')?;
        for c in self.0.chars() {
            match c {
                '\'' => f.write_str("''")?,
                '\\' => f.write_str("\\\\")?,
                ' '..='~' => f.write_char(c)?,
                _ => write!(f, "\\X4\\{:08X}\\X0\\", u32::from(c))?,
            }
        }
        f.write_char('\'')
    }
}

/// Writes entities.
pub(super) struct Entities<'a> {
    out: &'a mut dyn Write,
    text: String,
    last: u64,
}

impl<'a> Entities<'a> {
    pub(super) fn new(out: &'a mut dyn Write) -> Self {
        Self { out, text: String::with_capacity(STEP_BUFFER_BYTES + 4096), last: 0 }
    }

    /// Writes text that is not an entity.
    pub(super) fn line(&mut self, text: &str) -> Result<(), FormatError> {
        self.text.push_str(text);
        self.text.push('\n');
        self.flush_above(STEP_BUFFER_BYTES)
    }

    /// Writes an entity.
    pub(super) fn add(&mut self, text: fmt::Arguments<'_>) -> Result<Id, FormatError> {
        self.last += 1;
        writeln!(self.text, "#{}={text};", self.last).map_err(io::Error::other)?;
        self.flush_above(STEP_BUFFER_BYTES)?;
        Ok(Id(self.last))
    }

    /// Writes a point.
    pub(super) fn point(&mut self, point: [f64; 3]) -> Result<Id, FormatError> {
        let point = point.map(Real);
        self.add(format_args!("CARTESIAN_POINT('',{})", List(&point)))
    }

    /// Writes the rest of the buffer.
    pub(super) fn finish(mut self) -> Result<(), FormatError> {
        self.flush_above(0)
    }

    fn flush_above(&mut self, n: usize) -> Result<(), FormatError> {
        if self.text.len() > n {
            self.out.write_all(self.text.as_bytes())?;
            self.text.clear();
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{Real, StepText};

    #[test]
    fn numbers_have_a_point_and_a_capital_exponent() {
        for (x, text) in [(1.0, "1."), (-0.0, "0."), (0.25, "0.25"), (1e-7, "1.E-7"), (1.5e-9, "1.5E-9")] {
            assert_eq!(Real(x).to_string(), text);
        }
        assert_eq!(Real(1e30).to_string(), "1.E+30");
    }

    #[test]
    fn texts_are_quoted() {
        assert_eq!(StepText("it's a \\ ü").to_string(), r"'it''s a \\ \X4\000000FC\X0\'");
    }
}
