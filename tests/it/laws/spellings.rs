//! A preset is equivalent to its word: the same key and the same bytes.

use std::collections::BTreeSet;

use planish::math::parameter::Values;
use planish::scheme::preset::Preset;
use planish::scheme::presets::PRESETS;
use serde_json::{Value, json};

use crate::support::nets::{self, Net};
use crate::support::{parsed, render};

fn check(input: &Value, preset: &Value, word: &Value, format: &str) {
    let [(key, bytes), (word_key, word_bytes)] = [preset, word].map(|plan| {
        let job = json!({ "input": input, "plan": plan, "levels": 2, "outputs": [{ "format": format }] });
        let text = job.to_string();
        let read = parsed(text.as_bytes()).unwrap_or_else(|faults| panic!("{faults:?} for {plan}"));
        (read.keys()[0], render(&job).expect("the job runs").0)
    });
    assert_eq!(key, word_key, "{preset} and {word}");
    assert_eq!(bytes, word_bytes, "{preset} and {word}");
}

fn check_curves(preset: &Value, word: &Value) {
    let points = [[0.0, 0.0], [2.0, 0.25], [3.0, 2.0], [1.0, 3.0], [-1.0, 1.0]];
    for closed in [true, false] {
        let input = json!({ "polygon": { "points": points, "closed": closed } });
        check(&input, preset, word, "json");
        check(&input, preset, word, "obj");
    }
}

fn check_meshes(preset: &Value, word: &Value) {
    let nets: [Net; 3] = [nets::cube(), nets::mixed(), nets::prism(5)];
    for net in nets {
        check(&net.input(), preset, word, "json");
        check(&net.input(), preset, word, "ply");
    }
}

#[test]
fn b_splines_are_their_words() {
    check_curves(&json!({ "preset": "chaikin" }), &json!({ "word": "UD" }));
    check_curves(&json!({ "preset": "cubic-b-spline" }), &json!({ "word": "UC" }));
    check_curves(&json!({ "preset": "cubic-b-spline" }), &json!({ "word": "UDD" }));
    for degree in 1..=12 {
        let preset = json!({ "preset": "b-spline", "parameters": { "degree": degree } });
        let word = format!("U{}", "D".repeat(degree - 1));
        check_curves(&preset, &json!({ "word": word }));
    }
    check_curves(&json!({ "preset": "b-spline" }), &json!({ "preset": "cubic-b-spline" }));
}

#[test]
fn c_b_splines_are_their_words() {
    for degree in 2..=12 {
        let preset = json!({ "preset": "c-b-spline", "parameters": { "degree": degree, "alpha": "2*pi/5" } });
        let word = json!({ "word": format!("U{}", "D".repeat(degree - 1)), "parameters": {
            "alpha": "2*pi/5", "kernel": "cos(alpha/2)",
        } });
        check_curves(&preset, &word);
    }
}

#[test]
fn d_ary_b_splines_are_their_words() {
    for (arity, degree) in [(2, 3), (3, 1), (3, 4), (4, 3), (5, 2)] {
        let preset = json!({ "preset": "d-ary-b-spline", "parameters": { "arity": arity, "degree": degree } });
        let averages = if degree > 1 { format!("A^{}", degree - 1) } else { String::new() };
        check_curves(&preset, &json!({ "word": format!("U{arity}{averages}") }));
    }
}

#[test]
fn four_point_is_its_word() {
    check_curves(&json!({ "preset": "four-point" }), &json!({ "word": "UCP" }));
    let preset = json!({ "preset": "four-point", "parameters": { "w": "1/20" } });
    check_curves(&preset, &json!({ "word": "UCP", "parameters": { "compensation": "16*(1/20)" } }));
}

#[test]
fn push_back_is_its_word() {
    for k in 1..=3 {
        let parameters = json!({
            "alpha": 1.5, "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": "0.8",
        });
        let mut with_k = parameters.clone();
        with_k["k"] = json!(k);
        let preset = json!({ "preset": "push-back", "parameters": with_k });
        let word = json!({ "word": format!("UC^{k}P"), "parameters": parameters });
        check_curves(&preset, &word);
        check_meshes(&preset, &word);
    }
    check_meshes(&json!({ "preset": "push-back" }), &json!({ "word": "UCP" }));
}

#[test]
fn bilinear_is_its_word() {
    check_meshes(&json!({ "preset": "bilinear" }), &json!({ "word": "U" }));
}

#[test]
fn repeated_averaging_is_its_word() {
    for (degree, word) in (2..=9).zip(["UD", "UC", "UCD", "UCC", "UCCD", "UCCC", "UCCCD", "UCCCC"]) {
        let preset = json!({ "preset": "repeated-averaging", "parameters": { "degree": degree } });
        let word = json!({ "word": word });
        for net in [nets::cube(), nets::torus(3, 4), nets::prism(5)] {
            check(&net.input(), &preset, &word, "json");
        }
        if degree % 2 == 1 {
            check_meshes(&preset, &word);
        }
    }
}

#[test]
fn every_preset_with_a_word_is_spelled_here() {
    // a scheme that is a single mask has a word of one letter and an arity, which says no more than its table
    let is_word = |preset: &&&Preset| {
        let spelled = (preset.spell)(&Values::default());
        spelled.is_ok_and(|spelling| spelling.cycle.iter().all(|letter| letter.facts().letter.is_some()))
    };
    let words: BTreeSet<&str> = PRESETS.iter().filter(is_word).map(|preset| preset.name).collect();
    let here = [
        "d-ary-b-spline",
        "chaikin",
        "cubic-b-spline",
        "b-spline",
        "c-b-spline",
        "four-point",
        "push-back",
        "bilinear",
        "repeated-averaging",
    ];
    assert_eq!(words, BTreeSet::from(here), "a new preset shows here that it is its word");
}
