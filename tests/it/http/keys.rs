//! Keys: who is admitted, to what, and how keys are added and removed while the service runs.

use std::sync::atomic::{AtomicU8, Ordering};
use std::time::Duration;

use axum::http::Method;
use planish::config::Settings;
use planish::config::keys::{KEYS_FILE, KeyEntry, KeyFile, KeyRole, Token};
use planish::http::serve::bind;
use serde_json::json;

use super::jobs::{mesh, with};
use super::server::{Folder, Server, settings, story, until};

/// Adds a new key to a folder; each one is different.
pub(crate) fn key(folder: &Folder, tenant: &str, role: KeyRole) -> Token {
    key_with(folder, tenant, role, |_| {})
}

/// Adds a new key with a change of its entry.
pub(crate) fn key_with(folder: &Folder, tenant: &str, role: KeyRole, change: impl FnOnce(&mut KeyEntry)) -> Token {
    static NEXT: AtomicU8 = AtomicU8::new(1);
    let token = Token::new(|bytes| {
        bytes.fill(NEXT.fetch_add(1, Ordering::Relaxed));
        Ok(())
    });
    let token = token.unwrap();
    let mut entry = KeyEntry {
        id: token.id().to_owned(),
        tenant: tenant.to_owned(),
        role,
        hash: token.hash(),
        link: token.link_secret(),
        created: 0,
        expires: None,
        requests_per_minute: None,
        in_flight: None,
    };
    change(&mut entry);
    let file = KeyFile::of(folder.path());
    file.change(|keys| {
        keys.push(entry);
        Ok(())
    })
    .unwrap();
    token
}

/// Returns the settings of a service with the keys of a folder, which keeps nothing else there.
pub(crate) fn keyed(folder: &Folder) -> Settings {
    Settings { data_dir: folder.path().to_owned(), cache_bytes: 0, ..settings() }
}

/// Returns the header value that presents a key.
pub(crate) fn bearer(token: &Token) -> String {
    format!("Bearer {}", token.expose())
}

#[test]
fn who_shows_no_key_or_a_wrong_one_is_told_what_to_do_and_health_and_catalogue_stay_open() {
    let folder = Folder::new();
    let own = key(&folder, "acme", KeyRole::Render);
    let other = Folder::new();
    let foreign = key(&other, "acme", KeyRole::Render);
    story(keyed(&folder), async |server| {
        let problem = server.render(&with(mesh(1), "obj")).await;
        assert_eq!(problem.header("www-authenticate"), "Bearer realm=\"planish\"");
        let detail = problem.problem(401, "unauthorized")["detail"].as_str().unwrap().to_owned();
        assert!(detail.contains("Authorization: Bearer planish_"), "{detail}");
        let altered = format!("{}x", bearer(&own));
        let cut = bearer(&own)[..bearer(&own).len() - 1].to_owned();
        for shown in [&bearer(&foreign), &altered, &cut, "Basic abc", "Bearer", "Bearer planish_", own.expose()] {
            server.get_with("/v1/jobs", &[("authorization", shown)]).await.problem(401, "unauthorized");
        }
        for path in
            ["/v1/jobs", "/v1/limits", "/metrics", "/nowhere", "/v1/blobs/b3-0", "/v1/render?job=e30", "/kroki/svg/e"]
        {
            server.get(path).await.problem(401, "unauthorized");
        }
        for path in ["/livez", "/openapi.json", "/", "/v1/presets", "/v1/formats/png", "/docs/problems/quota"] {
            let status = server.get(path).await.status;
            assert!([200, 404].contains(&status), "{path} is open: {status}");
        }
        let shown = bearer(&own);
        let rendered = server.post_with("/v1/render", &with(mesh(1), "obj"), &[("authorization", &shown)]).await.ok();
        assert_eq!(rendered.header("cache-status"), "planish; fwd=miss; stored");
        let scheme = shown.replace("Bearer", "bearer");
        server.get_with("/v1/jobs", &[("authorization", &scheme)]).await.ok();
    });
}

#[test]
fn a_role_allows_what_it_says_and_no_more() {
    let folder = Folder::new();
    let [read, render, admin] = [KeyRole::Read, KeyRole::Render, KeyRole::Admin].map(|role| key(&folder, "acme", role));
    story(keyed(&folder), async |server| {
        let ask = async |token: &Token, method: Method, path: &str| {
            let body = if method == Method::POST { mesh(1).to_string().into_bytes() } else { Vec::new() };
            let shown = bearer(token);
            let headers = [("authorization", shown.as_str()), ("content-type", "application/json")];
            server.ask(method, path, &headers, body).await
        };
        for (method, path) in [
            (Method::POST, "/v1/render"),
            (Method::POST, "/v1/jobs"),
            (Method::POST, "/v1/validate"),
            (Method::DELETE, "/v1/jobs/0"),
            (Method::GET, "/v1/render?job=e30"),
            (Method::GET, "/kroki/svg/e30"),
        ] {
            let refused = ask(&read, method.clone(), path).await;
            let detail = refused.problem(403, "forbidden")["detail"].as_str().unwrap().to_owned();
            assert!(detail.contains("role read") && detail.contains("takes render"), "{detail}");
            assert!(ask(&render, method, path).await.status != 403, "{path}");
        }
        ask(&render, Method::POST, "/v1/render").await.ok();
        for token in [&read, &render, &admin] {
            ask(token, Method::GET, "/v1/jobs").await.ok();
            ask(token, Method::GET, "/v1/limits").await.ok();
        }
        ask(&read, Method::GET, "/metrics").await.problem(403, "forbidden");
        ask(&render, Method::GET, "/metrics").await.problem(403, "forbidden");
        let metrics = ask(&admin, Method::GET, "/metrics").await.ok().text();
        assert!(metrics.contains("planish_keys 3"), "{metrics}");
        assert!(metrics.contains("planish_requests_total{method=\"GET\",route=\"/metrics\",status=\"403\"} 2"));
    });
}

