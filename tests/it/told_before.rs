//! Shapes that exceed the counts of a format are refused by the estimate, before anything is refined.

use planish::fault::Fault;
use planish::job::limits::{Limits, Refusal};
use planish::math::parameter::{Literal, Values};
use planish::output::{Counts, ShapeKind, named};
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::nets::{self, Net};
use crate::support::{nothing, parsed, render};

/// Returns the number of corners of the largest face of the result, from the estimate of a job.
fn estimate(job: &Value, limits: &Limits) -> Result<u128, Vec<Fault>> {
    let job = parsed(job.to_string().as_bytes())?;
    match limits.estimate(&job) {
        Ok(estimate) => Ok(estimate.forecast.levels.last().map_or(0, |count| count.largest_face)),
        Err(Refusal::Impossible(faults) | Refusal::TooLarge { faults, .. }) => Err(faults),
        Err(Refusal::Stopped) => unreachable!("nothing stops it"),
    }
}

/// Returns two faces of `n` corners, back to back.
fn disc(n: usize) -> Net {
    let positions = nets::prism(n).positions[..n].to_vec();
    Net { positions, faces: vec![(0..n).collect(), (0..n).rev().collect()] }
}

/// Returns triangles between a circle of `n` vertices and two apexes.
fn double_cone(n: usize) -> Net {
    let mut positions = nets::prism(n).positions[..n].to_vec();
    positions.extend([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
    let side = |i: usize| [vec![i, (i + 1) % n, n], vec![(i + 1) % n, i, n + 1]];
    Net { positions, faces: (0..n).flat_map(side).collect() }
}

fn largest(job: &Value) -> usize {
    let mut job = job.clone();
    job["outputs"] = json!([{ "format": "json" }]);
    let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job:.200}"));
    let net = Net::of(&serde_json::from_slice(&bytes).expect("json"));
    net.faces.iter().map(Vec::len).max().unwrap_or(0)
}

#[test]
fn a_face_too_large_for_one_byte_is_refused_by_the_estimate() {
    let plans = [
        (Value::Null, 0),
        (json!({ "word": "UD" }), 1),
        (json!({ "word": "UUD(U)" }), 0),
        (json!({ "word": "D" }), 1),
        (json!({ "word": "UDD" }), 1),
        (json!({ "preset": "doo-sabin" }), 1),
        (json!({ "preset": "doo-sabin" }), 2),
    ];
    let mut refused = 0;
    for n in [255, 256] {
        for net in [disc(n), double_cone(n)] {
            for (plan, levels) in &plans {
                let mut job = json!({ "input": net.input(), "levels": levels });
                if !plan.is_null() {
                    job["plan"] = plan.clone();
                }
                job["outputs"] = json!([{ "format": "json" }]);
                if let Err(faults) = estimate(&job, &Limits::default()) {
                    // the faces of a disc meet in vertices of two faces, of which no dual makes a face
                    assert_eq!(render(&job).expect_err("the estimate refuses"), faults, "{job:.200}");
                    continue;
                }
                let expected = largest(&job);
                for (options, one_byte) in [
                    (json!({ "format": "ply" }), true),
                    (json!({ "format": "ply", "ascii": true }), false),
                    (json!({ "format": "ply", "face_sizes": "uint" }), false),
                ] {
                    job["outputs"] = json!([options]);
                    let [told, made] = [estimate(&job, &Limits::default()), render(&job).map(|_| expected as u128)];
                    assert_eq!(told, made, "{plan} on {n}: {options}");
                    if one_byte && expected > 255 {
                        let faults = told.expect_err("one byte counts to 255");
                        refused += 1;
                        assert_eq!(faults[0].pointer, "/outputs/0/face_sizes");
                        for part in [&expected.to_string(), "255", "\"uint\""] {
                            assert!(faults[0].detail.contains(part), "{faults:?}");
                        }
                    } else {
                        assert_eq!(told, Ok(expected as u128), "{plan} on {n}: {options}");
                    }
                }
            }
        }
    }
    assert!(refused >= 7, "{refused}");
}

/// The refusal names each output that it concerns.
#[test]
fn all_outputs_that_do_not_fit_are_named() {
    let outputs = json!([{ "format": "ply" }, { "format": "obj" }, { "format": "ply", "name": "other" }]);
    let job = json!({ "input": disc(300).input(), "levels": 0, "outputs": outputs });
    let faults = estimate(&job, &Limits::default()).expect_err("300 corners");
    let pointers: Vec<&str> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
    assert_eq!(pointers, ["/outputs/0/face_sizes", "/outputs/2/face_sizes"]);
}

#[test]
fn a_glb_of_more_than_four_gigabytes_is_refused_by_the_estimate() {
    let most = u64::MAX;
    let all = Limits {
        max_faces: most,
        max_vertices: most,
        max_output_bytes: most,
        max_job_bytes: most,
        max_held_bytes: most,
    };
    let ask = |format: &str| {
        let job = json!({ "input": nets::cube().input(), "plan": { "preset": "catmull-clark" }, "levels": 13,
            "outputs": [{ "format": format }] });
        estimate(&job, &all)
    };
    let faults = ask("glb").expect_err("glb counts its bytes with 32 bits");
    assert_eq!(faults[0].pointer, "/outputs/0/format");
    assert!(faults[0].detail.contains("3.9 GiB") && faults[0].detail.contains("ply"), "{faults:?}");
    assert_eq!(ask("ply"), Ok(4));
}

#[test]
fn origins_that_f32_cannot_number_are_refused_by_the_estimate() {
    let counts = |input_edges| Counts { input_edges, ..nothing(ShapeKind::Mesh) };
    for name in ["glb", "gltf"] {
        let format = named(name).expect("a format");
        let options = |ids| {
            let given = [("ids".to_owned(), Literal::Flag(ids))];
            Values::resolve(format.facts().parameters, &given).expect("an option")
        };
        for (cells, ids, fits) in [(1 << 24, true, true), ((1 << 24) + 1, true, false), ((1 << 24) + 1, false, true)] {
            let told = format.fits(&counts(cells), &options(ids));
            assert_eq!(told.is_ok(), fits, "{name}: {told:?}");
            assert!(told.err().is_none_or(|fault| fault.pointer == "/ids" && fault.detail.contains("16777217")));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    /// Schemes with faces of their own; words are tested together with their other counts.
    #[test]
    fn largest_faces_are_as_forecast(
        net in nets::manifold(),
        triangles in nets::triangle_manifold(),
        levels in 0..3_u32,
    ) {
        for (net, preset) in
            [(&net, "doo-sabin"), (&triangles, "sqrt-3"), (&triangles, "loop"), (&net, "catmull-clark")]
        {
            let job = json!({ "input": net.input(), "plan": { "preset": preset }, "levels": levels,
                "outputs": [{ "format": "json" }] });
            if let Ok(told) = estimate(&job, &Limits::default()) {
                prop_assert_eq!(told, largest(&job) as u128, "{} at level {}", preset, levels);
            }
        }
    }
}
