//! The alpha of the compensation: on latitude lines, and overridden by an alpha of points.

use planish::math::functions::cos;
use serde_json::{Value, json};

use super::outlooks::tube;
use crate::support;

const RINGS: [(f64, f64, f64); 5] =
    [(1.0, 0.0, 0.2), (1.7, 0.4, 0.2), (1.2, 2.0, 0.5), (0.6, 2.2, 0.2), (1.4, 3.9, 0.1)];

fn positions(mesh: &Value, parameters: &Value, levels: u32) -> Vec<[f64; 3]> {
    let plan = json!({ "word": "UCP", "parameters": parameters });
    let result = support::json(json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels }));
    serde_json::from_value(result["positions"].clone()).expect("positions")
}

fn apart(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).fold(0.0, |most: f64, (x, y)| most.max((x - y).abs()))
}

fn key(job: &Value) -> String {
    let job = support::parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{faults:?}"));
    job.keys()[0].to_string()
}

/// On latitude lines, and beside untagged ones, the compensation of a level depends on its own alpha.
#[test]
fn latitude_lines_see_the_alpha_of_the_compensation() {
    let mut part = tube(6, &RINGS);
    part["latitude"] = json!((0..6).map(|i| [12 + i, 12 + (i + 1) % 6]).collect::<Vec<_>>());
    part["longitude"] = json!([]);
    for mesh in [tube(6, &RINGS), part] {
        for alpha in [0.0, 0.3, 2.0] {
            for rule in ["difference", "position"] {
                let with = |name: &str, value: f64| json!({ "delta": 0.5, "latitude_rule": rule, name: value });
                let found = positions(&mesh, &with("compensation_alpha", alpha), 1);
                let expected = positions(&mesh, &with("compensation", 1.0 / cos(alpha / 2.0)), 1);
                assert!(apart(&found, &expected) < 1e-14, "{alpha}, {rule}");
                // the next level uses half of it
                let [found, other] = [alpha, 0.0].map(|alpha| positions(&mesh, &with("compensation_alpha", alpha), 2));
                assert_eq!(apart(&found, &other) > 1e-6, alpha > 0.0, "{alpha}, {rule}");
            }
        }
    }
}

/// Stating the alpha of the lines explicitly changes nothing.
#[test]
fn the_alpha_of_lines_may_be_written_down() {
    let mesh = tube(5, &RINGS);
    let [plain, written] = [json!({}), json!({ "compensation_alpha": "2*pi/5" })].map(|p| positions(&mesh, &p, 3));
    assert!(apart(&plain, &written) < 1e-13);
}

/// "Per-vertex beats plan-wide": then the other alpha changes neither the result nor its key.
#[test]
fn an_alpha_that_points_carry_beats_it() {
    let functions = json!({ "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 0.5 });
    let mut mesh = tube(4, &RINGS);
    mesh["parameters"] = json!({ "alpha": (0..20).map(|v| 0.1 * f64::from(v)).collect::<Vec<_>>() });
    let points = [[0, 0], [2, 1], [3, 3], [0, 2]];
    let polygon = json!({ "points": points, "closed": true, "parameters": { "alpha": [0.1, 0.5, 0.7, 0.2] } });
    for input in [json!({ "mesh": mesh }), json!({ "polygon": polygon })] {
        let job = |other: Option<f64>| {
            let mut parameters = functions.clone();
            other.into_iter().for_each(|other| parameters["compensation_alpha"] = json!(other));
            let plan = json!({ "word": "UCP", "parameters": parameters });
            json!({ "input": input, "plan": plan, "levels": 2, "outputs": [{ "format": "json" }] })
        };
        let [without, with] = [None, Some(0.9)].map(job);
        assert_eq!(support::json(without.clone()), support::json(with.clone()), "{input}");
        assert_eq!(key(&without), key(&with), "{input}");
    }
}

/// Among several polygons, those without an alpha of their own use it as they do alone.
#[test]
fn among_several_polygons_those_without_alpha_see_it() {
    let points = [[0, 0], [2, 1], [3, 3], [0, 2]];
    let bare = json!({ "points": points, "closed": true });
    let own = json!({ "points": points, "closed": true, "parameters": { "alpha": [0.1, 0.5, 0.7, 0.2] } });
    let plan = json!({ "word": "UCP", "parameters": { "compensation": "1/cos(alpha/2)", "compensation_alpha": 0.9 } });
    let refined = |input: Value| support::json(json!({ "input": input, "plan": plan, "levels": 2 }));
    let both = refined(json!({ "polygons": [own, bare] }));
    for (i, polygon) in [own, bare].into_iter().enumerate() {
        assert_eq!(both["polygons"][i]["points"], refined(json!({ "polygon": polygon }))["points"]);
        assert!(both["polygons"][i]["points"].is_array(), "{both}");
    }
}
