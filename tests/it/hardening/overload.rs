//! More work than there is room for.

use std::future::{Future, poll_fn};
use std::pin::pin;
use std::task::Poll;

use planish::config::Settings;
use planish::service::pool::Lane;

use crate::http::jobs::{endless, mesh, with};
use crate::http::server::{settings, story, until};

#[test]
fn a_full_queue_is_answered_503_while_cached_answers_and_health_go_on() {
    story(Settings { max_queue: 2, ..settings() }, async |server| {
        let cached = server.render(&mesh(1)).await.ok();
        until("the canary has sung", || server.app.canary.last_success().is_some()).await;
        let held = server.hold().await;
        for format in ["obj", "ply"] {
            let answer = server.post_with("/v1/render", &with(mesh(2), format), &[("prefer", "wait=0")]).await;
            assert_eq!(answer.status, 202);
        }
        for _ in 0..20 {
            let refused = server.render(&with(mesh(2), "stl")).await;
            refused.problem(503, "busy");
            assert!(refused.header("retry-after").parse::<u64>().unwrap() >= 1);
            let hit = server.render(&mesh(1)).await.ok();
            assert_eq!(hit.header("cache-status"), "planish; hit");
            assert_eq!(hit.body, cached.body);
            assert_eq!(server.get("/livez").await.status, 200);
            let problem = server.get("/readyz").await.problem(503, "not-ready");
            assert!(problem["detail"].as_str().unwrap().contains("short-lane"), "{problem}");
        }
        let joined = server.post_with("/v1/render", &with(mesh(2), "obj"), &[("prefer", "wait=0")]).await;
        assert_eq!(joined.status, 202, "who joins needs no place");
        drop(held);
        until("the queue is empty", || server.app.desk.n_under_way() == 0).await;
        server.render(&with(mesh(2), "stl")).await.ok();
        server.get("/readyz").await.ok();
    });
}

#[test]
fn levels_of_tolerances_on_meshes_are_found_in_line() {
    story(Settings { max_queue: 2, ..settings() }, async |server| {
        let held = server.hold().await;
        let within = |tolerance: f64| {
            let mut job = mesh(1);
            job["levels"] = serde_json::json!({ "tolerance": tolerance });
            job
        };
        let mut clients = Vec::new();
        for (path, tolerance) in [("/v1/render", 0.5), ("/v1/estimate", 0.4)] {
            clients.push(server.said(&server.request(path, "", &within(tolerance).to_string())).await);
            until("it waits", || server.app.desk.pool.waiting()[1] == clients.len()).await;
        }
        for path in ["/v1/render", "/v1/estimate"] {
            server.post(path, &within(0.3)).await.problem(503, "busy");
        }
        assert_eq!(server.get("/livez").await.status, 200);
        drop(held);
        until("the queue is empty", || server.app.desk.pool.waiting() == [0, 0]).await;
        let found = server.render(&within(0.3)).await.ok();
        assert_eq!(found.header("planish-level"), "1");
        drop(clients);
    });
}

/// A client that disconnects ends its wait, not the work.
#[test]
fn a_turn_lasts_until_its_work_ends_though_nobody_waits_for_it() {
    story(settings(), async |server| {
        let turn = server.hold().await.pop().expect("one");
        let (end, ended) = std::sync::mpsc::channel::<()>();
        drop(tokio::task::spawn_blocking(move || turn.run(move || ended.recv())));
        let mut next = pin!(server.turn(Lane::Long));
        assert!(poll_fn(|context| Poll::Ready(next.as_mut().poll(context).is_pending())).await, "its place is taken");
        end.send(()).expect("the work goes on");
        drop(next.await);
    });
}

#[test]
fn short_work_does_not_wait_behind_long_work() {
    story(settings(), async |server| {
        let client = server.said(&server.request("/v1/render", "", &with(endless(), "stats").to_string())).await;
        until("the long one runs", || server.app.desk.n_under_way() == 1 && server.app.desk.pool.waiting() == [0, 0])
            .await;
        server.render(&mesh(2)).await.ok();
        assert_eq!(server.app.desk.n_under_way(), 1, "the long one still runs");
        drop(client);
    });
}

#[test]
fn a_job_that_is_too_large_is_refused_before_it_takes_a_place() {
    story(settings(), async |server| {
        let held = server.hold().await;
        for levels in [20, 40, 64] {
            server.render(&mesh(levels)).await.problem(422, "too-large");
        }
        drop(held);
    });
}
