//! The claims of the catalogue about presets, compared with the analysis.

use planish::math::expression::Expression;
use planish::scheme::claim::Claim;
use planish::scheme::preset::Refines;
use planish::scheme::presets::PRESETS;
use serde_json::{Map, Value, json};

use super::{asked, numbers, smoothness};

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
fn every_preset_with_a_scheme_of_its_own_has_claims_of_all_that_it_refines() {
    for of in PRESETS {
        // `incenter` is not linear, and `mask` is whatever its client makes of it
        let without = ["incenter", "mask"].contains(&of.name);
        let has = |of_meshes: bool| of.claims.iter().any(|claim| claim.is_of_meshes == of_meshes);
        assert_eq!(has(false), of.refines != Refines::Meshes && !without, "{}", of.name);
        assert_eq!(has(true), of.refines != Refines::Curves, "{}", of.name);
    }
}

/// Returns the valences at which a claim is tested: its ends, and some between.
fn valences([from, to]: [u32; 2]) -> Vec<u32> {
    let mut all: Vec<u32> = [from, from + 1, 5, 7, 12, to].into_iter().filter(|n| (from..=to).contains(n)).collect();
    all.sort_unstable();
    all.dedup();
    all
}

fn holds(name: &str, claim: &Claim, values: &[(&'static str, &'static str)]) {
    let at = format!("{name} {values:?}");
    let literal = |text: &str| text.parse::<i64>().map_or_else(|_| json!(text), |n| json!(n));
    let parameters: Map<String, Value> = values.iter().map(|(name, text)| ((*name).into(), literal(text))).collect();
    let mut question = json!({ "plan": { "preset": name, "parameters": parameters }, "nodes": 20_000 });
    if claim.is_of_meshes {
        // matrices of surfaces are larger, and need the default number of products
        question["nodes"] = json!(100_000);
        question["valences"] = json!(claim.valences.map_or(vec![3, 5], valences));
        question["boundaries"] = json!([]);
    }
    let answer = asked(&question);
    let (variable, x) = values.first().copied().unwrap_or(("", "0"));
    let x = Expression::parse(x, "").unwrap().value(0.0).unwrap();
    let number = |text: &str| Expression::parse(text, variable).unwrap().value(x).unwrap();
    #[expect(clippy::cast_possible_truncation, reason = "claims are small whole numbers")]
    let whole = |text: &str| number(text) as i64;
    let regular = if claim.is_of_meshes { &answer["regular"] } else { answer.get("static_limit").unwrap_or(&answer) };
    let k = whole(claim.smoothness);
    let (proved, disproved) = smoothness(regular);
    assert_eq!(proved, k, "smoothness of {at}");
    // if the stability of shifts is unknown, nothing is disproved on lattices
    let may_be_open = claim.is_of_meshes && disproved.is_none();
    assert!(may_be_open || disproved == Some(k + 1), "{at} is not C{}: {disproved:?}", k + 1);
    let support = if claim.is_of_meshes { &regular["support"][0] } else { &regular["support"] };
    let support = numbers(support);
    assert!((support[1] - support[0] - number(claim.support)).abs() < 1e-12, "support of {at}: {support:?}");
    assert_eq!(regular["reproduction_degree"], whole(claim.reproduction_degree), "reproduction degree of {at}");
    if claim.is_of_meshes {
        is_c1(&at, claim, &answer["valences"]);
    }
}

/// Checks at all valences of a claim that C1 is proved, or that all criteria are met numerically.
fn is_c1(at: &str, claim: &Claim, rows: &Value) {
    for row in rows.as_array().unwrap() {
        let evidence = row["evidence"].as_str().unwrap();
        let holds = ["proved", "supported"].contains(&evidence);
        assert_eq!(holds, claim.valences.is_some(), "{at} at {}: {}", row["valence"], row["criteria"]);
        assert!(claim.valences.is_some() || evidence == "disproved", "{at} at {}: {evidence}", row["valence"]);
    }
}
