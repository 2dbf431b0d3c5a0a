//! The reason for which an operator cannot be applied: a sentence, and the part of the request that it concerns.

use std::borrow::Cow;
use std::fmt;

/// Maximum number of input points that a message names. Fewer would tell less of where to look; more would make
/// messages too long.
const MAX_NAMED_POINTS: usize = 8;

/// The reason for which an operator cannot be applied.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{about}{sentence}")]
pub struct StepError {
    /// The part of the request that the error concerns.
    pub about: About,
    /// What is wrong, and the remedy.
    sentence: Cow<'static, str>,
}

/// The part of a request that an error concerns.
#[derive(Debug, Clone, PartialEq)]
pub enum About {
    /// The operators of the plan, or the net to which they are applied.
    Plan,
    /// Faces that cannot be split into triangles.
    Triangles,
    /// An upsampling that does not halve edges, or does not make quads.
    Halves,
    /// The end rule of open polygons.
    Ends,
    /// A value of a single point; the sentence continues with the value.
    Point {
        /// The name of the value.
        name: &'static str,
        /// The index of the point in the net.
        point: usize,
        /// The input points that make the point, or between which it lies, ascending; empty if they are not known.
        from: Vec<u32>,
    },
}

impl StepError {
    /// Creates an error that concerns the plan.
    pub fn new(sentence: impl Into<Cow<'static, str>>) -> Self {
        Self { about: About::Plan, sentence: sentence.into() }
    }

    /// Creates an error that concerns `about`.
    pub(super) fn about(about: About, sentence: impl Into<Cow<'static, str>>) -> Self {
        Self { about, sentence: sentence.into() }
    }
}

impl fmt::Display for About {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Point { name, point, from } = self else { return Ok(()) };
        write!(f, "the {name} of point {point}")?;
        let named = from.iter().take(MAX_NAMED_POINTS).map(u32::to_string).collect::<Vec<_>>().join(", ");
        match from[..] {
            [] => {}
            [own] if own as usize == *point => {}
            [_] => write!(f, " (point {named} of the input)")?,
            _ if from.len() > MAX_NAMED_POINTS => write!(f, " (between the points {named}, ... of the input)")?,
            _ => write!(f, " (between the points {named} of the input)")?,
        }
        write!(f, " is ")
    }
}
