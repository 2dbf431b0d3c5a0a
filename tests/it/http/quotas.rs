//! Quotas of one client: per minute, and at once.

use std::sync::Arc;
use std::time::Duration;

use planish::config::Settings;
use planish::config::keys::KeyRole;
use planish::service::clock::Manual;

use super::jobs::{mesh, polygon, with};
use super::keys::{bearer, key, key_with, keyed};
use super::server::{Folder, settings, story, story_at, until};

#[test]
fn requests_for_work_beyond_the_minute_are_told_when_to_come_back_and_the_rest_goes_on() {
    let clock = Arc::new(Manual::default());
    story_at(Settings { requests_per_minute: 3, ..settings() }, clock.clone(), async |server| {
        let place = server.render(&with(polygon(1), "svg")).await.ok().header("content-location").to_owned();
        let second = server.render(&with(polygon(2), "svg")).await.ok();
        assert_eq!(second.header("ratelimit-policy"), "\"requests\";q=3;w=60");
        assert_eq!(second.header("ratelimit"), "\"requests\";r=1;t=40");
        // earlier results cost nothing
        for _ in 0..5 {
            server.render(&with(polygon(1), "svg")).await.ok();
        }
        server.render(&with(polygon(3), "svg")).await.ok();
        let refused = server.render(&with(polygon(4), "svg")).await;
        let problem = refused.problem(429, "quota");
        assert!(problem["detail"].as_str().unwrap().contains("3 requests for work a minute"), "{problem}");
        assert_eq!(refused.header("retry-after"), "20");
        assert_eq!(refused.header("ratelimit"), "\"requests\";r=0;t=60");
        // health, available results and status do not count
        for path in ["/livez", &place, "/v1/jobs", "/v1/presets", "/metrics"] {
            let answer = server.get(path).await.ok();
            assert_eq!(answer.header("ratelimit"), "", "{path}");
        }
        clock.advance(Duration::from_secs(20));
        server.render(&with(polygon(4), "svg")).await.ok();
        server.render(&with(polygon(5), "svg")).await.problem(429, "quota");
    });
}

#[test]
fn each_key_has_a_quota_of_its_own() {
    let folder = Folder::new();
    let usual = key(&folder, "acme", KeyRole::Render);
    let large = key_with(&folder, "acme", KeyRole::Render, |entry| entry.requests_per_minute = Some(5));
    let free = key_with(&folder, "acme", KeyRole::Render, |entry| entry.requests_per_minute = Some(0));
    story(Settings { requests_per_minute: 1, ..keyed(&folder) }, async |server| {
        let left = async |token| {
            let shown = bearer(token);
            let answer = server.post_with("/v1/estimate", &mesh(1), &[("authorization", &shown)]).await;
            (answer.status, answer.header("ratelimit").split(';').nth(1).unwrap_or_default().to_owned())
        };
        assert_eq!(left(&usual).await, (200, "r=0".to_owned()));
        assert_eq!(left(&usual).await, (429, "r=0".to_owned()));
        assert_eq!(left(&large).await, (200, "r=4".to_owned()));
        assert_eq!(left(&free).await, (200, String::new()));
        // a client that is not admitted does not use up a quota
        server.post("/v1/estimate", &mesh(1)).await.problem(401, "unauthorized");
        assert_eq!(left(&large).await, (200, "r=3".to_owned()));
    });
}

#[test]
fn no_more_requests_of_a_client_are_answered_at_once_than_it_may_have() {
    story(Settings { requests_in_flight: 2, ..settings() }, async |server| {
        let held = server.hold().await;
        let ask = |levels| {
            let request = server.client.post(server.url("/v1/render")).json(&with(mesh(levels), "obj"));
            tokio::spawn(request.send())
        };
        let waiting = [ask(1), ask(2)];
        until("two wait", || server.app.desk.n_interests() == 2).await;
        let refused = server.render(&with(mesh(3), "obj")).await;
        let problem = refused.problem(429, "quota");
        assert!(problem["detail"].as_str().unwrap().contains("2 requests of yours"), "{problem}");
        assert_eq!(refused.header("retry-after"), "1");
        server.get("/livez").await.ok();
        drop(held);
        for waiting in waiting {
            let response = waiting.await.unwrap().unwrap();
            assert_eq!(response.status().as_u16(), 200);
            drop(response.bytes().await.unwrap());
        }
        until("both are answered", || server.app.desk.peers.held(planish::service::peer::QuotaKind::InFlight) == 0)
            .await;
        server.render(&with(mesh(3), "obj")).await.ok();
    });
}
