//! Resolves a plan from a client's input.

use super::legal::{other_than_halves, useless};
use super::{AlphaOf, Carried, Latitude, Perturbation, Plan, PlanInput, Subject};
use crate::fault::{Fault, did_you_mean, shortened, under};
use crate::math::expression::Expression;
use crate::math::functions::ratio;
use crate::math::parameter::{Literal, Value, Values};
use crate::scheme::letter::Letter;
use crate::scheme::parameters::{KERNEL, SPLIT, WORD_PARAMETERS};
use crate::scheme::preset::{Preset, Refines, Spelling};
use crate::scheme::presets::{PRESETS, with_functions};
use crate::scheme::rules::LatitudeRule;
use crate::scheme::step_error::About;
use crate::scheme::word::Word;
use crate::shape::tile::Tile;

impl Plan {
    /// Resolves a client's input for a subject.
    ///
    /// # Errors
    /// Every fault, with pointers below the plan.
    pub fn resolve(input: &PlanInput, subject: Subject) -> Result<Self, Vec<Fault>> {
        let (spelling, prefix, place) = match (&input.preset, &input.word) {
            (Some(name), None) => (preset(name, &input.parameters, subject)?, Vec::new(), "/preset"),
            (None, Some(text)) => {
                let word = Word::parse(text).map_err(|error| vec![Fault::new("/word", error.to_string())]);
                let values = Values::resolve(WORD_PARAMETERS, &input.parameters);
                let (word, values) = both(word, values.map_err(|faults| under("/parameters", faults)))?;
                (with_functions(word.cycle, &values), word.prefix, "/word")
            }
            (None, None) => {
                return Err(vec![Fault::new("", "a plan is a \"preset\" or a \"word\"; give one of them")]);
            }
            (Some(_), Some(_)) => {
                return Err(vec![Fault::new("/word", "a plan is a \"preset\" or a \"word\"; leave one of them out")]);
            }
        };
        let (spelling, latitude) = with_lines(spelling, input, subject);
        let mut word = Word { prefix, cycle: spelling.cycle };
        if !subject.is_mesh && spelling.kernel.len() == 1 {
            pair_duals(&mut word.prefix);
            pair_duals(&mut word.cycle);
        }
        if subject.is_mesh && spelling.tile == Tile::Triangle {
            let letters = word.prefix.iter_mut().chain(&mut word.cycle);
            letters.for_each(|letter| letter.settings.set(&SPLIT, Value::Choice("triangle")));
        }
        let Spelling { alpha, compensation_alpha, kernel, mu, compensation, delta, perturbation, rules, .. } = spelling;
        let perturbation = perturbation.map(|[amplitude, decay]| Perturbation { amplitude, decay, seed: input.seed });
        let lines_differ = latitude.as_ref().is_some_and(|latitude| latitude.own_alpha);
        let differs = |other: &f64| lines_differ || other.to_bits() != alpha.to_bits();
        // the alpha of points takes precedence over that of the plan
        let compensation_alpha = compensation_alpha.filter(|other| subject.alpha == AlphaOf::Plan && differs(other));
        let plan = Self {
            word,
            alpha,
            compensation_alpha,
            kernel,
            mu,
            compensation,
            delta,
            boundary: input.boundary,
            rules,
            ends: input.ends,
            perturbation,
            latitude,
        };
        if subject.is_mesh && plan.perturbation.is_some() && !plan.averages_halves() {
            let rule = "on meshes, perturbation acts in words over U, C and P with arity 2 and split quad";
            let mut letters = plan.word.prefix.iter().chain(&plan.word.cycle);
            let detail = match letters.find_map(other_than_halves) {
                Some(found) => format!("{rule}; here stands {found}: change it or leave it out"),
                None => format!("{rule}; leave it out"),
            };
            return Err(vec![Fault::new("/parameters/perturbation", detail)]);
        }
        plan.check_legal(subject).map_err(|error| {
            let split = match error.about {
                About::Triangles => input.word.is_some(),
                About::Halves => {
                    plan.tile() == Tile::Triangle && input.parameters.iter().any(|(name, _)| name == "split")
                }
                _ => false,
            };
            vec![Fault::new(if split { "/parameters/split" } else { place }, error.to_string())]
        })?;
        plan.check_delta(subject)?;
        Ok(plan)
    }

