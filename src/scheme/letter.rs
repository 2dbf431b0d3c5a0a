//! Letters: operators with the values of their parameters.

use super::operator::{Facts, Operator};
use super::settings::LetterSettings;
use crate::math::parameter::{Parameter, Value};

/// One letter of a word: an operator and the values of its parameters.
#[derive(Debug, Clone)]
pub struct Letter {
    /// The operator.
    pub operator: &'static dyn Operator,
    /// The values of its parameters.
    pub settings: LetterSettings,
}

impl Letter {
    /// Returns an operator with the default values.
    pub fn plain(operator: &'static dyn Operator) -> Self {
        Self { operator, settings: LetterSettings::usual(operator.facts().parameters) }
    }

    /// Returns the letter with another value of a parameter.
    #[must_use]
    pub fn with(mut self, parameter: &Parameter, value: Value) -> Self {
        self.settings.set(parameter, value);
        self
    }

    /// Returns the facts of its operator.
    pub fn facts(&self) -> &'static Facts {
        self.operator.facts()
    }

    /// Returns whether the letter moves the points of a polygon by half a step.
    pub fn shifts(&self) -> bool {
        self.operator.mask_range(&self.settings, 0).is_some_and(|range| range.shifts())
    }
}

impl PartialEq for Letter {
    fn eq(&self, other: &Self) -> bool {
        self.facts().name == other.facts().name && self.settings == other.settings
    }
}
