//! Posted jobs: several outputs, one resource for equal jobs, cancel, forget, lists, terms.

use std::sync::Arc;
use std::time::Duration;

use axum::http::Method;
use planish::config::Settings;
use planish::job::key::content;
use planish::output::named;
use planish::service::job_key::{JobKey, JobTerms, Tenant};
use planish::service::jobs::{Holder, JobPhase, JobSummary, Predicted, Product};
use planish::service::peer::Peer;
use serde_json::{Value, json};

use super::jobs::{endless, mesh, polygon, with};
use super::server::{Server, settings, story, until};

/// Returns a cube as a picture, as statistics, and as a mesh file.
fn three() -> Value {
    let mut job = mesh(2);
    job["outputs"] = json!([
        { "format": "png", "width": 64, "height": 64 },
        { "format": "stats" },
        { "name": "file", "format": "obj" },
    ]);
    job
}

async fn accepted(server: &Server, path: &str, job: &Value) -> (String, Value) {
    let answer = server.post(path, job).await;
    assert_eq!(answer.status, 202, "{}", answer.text());
    (answer.header("location").to_owned(), answer.json())
}

async fn cancel(server: &Server, location: &str) -> (u16, Value) {
    let answer = server.ask(Method::POST, &format!("{location}/cancel"), &[], Vec::new()).await;
    (answer.status, answer.json())
}

async fn delete(server: &Server, location: &str) -> u16 {
    server.ask(Method::DELETE, location, &[], Vec::new()).await.status
}

#[test]
fn a_job_with_several_outputs_makes_them_all_and_links_to_each() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let (location, status) = accepted(server, "/v1/jobs", &three()).await;
        assert_eq!(location, format!("/v1/jobs/{}", status["id"].as_str().unwrap()));
        assert_eq!((&status["state"], &status["attempts"]), (&"queued".into(), &1.into()), "{status}");
        assert_eq!(status["outputs"].as_array().unwrap().len(), 3);
        drop(held);
        let done = server.settled(&location).await;
        assert_eq!((&done["state"], &done["progress"]), (&"done".into(), &1.0.into()), "{done}");
        let mut bytes = 0;
        for (output, format) in done["outputs"].as_array().unwrap().iter().zip(["png", "stats", "obj"]) {
            assert_eq!((&output["format"], &output["state"]), (&format.into(), &"done".into()), "{output}");
            let result = server.get(output["href"].as_str().unwrap()).await.ok();
            assert_eq!(output["bytes"], result.body.len(), "{output}");
            bytes += result.body.len();
        }
        assert_eq!(done["actual"]["bytes"], bytes);
        assert!(done["actual"]["time_ms"].as_f64().unwrap() > 0.0, "{done}");
        // each is the result of the job with that output only
        let alone = server.render(&with(mesh(2), "stats")).await.ok();
        assert_eq!(alone.header("cache-status"), "planish; hit");
        let again = server.post("/v1/jobs", &three()).await.ok();
        assert_eq!((again.json()["state"].clone(), again.header("location")), ("done".into(), location.as_str()));
    });
}

#[test]
fn an_analysis_is_a_job_too_and_has_the_bytes_of_its_own_route() {
    story(settings(), async |server| {
        let question = json!({ "plan": { "preset": "four-point" } });
        let (location, _) = accepted(server, "/v1/jobs", &json!({ "analysis": question })).await;
        let done = server.settled(&location).await;
        assert_eq!(done["outputs"][0]["name"], "analysis", "{done}");
        let result = server.get(done["outputs"][0]["href"].as_str().unwrap()).await.ok();
        let own = server.post("/v1/analyses", &question).await.ok();
        assert_eq!((own.header("cache-status"), &own.body), ("planish; hit", &result.body));
        let wrong = json!({ "analysis": { "plan": { "preset": "nothing" } } });
        let problem = server.post("/v1/jobs", &wrong).await.problem(422, "invalid-job");
        assert_eq!(problem["errors"][0]["pointer"], "/analysis/plan/preset", "{problem}");
    });
}

#[test]
fn a_wait_ends_with_the_job_and_what_is_there_needs_none() {
    story(settings(), async |server| {
        let waited = server.post_with("/v1/jobs", &three(), &[("prefer", "wait=60")]).await.ok();
        assert_eq!((waited.json()["state"].clone(), waited.header("preference-applied")), ("done".into(), "wait=60"));
        // the results of another job are already available
        let mut fewer = three();
        fewer["outputs"].as_array_mut().unwrap().remove(0);
        let there = server.post("/v1/jobs", &fewer).await.ok().json();
        assert_eq!((&there["state"], &there["attempts"]), (&"done".into(), &0.into()), "{there}");
        let held = server.hold().await;
        let wait = [("prefer", "wait=1")];
        let later = server.post_with("/v1/jobs", &with(mesh(3), "obj"), &wait).await;
        assert_eq!(later.status, 202, "{}", later.text());
        drop(held);
    });
}

