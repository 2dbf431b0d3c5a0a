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
pub struct Settings {
    values: Arc<Values>,
    /// The entries of the mask without rounding, where they are fractions.
    exact_mask: Option<Arc<[Exact]>>,
}

impl PartialEq for Settings {
    /// Equal values are equal, however they were written.
    fn eq(&self, other: &Self) -> bool {
        self.values == other.values
    }
}

impl Settings {
    /// The usual values.
    pub fn usual(declared: &'static [Parameter]) -> Self {
        Self { values: Arc::new(Values::usual(declared)), exact_mask: None }
    }

    /// Sets a parameter, where it is declared.
    pub fn set(&mut self, parameter: &Parameter, value: Value) {
        Arc::make_mut(&mut self.values).set(parameter, value);
    }

    /// Sets the mask, where one is declared.
    pub fn set_mask(&mut self, mask: Mask) {
        self.set(&FIRST, Value::Integer(mask.first.into()));
        self.set(&MASK, Value::Numbers(mask.values));
        self.exact_mask = None;
    }

    /// Sets the mask together with what its entries are without rounding.
    pub fn set_weights(&mut self, first: i32, weights: &[Weight]) {
        self.set_mask(Mask { first, values: weights.iter().map(|weight| weight.value).collect() });
        self.exact_mask = weights.iter().map(|weight| weight.exact.clone()).collect();
    }

    /// The entries of the mask without rounding, where they are known.
    pub fn exact_mask(&self) -> Option<&[Exact]> {
        self.exact_mask.as_deref()
    }

    /// All values.
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// New points for each old one; 2 where no arity is declared.
    pub fn arity(&self) -> u32 {
        self.whole(&ARITY).unwrap_or(2)
    }

    /// Into what faces are split.
    pub fn tile(&self) -> Tile {
        tile(&self.values)
    }

    /// The mask, where there is one.
    pub fn mask(&self) -> Option<Mask> {
        let Value::Numbers(values) = self.values.get(MASK.name) else { return None };
        let first = i32::try_from(self.values.integer(FIRST.name)?).ok()?;
        Some(Mask { first, values: values.clone() })
    }

    /// A number of its own, 0 where there is none.
    pub fn number(&self, parameter: &Parameter) -> f64 {
        self.values.number(parameter.name).unwrap_or(0.0)
    }

    /// A number of things.
    pub fn whole(&self, parameter: &Parameter) -> Option<u32> {
        u32::try_from(self.values.integer(parameter.name)?).ok()
    }

    /// Whether an upsampling splits faces of any size into quads, one for each of their vertices.
    pub fn halves(&self) -> bool {
        self.tile() == Tile::Quad && self.arity() == 2
    }

    /// Pieces into which an upsampling of a mesh cuts each edge: other faces than quads are first split into quads.
    pub fn pieces(&self, is_quads: bool) -> u32 {
        let arity = self.arity();
        if self.tile() == Tile::Quad && arity != 2 && !is_quads { 2 * arity } else { arity }
    }
}
