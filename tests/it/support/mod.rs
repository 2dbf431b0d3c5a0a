//! Helpers that the tests share: jobs from JSON through the public API, and nets.

pub(crate) mod cages;
pub(crate) mod nets;
pub(crate) mod surfaces;

use std::sync::Arc;

use planish::fault::Fault;
use planish::job::limits::{Limits, Refusal};
use planish::job::{Job, Report, RunError, run};
use planish::output::scene::CoordinateSystem;
use planish::output::{Counts, ShapeKind};
use planish::solid::CageCounts;
use planish::watch::Watch;
use planish::wire::JobRequest;
use planish::wire::read::{ReadError, read};

/// Reads and checks a job given as JSON text.
pub(crate) fn parsed(text: &[u8]) -> Result<Job, Vec<Fault>> {
    let request: JobRequest = read(text).map_err(|error| match error {
        ReadError::NotJson(detail) => vec![Fault::new("", detail)],
        ReadError::Unfit(faults) => faults,
    })?;
    request.resolve()
}

/// Runs the first output of a job given as JSON; returns the bytes and the report.
pub(crate) fn render(job: &serde_json::Value) -> Result<(Vec<u8>, Report), Vec<Fault>> {
    let text = serde_json::to_vec(job).expect("a JSON value can be written");
    let admitted = Limits::default().admit(parsed(&text)?).map_err(|refusal| match refusal {
        Refusal::Impossible(faults) => faults,
        Refusal::TooLarge { detail, .. } => vec![Fault::new("/levels", detail)],
        Refusal::Stopped => unreachable!("nothing stops it"),
    })?;
    let output = admitted.job().outputs[0].clone();
    let mut bytes = Vec::new();
    let report = run(&admitted, &output, &mut bytes, &Watch::new()).map_err(|error| match error {
        RunError::Impossible(fault) => vec![admitted.job().entries(&output).fault(fault)],
        other => vec![Fault::new("", other.to_string())],
    })?;
    Ok((bytes, report))
}

/// Returns the counts of an empty output.
pub(crate) fn nothing(kind: ShapeKind) -> Counts {
    Counts {
        kind,
        polygons: 1,
        control: 0,
        vertices: 0,
        faces: 0,
        half_edges: 0,
        largest_face: 0,
        split_vertices: 0,
        uvs: 0,
        seamed: 0,
        unfolded: 0,
        frames: 0,
        coordinate_system: CoordinateSystem::default(),
        attachments: Arc::default(),
        input_faces: 0,
        input_edges: 0,
        cage: CageCounts::default(),
        tags: 0,
        weights: [0; 2],
    }
}

/// Returns the JSON output of a job without outputs.
pub(crate) fn json(job: serde_json::Value) -> serde_json::Value {
    json_with(job, &serde_json::json!({}))
}

/// Returns the JSON output, with options, of a job without outputs.
pub(crate) fn json_with(mut job: serde_json::Value, options: &serde_json::Value) -> serde_json::Value {
    let mut output = options.clone();
    output["format"] = "json".into();
    job["outputs"] = serde_json::json!([output]);
    let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
    serde_json::from_slice(&bytes).expect("the json output is JSON")
}

/// Returns the faults of a job without outputs.
pub(crate) fn faults(mut job: serde_json::Value) -> Vec<Fault> {
    job["outputs"] = serde_json::json!([{ "format": "json" }]);
    match render(&job) {
        Ok((bytes, _)) => panic!("accepted, with {} bytes: {job:.2000}", bytes.len()),
        Err(faults) => faults,
    }
}

/// Returns the result of a computation, and the largest number of bytes that it held at once. It runs in one thread, as
/// bytes are counted by thread.
pub(crate) fn peak<T: Send>(run: impl FnOnce() -> T + Send) -> (T, u64) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    pool.install(|| {
        let mut found = None;
        let taken = allocation_counter::measure(|| found = Some(run()));
        (found.expect("it ran"), taken.bytes_max)
    })
}