#[test]
fn a_job_that_cannot_be_is_refused_and_not_known() {
    story(settings(), async |server| {
        server.post("/v1/jobs", &mesh(40)).await.problem(422, "too-large");
        let mut typo = three();
        typo["outputs"][1]["format"] = "statistics".into();
        let problem = server.post("/v1/jobs", &typo).await.problem(422, "invalid-job");
        assert_eq!(problem["errors"][0]["pointer"], "/outputs/1/format");
        for (query, pointer) in [
            ("priority=high", "?priority"),
            ("queue_timeout_s=0", "?queue_timeout_s"),
            ("run_timeout_s=-1", "?run_timeout_s"),
            ("prio=batch", "?prio"),
        ] {
            let problem = server.post(&format!("/v1/jobs?{query}"), &three()).await.problem(422, "invalid-job");
            assert_eq!(problem["errors"][0]["pointer"], pointer, "{problem}");
        }
        assert!(server.app.desk.jobs.n_known() == 0);
    });
}

#[test]
fn an_output_that_fails_leaves_the_others_and_the_job_says_so() {
    story(settings(), async |server| {
        // numbers beyond the range of f32, which JSON can hold and STL cannot
        let mut job = mesh(1);
        job["input"]["mesh"]["positions"][0][0] = json!(1e200);
        job["outputs"] = json!([{ "format": "stl" }, { "format": "json" }]);
        let (location, _) = accepted(server, "/v1/jobs", &job).await;
        let failed = server.settled(&location).await;
        assert_eq!(failed["state"], "failed", "{failed}");
        assert_eq!(failed["outputs"][0]["state"], "failed");
        assert_eq!(failed["outputs"][0]["error"], failed["error"]);
        assert_eq!(failed["outputs"][1]["state"], "done");
        server.get(failed["outputs"][1]["href"].as_str().unwrap()).await.ok();
    });
}

#[test]
fn cancel_ends_what_runs_and_a_job_posted_again_is_a_further_attempt() {
    story(settings(), async |server| {
        let job = with(endless(), "stats");
        let (location, _) = accepted(server, "/v1/jobs", &job).await;
        until("it runs", || server.app.desk.n_under_way() == 1 && server.app.desk.pool.waiting() == [0, 0]).await;
        let (status, cancelled) = cancel(server, &location).await;
        assert_eq!((status, &cancelled["state"]), (202, &"cancelled".into()), "{cancelled}");
        until("it has stopped", || server.app.desk.n_under_way() == 0).await;
        assert_eq!(cancel(server, &location).await.0, 200, "it is cancelled already");
        let (same, again) = accepted(server, "/v1/jobs", &job).await;
        assert_eq!((same, &again["attempts"]), (location.clone(), &2.into()), "{again}");
        assert_eq!(delete(server, &location).await, 204);
        until("it has stopped", || server.app.desk.n_under_way() == 0).await;
        server.get(&location).await.problem(404, "not-found");
        let (_, anew) = accepted(server, "/v1/jobs", &job).await;
        assert_eq!(anew["attempts"], 1, "what is forgotten is not counted");
        delete(server, &location).await;
    });
}

#[test]
fn a_job_is_one_however_it_is_asked_for() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let job = with(mesh(3), "obj");
        let (location, _) = accepted(server, "/v1/jobs?priority=batch", &job).await;
        let render = server.post_with("/v1/render", &job, &[("prefer", "wait=0")]).await;
        assert_eq!((render.status, render.header("location")), (202, location.as_str()), "{}", render.text());
        assert_eq!(render.json()["priority"], "batch");
        let (same, status) = accepted(server, "/v1/jobs", &job).await;
        assert_eq!((same, &status["attempts"]), (location.clone(), &1.into()));
        assert_eq!(server.app.desk.n_under_way(), 1);
        drop(held);
        assert_eq!(server.settled(&location).await["state"], "done");
    });
}

