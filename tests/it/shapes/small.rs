//! The cost of a small mesh before its job has a turn: no thread is started or awaited for it. The test binary runs
//! itself, as other tests start rayon's global pool.

use std::process::Command;

use planish::job::limits::Limits;
use rayon::ThreadPoolBuilder;
use serde_json::{Value, json};

use crate::support::nets::{cube, cylinder, mixed, octahedron};
use crate::support::parsed;

/// The environment variable that marks the child process.
const CHILD: &str = "PLANISH_TEST_WITHOUT_GLOBAL_POOL";

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";

/// Returns jobs whose inputs and plans use different queries of a mesh.
fn jobs() -> Vec<Value> {
    let presets = ["catmull-clark", "loop", "doo-sabin", "sqrt-3", "bilinear"];
    let inputs = [
        cube().input(),
        cylinder(5, 3).input(),
        mixed().input(),
        octahedron().input(),
        json!({ "text": { "format": "obj", "data": OBJ } }),
    ];
    let outputs = |positions| json!([{ "format": "json", "positions": positions }, { "format": "png" }]);
    let job = |input: &Value, preset, positions| {
        json!({
            "input": input, "plan": { "preset": preset }, "levels": 2, "outputs": outputs(positions)
        })
    };
    let of_input = |input| presets.into_iter().map(move |preset| ["refined", "limit"].map(|at| job(input, preset, at)));
    inputs.iter().flat_map(of_input).flatten().collect()
}

/// Runs only in the child process.
#[test]
fn child_reader_entry() {
    if std::env::var_os(CHILD).is_none() {
        return;
    }
    let admit = |job: Value| {
        let job = parsed(job.to_string().as_bytes()).map_err(|faults| format!("{faults:?}"))?;
        Limits::default().admit(job).map_err(|refusal| format!("{refusal:?}"))
    };
    let (admitted, refused): (Vec<_>, Vec<_>) = jobs().into_iter().map(admit).partition(Result::is_ok);
    assert!(admitted.len() >= 20, "{} are admitted, and not {refused:?}", admitted.len());
    let global = ThreadPoolBuilder::new().num_threads(1).build_global();
    assert!(global.is_ok(), "something of a small mesh has started the global pool: {global:?}");
}

#[test]
fn a_small_mesh_is_read_and_admitted_without_rayons_global_pool() {
    let entry = format!("{}::child_reader_entry", module_path!().split_once("::").map_or("", |(_, path)| path));
    let child = Command::new(std::env::current_exe().unwrap()).args([&entry, "--exact"]).env(CHILD, "1").output();
    let child = child.unwrap();
    assert!(child.status.success(), "{}", String::from_utf8_lossy(&child.stdout));
    assert!(String::from_utf8_lossy(&child.stdout).contains("1 passed"), "the child ran its test");
}
