//! Tubes whose latitude lines have one alpha are refined patch by patch, with the same bits as whole nets.

use serde_json::{Value, json};

use super::paths::compare;
use super::{semi_stationary, static_word, word};
use crate::support::nets::{self, Net};

/// Returns the latitude and longitude tags of consecutive rings of `n` vertices.
fn tags(net: &Net, n: usize) -> Value {
    let (latitude, longitude): (Vec<_>, Vec<_>) = net.edges().into_iter().partition(|(a, b)| a / n == b / n);
    json!({ "latitude": latitude, "longitude": longitude })
}

/// Returns the net with each face starting at another corner, so that latitude lines run along different sides of
/// patches.
fn turned(net: Net) -> Net {
    turned_by(net, |f| f)
}

/// Returns the net with face `f` starting `turns(f)` corners later.
fn turned_by(mut net: Net, turns: impl Fn(usize) -> usize) -> Net {
    net.faces.iter_mut().enumerate().for_each(|(f, face)| face.rotate_left(turns(f) % 4));
    net
}

fn plans() -> Vec<Value> {
    let push_back = |k: u32, delta: f64| json!({ "preset": "push-back", "parameters": { "k": k, "delta": delta } });
    let mut plans = vec![
        word("UC"),
        static_word("UP"),
        static_word("UCCP"),
        semi_stationary("UCP", "pi/3", 0.5),
        push_back(1, 0.4),
        push_back(2, 0.7),
        json!({ "word": "UCP", "parameters": { "delta": "1/valence" } }),
    ];
    plans.iter_mut().for_each(|plan| plan["boundary"] = json!("edge-only"));
    plans
}

#[test]
fn tubes_with_one_alpha_are_swept_to_the_bits_of_whole_nets() {
    for n in [3, 5] {
        // faces that are turned alike are refined together, as far as they follow each other
        let alike = turned_by(nets::torus(n, 4), |_| 1);
        let in_parts = turned_by(nets::torus(n, 5), |f| f / 7);
        let mixed = [turned(nets::torus(n, 5)), turned(nets::cylinder(n, 5))];
        for net in [nets::torus(n, 4), alike, in_parts].into_iter().chain(mixed) {
            let mut extras = tags(&net, n);
            let heat: Vec<usize> = (0..net.positions.len()).map(|v| v * v % 7).collect();
            extras["channels"] = json!({ "heat": heat });
            for plan in plans() {
                assert!(compare(&net, &extras, &plan, 4), "{plan} is not swept on rings of {n}");
            }
        }
    }
}

#[test]
fn creases_along_latitude_and_longitude_lines_are_swept() {
    let net = turned(nets::torus(4, 5));
    let mut extras = tags(&net, 4);
    extras["creases"] = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 8], [8, 12]]
        .map(|edge| json!({ "edge": edge, "sharpness": 10 }))
        .as_slice()
        .into();
    for plan in plans() {
        compare(&net, &extras, &plan, 4);
    }
}

/// Rings of different sizes have different alphas, and points beside the ends of tags or latitude lines follow other
/// rules: rows of whole nets refine all of them.
#[test]
fn what_differs_from_place_to_place_is_refined_by_rows() {
    let net = nets::torus(5, 4);
    let swept = |extras: &Value, plan: &Value| compare(&net, extras, plan, 3);
    let plan = plans().swap_remove(4);
    let all = tags(&net, 5);
    assert!(swept(&all, &plan));
    let mut some = all.clone();
    some["latitude"].as_array_mut().expect("a list").pop();
    assert!(!swept(&some, &plan));
    let mut own = all.clone();
    own["parameters"] = json!({ "alpha": (0..20).map(|v| 0.3 + 0.01 * f64::from(v)).collect::<Vec<_>>() });
    assert!(!swept(&own, &plan));
    let [mut position, mut apart] = [plan.clone(), plan.clone()];
    position["parameters"]["latitude_rule"] = json!("position");
    apart["parameters"]["kernel_longitude"] = json!(1);
    assert!(!swept(&all, &position) && !swept(&all, &apart));
    let grid = nets::grid(4, 3);
    assert!(!compare(&grid, &tags(&grid, 5), &plan, 3));
}