/// Two clients with an interest in one computation: in every order of their leaving, it continues as long as one of
/// them is left, and ends with the last.
#[test]
fn a_computation_lasts_exactly_as_long_as_the_last_interest_in_every_order() {
    let leaves = ["cancel", "delete", "disconnect"];
    for first in leaves {
        for second in leaves {
            story(settings(), async |server| {
                let held = server.hold().await;
                let job = with(mesh(2), "stats");
                let mut clients = Vec::new();
                for (at, how) in [first, second].into_iter().enumerate() {
                    // the same output in jobs with two names, so that these are two interests
                    let mut job = job.clone();
                    job["outputs"][0]["name"] = format!("client-{at}").into();
                    if how == "disconnect" {
                        let body = job.to_string();
                        clients
                            .push((Some(server.said(&server.request("/v1/render", "", &body)).await), String::new()));
                    } else {
                        let later = server.post_with("/v1/render", &job, &[("prefer", "wait=0")]).await;
                        clients.push((None, later.header("location").to_owned()));
                    }
                    until("it is wanted", || server.app.desk.n_interests() == at + 1).await;
                }
                assert_eq!(server.app.desk.n_under_way(), 1, "{first} {second}");
                for (left, (how, (stream, location))) in
                    [(1, (first, clients.remove(0))), (0, (second, clients.remove(0)))]
                {
                    match how {
                        "cancel" => assert_eq!(cancel(server, &location).await.0, 202),
                        "delete" => assert_eq!(delete(server, &location).await, 204),
                        _ => drop(stream),
                    }
                    until("it is left", || server.app.desk.n_interests() == left).await;
                    assert_eq!(server.app.desk.n_under_way(), left, "{first} {second}");
                }
                // and once more from the beginning
                drop(held);
                assert_eq!(server.render(&job).await.ok().header("cache-status"), "planish; fwd=miss; stored");
            });
        }
    }
}

#[test]
fn two_tenants_have_two_jobs_in_one_computation() {
    story(settings(), async |server| {
        let desk = &server.app.desk;
        let held = server.hold().await;
        let job = with(mesh(2), "stats");
        let (location, status) = accepted(server, "/v1/jobs", &job).await;
        let id = planish::job::key::Key::parse(status["id"].as_str().unwrap()).unwrap();
        // of the record nothing but its summary, as the record may hold an interest
        let summary = desk.jobs.get(&JobKey::of_anyone(id)).unwrap().summary.clone();
        let other = JobKey { tenant: Tenant(7), id };
        desk.accept(other, (*summary).clone(), JobTerms::default(), (Peer::SELF, Holder::Client), Vec::new())
            .await
            .unwrap();
        until("both wait", || desk.n_interests() == 2).await;
        assert_eq!(desk.n_under_way(), 1, "computations have no tenant");
        assert_eq!(delete(server, &location).await, 204);
        assert!(desk.jobs.of_artifact(Tenant::ANYONE, &summary.products[0].key).is_none());
        until("one waits", || desk.n_interests() == 1).await;
        drop(held);
        until("it is done", || desk.standing(&other).unwrap().phase == JobPhase::Done).await;
        assert_eq!(server.get(&location).await.status, 404, "the job of a tenant is nobody else's");
        let list = server.get("/v1/jobs").await.ok().json();
        assert_eq!(list["jobs"], json!([]));
    });
}

#[test]
fn lists_go_by_pages_from_the_newest() {
    story(settings(), async |server| {
        let mut ids = Vec::new();
        for levels in 1..=5 {
            let done = server.post_with("/v1/jobs", &with(polygon(levels), "svg"), &[("prefer", "wait=60")]).await.ok();
            ids.push(done.json()["id"].clone());
        }
        ids.reverse();
        let (mut found, mut path) = (Vec::new(), "/v1/jobs?limit=2".to_owned());
        loop {
            let page = server.get(&path).await.ok().json();
            let jobs = page["jobs"].as_array().unwrap();
            assert!(jobs.len() <= 2);
            found.extend(jobs.iter().map(|job| job["id"].clone()));
            let Some(next) = page["next"].as_str() else { break };
            path = format!("/v1/jobs?limit=2&cursor={next}");
        }
        assert_eq!(found, ids);
        for query in ["limit=0", "limit=101", "cursor=x", "page=2"] {
            server.get(&format!("/v1/jobs?{query}")).await.problem(422, "invalid-job");
        }
    });
}

#[test]
fn a_batch_stands_back_and_jobs_in_line_know_their_place() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let mut locations = Vec::new();
        // two are taken out of the queue and wait for a place to compute
        for (at, priority) in ["batch", "batch", "batch", "batch", "interactive"].into_iter().enumerate() {
            let mut job = with(mesh(2), "stats");
            job["input"]["mesh"]["positions"][0][0] = json!(at);
            locations.push(accepted(server, &format!("/v1/jobs?priority={priority}"), &job).await.0);
            until("it is in line", || server.app.desk.n_under_way() == (at + 1).min(2)).await;
        }
        let mut places = Vec::new();
        for location in &locations {
            places.push(server.get(location).await.ok().json()["queue_position"].as_u64());
        }
        assert_eq!(places, [None, None, Some(1), Some(2), Some(0)]);
        drop(held);
        for location in &locations {
            assert_eq!(server.settled(location).await["state"], "done");
        }
    });
}

