//! Renders that outlast their request.

use axum::http::Method;
use planish::config::Settings;

use super::jobs::{mesh, with};
use super::server::{settings, story, until};

#[test]
fn a_job_that_outlasts_the_wait_goes_on_and_its_result_has_the_promised_address() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let later = server.post_with("/v1/render", &with(mesh(3), "obj"), &[("prefer", "wait=0")]).await;
        assert_eq!(later.status, 202, "{}", later.text());
        assert_eq!(later.header("preference-applied"), "wait=0");
        assert!(later.header("retry-after").parse::<u64>().unwrap() >= 1);
        assert_eq!(later.header("content-type"), "application/json");
        let location = later.header("location").to_owned();
        let status = later.json();
        assert_eq!(location, format!("/v1/jobs/{}", status["id"].as_str().unwrap()));
        assert_eq!((&status["state"], &status["attempts"]), (&"queued".into(), &1.into()), "{status}");
        assert_eq!(status["cost"]["faces"], 6 * 64, "{status}");
        let waiting = server.get(&location).await.ok();
        assert!(!waiting.header("retry-after").is_empty());

        drop(held);
        let done = server.settled(&location).await;
        assert_eq!((&done["state"], &done["progress"]), (&"done".into(), &1.0.into()), "{done}");
        assert!(done["timings_ms"]["refine"].as_f64().unwrap() >= 0.0, "{done}");
        let output = &done["outputs"][0];
        assert_eq!((&output["name"], &output["format"]), (&"obj".into(), &"obj".into()));
        let result = server.get(output["href"].as_str().unwrap()).await.ok();
        assert_eq!(result.header("etag"), format!("\"{}\"", output["key"].as_str().unwrap()));
        let again = server.render(&with(mesh(3), "obj")).await.ok();
        assert_eq!(again.header("cache-status"), "planish; hit");
        assert_eq!(again.body, result.body);
    });
}

#[test]
fn every_way_to_say_at_once_is_understood() {
    story(settings(), async |server| {
        let held = server.hold().await;
        for prefer in ["wait=0", "respond-async", "Wait=0", "return=minimal, wait=0", "wait=\"0\""] {
            let answer = server.post_with("/v1/render", &mesh(3), &[("prefer", prefer)]).await;
            assert_eq!(answer.status, 202, "{prefer}");
        }
        drop(held);
        for (format, prefer) in [
            ("obj", "respond-async, wait=20"),
            ("ply", "wait=20, respond-async"),
            ("stl", "respond-async; a=b, wait=20; c"),
        ] {
            let answer = server.post_with("/v1/render", &with(mesh(2), format), &[("prefer", prefer)]).await;
            assert_eq!(answer.status, 200, "first a wait, only then an answer later: {prefer}");
        }
    });
}

#[test]
fn asking_again_while_it_runs_joins_it_and_is_no_second_attempt() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let now = [("prefer", "wait=0")];
        let first = server.post_with("/v1/render", &mesh(3), &now).await;
        let second = server.post_with("/v1/render", &mesh(3), &now).await;
        assert_eq!(first.header("location"), second.header("location"));
        assert_eq!(second.json()["attempts"], 1);
        assert_eq!(server.app.desk.n_under_way(), 1);
        drop(held);
        assert_eq!(server.settled(first.header("location")).await["state"], "done");
    });
}

#[test]
fn after_a_202_a_disconnect_no_longer_cancels() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let body = mesh(3).to_string();
        let request = server.request("/v1/render", "prefer: wait=0\r\nconnection: close\r\n", &body);
        let answer = super::server::rest(server.said(&request).await).await;
        assert!(answer.starts_with("HTTP/1.1 202"), "{answer}");
        assert_eq!(server.app.desk.n_under_way(), 1);
        drop(held);
        until("it is done", || server.app.desk.n_under_way() == 0).await;
        assert_eq!(server.render(&mesh(3)).await.ok().header("cache-status"), "planish; hit");
    });
}

#[test]
fn a_job_that_nobody_posted_is_not_known() {
    story(settings(), async |server| {
        server.get(&format!("/v1/jobs/{}", "0".repeat(64))).await.problem(404, "not-found");
        server.get("/v1/jobs/1").await.problem(404, "not-found");
    });
}

#[test]
fn a_computation_that_runs_too_long_is_stopped_and_says_so() {
    let settings = planish::config::Settings { run_timeout_s: 1, ..settings() };
    story(settings, async |server| {
        let problem = server.render(&with(super::jobs::endless(), "stats")).await.problem(422, "timed-out");
        assert!(problem["detail"].as_str().unwrap().contains("1 s"), "{problem}");
        let later =
            server.post_with("/v1/render", &with(super::jobs::endless(), "stats"), &[("prefer", "wait=0")]).await;
        let status = server.settled(later.header("location")).await;
        assert_eq!(status["state"], "failed", "{status}");
        assert!(status["error"].as_str().unwrap().contains("1 s"), "{status}");
        let again =
            server.post_with("/v1/render", &with(super::jobs::endless(), "stats"), &[("prefer", "wait=0")]).await;
        assert_eq!(again.json()["attempts"], 2, "a failed job that is posted again is queued again");
        server.settled(again.header("location")).await;
    });
}

#[test]
fn forgetting_one_job_leaves_the_artifact_of_another_with_the_same_bytes() {
    let nothing_is_kept = Settings { memory_cache_bytes: 0, cache_bytes: 0, ..settings() };
    story(nothing_is_kept, async |server| {
        let named = |name: &str| {
            let mut job = with(mesh(2), "obj");
            job["outputs"][0]["name"] = name.into();
            job
        };
        let mut jobs = Vec::new();
        for name in ["one", "other"] {
            let held = server.hold().await;
            let later = server.post_with("/v1/render", &named(name), &[("prefer", "wait=0")]).await;
            assert_eq!(later.status, 202, "{}", later.text());
            drop(held);
            let location = later.header("location").to_owned();
            let done = server.settled(&location).await;
            jobs.push((location, done["outputs"][0]["href"].as_str().unwrap().to_owned()));
        }
        let [(one, href), (other, same)] = &jobs[..] else { unreachable!("there are two jobs") };
        assert!(one != other && href == same, "two jobs with one artifact");
        let forgotten = server.ask(Method::DELETE, one, &[], Vec::new()).await;
        assert!(forgotten.status < 300, "{}", forgotten.text());
        server.get(other).await.ok();
        server.get(href).await.ok();
        server.ask(Method::DELETE, other, &[], Vec::new()).await;
        server.get(href).await.problem(404, "not-found");
    });
}
