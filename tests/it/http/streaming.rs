//! Large results are sent while they are made, and kept only on request.

use axum::http::Method;
use planish::config::Settings;
use serde_json::{Value, json};
use tokio::io::AsyncReadExt;

use super::jobs::{mesh, with};
use super::server::{Server, settings, story, until};

/// Returns the settings of a server that keeps results of at most 10,000 bytes.
fn small() -> Settings {
    Settings { keep_at_most_bytes: 10_000, ..settings() }
}

/// Returns the bytes of memory that computations of the long lane hold, and the number of free stream places.
fn long(server: &Server) -> (u64, usize) {
    (server.app.desk.account.long.usage().taken, server.app.desk.pool.free_stream_places())
}

#[test]
fn a_large_result_is_sent_as_it_is_and_not_kept() {
    let whole = story(settings(), async |server| {
        let whole = server.render(&with(mesh(4), "ply")).await.ok();
        assert_eq!(whole.header("cache-status"), "planish; fwd=miss; stored");
        whole
    });
    story(small(), async |server| {
        for _ in 0..2 {
            let streamed = server.render(&with(mesh(4), "ply")).await.ok();
            assert_eq!(streamed.body, whole.body);
            assert_eq!(streamed.header("cache-status"), "planish; fwd=miss");
            assert_eq!(streamed.header("content-length"), whole.body.len().to_string());
            for same in ["etag", "content-type", "vary", "content-security-policy"] {
                assert_eq!(streamed.header(same), whole.header(same), "{same}");
            }
            assert_eq!((streamed.header("accept-ranges"), streamed.header("content-location")), ("none", ""));
        }
        server.get(whole.header("content-location")).await.problem(404, "not-found");
        let small = server.render(&with(mesh(1), "ply")).await.ok();
        assert_eq!(small.header("cache-status"), "planish; fwd=miss; stored");
        until("everything is given back", || long(server) == (0, 1)).await;
    });
}

#[test]
fn text_of_unknown_length_comes_in_chunks() {
    story(small(), async |server| {
        let text = server.render(&with(mesh(4), "obj")).await.ok();
        assert_eq!((text.header("content-length"), text.header("transfer-encoding")), ("", "chunked"));
        assert!(text.text().starts_with("# planish\nv ") && text.text().ends_with('\n'));
    });
}

#[test]
fn a_large_result_is_kept_where_the_request_asks_for_it() {
    story(small(), async |server| {
        let job = with(mesh(4), "ply");
        let kept = server.post("/v1/render?keep=true", &job).await.ok();
        assert_eq!(kept.header("cache-status"), "planish; fwd=miss; stored");
        let again = server.render(&job).await.ok();
        assert_eq!((again.header("cache-status"), &again.body), ("planish; hit", &kept.body));
        assert_eq!(server.get(kept.header("content-location")).await.ok().body, kept.body);

        let held = server.hold().await;
        let later = server.post_with("/v1/render", &with(mesh(4), "obj"), &[("prefer", "respond-async")]).await;
        assert_eq!(later.status, 202, "{}", later.text());
        drop(held);
        assert_eq!(server.settled(later.header("location")).await["state"], "done");
        assert_eq!(server.render(&with(mesh(4), "obj")).await.ok().header("cache-status"), "planish; hit");
    });
}

#[test]
fn a_result_for_which_there_is_no_memory_is_sent_but_not_kept() {
    let settings = Settings { max_job_bytes: 400 << 20, max_faces: 1 << 30, max_vertices: 1 << 30, ..small() };
    story(settings, async |server| {
        let job = with(mesh(11), "ply");
        let refused = server.post("/v1/render?keep=true", &job).await.problem(422, "too-large");
        assert!(refused["detail"].as_str().unwrap().contains("keep=true"), "{refused}");
        let request = server.client.post(server.url("/v1/render")).body(job.to_string());
        let mut answer = request.header("content-type", "application/json").send().await.unwrap();
        assert_eq!(answer.status(), 200);
        assert!(answer.content_length().unwrap() > 1_000_000_000);
        assert!(answer.chunk().await.unwrap().unwrap().starts_with(b"ply\n"));
        // a client that disconnects stops the work
        drop(answer);
        until("the work has ended", || long(server) == (0, 1)).await;
    });
}

#[test]
fn a_client_that_does_not_read_holds_no_place() {
    let settings = Settings { max_faces: 1 << 30, max_vertices: 1 << 30, ..small() };
    story(settings, async |server| {
        let mut stream = server.said(&server.request("/v1/render", "", &with(mesh(10), "ply").to_string())).await;
        let mut head = [0; 12];
        stream.read_exact(&mut head).await.unwrap();
        assert_eq!(&head, b"HTTP/1.1 200");
        until("the stream waits for its client", || long(server).1 == 1).await;
        assert!(long(server).0 > 0);
        // other requests are streamed meanwhile
        let other = server.render(&with(mesh(4), "ply")).await.ok();
        assert_eq!(other.header("cache-status"), "planish; fwd=miss");
        drop(stream);
        until("the work has ended", || long(server) == (0, 1)).await;
    });
}

/// Returns a plane of 200 x 200 vertices, one of which has a coordinate that f32 cannot hold.
fn broken(at: usize) -> Value {
    let n = 200;
    let mut positions: Vec<[f64; 3]> = Vec::new();
    for i in 0..n * n {
        let place = |x: usize| f64::from(u32::try_from(x).unwrap());
        positions.push([place(i % n), place(i / n), if i == at { 1e39 } else { 0.0 }]);
    }
    let cells = (0..n - 1).flat_map(|j| (0..n - 1).map(move |i| j * n + i));
    let faces: Vec<_> = cells.map(|v| [v, v + 1, v + n + 1, v + n]).collect();
    json!({ "input": { "mesh": { "positions": positions, "faces": faces } },
        "outputs": [{ "format": "ply", "precision": "f32" }] })
}

#[test]
fn what_fails_before_the_first_bytes_is_refused_and_what_fails_later_ends_the_connection() {
    story(small(), async |server| {
        server.render(&broken(0)).await.problem(422, "invalid-job");
        let request = server.client.request(Method::POST, server.url("/v1/render")).body(broken(39_999).to_string());
        let answer = request.header("content-type", "application/json").send().await.unwrap();
        assert_eq!(answer.status(), 200);
        assert!(answer.bytes().await.is_err(), "it looks whole");
        server.render(&broken(0)).await.problem(422, "invalid-job");
        until("everything is given back", || long(server) == (0, 1)).await;
    });
}

#[test]
fn a_solid_is_kept_and_its_certificate_goes_along_however_large_it_was_thought_to_be() {
    story(small(), async |server| {
        let solid = server.render(&with(mesh(0), "step")).await.ok();
        assert!(solid.body.len() > 10_000, "{} bytes", solid.body.len());
        assert!(solid.header("planish-warnings").contains("% of the area exact"), "{:?}", solid.headers);
        assert_eq!(solid.header("cache-status"), "planish; fwd=miss; stored");
    });
}
