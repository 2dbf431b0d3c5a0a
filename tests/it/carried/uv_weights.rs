//! Texture coordinates have the weights of their vertices: data of vertices and edges, and perturbations, affect them
//! as well, on both sides of seams.

use std::collections::{BTreeMap, BTreeSet};

use planish::job::limits::Limits;
use serde_json::{Value, json};

use super::uvs::{Unfolded, check_at_vertices, seamless};
use super::{bytes, job, told};
use crate::support::nets::{self, Net, distance};
use crate::support::parsed;

const TOLERANCE: f64 = 1e-12;
/// Number of faces that the weights of the plans here reach at most, all levels together.
const REACH: usize = 4;

/// A plan, and the data of the mesh other than positions, faces and texture coordinates.
#[derive(Clone)]
struct Case {
    plan: Value,
    extra: Value,
}

/// Returns numbers for `n` vertices between two bounds, different at neighbours.
fn uneven(n: usize, from: f64, to: f64) -> Vec<f64> {
    (0..n).map(|i| from + (to - from) * f64::from(u8::try_from(i * 29 % 23).expect("below 23")) / 23.0).collect()
}

fn parameters(n: usize) -> [(&'static str, Vec<f64>); 4] {
    [
        ("alpha", uneven(n, 0.2, 1.4)),
        ("kernel", uneven(n, 0.6, 1.9)),
        ("compensation", uneven(n, 0.7, 1.5)),
        ("delta", uneven(n, -0.3, 1.0)),
    ]
}

/// Returns plans with parameters at `n` vertices: each kind separately, and all together.
fn own(n: usize) -> Vec<Case> {
    let functions = json!({ "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "alpha": 0.5, "delta": 0.25 });
    let case = |word: &str, own: Value| Case {
        plan: json!({ "word": word, "boundary": "edge-only", "parameters": functions }),
        extra: json!({ "parameters": own }),
    };
    let all: serde_json::Map<String, Value> =
        parameters(n).map(|(name, own)| (name.to_owned(), json!(own))).into_iter().collect();
    let mut cases: Vec<Case> = parameters(n).into_iter().map(|(name, own)| case("UCP", json!({ name: own }))).collect();
    cases.push(case("UCCP", Value::Object(all)));
    cases
}

/// Returns perturbed plans, with and without parameters at `n` vertices.
fn perturbed(n: usize) -> Vec<Case> {
    let plan = json!({ "word": "UCP", "seed": 7, "boundary": "edge-only",
        "parameters": { "delta": 0.5, "perturbation": { "amplitude": 0.4, "decay": 0.7 } } });
    let [_, (kernel, own), ..] = parameters(n);
    let extras = [json!({}), json!({ "parameters": { kernel: own } })];
    extras.into_iter().map(|extra| Case { plan: plan.clone(), extra }).collect()
}

/// Returns the tags of closed latitude lines of `k` vertices each, under both rules: with the alpha of the lines, with
/// that of the plan, perturbed, and with alpha or delta of the vertices.
fn lines(k: usize, net: &Net) -> Vec<Case> {
    let n = net.positions.len();
    let tags = |along: bool| -> Vec<(usize, usize)> {
        net.edges().into_iter().filter(|&(a, b)| (a / k == b / k) == along).collect()
    };
    let [alpha, _, _, delta] = parameters(n).map(|(name, own)| json!({ name: own }));
    let mut cases = Vec::new();
    for rule in ["difference", "position"] {
        for (more, own) in [
            (json!({}), Value::Null),
            (json!({ "alpha": 0.6, "kernel_longitude": 1.2 }), Value::Null),
            (json!({ "perturbation": { "amplitude": 0.2, "decay": 0.5 } }), Value::Null),
            (json!({}), alpha.clone()),
            (json!({}), delta.clone()),
        ] {
            let mut plan = json!({
                "preset": "push-back", "boundary": "edge-only", "parameters": { "delta": 0.6, "latitude_rule": rule }
            });
            for (name, value) in more.as_object().expect("parameters") {
                plan["parameters"][name] = value.clone();
            }
            let mut extra = json!({ "latitude": tags(true), "longitude": tags(false) });
            if !own.is_null() {
                extra["parameters"] = own;
            }
            cases.push(Case { plan, extra });
        }
    }
    cases
}

fn question(net: &Net, uvs: &Value, case: &Case, levels: u32) -> Value {
    let mut extra = case.extra.clone();
    extra["uvs"] = uvs.clone();
    job(net, &extra, &case.plan, levels)
}

/// Refines and compares with the forecast.
fn unfolded(net: &Net, uvs: &Value, case: &Case, levels: u32) -> Unfolded {
    let mut question = question(net, uvs, case, levels);
    let found = Unfolded::of(&told(question.clone()));
    question["outputs"] = json!([{ "format": "json" }]);
    let read = parsed(question.to_string().as_bytes()).expect("a job");
    let forecast = Limits::default().estimate(&read).expect("within limits").forecast;
    let count = forecast.levels[levels as usize];
    assert_eq!([count.vertices, count.uvs], [found.net.positions.len(), found.values.len()].map(|n| n as u128));
    found
}

/// Returns the coordinates of the vertices as texture coordinates, with a seam around the faces of `within`.
fn parted(net: &Net, within: impl Fn(usize) -> bool) -> Value {
    let mut uvs = seamless(net, "none");
    let n = net.positions.len();
    let copies: Vec<Value> = uvs["values"].as_array().expect("values").clone();
    uvs["values"].as_array_mut().expect("values").extend(copies);
    for (f, face) in net.faces.iter().enumerate().filter(|&(f, _)| within(f)) {
        uvs["faces"][f] = json!(face.iter().map(|v| n + v).collect::<Vec<_>>());
    }
    uvs
}

/// Returns for each face the number of faces between it and the nearest seam.
fn depths(net: &Net, within: impl Fn(usize) -> bool) -> Vec<usize> {
    let vertices = |side: bool| -> BTreeSet<usize> {
        (0..net.faces.len()).filter(|&f| within(f) == side).flat_map(|f| net.faces[f].clone()).collect()
    };
    let mut reached: BTreeSet<usize> = vertices(true).intersection(&vertices(false)).copied().collect();
    let mut depths = vec![usize::MAX; net.faces.len()];
    for depth in 0.. {
        let touched = |f: &usize| net.faces[*f].iter().any(|v| reached.contains(v));
        let next: Vec<usize> = (0..depths.len()).filter(|&f| depths[f] == usize::MAX).filter(touched).collect();
        if next.is_empty() {
            break;
        }
        for f in next {
            depths[f] = depth;
            reached.extend(&net.faces[f]);
        }
    }
    depths
}

/// Checks that away from the seams, values are the coordinates of their vertices.
fn check_away(net: &Net, within: impl Fn(usize) -> bool + Copy, case: &Case, levels: u32) {
    let (found, depths) = (unfolded(net, &parted(net, within), case, levels), depths(net, within));
    let mut away = [0, 0];
    for f in (0..found.faces.len()).filter(|&f| depths[found.origins[f]] >= REACH) {
        away[usize::from(within(found.origins[f]))] += 1;
        for j in 0..found.faces[f].len() {
            let (vertex, place) = found.corner(f, j);
            let apart = distance(&found.net.positions[vertex][..2], &found.values[place]);
            assert!(apart <= TOLERANCE, "face {f}, corner {j}: {apart} apart under {} {}", case.plan, case.extra);
        }
    }
    assert!(away.iter().all(|&n| n > 0), "there are faces away from the seam on both sides: {away:?}");
}

/// Checks that along closed seams, values of both sides agree wherever they agreed in the input.
fn check_together(net: &Net, within: impl Fn(usize) -> bool + Copy, case: &Case, levels: u32) {
    let found = unfolded(net, &parted(net, within), case, levels);
    let mut at: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for f in 0..found.faces.len() {
        for j in 0..found.faces[f].len() {
            let (vertex, place) = found.corner(f, j);
            at.entry(vertex).or_default().insert(place);
        }
    }
    let pairs: Vec<Vec<usize>> =
        at.into_values().filter(|at| at.len() > 1).map(|at| at.into_iter().collect()).collect();
    assert!(!pairs.is_empty());
    for pair in pairs {
        let apart = distance(&found.values[pair[0]], &found.values[pair[1]]);
        assert!(apart <= TOLERANCE, "{apart} apart under {} {}", case.plan, case.extra);
    }
}

#[test]
fn without_seams_they_stay_with_their_vertices() {
    for net in [nets::cube(), nets::mixed(), nets::prism(5), nets::grid(3, 2)] {
        let n = net.positions.len();
        for case in own(n).into_iter().chain(perturbed(n)) {
            check_at_vertices(&unfolded(&net, &seamless(&net, "none"), &case, 3), TOLERANCE);
            let mut tagged = case;
            tagged.plan["boundary"] = json!("edge-and-corner");
            tagged.extra["corners"] = json!([{ "vertex": 2, "sharpness": 10 }]);
            tagged.extra["creases"] = json!([{ "edge": net.faces[0][..2], "sharpness": 10 }]);
            check_at_vertices(&unfolded(&net, &seamless(&net, "none"), &tagged, 2), TOLERANCE);
        }
    }
    for net in [nets::torus(6, 4), nets::cylinder(5, 4)] {
        for case in lines(if net.positions.len() == 24 { 6 } else { 5 }, &net) {
            check_at_vertices(&unfolded(&net, &seamless(&net, "none"), &case, 2), TOLERANCE);
        }
    }
}

/// Isolated vertices have parameters, too, but no texture coordinates.
#[test]
fn vertices_without_faces_shift_nothing() {
    let mut net = nets::cube();
    net.positions.insert(0, [5.0, 5.0, 5.0]);
    net.faces.iter_mut().flatten().for_each(|v| *v += 1);
    for case in own(9).into_iter().chain(perturbed(9)) {
        let found = Unfolded::of(&told(question(&net, &seamless(&net, "none"), &case, 2)));
        check_at_vertices(&found, TOLERANCE);
    }
}

#[test]
fn away_from_seams_they_stay_with_their_vertices() {
    let grid = nets::grid(20, 3);
    for case in own(84).into_iter().chain(perturbed(84)) {
        check_away(&grid, |f| f % 20 < 10, &case, 2);
    }
    // across the lines, and along them
    let (around, along) = (nets::torus(20, 4), nets::torus(4, 20));
    for case in lines(20, &around).into_iter().chain(perturbed(80)) {
        check_away(&around, |f| f % 20 < 10, &case, 2);
    }
    for case in lines(4, &along) {
        check_away(&along, |f| f / 4 < 10, &case, 2);
    }
}

/// Only data along a seam affect it: parameters and perturbations are those of its vertices and edges.
#[test]
fn both_sides_of_a_seam_have_the_weights_of_its_vertices() {
    let cube = nets::cube();
    for case in own(8).into_iter().chain(perturbed(8)) {
        check_together(&cube, |f| f < 1, &case, 3);
    }
    let torus = nets::torus(5, 6);
    for case in own(30).into_iter().chain(perturbed(30)).chain(lines(5, &torus)) {
        check_together(&torus, |f| f / 5 < 3, &case, 2);
        check_together(&torus, |f| f % 5 < 2, &case, 2);
    }
}

/// A region is refined as if it were cut out, with the data of its vertices and edges.
#[test]
fn a_region_takes_along_what_its_vertices_carry() {
    let net = nets::torus(5, 6);
    let tagged = lines(5, &net).into_iter().filter(|case| case.extra["parameters"]["alpha"].is_array());
    for case in own(30).into_iter().chain(tagged) {
        let found = unfolded(&net, &parted(&net, |f| f / 5 < 3), &case, 2);
        let alone = Net { faces: net.faces[..15].to_vec(), ..net.clone() };
        let mut extra = case.extra.clone();
        for direction in ["latitude", "longitude"] {
            if let Some(tags) = extra.get_mut(direction).and_then(Value::as_array_mut) {
                tags.retain(|ends| {
                    alone.edges().contains(&serde_json::from_value(ends.clone()).expect("two vertices"))
                });
            }
        }
        let alone = Net::of(&told(job(&alone, &extra, &case.plan, 2)));
        for (face, expected) in found.faces.iter().zip(&alone.faces) {
            for (&place, &vertex) in face.iter().zip(expected) {
                let apart = distance(&found.values[place], &alone.positions[vertex][..2]);
                assert!(apart <= TOLERANCE, "{apart} apart under {} {}", case.plan, case.extra);
            }
        }
    }
}

/// Limit positions do not change texture coordinates, and linear ones ignore parameters.
#[test]
fn neither_limits_nor_linear_ones_depend_on_weights() {
    let net = nets::cube();
    for case in own(8).into_iter().chain(perturbed(8)) {
        let uvs = |interpolation: &str, output: Value| {
            let mut uvs = parted(&net, |f| f < 2);
            uvs["interpolation"] = json!(interpolation);
            let mut question = question(&net, &uvs, &case, 2);
            question["outputs"] = json!([output]);
            let found: Value = serde_json::from_slice(&bytes(&question)).expect("the json output is JSON");
            found["uvs"].clone()
        };
        let [refined, limit] = ["refined", "limit"].map(|to| uvs("none", json!({ "format": "json", "positions": to })));
        assert_eq!(refined, limit);
        let bilinear = Case { plan: json!({ "word": "U" }), extra: json!({}) };
        let mut plain = question(&net, &parted(&net, |f| f < 2), &bilinear, 2);
        plain["input"]["mesh"]["uvs"]["interpolation"] = json!("all");
        assert_eq!(uvs("all", json!({ "format": "json" })), told(plain)["uvs"]);
    }
}
