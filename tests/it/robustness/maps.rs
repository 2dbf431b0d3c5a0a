//! Steps that are not linear: the same bits for any number of threads, counted work, and an end on request.

use planish::job::limits::Limits;
use planish::job::{Input, Job};
use planish::refine::{RefineError, refine_polygon};
use planish::shape::source::Curve;
use planish::watch::Watch;
use serde_json::json;

use crate::support::parsed;

/// Returns a job with enough levels for several blocks of points.
fn job(closed: bool) -> Job {
    let job = json!({
        "input": { "polygon": {
            "points": [[0, 0], [3, 0.5], [3, 0.5], [2.5, 2], [-1, 3], [-2, 1]], "closed": closed, "pinned": [3],
        } },
        "plan": { "preset": "incenter", "parameters": { "mu": 0.3 } }, "levels": 12,
        "outputs": [{ "format": "json" }],
    });
    parsed(job.to_string().as_bytes()).expect("a job")
}

fn refined(job: &Job, watch: &Watch) -> Result<Curve, RefineError> {
    let Input::Polygons(polygons) = &*job.input else { panic!("a polygon") };
    let steps = job.plan.schedule(job.levels).expect("there are no functions");
    refine_polygon(&polygons[0], &job.plan, &steps, watch)
}

#[test]
fn threads_do_not_matter() {
    for closed in [true, false] {
        let [one, many] = [1, 7].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
            pool.install(|| refined(&job(closed), &Watch::new()).expect("it can be refined"))
        });
        assert!(one.points.len() > 40_000, "{}", one.points.len());
        assert_eq!(one, many);
    }
}

#[test]
fn work_is_what_was_forecast() {
    for closed in [true, false] {
        let (job, watch) = (job(closed), Watch::new());
        refined(&job, &watch).expect("it can be refined");
        let estimate = Limits::default().estimate(&job).expect("it is small");
        assert_eq!(u128::from(watch.done()), estimate.forecast.work);
    }
}

#[test]
fn it_ends_when_it_is_stopped() {
    let watch = Watch::new();
    watch.stop();
    assert!(matches!(refined(&job(true), &watch), Err(RefineError::Stopped(_))));
    assert_eq!(watch.done(), 0);
}
