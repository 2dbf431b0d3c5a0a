//! Limits of perturbed plans: each vertex is followed separately, with its numbers in the whole nets of later levels.

use planish::job::limits::Limits;
use planish::job::{RunError, run};
use planish::watch::Watch;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::nets::{self, Net, distance};
use crate::support::{json, json_with, parsed, render};

/// Returns a plan with a perturbation and awkward constants.
fn plan(word: &str, amplitude: f64, decay: f64) -> Value {
    json!({ "word": word, "seed": 7, "parameters": {
        "kernel": "1 + alpha/8", "compensation": "1 - alpha/6", "alpha": 0.9, "delta": 0.4,
        "perturbation": { "amplitude": amplitude, "decay": decay },
    } })
}

fn refined(mesh: &Value, plan: &Value, levels: u32) -> Net {
    Net::of(&json(json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels })))
}

/// Returns limit positions.
fn limit(mesh: &Value, plan: &Value, levels: u32) -> Net {
    let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels });
    Net::of(&json_with(job, &json!({ "positions": "limit" })))
}

/// Returns limit positions and normals, and the warnings.
fn with_normals(mesh: &Value, plan: &Value, levels: u32) -> (Net, Vec<[f64; 3]>, Vec<String>) {
    let output = json!({ "format": "json", "positions": "limit", "normals": "limit" });
    let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels, "outputs": [output] });
    let (bytes, report) = render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
    let result: Value = serde_json::from_slice(&bytes).expect("the json output is JSON");
    let normals = serde_json::from_value(result["normals"].clone()).expect("normals are lists of numbers");
    (Net::of(&result), normals, report.warnings)
}

/// Returns the largest distance between the first vertices of two nets, which are the images of those of the input.
fn apart(a: &Net, b: &Net, n: usize) -> f64 {
    a.positions.iter().zip(&b.positions).take(n).map(|(p, q)| distance(p, q)).fold(0.0, f64::max)
}

/// Returns meshes with all data that words with perturbations support.
fn meshes() -> Vec<(&'static str, Value)> {
    let corners_and_creases = |net: Net| {
        let face = net.faces[0].clone();
        let mut mesh = net.to_json();
        mesh["corners"] = json!([{ "vertex": face[0], "sharpness": 10 }]);
        mesh["creases"] = json!([1, 2].map(|i| json!({ "edge": [face[i], face[i + 1]], "sharpness": 10 })));
        mesh
    };
    let own = |net: Net| {
        let n = u32::try_from(net.positions.len()).expect("small");
        let mut mesh = net.to_json();
        let ramp: Vec<f64> = (0..n).map(|v| 0.2 + 0.07 * f64::from(v * v % 11)).collect();
        mesh["parameters"] = json!({ "delta": ramp, "alpha": ramp });
        mesh
    };
    let tagged = |net: Net| {
        let mut mesh = net.to_json();
        mesh["latitude"] = json!([[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [6, 7], [7, 8], [8, 6]]);
        mesh["longitude"] = json!([[0, 3], [1, 4], [2, 5], [3, 6], [4, 7], [5, 8]]);
        mesh
    };
    vec![
        ("cube", nets::cube().to_json()),
        ("open", nets::mixed().to_json()),
        ("sharp", corners_and_creases(nets::prism(5))),
        ("own", own(nets::mixed())),
        ("tagged", tagged(nets::cylinder(3, 4))),
    ]
}

/// The vertices of the input move less and less.
#[test]
fn refined_vertices_approach_their_perturbed_limits() {
    for (name, mesh) in meshes() {
        let n = mesh["positions"].as_array().expect("positions").len();
        let decays: &[f64] = if name == "cube" { &[0.3, 0.5, 0.7] } else { &[0.7] };
        for &decay in decays {
            let plan = plan("UCP", 0.3, decay);
            let found = limit(&mesh, &plan, 0);
            let [early, late] = [5, 7].map(|levels| apart(&found, &refined(&mesh, &plan, levels), n));
            // distances shrink by 1/4 per level, and by 1/2 at the ends of sharp edges; perturbations act on them
            let (ratio, most) = if name == "sharp" { (0.56, 1e-3) } else { (0.31, 1e-4) };
            assert!(late < most && late < early * ratio * ratio, "{name}, decay {decay}: {early}, then {late}");
        }
    }
}

#[test]
fn perturbed_limits_do_not_move_under_one_more_level() {
    for (name, mesh) in meshes() {
        let n = mesh["positions"].as_array().expect("positions").len();
        for (word, decay) in [("UCP", 0.3), ("UC", 0.5), ("UCP", 0.9), ("U(CUP)", 0.7)] {
            let plan = plan(word, 0.4, decay);
            let [coarse, fine] = [0, 1].map(|levels| limit(&mesh, &plan, levels));
            let off = apart(&coarse, &fine, n);
            assert!(off < 1e-13, "{name}, {word}, decay {decay}: {off}");
        }
    }
}

/// Normals converge to the limit normals, which no level changes; on both sides of sharp edges.
#[test]
fn normals_of_perturbed_limits_are_those_of_deep_levels() {
    for (name, mesh) in meshes() {
        let plan = plan("UCP", 0.3, 0.4);
        let n = mesh["positions"].as_array().expect("positions").len();
        let [(_, normals, said), (_, fine, _)] = [0, 1].map(|levels| with_normals(&mesh, &plan, levels));
        // a corner of the mesh has no tangent plane
        let smooth = usize::from(name == "sharp")..n;
        for v in smooth {
            let off = distance(&normals[v], &fine[v]);
            assert!(off < 1e-11, "{name}: normal {v} turns by {off}; {said:?}");
        }
        // the sums differ on the two sides of a sharp edge
        if name == "sharp" {
            continue;
        }
        let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 6 });
        let area: Vec<[f64; 3]> =
            serde_json::from_value(json_with(job, &json!({ "normals": "area" }))["normals"].clone()).expect("normals");
        for v in 0..n {
            let off = distance(&normals[v], &area[v]);
            assert!(off < 5e-2, "{name}: normal {v} is {:?}, not {:?}; {said:?}", normals[v], area[v]);
        }
    }
}

