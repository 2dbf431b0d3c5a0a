//! Health, the OpenAPI document, the start page.

use std::time::Instant;

use super::server::{PATIENCE, Server, settings, story};

pub(super) async fn ready(server: &Server) -> serde_json::Value {
    let start = Instant::now();
    loop {
        let answer = server.get("/readyz").await;
        if answer.status == 200 {
            return answer.json();
        }
        answer.problem(503, "not-ready");
        assert!(start.elapsed() < PATIENCE, "never ready");
        tokio::time::sleep(std::time::Duration::from_millis(5)).await;
    }
}

#[test]
fn the_service_is_ready_once_its_canary_has_sung() {
    story(settings(), async |server| {
        let readiness = ready(server).await;
        assert_eq!(readiness["ready"], true);
        assert!(readiness["canary_age_s"].as_f64().unwrap() >= 0.0);
        assert!(readiness["canary_ms"].as_f64().unwrap() > 0.0);
        assert_eq!(readiness["under_way"], 0);
    });
}

#[test]
fn health_is_answered_while_nothing_is_computed() {
    story(settings(), async |server| {
        ready(server).await;
        let held = server.hold().await;
        assert_eq!(server.get("/livez").await.ok().text(), "alive\n");
        ready(server).await;
        drop(held);
    });
}

#[test]
fn the_start_page_links_only_to_pages_that_exist() {
    story(settings(), async |server| {
        ready(server).await;
        let page = server.get("/").await.ok();
        assert!(page.header("content-type").starts_with("text/html"));
        let text = page.text();
        let links: Vec<&str> = text.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
        assert!(links.contains(&"/play/play.css"), "{links:?}");
        for link in links {
            assert_eq!(server.get(link).await.status, 200, "{link}");
        }
    });
}

#[test]
fn the_document_that_is_served_is_the_one_that_is_committed() {
    story(settings(), async |server| {
        let answer = server.get("/openapi.json").await.ok();
        assert_eq!(answer.header("content-type"), "application/json");
        assert_eq!(answer.text(), planish::http::document_text());
    });
}