#[test]
fn keys_come_and_go_while_the_service_runs_and_two_of_one_tenant_see_the_same() {
    let folder = Folder::new();
    let old = key(&folder, "acme", KeyRole::Render);
    story(keyed(&folder), async |server| {
        let status = async |token: &Token| {
            let shown = bearer(token);
            server.get_with("/v1/jobs", &[("authorization", &shown)]).await.status
        };
        let posted = server.post_with("/v1/jobs", &with(mesh(1), "obj"), &[("authorization", &bearer(&old))]).await;
        let location = posted.header("location").to_owned();
        assert!(!location.is_empty(), "{}", posted.text());
        let new = key(&folder, "acme", KeyRole::Render);
        let ended = key_with(&folder, "acme", KeyRole::Render, |entry| entry.expires = Some(1));
        until_async(server, "the new key is let in", async || status(&new).await == 200).await;
        assert_eq!((status(&old).await, status(&ended).await), (200, 401), "two at a time; an expired one never");
        server.get_with(&location, &[("authorization", &bearer(&new))]).await.ok();

        KeyFile::of(folder.path())
            .change(|keys| {
                keys.retain(|key| key.id != old.id());
                Ok(())
            })
            .unwrap();
        until_async(server, "the old key is refused", async || status(&old).await == 401).await;
        assert_eq!(status(&new).await, 200);

        // a key file that is unreadable or missing changes nothing: nobody is admitted by mistake
        let path = folder.path().join(KEYS_FILE);
        std::fs::write(&path, "[[key]]\nid = 7\n").unwrap();
        tokio::time::sleep(Duration::from_millis(1200)).await;
        assert_eq!((status(&new).await, status(&old).await), (200, 401));
        std::fs::remove_file(&path).unwrap();
        tokio::time::sleep(Duration::from_millis(1200)).await;
        assert_eq!((status(&new).await, server.get("/v1/jobs").await.status), (200, 401));
    });
}

async fn until_async(_: &Server, what: &str, mut yes: impl AsyncFnMut() -> bool) {
    for _ in 0..2000 {
        if yes().await {
            return;
        }
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
    panic!("waited in vain: {what}");
}

#[test]
fn the_first_key_shuts_a_service_that_was_open() {
    let folder = Folder::new();
    story(keyed(&folder), async |server| {
        server.get("/v1/jobs").await.ok();
        let token = key(&folder, "acme", KeyRole::Read);
        until("the keys are read", || server.app.gate.is_shut()).await;
        server.get("/v1/jobs").await.problem(401, "unauthorized");
        server.get_with("/v1/jobs", &[("authorization", &bearer(&token))]).await.ok();
    });
}

#[test]
fn on_an_address_of_the_network_the_service_wants_keys_or_to_be_told_that_it_needs_none() {
    let runtime = tokio::runtime::Runtime::new().unwrap();
    let folder = Folder::new();
    let open = Settings { listen: ([0, 0, 0, 0], 0).into(), ..keyed(&folder) };
    let starts = |settings: Settings| runtime.block_on(async { bind(settings).await.map(|(_, app)| app) });
    let refused = starts(open.clone()).map(drop).unwrap_err().to_string();
    assert!(refused.contains("planish key add --data-dir") && refused.contains("--without-keys true"), "{refused}");
    let app = starts(Settings { without_keys: true, ..open.clone() }).unwrap();
    assert!(!app.gate.is_shut());
    key(&folder, "acme", KeyRole::Render);
    assert!(starts(open.clone()).unwrap().gate.is_shut());
    std::fs::write(folder.path().join(KEYS_FILE), "key = 1").unwrap();
    let refused = starts(Settings { without_keys: true, ..open }).map(drop).unwrap_err().to_string();
    assert!(refused.contains("mend the file"), "{refused}");
}

#[test]
fn a_body_is_not_read_for_who_is_not_let_in() {
    let folder = Folder::new();
    key(&folder, "acme", KeyRole::Render);
    story(keyed(&folder), async |server| {
        let long = json!({ "input": "x".repeat(1 << 20) });
        server.post("/v1/render", &long).await.problem(401, "unauthorized");
        let taken = server.app.desk.account.bodies.usage().most;
        assert_eq!(taken, 0, "no memory was taken for the body");
    });
}
