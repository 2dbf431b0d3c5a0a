//! Laws of every scheme, and the agreement of analysis and refinement.

use planish::analysis::curve::{CycleMask, ExactCycle};
use planish::math::exact::rounded;
use planish::math::parameter::Literal;
use planish::scheme::plan::{Plan, PlanInput, Subject};
use planish::watch::Watch;
use proptest::prelude::*;
use serde_json::{Value, json};

use super::{preset, smoothness};

fn plan(preset: Option<&str>, word: Option<&str>, parameters: &[(&str, &str)]) -> Plan {
    let parameters = parameters.iter().map(|(name, text)| {
        let value = text.parse().map_or_else(|_| Literal::Text((*text).into()), Literal::Number);
        ((*name).to_owned(), value)
    });
    let input = PlanInput {
        preset: preset.map(Into::into),
        word: word.map(Into::into),
        parameters: parameters.collect(),
        ..PlanInput::default()
    };
    Plan::resolve(&input, Subject::default()).unwrap()
}

/// Checks that the exact mask is that of an impulse which the operators refine.
fn agree(plan: &Plan, name: &str) {
    let exact = ExactCycle::settled(plan).unwrap_or_else(|| panic!("{name} is exact"));
    let refined = CycleMask::settled(plan, &Watch::new()).unwrap();
    assert_eq!(exact.arity, refined.arity, "{name}");
    let last = exact.first + i64::try_from(exact.mask.len()).unwrap() - 1;
    for j in exact.first.min(refined.mask.first.into())..=last.max(refined.mask.last().into()) {
        let place = usize::try_from(j - exact.first).ok().and_then(|place| exact.mask.get(place));
        let (a, b) = (place.map_or(0.0, rounded), refined.at(j));
        assert!((a - b).abs() <= 1e-14 * a.abs().max(1.0), "{name}: a[{j}] is {a}, refined {b}");
    }
}

#[test]
fn exact_masks_of_presets_are_those_that_refine() {
    let cases: &[(&str, &[(&str, &str)])] = &[
        ("chaikin", &[]),
        ("cubic-b-spline", &[]),
        ("b-spline", &[("degree", "5")]),
        ("c-b-spline", &[("degree", "4"), ("alpha", "1")]),
        ("four-point", &[("w", "1/20")]),
        ("two-n-point", &[("n", "5")]),
        ("d-ary-b-spline", &[("arity", "3"), ("degree", "4")]),
        ("d-ary-b-spline", &[("arity", "4"), ("degree", "3")]),
        ("d-ary-circle", &[("arity", "3"), ("averages", "2"), ("alpha", "1"), ("delta", "1/3")]),
        ("d-ary-circle", &[("arity", "4"), ("averages", "2"), ("alpha", "1")]),
        (
            "ternary-blending",
            &[("eta", "1/50"), ("theta", "1/20"), ("omega", "1/9"), ("delta", "1/3"), ("lambda", "2/3")],
        ),
        ("ternary-c4", &[]),
        ("ternary-linear", &[]),
        ("ternary-quadratic", &[]),
        ("ternary-cubic", &[]),
        ("ternary-quartic", &[]),
        ("ternary-quintic", &[]),
        ("ternary-three-point", &[]),
        ("ternary-four-point", &[]),
        ("ternary-combined-pan", &[("alpha", "1/3"), ("beta", "1/7")]),
        ("ternary-combined-rehan", &[("alpha", "1/60"), ("beta", "1/100")]),
        ("ternary-combined-novara", &[("alpha", "1/30"), ("beta", "1/40"), ("gamma", "1/50")]),
        ("mask", &[("arity", "2"), ("first", "-1")]),
        ("push-back", &[("k", "2"), ("kernel", "5/4"), ("compensation", "2/3"), ("delta", "1/7")]),
    ];
    for (name, parameters) in cases.iter().filter(|(name, _)| *name != "mask") {
        agree(&plan(Some(name), None, parameters), name);
    }
}

#[test]
fn exact_masks_of_words_are_those_that_refine() {
    let functions = &[("kernel", "3/2"), ("compensation", "4/5"), ("delta", "1/3")];
    for word in [
        "U", "UD", "UC", "UDDD", "UCP", "UDDP", "UCCP", "U3C", "U3CP", "U3AP", "U4A^2P", "U2A", "UUCP", "UCPUD", "UCPP",
    ] {
        agree(&plan(None, Some(word), functions), word);
    }
    let several = Literal::List(["3/2", "1/2", "2"].iter().map(|text| Literal::Text((*text).into())).collect());
    let input = PlanInput {
        word: Some("UDCDP".into()),
        parameters: vec![("kernel".into(), several), ("delta".into(), Literal::Text("1/3".into()))],
        ..PlanInput::default()
    };
    agree(&Plan::resolve(&input, Subject::default()).unwrap(), "UDCDP with three kernels");
}

fn mask(arity: i64, first: i64, mask: &[String]) -> Value {
    preset("mask", &json!({ "arity": arity, "first": first, "mask": mask }))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Shifts of indices and reflections only move the scheme; a factor changes the convergence only.
    #[test]
    fn shifted_and_reflected_masks_are_as_smooth(w in -20_i64..60, s in -20_i64..20, shift in -9_i64..9) {
        let entries = [-w, s, 50 + w, 100 - 2 * s, 50 + w, s, -w, 0];
        let text = |n: i64| format!("{n}/100");
        let forward: Vec<String> = entries.iter().map(|n| text(*n)).collect();
        let backward: Vec<String> = forward.iter().rev().cloned().collect();
        let twice: Vec<String> = entries.iter().map(|n| text(2 * n)).collect();
        let [a, b, c] = [mask(2, 0, &forward), mask(2, shift, &forward), mask(2, shift, &backward)];
        for other in [&b, &c] {
            for name in ["sum_rules", "generation_degree", "reproduction_degree"] {
                prop_assert_eq!(&a[name], &other[name], "{}", name);
            }
            prop_assert_eq!(smoothness(&a), smoothness(other));
            prop_assert_eq!(&a["smoothness"]["stable"], &other["smoothness"]["stable"]);
        }
        let mut moved = a["smoothness"].clone();
        if let Some(first) = moved.pointer_mut("/reduction/mask/first") {
            *first = (first.as_i64().expect("an index") + shift).into();
        }
        prop_assert_eq!(&moved, &b["smoothness"]);
        prop_assert_eq!(smoothness(&mask(2, 0, &twice)), (-1, Some(0)));
        let (proved, disproved) = smoothness(&a);
        prop_assert!(disproved.is_none_or(|disproved| proved < disproved));
        let bounds = super::numbers(&a["smoothness"]["joint_spectral_radius"]);
        prop_assert!(bounds[0] <= bounds[1], "{:?}", bounds);
    }
}

#[test]
fn a_larger_search_only_narrows_the_interval() {
    let bounds = |nodes: u64| {
        let question = json!({ "plan": { "preset": "four-point", "parameters": { "w": "1/10" } }, "nodes": nodes });
        super::numbers(&super::asked(&question)["smoothness"]["joint_spectral_radius"])
    };
    let [none, few, many] = [0, 1000, 20_000].map(bounds);
    assert!(none[1] >= few[1] && few[1] > many[1], "{none:?} {few:?} {many:?}");
    assert_eq!(none[0].to_bits(), many[0].to_bits());
    assert!(many[0] <= many[1]);
}
