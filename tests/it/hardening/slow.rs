//! Slow clients are disconnected; the others do not notice.

use planish::config::Settings;
use tokio::io::{AsyncReadExt, AsyncWriteExt};

use crate::http::jobs::{mesh, with};
use crate::http::server::{rest, settings, story, until};

/// Returns settings with timeouts of one second.
fn impatient() -> Settings {
    Settings { header_timeout_s: 1, body_timeout_s: 1, least_rate_bytes_s: 100 << 20, ..settings() }
}

#[test]
fn half_a_header_is_not_waited_for() {
    story(impatient(), async |server| {
        let begun = "POST /v1/render HTTP/1.1\r\nhost: localhost\r\ncontent-";
        let answer = rest(server.said(begun).await).await;
        assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 408"), "{answer}");
    });
}

#[test]
fn a_header_that_drips_is_not_waited_for() {
    story(impatient(), async |server| {
        let mut stream = server.said("GET /livez HTTP/1.1\r\nhost: localhost\r\n").await;
        // writes until the server has closed its side, which ends the test
        let dripping = async {
            while stream.write_all(b"x-a: b\r\n").await.is_ok() {
                tokio::time::sleep(std::time::Duration::from_millis(50)).await;
            }
        };
        dripping.await;
    });
}

#[test]
fn a_silent_client_is_let_go() {
    story(impatient(), async |server| {
        assert_eq!(rest(server.connect().await).await, "");
    });
}

#[test]
fn a_client_that_is_silent_after_its_answer_is_let_go() {
    story(impatient(), async |server| {
        let stream = server.said("GET /livez HTTP/1.1\r\nhost: localhost\r\n\r\n").await;
        let answer = rest(stream).await;
        assert!(answer.starts_with("HTTP/1.1 200") && answer.ends_with("alive\n"), "{answer}");
    });
}

#[test]
fn a_body_that_stalls_is_answered_408() {
    story(impatient(), async |server| {
        let request = server.request("/v1/render", "", &mesh(1).to_string());
        let answer = rest(server.said(&request[..request.len() - 9]).await).await;
        assert!(answer.starts_with("HTTP/1.1 408") && answer.contains("/docs/problems/too-slow"), "{answer}");
    });
}

#[test]
fn a_client_that_does_not_read_its_answer_is_let_go() {
    story(impatient(), async |server| {
        // about 30 MB, more than the buffers of a connection take
        let job = with(mesh(8), "json").to_string();
        let request = server.request("/v1/render", "", &job);
        let mut stream = server.said(&request).await;
        let mut first = [0; 12];
        stream.read_exact(&mut first).await.unwrap();
        assert_eq!(&first, b"HTTP/1.1 200");
        until("it is let go", || server.app.connections.n_open() == 0).await;
        drop(stream);
    });
}

#[test]
fn beyond_the_cap_a_connection_takes_the_place_of_the_one_that_is_idle_for_longest() {
    let settings = Settings { max_connections: 2, header_timeout_s: 60, ..settings() };
    story(settings, async |server| {
        let first = server.connect().await;
        until("the first is in", || server.app.connections.n_open() == 1).await;
        let mut second = server.connect().await;
        until("both are in", || server.app.connections.n_open() == 2).await;
        let asked = server.said("GET /livez HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n").await;
        assert!(rest(asked).await.starts_with("HTTP/1.1 200"));
        assert_eq!(rest(first).await, "", "it was idle for longest");
        second.write_all(b"GET /livez HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n").await.unwrap();
        assert!(rest(second).await.starts_with("HTTP/1.1 200"));
    });
}

#[test]
fn many_idle_connections_do_not_keep_others_from_their_answers() {
    let settings = Settings { header_timeout_s: 60, ..settings() };
    story(settings, async |server| {
        let mut idle = Vec::new();
        for _ in 0..300 {
            idle.push(server.said("GET /livez HTTP/1.1\r\nhost: ").await);
        }
        server.render(&mesh(2)).await.ok();
        drop(idle);
    });
}

#[test]
fn requests_in_one_breath_are_answered_in_their_order() {
    story(settings(), async |server| {
        let get = |path: &str, more: &str| format!("GET {path} HTTP/1.1\r\nhost: localhost\r\n{more}\r\n");
        let all = get("/livez", "") + &get("/v1/nothing", "") + &get("/livez", "connection: close\r\n");
        let answer = rest(server.said(&all).await).await;
        let statuses: Vec<&str> = answer.split("HTTP/1.1 ").skip(1).map(|rest| &rest[..3]).collect();
        assert_eq!(statuses, ["200", "404", "200"]);
    });
}

#[test]
fn bytes_that_are_no_http_are_refused() {
    story(settings(), async |server| {
        for nonsense in
            ["\0\0\0\0\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "\u{16}\u{3}\u{1}\u{2}hello tls\r\n\r\n"]
        {
            let answer = rest(server.said(nonsense).await).await;
            assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 4"), "{nonsense:?}: {answer}");
        }
        let long = format!("GET / HTTP/1.1\r\nhost: localhost\r\nx: {}\r\n\r\n", "a".repeat(200_000));
        let mut stream = server.connect().await;
        let _ = stream.write_all(long.as_bytes()).await;
        let answer = rest(stream).await;
        assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 431"), "{answer}");
        until("it goes on", || server.app.desk.n_under_way() == 0).await;
        assert_eq!(server.get("/livez").await.status, 200);
    });
}
