//! Why an operator cannot be applied: a sentence, which stands where the operator or the rule does, and what it is
//! about.

use std::borrow::Cow;
use std::fmt;

/// Most points of the input that a sentence names.
/// Half of it tells less of where to look; twice of it makes sentences twice as long.
const MOST: usize = 8;

/// Why an operator cannot be applied.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{about}{sentence}")]
pub struct StepError {
    /// What it is about.
    pub about: About,
    /// What is wrong, and what helps.
    sentence: Cow<'static, str>,
}

/// What an error is about, so that others can point there.
#[derive(Debug, Clone, PartialEq)]
pub enum About {
    /// The operators of the plan and what they are applied to.
    Plan,
    /// Faces that are to be split into triangles.
    Triangles,
    /// An upsampling that does not halve edges, or makes no quads.
    Halves,
    /// The end rule of open polygons.
    Ends,
    /// A value of a single point: the sentence goes on with it.
    Point {
        /// Which value.
        name: &'static str,
        /// The point in the net of which it is a value.
        point: usize,
        /// The points of the input that make it, or between which it lies, ascending, where they are known.
        from: Vec<u32>,
    },
}

impl StepError {
    /// An error that is about the plan.
    pub fn new(sentence: impl Into<Cow<'static, str>>) -> Self {
        Self { about: About::Plan, sentence: sentence.into() }
    }

    /// An error that is about something else than the plan.
    pub(super) fn about(about: About, sentence: impl Into<Cow<'static, str>>) -> Self {
        Self { about, sentence: sentence.into() }
    }
}

impl fmt::Display for About {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Point { name, point, from } = self else { return Ok(()) };
        write!(f, "the {name} of point {point}")?;
        let named = from.iter().take(MOST).map(u32::to_string).collect::<Vec<_>>().join(", ");
        match from[..] {
            [] => {}
            [own] if own as usize == *point => {}
            [_] => write!(f, " (point {named} of the input)")?,
            _ if from.len() > MOST => write!(f, " (between the points {named}, ... of the input)")?,
            _ => write!(f, " (between the points {named} of the input)")?,
        }
        write!(f, " is ")
    }
}
