//! The page for experiments: its files, their headers, and what they may load.

use std::io::Read;

use super::server::{Answer, settings, story};

fn policy(answer: &Answer) -> Vec<String> {
    answer.header("content-security-policy").split("; ").map(str::to_owned).collect()
}

#[test]
fn the_start_page_is_the_page_for_trying_it() {
    story(settings(), async |server| {
        let client = crate::http::server::client_builder().redirect(reqwest::redirect::Policy::none()).build().unwrap();
        let start = Answer::of(client.get(server.url("/")).send().await.unwrap()).await;
        assert_eq!((start.status, start.header("location")), (307, "/play"));
        let page = server.get("/play").await.ok();
        assert_eq!(page.header("content-type"), "text/html; charset=utf-8");
        assert!(page.text().contains("src=\"/play/main.js\""), "{}", page.text());
    });
}

#[test]
fn the_page_runs_scripts_of_its_own_only() {
    story(settings(), async |server| {
        for path in ["/play", "/play/main.js"] {
            let allowed = policy(&server.get(path).await.ok());
            for part in ["default-src 'none'", "script-src 'self'", "style-src 'self'", "connect-src 'self'"] {
                assert!(allowed.iter().any(|known| known == part), "{part} of {allowed:?}");
            }
            assert!(!allowed.concat().contains("unsafe"), "{allowed:?}");
        }
    });
}

#[test]
fn the_files_of_the_page_are_a_closed_list_with_types() {
    story(settings(), async |server| {
        for (name, media_type) in [
            ("main.js", "text/javascript; charset=utf-8"),
            ("planish-view.js", "text/javascript; charset=utf-8"),
            ("play.css", "text/css; charset=utf-8"),
            ("icon.svg", "image/svg+xml"),
            ("cube.json", "application/json"),
        ] {
            let file = server.get(&format!("/play/{name}")).await.ok();
            assert_eq!(file.header("content-type"), media_type, "{name}");
            assert_eq!(file.header("access-control-allow-origin"), "*", "{name}");
        }
        for name in ["", "index.html", "none.js", "..%2fplay.rs", "Main.js"] {
            server.get(&format!("/play/{name}")).await.problem(404, "not-found");
        }
    });
}

#[test]
fn each_form_of_a_file_has_a_strong_etag_that_is_answered_304() {
    story(settings(), async |server| {
        let plain = server.get("/play/main.js").await.ok();
        let gzip = server.get_with("/play/main.js", &[("accept-encoding", "gzip")]).await.ok();
        let zstd = server.get_with("/play/main.js", &[("accept-encoding", "zstd, gzip")]).await.ok();
        assert_eq!((gzip.header("content-encoding"), zstd.header("content-encoding")), ("gzip", "zstd"));
        let mut inflated = Vec::new();
        flate2::read::GzDecoder::new(&gzip.body[..]).read_to_end(&mut inflated).unwrap();
        assert_eq!(inflated, plain.body);
        let tags = [&plain, &gzip, &zstd].map(|answer| answer.header("etag").to_owned());
        assert!(tags[0] != tags[1] && tags[1] != tags[2], "{tags:?}");
        for tag in &tags {
            assert!(tag.starts_with('"'), "{tag} is strong");
            let again = server.get_with("/play/main.js", &[("if-none-match", tag)]).await;
            assert_eq!((again.status, again.header("etag"), again.body.len()), (304, tag.as_str(), 0));
        }
        assert_eq!(plain.header("cache-control"), "no-cache");
        assert!(plain.headers.get_all("vary").iter().any(|value| value == "accept-encoding"));
    });
}

#[test]
fn the_whole_page_is_small() {
    story(settings(), async |server| {
        let gzip = [("accept-encoding", "gzip")];
        let page = server.get_with("/play", &gzip).await.ok();
        let mut sent = page.body.len();
        for name in ["play.css", "main.js", "dom.js", "state.js", "service.js", "curves.js", "pane.js", "scheme.js"] {
            sent += server.get_with(&format!("/play/{name}"), &gzip).await.ok().body.len();
        }
        assert!(sent < 60_000, "{sent} bytes");
    });
}
