//! Laws of stencils: the bits of JSON for any net, and weights that sum to 1.

use proptest::prelude::*;
use serde_json::{Value, json};

use super::applied::Table;
use super::{agrees, asking};
use crate::support::nets::{self, Net};
use crate::support::render;

/// Returns a job of a net with sharp edges and corners.
fn job(net: &Net, extras: &Value, plan: &Value, levels: usize) -> Value {
    let mut mesh = net.to_json();
    for (name, value) in extras.as_object().expect("an object") {
        mesh[name] = value.clone();
    }
    json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels })
}

/// Makes every `n`-th edge sharp, if `finite` alternately infinitely and finitely, else infinitely.
fn creases(net: &Net, n: usize, finite: bool) -> Value {
    let sharpness = |i: usize| if finite && i.is_multiple_of(2) { 1.5 } else { 10.0 };
    let edges = net.edges().into_iter().enumerate().filter(|(i, _)| i % n == n - 1);
    let tagged: Vec<Value> =
        edges.map(|(i, (a, b))| json!({ "edge": [a, b], "sharpness": sharpness(i / n) })).collect();
    json!({ "creases": tagged })
}

/// Fails if the bits differ, or if stencils are refused although JSON is not.
fn check(job: &Value, options: &Value) {
    if let Err(why) = agrees("random", job, options) {
        let mut output = options.clone();
        output["format"] = "json".into();
        assert!(render(&asking(job, &output)).is_err(), "{why} for {job}");
    }
}

fn plan(which: usize) -> Value {
    let words = ["UC", "UCCP", "UCPC", "UUCPD", "UD", "U3C", "C", "P(UC)"];
    match which {
        0 => json!({ "preset": "catmull-clark" }),
        1 => json!({ "preset": "kobbelt" }),
        2 => json!({ "preset": "doo-sabin" }),
        3 => json!({ "preset": "catmull-clark", "parameters": { "creasing": "chaikin" } }),
        which => json!({ "word": words[which - 4], "parameters": {
            "alpha": "pi/3", "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 0.4,
        } }),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn random_meshes_have_the_bits_of_json(
        net in nets::manifold(), which in 0_usize..12, levels in 0_usize..3, sharp in 2_usize..6,
        tagged in any::<bool>(),
    ) {
        // only some plans support sharp edges, and only Catmull-Clark finite ones
        let follows = which == 0 || which == 3 || (4..7).contains(&which);
        let extras = if tagged && follows { creases(&net, sharp, which == 0 || which == 3) } else { json!({}) };
        let job = job(&net, &extras, &plan(which), levels);
        check(&job, &json!({}));
    }

    #[test]
    fn random_meshes_of_triangles_have_the_bits_of_json(net in nets::triangle_manifold(), which in 0_usize..4) {
        let plan = [
            json!({ "preset": "loop" }), json!({ "preset": "butterfly" }), json!({ "preset": "sqrt-3" }),
            json!({ "word": "UCCP", "parameters": { "split": "triangle", "delta": 0.3 } }),
        ][which].clone();
        let extras = if which == 0 { creases(&net, 4, true) } else { json!({}) };
        let job = job(&net, &extras, &plan, 2);
        check(&job, &json!({}));
    }

    #[test]
    fn random_polygons_have_the_bits_of_json(
        points in prop::collection::vec(prop::array::uniform2(-9.0..9.0), 3..12), closed in any::<bool>(),
        which in 0_usize..6, levels in 0_usize..4, limit in any::<bool>(),
    ) {
        let plan = [
            json!({ "preset": "chaikin" }), json!({ "preset": "four-point" }), json!({ "preset": "cubic-b-spline" }),
            json!({ "word": "UUCPD", "parameters": { "delta": 0.7 } }), json!({ "preset": "ternary-four-point" }),
            json!({ "word": "UCP", "parameters": { "alpha": "2*pi/5", "kernel": "cos(alpha/2)", "delta": 0.5 } }),
        ][which].clone();
        let polygon = json!({ "points": points, "closed": closed });
        let job = json!({ "input": { "polygons": [polygon, polygon] }, "plan": plan, "levels": levels });
        let options = if limit { json!({ "positions": "limit" }) } else { json!({}) };
        check(&job, &options);
    }
}

#[test]
fn weights_of_each_point_sum_to_one() {
    let meshes = [nets::mixed(), nets::cube(), nets::grid(2, 3), nets::torus(3, 4)];
    let curve = json!({ "polygon": { "points": [[0, 0], [1, 0], [1, 2], [-1, 1]], "closed": true } });
    let plans = ["catmull-clark", "doo-sabin", "kobbelt", "bilinear"].map(|preset| json!({ "preset": preset }));
    let jobs = meshes.iter().flat_map(|net| plans.iter().map(|plan| job(net, &json!({}), plan, 2)));
    let presets = ["chaikin", "four-point", "cubic-b-spline", "ternary-quintic", "push-back"];
    let curves = presets.map(|preset| json!({ "input": curve, "plan": { "preset": preset }, "levels": 3 }));
    for mut job in jobs.chain(curves) {
        job["outputs"] = json!([{ "format": "stencils" }]);
        let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
        let table = Table::of_text(&bytes);
        let worst = table.sums().into_iter().map(|sum| (sum - 1.0).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-13, "{job}: {worst:e}");
    }
}
