//! A request names one host, with or without a port, and uses no transfer coding other than chunked.

use std::net::SocketAddr;

use planish::config::Settings;

use crate::http::jobs::{mesh, with};
use crate::http::server::{Server, rest, settings, story};

/// Sends the first lines of a request; returns the status and the text of the answer.
async fn said(server: &Server, lines: &str) -> (String, String) {
    let answer = rest(server.said(&format!("{lines}connection: close\r\n\r\n")).await).await;
    (answer.chars().skip(9).take(3).collect(), answer)
}

/// Values of `Host` that are not a host with or without a port.
const MALFORMED: [&str; 20] = [
    "[::1]evil.example",
    "[::1]evil.example:80",
    "[::1]]",
    "[::1",
    "::1",
    "[localhost]",
    "[127.0.0.1]",
    "localhost:evil",
    "localhost:80:80",
    "localhost:+80",
    "localhost:65536",
    "localhost: 80",
    "user@localhost",
    "localhost/",
    "localhost#",
    "localhost, localhost",
    "local host",
    "http://localhost",
    "",
    ":80",
];

#[test]
fn l_what_is_no_host_with_or_without_a_port_is_refused() {
    for listen in [[127, 0, 0, 1], [0, 0, 0, 0]] {
        let settings = Settings { listen: SocketAddr::from((listen, 0)), without_keys: true, ..settings() };
        story(settings, async |server| {
            for host in MALFORMED {
                let (status, answer) = said(server, &format!("GET /livez HTTP/1.1\r\nhost: {host}\r\n")).await;
                assert_eq!(status, "400", "{host:?}: {answer}");
                assert!(answer.contains("/docs/problems/bad-host"), "{host:?}: {answer}");
            }
            for host in ["localhost", "localhost:", "LocalHost:65535", "127.0.0.1:1", "[::1]", "[::1]:8080", "[0::1]"] {
                let (status, answer) = said(server, &format!("GET /livez HTTP/1.1\r\nhost: {host}\r\n")).await;
                assert_eq!(status, "200", "{host:?}: {answer}");
            }
        });
    }
}

#[test]
fn l_a_request_has_one_host() {
    story(settings(), async |server| {
        for lines in ["", "host: localhost\r\nhost: localhost\r\n", "host: localhost\r\nhost: evil.example\r\n"] {
            let (status, answer) = said(server, &format!("GET /livez HTTP/1.1\r\n{lines}")).await;
            assert_eq!(status, "400", "{lines}: {answer}");
            assert!(answer.contains("/docs/problems/bad-host"), "{lines}: {answer}");
        }
        // HTTP/1.0 has no such header, and browsers do not use it
        assert_eq!(said(server, "GET /livez HTTP/1.0\r\n").await.0, "200");
        assert_eq!(said(server, "GET /livez HTTP/1.0\r\nhost: evil.example\r\n").await.0, "403");
    });
}

#[test]
fn l_an_absolute_address_is_checked_like_the_header() {
    story(settings(), async |server| {
        for (target, status) in [
            ("http://localhost/livez", "200"),
            ("http://127.0.0.1:80/livez", "200"),
            ("http://evil.example/livez", "403"),
            ("http://user@localhost/livez", "400"),
        ] {
            let (found, answer) = said(server, &format!("GET {target} HTTP/1.1\r\nhost: localhost\r\n")).await;
            assert_eq!(found, status, "{target}: {answer}");
        }
    });
}

#[test]
fn l_a_transfer_coding_other_than_chunked_is_refused_and_not_read_as_json() {
    story(settings(), async |server| {
        let job = with(mesh(1), "stats").to_string();
        let chunks = format!("{:x}\r\n{job}\r\n0\r\n\r\n", job.len());
        let ask = async |codings: &str| {
            let lines = format!(
                "POST /v1/render HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\nconnection: close\r\n\
                 {codings}\r\n{chunks}"
            );
            rest(server.said(&lines).await).await
        };
        for fine in ["transfer-encoding: chunked\r\n", "transfer-encoding: Chunked\r\n"] {
            let answer = ask(fine).await;
            assert!(answer.starts_with("HTTP/1.1 200"), "{fine}: {answer}");
        }
        for foreign in [
            "transfer-encoding: gzip, chunked\r\n",
            "transfer-encoding: gzip\r\ntransfer-encoding: chunked\r\n",
            "transfer-encoding: identity, chunked\r\n",
        ] {
            let answer = ask(foreign).await;
            assert!(answer.starts_with("HTTP/1.1 501"), "{foreign}: {answer}");
            assert!(answer.contains("/docs/problems/unknown-transfer-coding"), "{foreign}: {answer}");
        }
    });
}
