//! Searches for the level of a tolerance: counted, stoppable, bounded, and separate from reading a job.

use planish::input::ReadLimits;
use planish::job::{Draft, Search, SearchError};
use planish::watch::{Stopped, Watch};
use planish::wire::JobRequest;
use serde_json::{Value, json};

use crate::support::nets::control;

/// Returns the cube with its first corner far away.
fn far_corner() -> Value {
    let mut input = control("cube");
    input["mesh"]["positions"][0] = json!([1e6, 1e6, 1e6]);
    input
}

fn search(input: &Value, plan: &Value, tolerance: f64) -> Search {
    let job = json!({
        "input": input, "plan": plan, "levels": { "tolerance": tolerance }, "outputs": [{ "format": "json" }]
    });
    let request: JobRequest = serde_json::from_value(job).unwrap();
    let Draft::Search(search) = request.draft_within(&ReadLimits::default()).unwrap() else {
        panic!("a tolerance was asked for")
    };
    *search
}

fn catmull_clark() -> Value {
    json!({ "preset": "catmull-clark" })
}

#[test]
fn h5_a_search_counts_its_work_and_stays_within_what_it_says() {
    for (input, plan, tolerance) in [(control("cube"), catmull_clark(), 0.05), (far_corner(), catmull_clark(), 3e4)] {
        let search = search(&input, &plan, tolerance);
        let watch = Watch::new();
        let found = search.run(&watch).unwrap();
        assert!(found.bound <= tolerance);
        assert!(watch.done() > 1000 && watch.done() <= search.cost().work, "{} units", watch.done());
        let job = search.complete(found).unwrap();
        assert_eq!((job.levels, job.reached), (found.level, Some(found.into())));
    }
}

#[test]
fn h5_a_search_stops_when_it_is_told_to() {
    let far = search(&far_corner(), &catmull_clark(), 0.05);
    let watch = Watch::new();
    let stopped = std::thread::scope(|scope| {
        scope.spawn(|| {
            while watch.done() < 10_000 {
                std::thread::yield_now();
            }
            watch.stop();
        });
        far.run(&watch)
    });
    assert_eq!(stopped, Err(SearchError::Stopped(Stopped)));

    let polygon = json!({ "polygon": { "points": [[0, 0], [1, 0], [1, 1], [0, 3]], "closed": true } });
    let watch = Watch::new();
    watch.stop();
    let curve = search(&polygon, &json!({ "preset": "cubic-b-spline" }), 1e-3);
    assert_eq!(curve.run(&watch), Err(SearchError::Stopped(Stopped)));
    assert!(curve.run(&Watch::new()).is_ok());
}

#[test]
fn h5_a_search_is_refused_without_one_where_that_can_be_told_at_once() {
    let job = json!({
        "input": control("cube"), "plan": { "preset": "catmull-clark" }, "levels": { "tolerance": 1e-30 },
        "outputs": [{ "format": "json" }]
    });
    let request: JobRequest = serde_json::from_value(job).unwrap();
    let faults = request.draft_within(&ReadLimits::default()).unwrap_err();
    assert_eq!(faults[0].pointer, "/levels/tolerance");
}

#[test]
fn h5_searches_with_one_answer_have_one_key() {
    let key = |input: &Value, plan: &Value, tolerance| search(input, plan, tolerance).key();
    let plain = key(&control("cube"), &catmull_clark(), 0.5);
    assert_eq!(plain, key(&control("cube"), &catmull_clark(), 0.5));
    for other in [
        key(&far_corner(), &catmull_clark(), 0.5),
        key(&control("cube"), &json!({ "word": "UC" }), 0.5),
        key(&control("cube"), &catmull_clark(), 0.25),
    ] {
        assert_ne!(plain, other);
    }
    let counted: JobRequest = serde_json::from_value(json!({
        "input": control("cube"), "plan": catmull_clark(), "levels": 1, "outputs": [{ "format": "json" }]
    }))
    .unwrap();
    let counted = counted.draft_within(&ReadLimits::default()).unwrap();
    assert!(matches!(counted, Draft::Job(_)), "a number of levels needs no search");
}
