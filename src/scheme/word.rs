//! Words: the grammar `item* [ '(' item+ ')' ]`, `item := letter [ '^' n ] | '(' item+ ')' '^' n`.

use super::letter::Letter;
use super::operator::{Operator, Role};
use super::ops::OPERATORS;
use super::parameters::{ARITIES, ARITY};
use crate::fault::did_you_mean;
use crate::math::parameter::Value;

/// Maximum length of a word's text in bytes: [`MAX_LETTERS`] letters of four bytes each. Half as many would refuse long
/// words written out; twice as many would admit only other spellings.
pub const MAX_WORD_BYTES: usize = 256;
/// Maximum number of letters of the prefix of a word, and of its cycle, after powers are written out. Each average is a
/// pass over the mesh at every level, so that twice as many take twice as long; half as many would refuse words of more
/// than 32 letters.
pub const MAX_LETTERS: usize = 64;
/// Maximum nesting depth of groups. Half of it would refuse groups nested five deep; twice of it would use more of the
/// stack for no more letters.
pub const MAX_GROUP_DEPTH: usize = 8;

/// Returns the operator of a letter.
pub fn lettered(letter: char) -> Option<&'static dyn Operator> {
    OPERATORS.iter().copied().find(|op| op.facts().letter == Some(letter))
}

/// A word: the prefix is applied once, then the cycle once a level.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Word {
    /// Applied once, first.
    pub prefix: Vec<Letter>,
    /// Applied once a level.
    pub cycle: Vec<Letter>,
}

/// The reason for which a text is not a word.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum WordError {
    /// The word is empty.
    #[error("the word is empty; write at least one operator ({known})", known = known())]
    Empty,
    /// The text is longer than [`MAX_WORD_BYTES`].
    #[error("the word has {0} bytes, at most {MAX_WORD_BYTES} are allowed; use powers such as (UC)^3")]
    TooLong(usize),
    /// The word has more than [`MAX_LETTERS`] letters once written out.
    #[error(
        "the word has more than {MAX_LETTERS} letters once its powers are written out; ask for more levels instead"
    )]
    TooManyLetters,
    /// Groups are nested deeper than [`MAX_GROUP_DEPTH`].
    #[error("groups are nested deeper than {MAX_GROUP_DEPTH}; write them out")]
    TooDeep,
    /// A letter is not an operator.
    #[error(
        "\"{letter}\" at character {at} is no operator; {meant}known are {known}",
        meant = meant(*letter), known = known()
    )]
    UnknownLetter {
        /// The letter.
        letter: char,
        /// Its position, counted from 1.
        at: usize,
    },
    /// A different character was expected.
    #[error("expected {expected} at character {at}")]
    Expected {
        /// The expected text.
        expected: &'static str,
        /// The position, counted from 1.
        at: usize,
    },
    /// An arity that no operator offers.
    #[error("U{arity} is not offered; the arity of U is {} to {}", ARITIES.start(), ARITIES.end())]
    Arity {
        /// The arity asked for.
        arity: u32,
    },
}

/// Suggests the letter in the other case if that is an operator.
fn meant(letter: char) -> String {
    let known: Vec<String> = OPERATORS.iter().filter_map(|op| op.facts().letter).map(String::from).collect();
    did_you_mean(&letter.to_string(), known.iter().map(String::as_str))
}

fn known() -> String {
    OPERATORS.iter().filter_map(|op| op.facts().letter).map(String::from).collect::<Vec<_>>().join(", ")
}

impl Word {
    /// Parses a word. Without a trailing group the whole word is the cycle.
    ///
    /// # Errors
    /// [`WordError`] naming the place.
    pub fn parse(text: &str) -> Result<Self, WordError> {
        if text.len() > MAX_WORD_BYTES {
            return Err(WordError::TooLong(text.len()));
        }
        let characters: Vec<char> = text.chars().collect();
        let mut parser = WordParser { text: &characters, at: 0 };
        let (letters, cycle) = parser.items(0)?;
        if letters.is_empty() && cycle.is_none() {
            return Err(WordError::Empty);
        }
        Ok(match cycle {
            Some(cycle) => Self { prefix: letters, cycle },
            None => Self { prefix: Vec::new(), cycle: letters },
        })
    }