    /// Returns whether this is a word over U, C and P whose upsamplings halve edges and make quads.
    fn averages_halves(&self) -> bool {
        let mut letters = self.word.prefix.iter().chain(&self.word.cycle);
        letters.all(|letter| letter.facts().pointwise && letter.settings.halves())
    }

    fn check_delta(&self, subject: Subject) -> Result<(), Vec<Fault>> {
        if subject.is_mesh || self.delta.is_constant() {
            let value = self.delta.value(ratio(self.tile().regular_valence(), 1));
            return value.map(drop).map_err(|error| vec![Fault::new("/parameters/delta", error.to_string())]);
        }
        Err(vec![Fault::new("/parameters/delta", "valence is a property of mesh vertices; give polygons a number")])
    }
}

/// Adapts a scheme to latitude and longitude tags: by default, kernel and compensation then preserve circles.
fn with_lines(spelling: Spelling, input: &PlanInput, subject: Subject) -> (Spelling, Option<Latitude>) {
    if subject.carried != Some(Carried::Latitude) || spelling.latitude_rule == LatitudeRule::Isotropic {
        return (spelling, None);
    }
    let given = |name: &str| input.parameters.iter().any(|(given, _)| given == name);
    let constant = |text| Expression::parse(text, "alpha").expect("a constant text is an expression");
    let latitude = Latitude {
        rule: spelling.latitude_rule,
        kernel_longitude: spelling.kernel_longitude.clone(),
        own_alpha: !given("alpha"),
    };
    let mut spelling = spelling;
    if !given("kernel") {
        spelling.kernel = vec![constant("cos(alpha/2)")];
    }
    if !given("compensation") {
        spelling.compensation = constant("1/cos(alpha/2)");
    }
    (spelling, Some(latitude))
}

fn preset(name: &str, parameters: &[(String, Literal)], subject: Subject) -> Result<Spelling, Vec<Fault>> {
    let Some(preset) = PRESETS.iter().copied().find(|preset| preset.name == name) else {
        let known = PRESETS.iter().map(|p| p.name).collect::<Vec<_>>().join(", ");
        let meant = did_you_mean(name, PRESETS.iter().map(|preset| preset.name));
        let detail = format!("there is no preset \"{}\"; {meant}known are {known}", shortened(name));
        return Err(vec![Fault::new("/preset", detail)]);
    };
    check_subject(preset, subject)?;
    check_carried(preset, subject)?;
    let values = Values::resolve(preset.parameters, parameters).map_err(|faults| under("/parameters", faults))?;
    (preset.spell)(&values).map_err(|faults| under("/parameters", faults))
}

fn check_subject(preset: &Preset, subject: Subject) -> Result<(), Vec<Fault>> {
    let (kind, remedy) = match (preset.refines, subject.is_mesh) {
        (Refines::Curves, true) => ("polygons", "a mesh takes catmull-clark, bilinear, push-back or a word"),
        (Refines::Meshes, false) => ("meshes", "a polygon takes cubic-b-spline, four-point, push-back or a word"),
        _ => return Ok(()),
    };
    Err(vec![Fault::new("/preset", format!("{} refines {kind}; {remedy}", preset.name))])
}

/// Checks that a preset has a kernel and similar parameters if vertices of the mesh have values for them.
fn check_carried(preset: &Preset, subject: Subject) -> Result<(), Vec<Fault>> {
    let Some(carried) = subject.carried else { return Ok(()) };
    if preset.parameters.iter().any(|parameter| parameter.name == KERNEL.name) {
        return Ok(());
    }
    Err(vec![Fault::new("/preset", useless(carried.name()).to_string())])
}

/// Returns both results, or the faults of both.
fn both<A, B>(a: Result<A, Vec<Fault>>, b: Result<B, Vec<Fault>>) -> Result<(A, B), Vec<Fault>> {
    match (a, b) {
        (Ok(a), Ok(b)) => Ok((a, b)),
        (a, b) => Err(a.err().into_iter().chain(b.err()).flatten().collect()),
    }
}

/// Replaces two adjacent D by a C, which they are on polygons, so that both spellings have the same key.
fn pair_duals(letters: &mut Vec<Letter>) {
    let mut paired: Vec<Letter> = Vec::with_capacity(letters.len());
    for letter in letters.drain(..) {
        match letter.facts().twice.filter(|_| paired.last() == Some(&letter)) {
            Some(whole) => {
                paired.pop();
                paired.push(Letter::plain(whole));
            }
            None => paired.push(letter),
        }
    }
    *letters = paired;
}
