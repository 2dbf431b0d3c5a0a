//! Kept work of earlier computations changes no byte, takes as much memory as stated, and is evicted if there is no
//! room.

use std::fs;
use std::path::Path;

use planish::job::limits::{Admitted, Limits};
use planish::job::{Input, KeepNothing, KeepWork, run_keeping};
use planish::refine::Program;
use planish::service::kept_work::KeptWork;
use planish::watch::Watch;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::nets::{self, Net};
use crate::support::parsed;

fn admitted(job: &Value) -> Admitted {
    let job = parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
    Limits::default().admit(job).unwrap()
}

/// Returns the bytes and warnings of all outputs.
fn made(job: &Admitted, kept: &dyn KeepWork) -> Vec<(Vec<u8>, Vec<String>)> {
    let output = |output| {
        let mut bytes = Vec::new();
        let report = run_keeping(job, output, kept, &mut bytes, &Watch::new()).unwrap();
        (bytes, report.warnings)
    };
    job.job().outputs.iter().map(output).collect()
}

fn n_kept(kept: &KeptWork) -> u64 {
    kept.usage().artifacts
}

/// Returns the same job with other positions.
fn moved(job: &Value) -> Value {
    let mut job = job.clone();
    for point in job["input"]["mesh"]["positions"].as_array_mut().into_iter().flatten() {
        point[0] = json!(0.75 * point[0].as_f64().unwrap() + 0.1 * point[1].as_f64().unwrap());
    }
    job
}

/// Checks a job, and the same job with other positions, without and with kept work of each kind.
fn check_warm(job: &Value) {
    let kept = KeptWork::new(64 << 20);
    for job in [job.clone(), moved(job), moved(job), job.clone()] {
        let ready = admitted(&job);
        assert!(made(&ready, &kept) == made(&ready, &KeepNothing), "other bytes warm than cold: {job:.2000}");
    }
}

#[test]
fn example_jobs_are_the_same_bytes_cold_and_warm() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("api/examples/jobs");
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert!(paths.len() > 50);
    let kept = KeptWork::new(64 << 20);
    for path in paths {
        let job: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        let ready = admitted(&job);
        let cold = made(&ready, &KeepNothing);
        for run in ["first", "second"] {
            assert!(made(&ready, &kept) == cold, "{} has other bytes in its {run} run", path.display());
        }
    }
}

#[test]
fn what_is_kept_serves_other_formats_cameras_and_positions() {
    let kept = KeptWork::new(64 << 20);
    let of = |outputs: Value, net: &Net| {
        let plan = json!({ "preset": "catmull-clark" });
        admitted(&json!({ "input": net.input(), "plan": plan, "levels": 3, "outputs": outputs }))
    };
    let cube = nets::cube();
    made(&of(json!([{ "format": "glb" }]), &cube), &kept);
    assert_eq!(n_kept(&kept), 2, "a program and a mesh");
    let picture =
        |azimuth: f64| json!({ "format": "png", "width": 32, "height": 32, "camera": { "azimuth_deg": azimuth } });
    let mut near = picture(0.5);
    near["name"] = json!("near");
    made(&of(json!([picture(0.1), near]), &cube), &kept);
    assert_eq!(n_kept(&kept), 2, "the same mesh");
    let limit = json!([{ "format": "glb", "positions": "limit" }]);
    made(&of(limit, &cube), &kept);
    assert_eq!(n_kept(&kept), 3, "another mesh");
    let wide = Net { positions: cube.positions.iter().map(|[x, y, z]| [2.0 * x, *y, *z]).collect(), ..nets::cube() };
    made(&of(json!([{ "format": "glb" }]), &wide), &kept);
    assert_eq!(n_kept(&kept), 4, "another mesh by the same program");
}

