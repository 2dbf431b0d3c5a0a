//! Ids are parsed before any lookup; no text of a request becomes a path.

use crate::http::jobs::mesh;
use crate::http::server::{Folder, rest, settings, story};

#[test]
fn no_trick_with_an_address_leads_anywhere() {
    let folder = Folder::new();
    let settings = planish::config::Settings { data_dir: folder.path().to_owned(), ..settings() };
    story(settings, async |server| {
        let made = server.render(&mesh(1)).await.ok();
        let place = made.header("content-location");
        let id = &place["/v1/artifacts/".len()..place.len() - ".glb".len()];
        let tricks = [
            format!("{}.glb", id.to_uppercase()),
            format!("{id}.GLB"),
            format!("{id}%00.glb"),
            format!("{id}.glb%00"),
            format!("{id}.glb%20"),
            format!("{id}.glb%2f"),
            format!("{id}..glb"),
            format!("{id}.manifest"),
            format!("..%2fartifacts%2f{}%2f{id}", &id[..2]),
            format!("%2e%2e%2f{id}.glb"),
            format!("..%5c{id}.glb"),
            "%2e%2e%2f%2e%2e%2fetc%2fpasswd".to_owned(),
            format!("{}\u{ff10}.glb", &id[..63]).replace('\u{ff10}', "%ef%bc%90"),
            format!("{}%c0%af.glb", &id[..62]),
            format!("{id}{id}.glb"),
            format!("{}.glb", &id[..63]),
            ".glb".to_owned(),
            "%2e.glb".to_owned(),
        ];
        for trick in tricks {
            let path = format!("/v1/artifacts/{trick}");
            let request = format!("GET {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n");
            let answer = rest(server.said(&request).await).await;
            assert!(answer.starts_with("HTTP/1.1 404"), "{trick}: {answer}");
            assert!(answer.contains("application/problem+json"), "{trick}: {answer}");
        }
        // the same address in another notation (RFC 3986)
        assert_eq!(server.get(&place.replace(".glb", "%2eglb")).await.ok().body, made.body);
    });
}

#[test]
fn addresses_that_climb_are_not_resolved() {
    story(settings(), async |server| {
        for path in ["/v1/artifacts/../../livez", "/v1/../livez", "/%2e%2e/livez", "//livez", "/livez/", "/livez%00"] {
            let request = format!("GET {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n");
            let answer = rest(server.said(&request).await).await;
            assert!(answer.starts_with("HTTP/1.1 404"), "{path}: {answer}");
        }
    });
}

#[test]
fn what_an_address_says_is_shortened_and_escaped_where_it_is_repeated() {
    story(settings(), async |server| {
        let long = "x".repeat(5000);
        let problem = server.get(&format!("/v1/presets/{long}")).await.problem(404, "not-found");
        assert!(problem["detail"].as_str().unwrap().len() < 500, "{problem}");
        let problem = server.get("/v1/presets/%3Cscript%3E%22").await.problem(404, "not-found");
        assert!(problem["detail"].as_str().unwrap().contains("<script>"), "text in JSON, never a page: {problem}");
        let answer = server.get("/docs/problems/%3Cscript%3E").await;
        answer.problem(404, "not-found");
    });
}
