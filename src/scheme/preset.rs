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

/// The preset whose limit surfaces have bicubic pieces, which is meant where only these will do and none is named.
pub const BICUBIC_PRESET: &str = "catmull-clark";

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
    /// What it claims of its limits.
    pub claims: &'static [Claim],
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

/// A scheme that is one mask, whose first entry has the index `first`; zeros at its ends are left out.
pub(super) fn masked(arity: u32, first: i32, weights: &[Weight]) -> Result<Spelling, Vec<Fault>> {
    let none = || vec![Fault::new("/mask", "every entry of the mask is 0; give the weights of the scheme")];
    let from = weights.iter().position(|weight| weight.value != 0.0).ok_or_else(none)?;
    let to = weights.iter().rposition(|weight| weight.value != 0.0).ok_or_else(none)?;
    let first = i32::try_from(from).ok().and_then(|from| first.checked_add(from)).ok_or_else(none)?;
    let mut letter = Letter::plain(&Masked).with(&ARITY, Value::Integer(arity.into()));
    letter.settings.set_weights(first, &weights[from..=to]);
    Ok(Spelling::of(vec![letter]))
}

/// A scheme whose mask is its own mirror image, from its middle entry outwards.
pub(super) fn mirrored(arity: u32, middle: Weight, outwards: &[Weight]) -> Result<Spelling, Vec<Fault>> {
    let reach = i32::try_from(outwards.len()).unwrap_or(i32::MAX);
    let weights: Vec<Weight> = outwards.iter().rev().cloned().chain([middle]).chain(outwards.iter().cloned()).collect();
    masked(arity, -reach, &weights)
}

/// A number that a preset was given, with its exact value; 0 where it is absent.
pub(super) fn weight(values: &Values, name: &str) -> Weight {
    Weight { value: values.number(name).unwrap_or(0.0), exact: values.written(name).and_then(exactly::literal) }
}

/// The constant function of a weight.
pub(super) fn constant(weight: &Weight) -> Expression {
    match &weight.exact {
        Some(exact) => Expression::written(weight.value, &exact.to_string()),
        // no text of digits, so that it is not taken for one
        None => Expression::written(weight.value, ""),
    }
}
