//! Requirements of browsers: cross-origin rules, compression of texts, a check of the host.

use axum::http::Method;

use super::jobs::mesh;
use super::server::{rest, settings, story};

#[test]
fn a_page_of_the_same_machine_may_post_a_job() {
    story(settings(), async |server| {
        let headers = [
            ("origin", "http://localhost:3000"),
            ("access-control-request-method", "POST"),
            ("access-control-request-headers", "content-type,if-none-match,prefer"),
        ];
        let preflight = server.ask(Method::OPTIONS, "/v1/render", &headers, Vec::new()).await.ok();
        assert_eq!(preflight.header("access-control-allow-origin"), "http://localhost:3000");
        assert!(preflight.header("access-control-allow-methods").contains("POST"));
        let allowed = preflight.header("access-control-allow-headers");
        for header in ["content-type", "accept", "if-none-match", "range", "if-range", "prefer"] {
            assert!(allowed.contains(header), "{header} of {allowed}");
        }
        assert!(preflight.header("access-control-max-age").parse::<u64>().unwrap() > 0);
    });
}

#[test]
fn a_page_that_may_ask_may_read_the_headers_of_answers() {
    story(settings(), async |server| {
        let origin = [("origin", "http://127.0.0.1:3000")];
        let made = server.post_with("/v1/render", &mesh(1), &origin).await.ok();
        let refused = server.get_with("/v1/nothing", &origin).await;
        for answer in [&made, &refused] {
            assert_eq!(answer.header("access-control-allow-origin"), origin[0].1);
            let exposed = answer.header("access-control-expose-headers").to_ascii_lowercase();
            for header in [
                "etag",
                "location",
                "content-location",
                "cache-status",
                "server-timing",
                "retry-after",
                "planish-warnings",
            ] {
                assert!(exposed.split(',').any(|name| name.trim() == header), "{header} of {exposed}");
            }
            assert_eq!(answer.header("x-content-type-options"), "nosniff");
        }
        assert_eq!(made.header("cross-origin-resource-policy"), "cross-origin");
    });
}

#[test]
fn text_answers_are_compressed_for_clients_that_ask() {
    story(settings(), async |server| {
        let gzip = [("accept-encoding", "gzip")];
        for path in ["/openapi.json", "/v1/presets", "/v1/formats", "/v1/limits"] {
            let answer = server.get_with(path, &gzip).await.ok();
            assert_eq!(answer.header("content-encoding"), "gzip", "{path}");
            assert_eq!(answer.body[..2], [0x1f, 0x8b], "{path}");
            assert!(answer.header("vary").to_ascii_lowercase().contains("accept-encoding"), "{path}");
            assert_eq!(server.get(path).await.ok().header("content-encoding"), "", "{path}");
        }
        let estimate = server.post_with("/v1/estimate", &mesh(5), &gzip).await.ok();
        assert_eq!(estimate.header("content-encoding"), "gzip");
    });
}

#[test]
fn on_a_loopback_address_only_loopback_names_are_answered() {
    story(settings(), async |server| {
        let port = server.address.port();
        let fine = ["localhost", "LOCALHOST", "127.0.0.1", "127.9.9.9", "[::1]"];
        for host in fine.map(|name| [name.to_owned(), format!("{name}:{port}")]).concat() {
            assert_eq!(server.get_with("/livez", &[("host", &host)]).await.status, 200, "{host}");
        }
        let foreign = [
            "evil.example",
            "evil.example:80",
            "localhost.evil.example",
            "192.168.0.1",
            "127.0.0.1.evil.example",
            "[2001:db8::1]:80",
        ];
        for host in foreign {
            let request = format!("GET /livez HTTP/1.1\r\nhost: {host}\r\nconnection: close\r\n\r\n");
            let answer = rest(server.said(&request).await).await;
            assert!(answer.starts_with("HTTP/1.1 403"), "{host}: {answer}");
            assert!(answer.contains("/docs/problems/wrong-host"), "{host}: {answer}");
        }
    });
}