/// Returns jobs with data that may prevent a sweep or change its program.
fn jobs() -> impl Strategy<Value = Value> {
    let plans = prop::sample::select(vec![
        json!({ "preset": "catmull-clark" }),
        json!({ "preset": "bilinear" }),
        json!({ "word": "UCCP", "parameters": { "delta": 0.1 } }),
        json!({ "word": "UCP", "parameters": { "kernel": "cos(alpha/2)", "alpha": "pi/3" } }),
        json!({ "word": "UC", "seed": 11, "parameters": { "perturbation": { "amplitude": 0.9, "decay": 0.49 } } }),
    ]);
    (nets::manifold(), plans, 1..4_u32, any::<bool>(), any::<bool>()).prop_map(|(net, plan, levels, uvs, sharp)| {
        let mut input = net.input();
        if uvs {
            let values: Vec<[f64; 2]> = net.positions.iter().map(|p| [p[0], p[1] * p[2]]).collect();
            input["mesh"]["uvs"] = json!({ "values": values, "faces": net.faces, "interpolation": "corners-only" });
        }
        if sharp {
            let edges = net.edges();
            let creases = edges.iter().step_by(3).map(|&(a, b)| json!({ "edge": [a, b], "sharpness": 10 }));
            input["mesh"]["creases"] = creases.collect();
            input["mesh"]["corners"] = json!([{ "vertex": 0, "sharpness": 10 }]);
        }
        input["mesh"]["channels"] = json!({ "heat": vec![0.5; net.positions.len()] });
        json!({ "input": input, "plan": plan, "levels": levels, "outputs": [{ "format": "glb" }] })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn random_jobs_are_the_same_bytes_cold_and_warm(job in jobs()) {
        check_warm(&job);
    }
}

/// Returns the bytes that the result of a computation keeps allocated, and the bytes that it reports.
fn held<T>(make: impl Fn() -> T + Sync, bytes: fn(&T) -> usize) -> [usize; 2] {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        let mut found = None;
        let taken = allocation_counter::measure(|| found = Some(make()));
        let said = bytes(&found.unwrap());
        [usize::try_from(taken.bytes_current).unwrap(), said]
    })
}

#[test]
fn programs_and_meshes_hold_no_more_than_they_say() {
    let (mixed, torus, grid) = (nets::mixed(), nets::torus(16, 12), nets::grid(20, 20));
    let mut creased = torus.input();
    let edges = torus.edges();
    creased["mesh"]["creases"] = edges.iter().map(|&(a, b)| json!({ "edge": [a, b], "sharpness": 10 })).collect();
    let uvs: Vec<[f64; 2]> = grid.positions.iter().map(|p| [p[0], p[1]]).collect();
    let mut mapped = grid.input();
    mapped["mesh"]["uvs"] = json!({ "values": uvs, "faces": grid.faces, "interpolation": "none" });
    mapped["mesh"]["channels"] = json!({ "heat": vec![0.5; grid.positions.len()] });
    let plans = ["UC", "UCCP", "UCCC"].map(|word| json!({ "word": word }));
    let changing = json!({ "word": "UCP", "parameters": { "kernel": "cos(alpha/2)", "alpha": "pi/3" } });
    for plan in plans.iter().chain([&json!({ "preset": "catmull-clark" }), &changing, &json!({ "word": "UCCCC" })]) {
        let least = admitted(&json!({
            "input": nets::torus(3, 3).input(), "plan": plan, "levels": 4, "outputs": [{ "format": "ply" }]
        }));
        let Input::Mesh(mesh) = &*least.job().input else { panic!("it is a mesh") };
        let [taken, said] = held(|| Program::of(mesh, &least.job().plan, least.job().steps()), Program::bytes);
        assert!(taken <= said, "a program of few faces takes {taken} and says {said}: {plan:?}");
        for input in [mixed.input(), torus.input(), grid.input(), creased.clone(), mapped.clone()] {
            let job = json!({ "input": input, "plan": plan, "levels": 4, "outputs": [{ "format": "ply" }] });
            let job = admitted(&job);
            let Input::Mesh(mesh) = &*job.job().input else { panic!("it is a mesh") };
            let (plan, steps) = (&job.job().plan, job.job().steps());
            let [taken, said] = held(|| Program::of(mesh, plan, steps), Program::bytes);
            assert!(taken <= said, "a program takes {taken} and says {said}: {plan:?}");
            let program = Program::of(mesh, plan, steps);
            let refine = || program.refine(mesh, plan, steps, &Watch::new()).unwrap();
            let [taken, said] = held(refine, planish::refine::RefinedMesh::bytes);
            assert!(taken <= said && said <= 2 * taken, "a mesh takes {taken} and says {said}: {plan:?}");
        }
    }
}

#[test]
fn work_leaves_when_there_is_no_room_and_too_large_work_is_not_kept() {
    let job = |n| {
        let outputs = json!([{ "format": "ply" }]);
        let input = nets::torus(n, 4).input();
        admitted(&json!({ "input": input, "plan": { "preset": "catmull-clark" }, "levels": 3, "outputs": outputs }))
    };
    let kept = KeptWork::new(256 << 10);
    for n in 3..12 {
        made(&job(n), &kept);
        assert!(kept.usage().bytes <= 256 << 10);
    }
    assert!(kept.usage().evicted > 0 && n_kept(&kept) > 0);
    let small = KeptWork::new(4 << 10);
    made(&job(8), &small);
    assert_eq!(n_kept(&small), 0);
}
