//! Compensations of single points have a bound, like that of the plan.

use std::f64::consts::PI;

use serde_json::{Value, json};

use crate::support::{
    self,
    nets::{self, Net},
};

fn job(input: &Value, plan: &Value, levels: u32, limit: bool) -> Value {
    let positions = if limit { "limit" } else { "refined" };
    let outputs = json!([{ "format": "json", "positions": positions }]);
    json!({ "input": input, "plan": plan, "levels": levels, "outputs": outputs })
}

fn told(input: &Value, plan: &Value, levels: u32, limit: bool) -> String {
    let job = job(input, plan, levels, limit);
    let Err(faults) = support::render(&job) else { panic!("accepted: {job}") };
    let fault = &faults[0];
    format!("{}: {}", fault.pointer, fault.detail)
}

fn cube(parameters: Value) -> Value {
    let mut input = nets::cube().input();
    input["mesh"]["parameters"] = parameters;
    input
}

fn square(closed: bool, parameters: &Value) -> Value {
    json!({ "polygon": { "points": [[0, 0], [2, 0], [3, 1], [1, 2]], "closed": closed, "parameters": parameters } })
}

fn secant(word: &str) -> Value {
    json!({ "word": word, "parameters": { "compensation": "1/cos(alpha/2)", "delta": 0.5 } })
}

/// At the alpha of points, the compensation has the same pole as at the alpha of a plan.
#[test]
fn poles_at_the_alpha_of_points_are_told_with_these_points() {
    let bound = "a pole of the function; at most 1000000000000 in size is allowed: choose another alpha there";
    // at vertices, between them, and at the second level, with half the alpha of the first
    let ends: Vec<f64> = (0..8).map(|v| if v % 2 == 0 { 0.0 } else { 2.0 * PI }).collect();
    for limit in [false, true] {
        for (alpha, level) in [(vec![PI; 8], 1), (ends.clone(), 1), (vec![2.0 * PI; 8], 2)] {
            let said = told(&cube(json!({ "alpha": alpha })), &secant("UCP"), 2, limit);
            let place = format!("/input/mesh/parameters/alpha: level {level}: the compensation of point ");
            assert!(said.starts_with(&place) && said.ends_with(bound), "{said}");
            assert!(said.contains(" (between the points "), "{said}");
        }
        for closed in [true, false] {
            let input = square(closed, &json!({ "alpha": [0, 0, 0, 2.0 * PI] }));
            let said = told(&input, &secant("UCP"), 1, false);
            let expected = "/input/polygon/parameters/alpha: level 1: the compensation of point 5 (between the points \
                            2, 3 of the input) is 1";
            assert!(said.starts_with(expected) && said.ends_with(bound), "{said}");
        }
    }
    // a function that no P uses has no bound, and the plan's own alpha is not checked
    support::json(job(&cube(json!({ "alpha": vec![PI; 8] })), &secant("UC"), 1, false));
    support::json(job(&cube(json!({ "alpha": vec![1; 8] })), &secant("UCP"), 1, false));
}

/// A pole at a third of an edge.
#[test]
fn poles_within_edges_of_higher_arity_are_told() {
    let said = told(&square(true, &json!({ "alpha": [0, 3.0 * PI, 0, 0] })), &secant("U3CP"), 1, false);
    let expected = "/input/polygon/parameters/alpha: level 1: the compensation of point 1 (between the points 0, 1 of \
                    the input) is ";
    assert!(said.starts_with(expected), "{said}");
}

/// Poles on latitude lines whose points carry the alpha.
#[test]
fn poles_on_latitude_lines_are_told() {
    let tube = nets::torus(4, 3);
    let (mut input, n) = (tube.input(), tube.positions.len());
    let lines: Vec<[usize; 2]> = tube.faces.iter().map(|face| [face[0], face[1]]).collect();
    input["mesh"]["latitude"] = json!(lines);
    input["mesh"]["parameters"] = json!({ "alpha": vec![PI; n] });
    let said = told(&input, &json!({ "word": "UCP" }), 1, false);
    assert!(said.starts_with("/input/mesh/parameters/alpha: level 1: the compensation of point "), "{said}");
}

/// Compensations of points, and constant ones of a plan, are not poles: no alpha helps.
#[test]
fn carried_and_constant_compensations_have_the_bound_too() {
    let bound = "the compensation is 10000000000000; at most 1000000000000 in size is allowed: choose a smaller one";
    let one = |n: usize| (0..n).map(|i| if i == 2 { 1e13 } else { 1.0 }).collect::<Vec<f64>>();
    let word = json!({ "word": "UCP" });
    assert_eq!(
        told(&cube(json!({ "compensation": one(8) })), &word, 1, false),
        format!("/input/mesh/parameters/compensation/2: {bound}")
    );
    assert_eq!(
        told(&square(true, &json!({ "compensation": one(4) })), &word, 1, false),
        format!("/input/polygon/parameters/compensation/2: {bound}")
    );
    let constant = json!({ "word": "UCP", "parameters": { "compensation": 1e13 } });
    for input in [nets::cube().input(), square(true, &json!({}))] {
        assert_eq!(told(&input, &constant, 1, false), format!("/plan/parameters/compensation: {bound}"));
    }
    // at the bound itself, and unused
    let most = cube(json!({ "compensation": vec![-1e12; 8] }));
    let fine = Net::of(&support::json(job(&most, &json!({ "word": "UCP" }), 1, false)));
    assert_eq!(fine.positions.len(), 26);
    support::json(job(&cube(json!({ "compensation": one(8) })), &json!({ "word": "UC" }), 1, false));
}
