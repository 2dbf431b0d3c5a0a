//! What a small mesh costs before its job has a turn: no thread is started for it, and none is waited for. The test
//! binary runs itself, as other tests start rayon's global pool.

use std::process::Command;

use planish::job::limits::Limits;
use rayon::ThreadPoolBuilder;
use serde_json::{Value, json};

use crate::support::nets::{cube, cylinder, mixed};
use crate::support::parsed;

/// Set where this process is the child.
const CHILD: &str = "PLANISH_TEST_WITHOUT_GLOBAL_POOL";

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";

/// Jobs whose inputs and plans ask different things of a mesh.
fn jobs() -> Vec<Value> {
    let outputs = json!([
        { "format": "json" }, { "format": "glb" }, { "format": "png" }, { "format": "glb", "positions": "limit" }
    ]);
    let presets = ["catmull-clark", "loop", "doo-sabin", "sqrt3", "bilinear"];
    let inputs = [
        cube().input(),
        cylinder(5, 3).input(),
        mixed().input(),
        json!({ "text": { "format": "obj", "data": OBJ } }),
        json!({ "mesh": { "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]] } }),
    ];
    let job = |input: &Value, preset| json!({ "input": input, "plan": { "preset": preset }, "levels": 3, "outputs": outputs });
    inputs.iter().flat_map(|input| presets.map(|preset| job(input, preset))).collect()
}

/// Runs only where the other test starts it.
#[test]
fn child_reader_entry() {
    if std::env::var_os(CHILD).is_none() {
        return;
    }
    let admitted = jobs().into_iter().filter(|job| {
        let job = parsed(job.to_string().as_bytes());
        job.is_ok_and(|job| Limits::default().admit(job).is_ok())
    });
    assert!(admitted.count() >= 12, "most of them can be done");
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
