//! Presets: named schemes, spelled as words over operators.

use super::claim::Claim;
use super::letter::Letter;
use super::ops::Masked;
use super::parameters::{ARITY, DEFAULT_MU};
use super::rules::LatitudeRule;
use super::rules::Rules;
use super::word::lettered;
use crate::fault::Fault;
use crate::math::exactly;
use crate::math::expression::Expression;
use crate::math::parameter::{Parameter, Value, Values};
use crate::math::weight::Weight;
use crate::shape::tile::Tile;

/// The preset with bicubic limit surfaces, which is the default where only such a scheme will do.
pub const BICUBIC_PRESET: &str = "catmull-clark";

/// A named scheme.
#[derive(Debug)]
pub struct Preset {
    /// Name in requests.
    pub name: &'static str,
    /// What the scheme is, with the formula.
    pub doc: &'static str,
    /// Author, year, page.
    pub source: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// The kinds of input that it refines.
    pub refines: Refines,
    /// The claimed properties of its limits.
    pub claims: &'static [Claim],
    /// Spells the preset for given parameters.
    pub spell: fn(&Values) -> Result<Spelling, Vec<Fault>>,
}

/// The kinds of input that a preset refines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refines {
    /// Polygons only.
    Curves,
    /// Meshes only.
    Meshes,
    /// Polygons and meshes.
    Both,
}

/// A scheme spelled out: the cycle and the functions that its operators use.
#[derive(Debug, Clone, PartialEq)]
pub struct Spelling {
    /// The word that is applied once per level.
    pub cycle: Vec<Letter>,
    /// The alpha that enters the first U, in radians.
    pub alpha: f64,
    /// The alpha of the compensation in radians, if it differs.
    pub compensation_alpha: Option<f64>,
    /// Kernels of the first, second, ... average after a U, as functions of alpha.
    pub kernel: Vec<Expression>,
    /// The tile into which the faces of a mesh are split.
    pub tile: Tile,
    /// Weight of a vertex in averages of triangles.
    pub mu: f64,
    /// Compensation, as a function of alpha.
    pub compensation: Expression,
    /// Push-back factor, as a function of the valence.
    pub delta: Expression,
    /// Amplitude and decay of the perturbation, if any.
    pub perturbation: Option<[f64; 2]>,
    /// Kernel along longitude lines, if it differs.
    pub kernel_longitude: Option<Expression>,
    /// The effect of latitude tags.
    pub latitude_rule: LatitudeRule,
    /// Rules of the scheme for meshes.
    pub rules: Rules,
}

impl Spelling {
    /// Creates a spelling of the cycle with alpha 0, kernel 1, compensation 1 and delta 1.
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

/// Returns the plain letters of a word.
pub(super) fn letters(word: &str) -> Vec<Letter> {
    let operator = |letter| lettered(letter).expect("presets are spelled in letters of the registry");
    word.chars().map(|letter| Letter::plain(operator(letter))).collect()
}

/// Spells a scheme as one mask whose first entry has the index `first`; zeros at its ends are dropped.
pub(super) fn masked(arity: u32, first: i32, weights: &[Weight]) -> Result<Spelling, Vec<Fault>> {
    let none = || vec![Fault::new("/mask", "every entry of the mask is 0; give the weights of the scheme")];
    let from = weights.iter().position(|weight| weight.value != 0.0).ok_or_else(none)?;
    let to = weights.iter().rposition(|weight| weight.value != 0.0).ok_or_else(none)?;
    let first = i32::try_from(from).ok().and_then(|from| first.checked_add(from)).ok_or_else(none)?;
    let mut letter = Letter::plain(&Masked).with(&ARITY, Value::Integer(arity.into()));
    letter.settings.set_weights(first, &weights[from..=to]);
    Ok(Spelling::of(vec![letter]))
}

/// Spells a scheme with a symmetric mask, given from its middle entry outwards.
pub(super) fn mirrored(arity: u32, middle: Weight, outwards: &[Weight]) -> Result<Spelling, Vec<Fault>> {
    let reach = i32::try_from(outwards.len()).unwrap_or(i32::MAX);
    let weights: Vec<Weight> = outwards.iter().rev().cloned().chain([middle]).chain(outwards.iter().cloned()).collect();
    masked(arity, -reach, &weights)
}

/// Returns the number that a preset was given, with its exact value; 0 if it is absent.
pub(super) fn weight(values: &Values, name: &str) -> Weight {
    Weight { value: values.number(name).unwrap_or(0.0), exact: values.written(name).and_then(exactly::literal) }
}

/// Returns the constant function of a weight.
pub(super) fn constant(weight: &Weight) -> Expression {
    match &weight.exact {
        Some(exact) => Expression::written(weight.value, &exact.to_string()),
        // an empty text marks that the exact value is unknown
        None => Expression::written(weight.value, ""),
    }
}