    /// Creates the word that repeats these letters.
    pub fn cycle(cycle: Vec<Letter>) -> Self {
        Self { prefix: Vec::new(), cycle }
    }

    /// Returns all letters of the prefix and of `levels` cycles, in order of application.
    pub fn letters(&self, levels: u32) -> impl Iterator<Item = Letter> + '_ {
        let cycles = (0..levels).flat_map(|_| self.cycle.iter());
        self.prefix.iter().chain(cycles).cloned()
    }
}

struct WordParser<'a> {
    text: &'a [char],
    at: usize,
}

impl WordParser<'_> {
    fn peek(&self) -> Option<char> {
        self.text.get(self.at).copied()
    }

    fn expected(&self, expected: &'static str) -> WordError {
        WordError::Expected { expected, at: self.at + 1 }
    }

    /// Parses items up to the end or a closing parenthesis; a group without a power is the cycle and must come last.
    fn items(&mut self, depth: usize) -> Result<(Vec<Letter>, Option<Vec<Letter>>), WordError> {
        if depth > MAX_GROUP_DEPTH {
            return Err(WordError::TooDeep);
        }
        let mut letters = Vec::new();
        while let Some(next) = self.peek() {
            if next == ')' && depth > 0 {
                break;
            }
            let (unit, group) = if next == '(' { (self.group(depth)?, true) } else { (vec![self.letter()?], false) };
            match self.power()? {
                Some(n) => (0..n).try_for_each(|_| extend(&mut letters, &unit))?,
                None if !group => extend(&mut letters, &unit)?,
                None if depth == 0 && self.peek().is_none() => return Ok((letters, Some(unit))),
                None => {
                    return Err(self.expected("\"^\" and a power after the group; only the last group may go without"));
                }
            }
        }
        Ok((letters, None))
    }

    fn group(&mut self, depth: usize) -> Result<Vec<Letter>, WordError> {
        self.at += 1;
        let (letters, _) = self.items(depth + 1)?;
        if letters.is_empty() {
            return Err(self.expected("an operator in the group"));
        }
        if self.peek() != Some(')') {
            return Err(self.expected("\")\""));
        }
        self.at += 1;
        Ok(letters)
    }

    fn letter(&mut self) -> Result<Letter, WordError> {
        let at = self.at + 1;
        let letter = self.peek().ok_or_else(|| self.expected("an operator"))?;
        let operator = lettered(letter).ok_or(WordError::UnknownLetter { letter, at })?;
        self.at += 1;
        let arity = match self.peek() {
            Some('0'..='9') if operator.facts().role == Role::Upsample => self.number()?,
            _ => return Ok(Letter::plain(operator)),
        };
        if ARITIES.contains(&arity.into()) {
            Ok(Letter::plain(operator).with(&ARITY, Value::Integer(arity.into())))
        } else {
            Err(WordError::Arity { arity })
        }
    }

    fn power(&mut self) -> Result<Option<u32>, WordError> {
        if self.peek() != Some('^') {
            return Ok(None);
        }
        self.at += 1;
        match self.number()? {
            0 => Err(self.expected("a power of at least 1")),
            n => Ok(Some(n)),
        }
    }

    fn number(&mut self) -> Result<u32, WordError> {
        let mut value = None;
        while let Some(digit) = self.peek().and_then(|c| c.to_digit(10)) {
            value = Some(value.unwrap_or(0_u32).saturating_mul(10).saturating_add(digit));
            self.at += 1;
        }
        value.ok_or_else(|| self.expected("a number"))
    }
}

fn extend(letters: &mut Vec<Letter>, unit: &[Letter]) -> Result<(), WordError> {
    if letters.len() + unit.len() > MAX_LETTERS {
        return Err(WordError::TooManyLetters);
    }
    letters.extend_from_slice(unit);
    Ok(())
}
