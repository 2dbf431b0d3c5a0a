//! Valid places of P: after a U, with an even number of D since, and with all vertices of that U still present.

use serde_json::{Value, json};

use crate::support::{faults, json as refined, nets, render};

const NO_U: &str = "P needs a U before it";
const ODD: &str = "P needs an even number of D since the last U";
const LOST: &str = "P needs a child of every point that entered the last U";

fn polygon(closed: bool) -> Value {
    let points = [[0.0, 0.0], [2.0, 0.0], [3.0, 2.0], [2.0, 4.0], [0.0, 4.0], [-1.0, 2.0], [-2.0, 1.0]];
    json!({ "polygon": { "points": points, "closed": closed } })
}

fn job(input: &Value, word: &str, ends: &str, levels: u32) -> Value {
    json!({ "input": input, "plan": { "word": word, "ends": ends }, "levels": levels })
}

/// Checks that the plan is accepted, also with 0 levels.
fn accepted(input: &Value, word: &str, ends: &str) {
    refined(job(input, word, ends, 0));
    refined(job(input, word, ends, 2));
}

/// Checks that the plan is refused at its word, whatever the number of levels.
fn refused(input: &Value, word: &str, ends: &str, why: &str) {
    for levels in [0, 1, 2] {
        let found = faults(job(input, word, ends, levels));
        assert_eq!(found.len(), 1, "{word}: {found:?}");
        assert_eq!(found[0].pointer, "/plan/word", "{word}");
        assert!(found[0].detail.starts_with(why), "{word}: {}", found[0].detail);
    }
}

#[test]
fn on_closed_nets() {
    for input in [polygon(true), nets::cube().input(), nets::prism(5).input()] {
        for word in ["UP", "UCP", "UPP", "UDDP", "UDDDDP", "UCPD", "UUCPD(UC)", "U(P)", "U(PDD)", "UPD", "C(UP)", "DUP"]
        {
            accepted(&input, word, "clamped");
        }
        for word in ["P", "PU", "CP", "P(U)", "C(PU)", "D(DP)"] {
            refused(&input, word, "clamped", NO_U);
        }
        // in U(PD), the second application fails
        for word in ["UDP", "UDDDP", "UDCP", "U(PD)", "UDD(PD)", "UDUDP"] {
            refused(&input, word, "clamped", ODD);
        }
    }
}

#[test]
fn on_open_meshes_a_dual_loses_the_boundary() {
    for input in [nets::grid(3, 3).input(), nets::mixed().input()] {
        for word in ["UP", "UCP", "UCCP", "UPD", "D(UCP)"] {
            if !word.contains('D') {
                accepted(&input, word, "clamped");
            }
        }
        accepted(&nets::grid(3, 3).input(), "UPD", "clamped");
        for word in ["UDDP", "U(PDD)"] {
            refused(&input, word, "clamped", LOST);
        }
        // even a closed mesh would refuse it
        refused(&input, "UDP", "clamped", ODD);
    }
}

#[test]
fn on_open_polygons_with_clamped_ends() {
    for word in ["UP", "UCP", "UDDP", "UUCPD(UC)", "UCPD", "D(UCP)"] {
        accepted(&polygon(false), word, "clamped");
    }
    refused(&polygon(false), "UDP", "clamped", ODD);
    refused(&polygon(false), "U(PD)", "clamped", ODD);
}

#[test]
fn on_open_polygons_with_natural_ends_an_average_loses_points() {
    accepted(&polygon(false), "UP", "natural");
    accepted(&polygon(false), "C(UP)", "natural");
    for word in ["UCP", "UDDP", "UPCP"] {
        refused(&polygon(false), word, "natural", LOST);
    }
    refused(&polygon(false), "UDP", "natural", ODD);
    // a closed polygon has no ends
    accepted(&polygon(true), "UCP", "natural");
}