/// Differences at a decay of 1/2 and more may leave kinks: positions have limits, normals are those of faces.
#[test]
fn slow_decays_have_no_limit_normals() {
    let (mesh, plan) = (nets::cube().to_json(), plan("UC", 0.3, 0.5));
    let (found, normals, said) = with_normals(&mesh, &plan, 1);
    assert!(said.len() == 1 && said[0].contains("below 1/2; here it is 0.5"), "{said:?}");
    let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 1 });
    let expected = json_with(job.clone(), &json!({ "positions": "limit", "normals": "area" }));
    assert_eq!(expected["normals"], json!(normals));
    assert_eq!(found, Net::of(&expected));
    let alone = json_with(job.clone(), &json!({ "normals": "limit" }));
    assert_eq!(alone["normals"], json_with(job, &json!({ "normals": "area" }))["normals"]);
}

#[test]
fn no_amplitude_is_no_perturbation() {
    for (name, mesh) in meshes() {
        let still = plan("UCP", 0.0, 0.3);
        let mut bare = still.clone();
        bare["parameters"].as_object_mut().expect("an object").remove("perturbation");
        let [(a, a_normals, _), (b, b_normals, _)] = [&still, &bare].map(|plan| with_normals(&mesh, plan, 1));
        let n = a.positions.len();
        assert!(apart(&a, &b, n) <= 1e-14, "{name}: {}", apart(&a, &b, n));
        assert!((0..n).all(|v| distance(&a_normals[v], &b_normals[v]) <= 1e-12), "{name}");
        // and a small perturbation has a small effect
        let little = limit(&mesh, &plan("UCP", 1e-9, 0.9), 1);
        let off = apart(&a, &little, n);
        assert!(off > 1e-12 && off < 1e-7, "{name}: {off}");
    }
}

/// Without averages and push-backs there is nothing to perturb.
#[test]
fn perturbations_without_effect_change_no_limit() {
    let net = nets::mixed();
    let (found, normals, said) = with_normals(&net.to_json(), &plan("UC(U)", 0.5, 0.9), 1);
    let refined = refined(&net.to_json(), &plan("UC(U)", 0.5, 0.9), 1);
    assert_eq!(found, refined);
    assert_eq!(normals.len(), refined.positions.len());
    assert!(said.len() == 1 && !said[0].contains("decay"), "{said:?}");
}

#[test]
fn seeds_tell_perturbed_limits_apart() {
    let mesh = nets::prism(5).to_json();
    let seeded = |seed: u64| {
        let mut plan = plan("UC", 0.4, 0.5);
        plan["seed"] = json!(seed);
        limit(&mesh, &plan, 1)
    };
    let [one, again, other] = [1, 1, 2].map(seeded);
    assert_eq!(one, again);
    assert!(apart(&one, &other, one.positions.len()) > 1e-3);
    // weights of averages and push-backs sum to 1, whatever they are
    let mut flat = mesh;
    flat["positions"].as_array_mut().expect("positions").iter_mut().for_each(|p| p[2] = json!(2.0));
    for p in limit(&flat, &plan("UCP", 0.4, 0.7), 1).positions {
        assert!((p[2] - 2.0).abs() < 1e-13, "{p:?}");
    }
}

/// With delta 1, vertices are fixed, whatever kernel and compensation are.
#[test]
fn perturbed_plans_that_interpolate_stay_where_they_are() {
    let mut plan = plan("UCP", 0.2, 0.6);
    plan["parameters"]["delta"] = json!(1);
    let mesh = nets::mixed().to_json();
    let (found, refined) = (limit(&mesh, &plan, 1), refined(&mesh, &plan, 1));
    assert!(apart(&found, &refined, found.positions.len()) < 1e-12);
}

