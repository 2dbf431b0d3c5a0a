//! The values of the parameters that an operator declares for its letters.

use std::sync::Arc;

use super::parameters::{ARITY, FIRST, MASK, tile};
use crate::math::exact::Exact;
use crate::math::mask::Mask;
use crate::math::parameter::{Parameter, Value, Values};
use crate::math::weight::Weight;
use crate::shape::tile::Tile;

/// A value for each parameter that an operator declares for its letters; copies share them.
#[derive(Debug, Clone)]
pub struct LetterSettings {
    values: Arc<Values>,
    /// The exact entries of the mask, if they are fractions.
    exact_mask: Option<Arc<[Exact]>>,
}

impl PartialEq for LetterSettings {
    /// Equal values are equal, however they were written.
    fn eq(&self, other: &Self) -> bool {
        self.values == other.values
    }
}

impl LetterSettings {
    /// Creates the default values.
    pub fn usual(declared: &'static [Parameter]) -> Self {
        Self { values: Arc::new(Values::usual(declared)), exact_mask: None }
    }

    /// Sets a parameter if it is declared.
    pub fn set(&mut self, parameter: &Parameter, value: Value) {
        Arc::make_mut(&mut self.values).set(parameter, value);
    }

    /// Sets the mask if one is declared.
    pub fn set_mask(&mut self, mask: Mask) {
        self.set(&FIRST, Value::Integer(mask.first.into()));
        self.set(&MASK, Value::Numbers(mask.values));
        self.exact_mask = None;
    }

    /// Sets the mask together with its exact entries.
    pub fn set_weights(&mut self, first: i32, weights: &[Weight]) {
        self.set_mask(Mask { first, values: weights.iter().map(|weight| weight.value).collect() });
        self.exact_mask = weights.iter().map(|weight| weight.exact.clone()).collect();
    }

    /// Returns the exact entries of the mask, if they are known.
    pub fn exact_mask(&self) -> Option<&[Exact]> {
        self.exact_mask.as_deref()
    }

    /// Returns all values, by which settings are equal and which enter keys.
    pub fn values(&self) -> &Values {
        // the exact entries of a mask follow from how its values were written
        let Self { values, exact_mask: _ } = self;
        values
    }

    /// Returns the number of new points per old one; 2 if no arity is declared.
    pub fn arity(&self) -> u32 {
        self.whole(&ARITY).unwrap_or(2)
    }

    /// Returns the tile into which faces are split.
    pub fn tile(&self) -> Tile {
        tile(&self.values)
    }

    /// Returns the mask, if there is one.
    pub fn mask(&self) -> Option<Mask> {
        let Value::Numbers(values) = self.values.get(MASK.name) else { return None };
        let first = i32::try_from(self.values.integer(FIRST.name)?).ok()?;
        Some(Mask { first, values: values.clone() })
    }

    /// Returns the number that a parameter has, or 0 if it is not declared.
    pub fn number(&self, parameter: &Parameter) -> f64 {
        self.values.number(parameter.name).unwrap_or(0.0)
    }

    /// Returns the value of a parameter that is a count.
    pub fn whole(&self, parameter: &Parameter) -> Option<u32> {
        u32::try_from(self.values.integer(parameter.name)?).ok()
    }

    /// Returns whether an upsampling splits faces of any size into quads, one per vertex.
    pub fn halves(&self) -> bool {
        self.tile() == Tile::Quad && self.arity() == 2
    }

    /// Returns the number of pieces into which an upsampling divides each edge of a mesh; other faces than quads are
    /// first split into quads.
    pub fn pieces(&self, is_quads: bool) -> u32 {
        let arity = self.arity();
        if self.tile() == Tile::Quad && arity != 2 && !is_quads { 2 * arity } else { arity }
    }
}
