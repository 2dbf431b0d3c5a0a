//! What the catalogue claims of presets, held against the analysis.

use planish::math::expression::Expression;
use planish::scheme::claim::Claim;
use planish::scheme::preset::Refines;
use planish::scheme::presets::PRESETS;
use serde_json::{Map, Value, json};

use super::{numbers, preset, smoothness};

#[test]
fn every_claim_of_a_preset_is_what_the_analysis_finds() {
    for of in PRESETS {
        for claim in of.claims {
            assert!(!claim.at.is_empty(), "{}: {} is tested nowhere", of.name, claim.range);
            claim.at.iter().for_each(|values| holds(of.name, claim, values));
        }
    }
}

#[test]
fn every_preset_for_curves_with_a_mask_of_its_own_has_claims() {
    for of in PRESETS.iter().filter(|preset| preset.refines != Refines::Meshes) {
        // the one is no linear scheme, the other what its client makes of it
        let without = ["incenter", "mask"].contains(&of.name);
        assert_eq!(of.claims.is_empty(), without, "{}", of.name);
    }
}

fn holds(name: &str, claim: &Claim, values: &[(&'static str, &'static str)]) {
    let literal = |text: &str| text.parse::<i64>().map_or_else(|_| json!(text), |n| json!(n));
    let parameters: Map<String, Value> = values.iter().map(|(name, text)| ((*name).into(), literal(text))).collect();
    let answer = preset(name, &json!(parameters));
    let answer = answer.get("static_limit").unwrap_or(&answer);
    let (variable, x) = values.first().copied().unwrap_or(("", "0"));
    let x = Expression::parse(x, "").unwrap().value(0.0).unwrap();
    let number = |text: &str| Expression::parse(text, variable).unwrap().value(x).unwrap();
    #[expect(clippy::cast_possible_truncation, reason = "claims are small whole numbers")]
    let whole = |text: &str| number(text) as i64;
    let at = format!("{name} {values:?}");
    let k = whole(claim.smoothness);
    assert_eq!(smoothness(answer), (k, Some(k + 1)), "smoothness of {at}");
    let support = numbers(&answer["support"]);
    assert!((support[1] - support[0] - number(claim.support)).abs() < 1e-12, "support of {at}: {support:?}");
    assert_eq!(answer["reproduction_degree"], whole(claim.reproduction_degree), "reproduction degree of {at}");
}
