//! Presets: named schemes, spelled as words over operators.

use super::letter::Letter;
use super::ops::Masked;
use super::parameters::{ARITY, DEFAULT_MU};
use super::rules::LatitudeRule;
use super::rules::Rules;
use super::word::lettered;
use crate::fault::Fault;
use crate::math::expression::Expression;
use crate::math::mask::Mask;
use crate::math::parameter::{Parameter, Value, Values};
use crate::shape::tile::Tile;

/// A named scheme.
#[derive(Debug)]
pub struct Preset {
    /// Name in requests.
    pub name: &'static str,
    /// What it is, with the formula.
    pub doc: &'static str,
    /// Author, year, page.
    pub source: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// Which inputs it refines.
    pub refines: Refines,
    /// How it is spelled.
    pub spell: fn(&Values) -> Result<Spelling, Vec<Fault>>,
}

/// Which inputs a preset refines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refines {
    /// Polygons only.
    Curves,
    /// Meshes only.
    Meshes,
    /// Both.
    Both,
}

/// A scheme spelled out: the cycle and the functions that its operators use.
#[derive(Debug, Clone, PartialEq)]
pub struct Spelling {
    /// The word applied once a level.
    pub cycle: Vec<Letter>,
    /// Parameter spacing that enters the first U.
    pub alpha: f64,
    /// Parameter spacing of the compensation, where it differs.
    pub compensation_alpha: Option<f64>,
    /// Kernels of the first, second, ... average after a U, in alpha.
    pub kernel: Vec<Expression>,
    /// Into what the faces of a mesh are split.
    pub tile: Tile,
    /// Weight of a vertex in averages of triangles.
    pub mu: f64,
    /// Compensation function, in alpha.
    pub compensation: Expression,
    /// Push-back factor, in valence.
    pub delta: Expression,
    /// Amplitude and decay of the perturbation, if any.
    pub perturbation: Option<[f64; 2]>,
    /// Kernel along longitude lines, where it differs.
    pub kernel_longitude: Option<Expression>,
    /// What latitude tags do.
    pub latitude_rule: LatitudeRule,
    /// Rules of the scheme for meshes.
    pub rules: Rules,
}

impl Spelling {
    /// The cycle with alpha 0, kernel 1, compensation 1, delta 1.
    pub(super) fn of(cycle: Vec<Letter>) -> Self {
        let one = Expression::constant(1.0);
        Self {
            cycle,
            alpha: 0.0,
            compensation_alpha: None,
            kernel: vec![one.clone()],
            tile: Tile::Quad,
            mu: DEFAULT_MU,
            compensation: one.clone(),
            delta: one,
            perturbation: None,
            kernel_longitude: None,
            latitude_rule: LatitudeRule::default(),
            rules: Rules::default(),
        }
    }
}

/// Letters of operators that have one.
pub(super) fn letters(word: &str) -> Vec<Letter> {
    let operator = |letter| lettered(letter).expect("presets are spelled in letters of the registry");
    word.chars().map(|letter| Letter::plain(operator(letter))).collect()
}

/// A scheme that is one mask; without entries there is none.
pub(super) fn masked(arity: u32, mask: Option<Mask>) -> Result<Spelling, Vec<Fault>> {
    let none = || vec![Fault::new("/mask", "every entry of the mask is 0; give the weights of the scheme")];
    let mut letter = Letter::plain(&Masked).with(&ARITY, Value::Integer(arity.into()));
    letter.settings.set_mask(mask.ok_or_else(none)?);
    Ok(Spelling::of(vec![letter]))
}
