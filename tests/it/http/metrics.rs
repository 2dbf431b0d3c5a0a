//! Metrics: counters of the service's work.

use std::collections::BTreeMap;

use super::jobs::{mesh, with};
use super::server::{Server, settings, story};

async fn read(server: &Server) -> BTreeMap<String, f64> {
    let page = server.get("/metrics").await.ok();
    assert_eq!(page.header("content-type"), "text/plain; version=0.0.4");
    let text = page.text();
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines.map(|line| line.rsplit_once(' ').unwrap()).map(|(name, n)| (name.to_owned(), n.parse().unwrap())).collect()
}

#[test]
fn requests_computations_jobs_and_finds_are_counted() {
    story(settings(), async |server| {
        let job = with(mesh(2), "stats");
        for _ in 0..3 {
            server.render(&job).await.ok();
        }
        server.post_with("/v1/jobs", &with(mesh(1), "obj"), &[("prefer", "wait=60")]).await.ok();
        server.render(&mesh(40)).await.problem(422, "too-large");
        server.get("/no/such/page?x=\"").await.problem(404, "not-found");
        let metrics = read(server).await;
        assert!(metrics["planish_sent_bytes_total"] > 1000.0, "{metrics:#?}");
        for (name, n) in [
            ("planish_requests_total{method=\"POST\",route=\"/v1/render\",status=\"200\"}", 3.0),
            ("planish_requests_total{method=\"POST\",route=\"/v1/render\",status=\"422\"}", 1.0),
            ("planish_requests_total{method=\"GET\",route=\"none\",status=\"404\"}", 1.0),
            ("planish_computations_total{outcome=\"done\"}", 2.0),
            ("planish_jobs_settled_total{outcome=\"done\"}", 1.0),
            ("planish_stage_seconds_count{stage=\"encode\"}", 2.0),
            ("planish_stage_seconds_bucket{stage=\"encode\",le=\"+Inf\"}", 2.0),
            ("planish_queue_waiting{line=\"jobs-long\"}", 0.0),
            ("planish_jobs_known", 1.0),
            ("planish_store_artifacts{store=\"memory\"}", 2.0),
        ] {
            assert_eq!(metrics.get(name), Some(&n), "{name} in {metrics:#?}");
        }
    });
}

#[test]
fn no_client_makes_a_label() {
    story(settings(), async |server| {
        let before = read(server).await;
        for n in 0..20 {
            server.get(&format!("/v1/jobs/{n}")).await.problem(404, "not-found");
            server.get(&format!("/{n}/%22%0a")).await.problem(404, "not-found");
            let method = axum::http::Method::from_bytes(format!("M{n}").as_bytes()).unwrap();
            server.ask(method, "/livez", &[], Vec::new()).await.problem(405, "method-not-allowed");
        }
        // one line for each of the three requests, and one for the metrics page that was read before
        let after = read(server).await;
        // the service's own canary may appear meanwhile
        let counted = after.keys().filter(|name| name.starts_with("planish_requests"));
        let new: Vec<&String> = counted.filter(|name| !before.contains_key(*name)).collect();
        assert_eq!(new.len(), 4, "{new:#?}");
    });
}
