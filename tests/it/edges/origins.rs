//! Pages that may send requests: those of the origins in the setting, and by default those of the same machine.

use std::net::SocketAddr;

use axum::http::Method;
use planish::config::{ConfigError, CorsOrigins, PartialSettings, Settings};

use crate::http::jobs::mesh;
use crate::http::server::{Answer, Folder, Server, rest, settings, story};

const LOCAL: [&str; 6] = [
    "http://localhost",
    "https://localhost",
    "http://localhost:5173",
    "https://127.0.0.1:8443",
    "http://[::1]:3000",
    "http://127.0.0.1",
];
const FOREIGN: [&str; 8] = [
    "https://evil.example",
    "http://localhost.evil.example",
    "http://localhost:80.evil.example",
    "http://localhost@evil.example",
    "http://[::1]evil.example",
    "http://192.168.0.1:8080",
    "ftp://localhost",
    "null",
];

fn with_origins(origins: &str) -> Settings {
    Settings { cors_origins: origins.parse().unwrap(), ..settings() }
}

/// Returns the answer to the preflight request of a page of this origin.
async fn preflight(server: &Server, origin: &str) -> Answer {
    let headers = [
        ("origin", origin),
        ("access-control-request-method", "POST"),
        ("access-control-request-headers", "content-type"),
    ];
    server.ask(Method::OPTIONS, "/v1/render", &headers, Vec::new()).await
}

/// Checks that every kind of answer allows the origins in `may`, and refuses those in `may_not`.
async fn check(server: &Server, may: &[&str], may_not: &[&str]) {
    for origin in may.iter().chain(may_not) {
        let header = [("origin", *origin)];
        let answers = [
            preflight(server, origin).await,
            server.get_with("/livez", &header).await,
            server.get_with("/v1/nothing", &header).await,
            server.post_text("/v1/render", "{", &header).await,
            server.post_with("/v1/render", &mesh(1), &header).await,
        ];
        for answer in answers {
            let said = answer.headers.get("access-control-allow-origin").map(|value| value.to_str().unwrap());
            assert_eq!(said, may.contains(origin).then_some(*origin), "{origin}: {}", answer.status);
            let varies =
                answer.headers.get_all("vary").iter().any(|value| value.as_bytes().eq_ignore_ascii_case(b"origin"));
            assert!(varies, "{origin}: {}", answer.status);
        }
    }
}

#[test]
fn m10_on_a_loopback_address_pages_of_the_same_machine_may_ask_and_no_others() {
    story(settings(), async |server| check(server, &LOCAL, &FOREIGN).await);
}

#[test]
fn m10_on_other_addresses_no_page_may_ask_unless_it_is_said() {
    let open = SocketAddr::from(([0, 0, 0, 0], 0));
    let all = [LOCAL.as_slice(), &FOREIGN].concat();
    story(Settings { listen: open, without_keys: true, ..settings() }, async |server| check(server, &[], &all).await);
    let said = Settings { listen: open, without_keys: true, ..with_origins("loopback") };
    story(said, async |server| check(server, &LOCAL, &FOREIGN).await);
}

#[test]
fn m10_the_setting_names_origins_all_or_none() {
    let listed = with_origins("https://example.org, http://shop.example:8080");
    let may = ["https://example.org", "http://shop.example:8080"];
    let may_not = ["http://example.org", "https://example.org:8443", "http://shop.example", "http://localhost"];
    story(listed, async |server| check(server, &may, &may_not).await);
    story(with_origins("none"), async |server| check(server, &[], &LOCAL).await);
    story(with_origins("*"), async |server| {
        for origin in FOREIGN.iter().chain(&LOCAL) {
            let answer = preflight(server, origin).await;
            assert_eq!(answer.header("access-control-allow-origin"), "*");
            assert_eq!(answer.header("vary"), "", "the answer is the same for all origins");
        }
    });
}

#[test]
fn m10_refusals_of_the_guard_can_be_read_by_pages_that_may_ask() {
    story(settings(), async |server| {
        for (host, status) in [("evil.example", 403), ("localhost:evil", 400)] {
            let request = format!(
                "GET /livez HTTP/1.1\r\nhost: {host}\r\norigin: http://localhost:3000\r\nconnection: close\r\n\r\n"
            );
            let answer = rest(server.said(&request).await).await.to_ascii_lowercase();
            assert!(answer.starts_with(&format!("http/1.1 {status}")), "{answer}");
            assert!(answer.contains("access-control-allow-origin: http://localhost:3000\r\n"), "{answer}");
        }
    });
}

#[test]
fn m10_origins_are_read_strictly_and_as_browsers_write_them() {
    let read = |text: &str| text.parse::<CorsOrigins>();
    assert_eq!(read("HTTPS://Example.org:443"), read("https://example.org"));
    assert_eq!(read("http://[::1]:80"), read("http://[::1]"));
    assert_ne!(read("http://example.org:8080"), read("http://example.org"));
    for wrong in ["", "example.org", "https://", "https://example.org/", "https://a@b", "null", "*,none", "http://a:b"]
    {
        let said = read(wrong).unwrap_err();
        assert!(said.contains("is no origin; write none, loopback, *, or origins like https://"), "{wrong}: {said}");
    }
    assert!(read(&"http://a,".repeat(64)).unwrap_err().contains("more than 64"));
    let folder = Folder::new();
    let path = folder.path().join("planish.toml");
    let of_file = |text: &str| -> Result<Settings, ConfigError> {
        std::fs::write(&path, text).unwrap();
        Settings::read(PartialSettings::default(), Some(&path))
    };
    let listed = CorsOrigins::Listed(vec!["http://a".to_owned(), "https://b:1".to_owned()]);
    for text in ["cors-origins = [\"http://a\", \"https://b:1\"]", "cors-origins = \"http://a,https://b:1\""] {
        assert_eq!(of_file(text).unwrap().cors_origins, listed, "{text}");
    }
    assert!(of_file("cors-origins = []").is_err() && of_file("cors-origins = 3").is_err());
}