#[test]
fn limits_of_perturbed_plans_commute_with_affine_maps() {
    let moved = |p: &[f64; 3]| [0.5 * p[0] - p[1] + 3.0, 2.0 * p[1] - p[2], p[2] + 0.25 * p[0] - 7.0];
    for net in [nets::cube(), nets::mixed()] {
        let image = Net { positions: net.positions.iter().map(moved).collect(), ..net.clone() };
        let plan = plan("UCP", 0.4, 0.8);
        let [a, b] = [net, image].map(|net| limit(&net.to_json(), &plan, 1));
        for (p, q) in a.positions.iter().zip(&b.positions) {
            assert!(distance(&moved(p), q) < 1e-12, "{p:?} {q:?}");
        }
    }
}

#[test]
fn any_number_of_threads_finds_the_same_perturbed_limits() {
    let job = |decay: f64| {
        json!({ "input": nets::mixed().input(), "plan": plan("UCP", 0.3, decay), "levels": 2,
            "outputs": [{ "format": "ply", "positions": "limit", "normals": "limit" }] })
    };
    for decay in [0.4, 0.9] {
        let with_threads = |n: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads start");
            pool.install(|| render(&job(decay))).expect("it has a limit").0
        };
        let [one, two, eight] = [1, 2, 8].map(with_threads);
        assert!(one == two && two == eight, "decay {decay}");
    }
}

/// Vertices that cannot be followed are refused, with the bound and the remedy.
#[test]
fn what_is_not_followed_is_refused() {
    let refused = |net: &Net, plan: Value, levels: u32| {
        let job = json!({ "input": net.input(), "plan": plan, "levels": levels,
            "outputs": [{ "format": "obj", "positions": "limit" }] });
        let faults = render(&job).expect_err("it is refused");
        format!("{}: {}", faults[0].pointer, faults[0].detail)
    };
    let said = refused(&nets::cube(), plan("UCCCP", 0.1, 0.5), 6);
    assert!(said.contains("more than 1048576 points around them") && said.contains("ask for fewer levels"), "{said}");
    let said = refused(&nets::cube(), plan("UCP", 1e3, 0.999), 0);
    assert!(said.contains("1000 levels") && said.contains("smaller amplitude or decay"), "{said}");
    let dual = json!({ "word": "UDD", "parameters": { "perturbation": { "amplitude": 0.1 } } });
    let job = json!({ "input": nets::cube().input(), "plan": dual, "levels": 1, "outputs": [{ "format": "obj" }] });
    let faults = parsed(job.to_string().as_bytes()).expect_err("D knows no perturbation");
    assert_eq!(faults[0].pointer, "/plan/parameters/perturbation");
}

/// Following vertices is most of the work, is forecast, and can be stopped in between.
#[test]
fn following_vertices_is_forecast_and_can_be_stopped() {
    let job = |levels: u32, decay: f64| {
        let job = json!({ "input": nets::cube().input(), "plan": plan("UCP", 0.3, decay), "levels": levels,
            "outputs": [{ "format": "ply", "positions": "limit", "normals": "limit" }] });
        let limits = Limits::default();
        let estimate = limits.estimate(&parsed(job.to_string().as_bytes()).expect("a job")).expect("it is small");
        (limits.admit(parsed(job.to_string().as_bytes()).expect("a job")).expect("it is small"), estimate)
    };
    for decay in [0.4, 0.8] {
        let (admitted, estimate) = job(1, decay);
        let watch = Watch::new();
        run(&admitted, &admitted.job().outputs[0], &mut Vec::new(), &watch).expect("it has a limit");
        let (done, forecast) = (u128::from(watch.done()), estimate.forecast.work);
        // finding the patches around the vertices is counted beside the rows
        let patches = forecast / 20;
        assert!(done <= forecast + patches && forecast <= done + 2 * 26, "decay {decay}: {done} of {forecast} rows");
    }
    let (admitted, estimate) = job(4, 0.8);
    let watch = Watch::new();
    let (stopper, some) = (watch.clone(), u64::try_from(estimate.forecast.work / 20).expect("small"));
    let waiting = std::thread::spawn(move || {
        while stopper.done() < some {
            std::thread::yield_now();
        }
        stopper.stop();
    });
    let ended = run(&admitted, &admitted.job().outputs[0], &mut Vec::new(), &watch);
    waiting.join().expect("it stops");
    assert!(matches!(ended, Err(RunError::Stopped(_))), "{ended:?}");
    assert!(u128::from(watch.done()) < estimate.forecast.work / 2, "{} rows", watch.done());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any faces, boundaries and isolated vertices.
    #[test]
    fn limits_of_random_nets_stay_under_one_more_level(net in nets::manifold(), decay in 0.1..0.95) {
        let (mesh, plan) = (net.to_json(), plan("UCP", 0.3, decay));
        let [coarse, fine] = [0, 1].map(|levels| limit(&mesh, &plan, levels));
        let off = apart(&coarse, &fine, coarse.positions.len());
        prop_assert!(off < 1e-12, "decay {}: {}", decay, off);
    }
}