#[test]
fn a_line_that_is_full_refuses_and_says_when_to_come_back() {
    story(Settings { max_queue: 2, ..settings() }, async |server| {
        let held = server.hold().await;
        let mut refused = 0;
        for at in 0..8 {
            let mut job = with(mesh(2), "stats");
            job["input"]["mesh"]["positions"][0][0] = json!(at);
            let answer = server.post("/v1/jobs", &job).await;
            until("those who do jobs have one each", || server.app.desk.n_under_way() == (at + 1).min(2)).await;
            if answer.status == 503 {
                answer.problem(503, "busy");
                assert!(answer.header("retry-after").parse::<u64>().unwrap() >= 1);
                refused += 1;
            }
        }
        // two wait in the queue, and two for a place to compute
        assert_eq!((refused, server.app.desk.jobs.n_known()), (4, 4));
        drop(held);
        until("all are done", || server.app.desk.jobs.any_active().is_none()).await;
    });
}

#[test]
fn what_waits_or_runs_for_too_long_fails_and_what_is_old_is_forgotten_by_the_clock() {
    let (desk_clock, settings) = (Arc::new(planish::service::clock::Manual::default()), settings());
    super::server::story_at(Settings { job_ttl_s: 1000, ..settings }, desk_clock.clone(), async |server| {
        let desk = &server.app.desk;
        let running = accepted(server, "/v1/jobs?run_timeout_s=60", &with(endless(), "stats")).await.0;
        until("it runs", || desk.n_under_way() == 1 && desk.pool.waiting() == [0, 0]).await;
        let held = [server.turn(planish::service::pool::Lane::Short).await];
        let mut in_line = Vec::new();
        for at in 0..3 {
            let mut job = with(mesh(2), "stats");
            job["input"]["mesh"]["positions"][0][0] = json!(at);
            in_line.push(accepted(server, "/v1/jobs?queue_timeout_s=30", &job).await.0);
        }
        let third = in_line.pop().unwrap();
        until("two have their turn", || desk.n_under_way() == 3).await;
        desk_clock.advance(Duration::from_secs(29));
        desk.tidy();
        assert_eq!(server.get(&third).await.ok().json()["state"], "queued");
        desk_clock.advance(Duration::from_secs(1));
        desk.tidy();
        let late = server.get(&third).await.ok().json();
        assert_eq!(late["state"], "failed");
        assert!(late["error"].as_str().unwrap().contains("queue_timeout_s"), "{late}");
        desk_clock.advance(Duration::from_secs(30));
        let stopped = server.settled(&running).await;
        assert!(stopped["error"].as_str().unwrap().contains("60 s"), "{stopped}");
        drop(held);
        for location in &in_line {
            assert_eq!(server.settled(location).await["state"], "done");
        }
        desk_clock.advance(Duration::from_secs(999));
        desk.tidy();
        assert_eq!(desk.jobs.n_known(), 3, "the one that waited was settled first");
        desk_clock.advance(Duration::from_secs(1));
        desk.tidy();
        assert!(desk.jobs.n_known() == 0);
    });
}

#[test]
fn what_is_known_of_jobs_takes_from_the_account_and_comes_back() {
    story(settings(), async |server| {
        let records = &server.app.desk.account.records;
        let (location, _) = accepted(server, "/v1/jobs", &three()).await;
        server.settled(&location).await;
        let taken = records.usage().taken;
        assert!((10 << 10..16 << 10).contains(&taken), "{taken} bytes");
        assert_eq!(delete(server, &location).await, 204);
        until("it is back", || records.usage().taken == 0 && server.app.desk.account.inputs.usage().taken == 0).await;
    });
}

#[test]
fn a_job_with_more_than_its_account_holds_is_refused() {
    story(settings(), async |server| {
        let format = named("json").unwrap();
        let key = content(b"");
        let product = Product { name: "x".to_owned(), format, key };
        let request = axum::body::Bytes::from(vec![0; 200 << 20]);
        let cost = Predicted::default();
        let summary = JobSummary {
            products: vec![product],
            cost,
            reached: None,
            details: Vec::new(),
            blobs: Vec::new(),
            request,
        };
        let job = JobKey::of_anyone(key);
        let refused =
            server.app.desk.accept(job, summary, JobTerms::default(), (Peer::SELF, Holder::Client), Vec::new()).await;
        assert!(refused.is_err() && server.app.desk.jobs.n_known() == 0);
    });
}
