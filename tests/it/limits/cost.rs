//! Limits of words that make many points of one: they are found at low cost, or refused.

use planish::job::limits::Limits;
use serde_json::{Value, json};

use super::{limit, warnings};
use crate::support::nets::{self, Net, distance};
use crate::support::{parsed, render};

fn word(text: &str) -> Value {
    json!({ "word": text })
}

/// A cycle written out several times is the same scheme.
#[test]
fn powers_of_cycles_have_the_limits_of_their_cycles() {
    for (net, cycle, powers) in [
        (nets::mixed(), "UC", ["UCUC", "UCUCUC"]),
        (nets::tetrahedron(), "UC", ["(UC)^4", "(UC)^5"]),
        (nets::cube(), "U3C", ["U3CU3C", "U3CU3CU3C"]),
    ] {
        let (expected, normals) = limit(&net, &word(cycle), 0);
        for power in powers {
            let (found, found_normals) = limit(&net, &word(power), 0);
            for v in 0..net.positions.len() {
                let off = distance(&found.positions[v], &expected.positions[v]);
                assert!(off <= 1e-12, "{power}: vertex {v} is off by {off}");
                let off = distance(&found_normals[v], &normals[v]);
                assert!(off <= 1e-8, "{power}: normal {v} is off by {off}");
            }
        }
    }
}

#[test]
fn large_arities_have_limits() {
    for (text, levels) in [("U4C", 1), ("U5C", 1), ("U8C", 1), ("U8CC", 0), ("UCU3C", 1)] {
        let (coarse, _) = limit(&nets::cube(), &word(text), 0);
        let (fine, normals) = limit(&nets::cube(), &word(text), levels);
        assert!(normals.iter().flatten().all(|x| x.is_finite()), "{text}");
        for (v, (p, q)) in coarse.positions.iter().zip(&fine.positions).enumerate() {
            let off = distance(p, q);
            assert!(off <= 1e-12, "{text}: vertex {v} moves by {off}");
        }
    }
}

/// Pieces of planes have no continuous tangents, whatever the arity.
#[test]
fn bilinear_words_have_no_tangents() {
    for text in ["U", "U3", "U5", "U8", "UUU", "UUUU"] {
        let all = warnings(&nets::cube(), &word(text), 0);
        assert!(all.len() == 1 && all[0].contains("no continuous tangents"), "{text}: {all:?}");
    }
}

fn job(net: &Net, text: &str, output: &Value) -> Value {
    json!({ "input": net.input(), "plan": word(text), "levels": 0, "outputs": [output] })
}

/// Words that make too many points are refused before anything is computed.
#[test]
fn endless_words_are_refused() {
    let net = nets::tetrahedron();
    for text in ["(UC)^8", "U8U8U8", "(U8CC)^4", "U^64", "U8^64"] {
        let positions = job(&net, text, &json!({ "format": "ply", "positions": "limit" }));
        let faults = parsed(positions.to_string().as_bytes()).expect_err("it takes too many points");
        assert_eq!(faults[0].pointer, "/outputs/0/positions", "{text}");
        assert!(faults[0].detail.contains("more than 1048576 points"), "{text}: {}", faults[0].detail);
        let normals = job(&net, text, &json!({ "format": "ply", "normals": "limit" }));
        let (_, result) = render(&normals).unwrap_or_else(|faults| panic!("{text}: {faults:?}"));
        assert!(result.warnings[0].contains("more than 1048576 points"), "{text}: {:?}", result.warnings);
    }
}

/// The cost of limits is estimated, also by the arity.
#[test]
fn estimates_count_what_limits_take() {
    let estimate = |text: &str, output: &Value| {
        let job = parsed(job(&nets::cube(), text, output).to_string().as_bytes()).expect("a job");
        let admitted = Limits::default().admit(job).expect("it is small enough");
        (admitted.estimate().memory_bytes, admitted.estimate().time_ms)
    };
    let (refined, limit) = (json!({ "format": "ply" }), json!({ "format": "ply", "positions": "limit" }));
    for (text, megabytes, time) in [("UC", 1, 2), ("U4C", 10, 20), ("U8C", 10, 50), ("UCU3C", 10, 20)] {
        assert!(estimate(text, &refined).0 < 100_000);
        let (bytes, ms) = estimate(text, &limit);
        assert!(bytes >= megabytes << 20 && bytes < 1 << 30, "{text}: {bytes} bytes");
        assert!(ms >= time && ms < 10_000, "{text}: {ms} ms");
    } // numbers of vertices are followed for fifty levels, those of the plan for thirty
    let mut net = nets::torus(5, 6).input();
    let time = |net: &Value, parameters: &Value| {
        let job = json!({
            "input": net, "plan": { "word": "UC", "parameters": parameters }, "levels": 3, "outputs": [limit]
        });
        let job = parsed(job.to_string().as_bytes()).expect("a job");
        Limits::default().admit(job).expect("it is small enough").estimate().time_ms
    };
    let plain = time(&net, &json!({}));
    net["mesh"]["parameters"] = json!({ "kernel": (0..30).map(|v| 1.0 + f64::from(v) / 30.0).collect::<Vec<_>>() });
    let own = time(&net, &json!({}));
    assert!(own > 10 * plain.max(1), "{own} ms and {plain} ms");
    let cube = nets::sectors_of_quads(60, 2).0.input();
    let [fixed, changing] = ["1", "cos(alpha/2)"].map(|kernel| time(&cube, &json!({ "alpha": 1, "kernel": kernel })));
    assert!(changing > 3 * fixed, "{changing} ms and {fixed} ms");
}
