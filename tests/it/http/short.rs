//! Repeated plain requests, which bypass the router, compared with those that it handles.

use axum::http::Method;
use planish::job::key::Key;

use super::jobs::{mesh, with};
use super::server::{Answer, rest, settings, story};

/// Returns the headers without the date, and the bytes.
fn told(answer: &Answer) -> (Vec<(String, String)>, Vec<u8>) {
    let text = |value: &axum::http::HeaderValue| value.to_str().unwrap().to_owned();
    let headers = answer.headers.iter().filter(|(name, _)| *name != "date");
    (headers.map(|(name, value)| (name.to_string(), text(value))).collect(), answer.body.to_vec())
}

#[test]
fn a_result_that_is_asked_again_and_again_has_the_same_headers_in_the_same_order_and_the_same_bytes() {
    story(settings(), async |server| {
        let made = server.render(&mesh(2)).await.ok();
        let place = made.header("content-location").to_owned();
        let origin = [("origin", "http://localhost:3000")];
        for headers in [&[][..], &origin, &[("origin", "http://elsewhere.example")], &[]] {
            let posts = [
                server.post_with("/v1/render", &mesh(2), headers).await.ok(),
                server.post_with("/v1/render", &mesh(2), headers).await.ok(),
                server.post_with("/v1/render", &mesh(2), headers).await.ok(),
            ];
            let gets = [
                server.get_with(&place, headers).await.ok(),
                server.get_with(&place, headers).await.ok(),
                server.get_with(&place, headers).await.ok(),
            ];
            for answers in [posts, gets] {
                assert_eq!(answers[0].header("cache-status"), "planish; hit");
                assert_eq!(answers[0].body, made.body);
                assert_eq!(told(&answers[0]), told(&answers[1]), "{headers:?}");
                assert_eq!(told(&answers[1]), told(&answers[2]), "{headers:?}");
            }
        }
        assert_eq!(server.app.short.n_answers(), 2, "one answer to POST, one to GET");
    });
}

#[test]
fn whatever_else_a_request_asks_of_a_remembered_answer_is_heeded() {
    story(settings(), async |server| {
        let job = with(mesh(2), "obj");
        let made = server.render(&job).await.ok();
        let (place, etag) = (made.header("content-location"), made.header("etag"));
        for _ in 0..3 {
            server.render(&job).await.ok();
            server.get(place).await.ok();
        }
        assert_eq!(server.app.short.n_answers(), 2);
        assert_eq!(server.get_with(place, &[("if-none-match", etag)]).await.status, 304);
        assert_eq!(server.get_with(place, &[("if-none-match", "*")]).await.status, 304);
        assert_eq!(server.post_with("/v1/render", &job, &[("if-none-match", etag)]).await.status, 304);
        let part = server.get_with(place, &[("range", "bytes=1-4")]).await;
        assert_eq!((part.status, &part.body[..]), (206, &made.body[1..5]));
        let head = server.ask(Method::HEAD, place, &[], Vec::new()).await.ok();
        assert_eq!(head.header("content-length"), made.body.len().to_string());
        assert!(head.body.is_empty());
        server.get(&place.replace(".obj", ".png")).await.problem(404, "not-found");
        server.get(&format!("{place}/")).await.problem(404, "not-found");
        let text = [("content-type", "text/plain")];
        server.post_with("/v1/render", &job, &text).await.problem(415, "unsupported-media-type");
        let allowed = server.get_with(place, &[("origin", "http://localhost:3000")]).await.ok();
        assert_eq!(allowed.header("access-control-allow-origin"), "http://localhost:3000");
        let foreign = server.get_with(place, &[("origin", "http://elsewhere.example")]).await.ok();
        assert_eq!(foreign.header("access-control-allow-origin"), "");
    });
}

#[test]
fn a_remembered_answer_is_not_given_under_a_foreign_host() {
    story(settings(), async |server| {
        let place = server.render(&mesh(2)).await.ok().header("content-location").to_owned();
        for _ in 0..3 {
            server.render(&mesh(2)).await.ok();
            server.get(&place).await.ok();
        }
        assert_eq!(server.app.short.n_answers(), 2);
        let get = format!("GET {place} HTTP/1.1\r\nhost: rebound.example\r\nconnection: close\r\n\r\n");
        let post = server.request("/v1/render", "connection: close\r\n", &mesh(2).to_string());
        let post = post.replace(&server.address.to_string(), "rebound.example");
        for request in [get, post] {
            let answer = rest(server.said(&request).await).await;
            assert!(answer.starts_with("HTTP/1.1 403"), "{answer}");
        }
    });
}

#[test]
fn an_artifact_that_left_takes_its_remembered_answer_with_it() {
    story(settings(), async |server| {
        let made = server.render(&mesh(2)).await.ok();
        let place = made.header("content-location");
        for _ in 0..3 {
            server.render(&mesh(2)).await.ok();
            server.get(place).await.ok();
        }
        let key = Key::parse(made.header("etag").trim_matches('"')).unwrap();
        server.app.desk.tiers.remove(&key).unwrap();
        server.get(place).await.problem(404, "not-found");
        assert_eq!(server.render(&mesh(2)).await.ok().header("cache-status"), "planish; fwd=miss; stored");
        for _ in 0..3 {
            let again = server.get(place).await.ok();
            assert_eq!((again.header("cache-status"), &again.body), ("planish; hit", &made.body));
        }
    });
}