#[test]
fn presets_that_push_back_are_refused_at_their_name() {
    for preset in ["push-back", "four-point"] {
        let plan = json!({ "preset": preset, "ends": "natural" });
        let found = faults(json!({ "input": polygon(false), "plan": plan, "levels": 1 }));
        assert_eq!((found.len(), found[0].pointer.as_str()), (1, "/plan/preset"));
        assert!(found[0].detail.starts_with(LOST), "{found:?}");
    }
}

#[test]
fn circles_with_natural_ends_push_back_only_what_keeps_its_points() {
    let job = |averages: u32, ends: &str| {
        let parameters = json!({ "arity": 3, "averages": averages, "alpha": 1, "delta": 1 });
        let plan = json!({ "preset": "d-ary-circle", "parameters": parameters, "ends": ends });
        json!({ "input": polygon(false), "plan": plan, "levels": 1, "outputs": [{ "format": "json" }] })
    };
    for averages in [1, 2, 3] {
        let found = faults(job(averages, "natural"));
        assert_eq!((found.len(), found[0].pointer.as_str()), (1, "/plan/preset"));
        assert!(found[0].detail.starts_with(LOST), "{found:?}");
        assert!(render(&job(averages, "clamped")).is_ok());
    }
    assert!(render(&job(0, "natural")).is_ok(), "without an average no point is lost");
}

#[test]
fn duals_carry_no_tags() {
    let tagged = |tags: Value| {
        let mut mesh = nets::cube().to_json();
        mesh.as_object_mut().expect("an object").extend(tags.as_object().expect("an object").clone());
        json!({ "mesh": mesh })
    };
    for (input, tag) in [
        (tagged(json!({ "corners": [{ "vertex": 0, "sharpness": 10 }] })), "corners"),
        (tagged(json!({ "creases": [{ "edge": [0, 1], "sharpness": 10 }] })), "creases"),
        (tagged(json!({ "holes": [0] })), "holes"),
        (json!({ "polygon": { "points": [[0], [1], [2]], "corners": [1] } }), "corners"),
    ] {
        refused(&input, "UD", "clamped", &format!("D cannot carry {tag}"));
        accepted(&input, "UC", "clamped");
    }
    let mut open = job(&nets::grid(3, 3).input(), "UD", "clamped", 1);
    open["plan"]["boundary"] = json!("none");
    assert!(faults(open)[0].detail.starts_with("D cannot carry the holes that boundary \"none\" makes"));
}

/// A dual has no face for a vertex of at most two faces, so that the net before the U has lost a child there.
#[test]
fn a_dual_loses_vertices_of_low_valence() {
    let mut lonely = nets::cube();
    lonely.positions.push([5.0; 3]);
    let pillow =
        nets::Net { positions: nets::tetrahedron().positions, faces: vec![vec![0, 1, 2, 3], vec![3, 2, 1, 0]] };
    for net in [lonely, pillow] {
        let found = faults(job(&net.input(), "UDDP", "clamped", 1));
        assert_eq!((found.len(), found[0].pointer.as_str()), (1, "/plan"), "{found:?}");
        assert!(found[0].detail.contains("lost to a boundary or a valence below 3"), "{found:?}");
        accepted(&net.input(), "UCP", "clamped");
    }
}

/// A closed mesh has no boundary, so that no boundary rule can make holes in it.
#[test]
fn boundary_none_does_not_keep_closed_meshes_from_their_dual() {
    let [none, default] = ["none", "edge-and-corner"].map(|boundary| {
        let mut job = job(&nets::cube().input(), "UD", "clamped", 2);
        job["plan"]["boundary"] = json!(boundary);
        refined(job)
    });
    assert_eq!(none, default);
}

#[test]
fn a_corner_of_sharpness_zero_is_no_tag() {
    let mut mesh = nets::cube().to_json();
    mesh["corners"] = json!([{ "vertex": 0, "sharpness": 0 }]);
    accepted(&json!({ "mesh": mesh }), "UD", "clamped");
}
