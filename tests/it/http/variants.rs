//! Compressed variants of results: negotiated, made once, each with its own ETag.

use std::io::Read;

use axum::http::Method;
use planish::config::Settings;
use serde_json::Value;

use super::jobs::{mesh, polygon, with};
use super::server::{Answer, Server, settings, story};

const CODINGS: [(&str, &str); 3] = [("zstd", "-zst"), ("br", "-br"), ("gzip", "-gz")];

fn inflated(coding: &str, bytes: &[u8]) -> Vec<u8> {
    let mut plain = Vec::new();
    match coding {
        "zstd" => zstd::stream::read::Decoder::new(bytes).unwrap().read_to_end(&mut plain),
        "br" => brotli::Decompressor::new(bytes, 4096).read_to_end(&mut plain),
        "gzip" => flate2::read::GzDecoder::new(bytes).read_to_end(&mut plain),
        _ => panic!("{coding}"),
    }
    .unwrap();
    plain
}

async fn render(server: &Server, job: &Value, codings: &str) -> Answer {
    server.post_with("/v1/render", job, &[("accept-encoding", codings)]).await.ok()
}

/// Returns the number of kept results and variants.
fn kept(server: &Server) -> u64 {
    server.app.desk.tiers.usage().iter().map(|(_, usage)| usage.artifacts).sum()
}

#[test]
fn a_result_is_answered_in_the_coding_that_is_asked_for() {
    story(settings(), async |server| {
        for format in ["glb", "obj", "json", "ply", "gltf", "stl"] {
            let job = with(mesh(4), format);
            let plain = server.render(&job).await.ok();
            assert_eq!(plain.header("content-encoding"), "");
            assert_eq!(plain.header("vary"), "accept, accept-encoding");
            let place = plain.header("content-location");
            let tag = plain.header("etag").trim_matches('"');
            for (coding, suffix) in CODINGS {
                let header = [("accept-encoding", coding)];
                for answer in [
                    server.get_with(place, &header).await.ok(),
                    server.get_with(place, &header).await.ok(),
                    render(server, &job, coding).await,
                    render(server, &job, coding).await,
                    render(server, &job, coding).await,
                ] {
                    assert_eq!(answer.header("content-encoding"), coding, "{format}");
                    assert_eq!(answer.header("etag"), format!("\"{tag}{suffix}\""));
                    assert_eq!(answer.header("vary"), "accept, accept-encoding");
                    assert_eq!(answer.header("content-location"), place);
                    assert_eq!(answer.header("content-type"), plain.header("content-type"));
                    assert_eq!(answer.header("content-length"), answer.body.len().to_string());
                    assert!(answer.body.len() < plain.body.len() * 7 / 8, "{format} by {coding}");
                    assert_eq!(inflated(coding, &answer.body), plain.body, "{format} by {coding}");
                }
                let head = server.ask(Method::HEAD, place, &header, Vec::new()).await.ok();
                assert_eq!(head.header("etag"), format!("\"{tag}{suffix}\""));
            }
        }
    });
}

#[test]
fn a_variant_is_made_once_and_the_first_request_has_it() {
    story(settings(), async |server| {
        let job = with(mesh(4), "obj");
        let first = render(server, &job, "br").await;
        assert_eq!(first.header("content-encoding"), "br");
        assert_eq!(first.header("cache-status"), "planish; fwd=miss; stored");
        let before = kept(server);
        for _ in 0..3 {
            let again = render(server, &job, "br").await;
            assert_eq!((again.header("cache-status"), &again.body), ("planish; hit", &first.body));
        }
        assert_eq!(kept(server), before);
        render(server, &job, "zstd").await;
        assert_eq!(kept(server), before + 1, "the result itself is not made again");
    });
}

#[test]
fn the_client_says_which_coding_it_likes_best() {
    story(settings(), async |server| {
        let job = with(mesh(3), "obj");
        for (said, coding) in [
            ("gzip, deflate, br, zstd", "zstd"),
            ("gzip, deflate, br", "br"),
            ("gzip;q=1.0, br;q=0.9, zstd;q=0.8", "gzip"),
            ("GZIP", "gzip"),
            ("br;q=0.5, gzip;q=0.5", "br"),
            ("zstd;q=0, *", "br"),
            ("*", "zstd"),
            ("identity", ""),
            ("identity;q=0, gzip;q=0.1", "gzip"),
            ("identity, gzip;q=0.5", ""),
            ("gzip;q=0", ""),
            ("deflate, compress", ""),
            ("", ""),
            ("gzip;q=nan", ""),
        ] {
            for _ in 0..3 {
                assert_eq!(render(server, &job, said).await.header("content-encoding"), coding, "{said}");
            }
        }
    });
}

#[test]
fn whoever_has_any_form_of_a_result_has_it() {
    story(settings(), async |server| {
        let job = with(mesh(3), "stl");
        let plain = server.render(&job).await.ok();
        let (place, tag) = (plain.header("content-location"), plain.header("etag").trim_matches('"'));
        for suffix in ["", "-zst", "-br", "-gz"] {
            let known = format!("\"{tag}{suffix}\"");
            let headers = [("if-none-match", known.as_str()), ("accept-encoding", "br")];
            for answer in [server.get_with(place, &headers).await, server.post_with("/v1/render", &job, &headers).await]
            {
                assert_eq!((answer.status, answer.header("etag")), (304, known.as_str()));
                assert_eq!(answer.header("vary"), "accept, accept-encoding");
                assert_eq!(answer.header("content-encoding"), "");
            }
        }
        let other = format!("\"{tag}-xz\"");
        let headers = [("if-none-match", other.as_str()), ("accept-encoding", "br")];
        server.get_with(place, &headers).await.ok();
        assert_eq!(kept(server), 2, "the result and one variant: no other was made for a 304");
    });
}

#[test]
fn ranges_are_those_of_the_variant() {
    story(settings(), async |server| {
        let plain = server.render(&with(mesh(4), "obj")).await.ok();
        let place = plain.header("content-location");
        let whole = server.get_with(place, &[("accept-encoding", "gzip")]).await.ok();
        let n = whole.body.len();
        let range = ("range", "bytes=10-29");
        let headers = [range, ("accept-encoding", "gzip"), ("if-range", whole.header("etag"))];
        let part = server.get_with(place, &headers).await;
        assert_eq!((part.status, &part.body[..]), (206, &whole.body[10..30]));
        assert_eq!(part.header("content-range"), format!("bytes 10-29/{n}"));
        assert_eq!(part.header("content-encoding"), "gzip");
        let headers = [range, ("accept-encoding", "gzip"), ("if-range", plain.header("etag"))];
        assert_eq!(server.get_with(place, &headers).await.ok().body, whole.body, "the bytes of another form");
        assert_eq!(server.get_with(place, &[range]).await.body, plain.body[10..30]);
    });
}

#[test]
fn what_does_not_pay_stays_as_it_is() {
    story(settings(), async |server| {
        let tiny = render(server, &with(polygon(1), "json"), "gzip").await;
        assert!(tiny.body.len() < 1 << 10 && tiny.header("content-encoding").is_empty());
        let picture = render(server, &with(mesh(3), "png"), "gzip").await;
        assert_eq!((picture.header("content-encoding"), kept(server)), ("", 2), "no variant was tried");
    });
}

#[test]
fn a_result_that_is_not_kept_is_sent_as_it_is() {
    story(Settings { keep_at_most_bytes: 1 << 10, ..settings() }, async |server| {
        let stream = render(server, &with(mesh(4), "stl"), "gzip").await;
        assert_eq!((stream.header("content-encoding"), stream.header("accept-ranges")), ("", "none"));
    });
}

#[test]
fn a_variant_is_no_artifact_of_its_own() {
    story(settings(), async |server| {
        let made = render(server, &with(mesh(3), "obj"), "zstd").await;
        let key = made.header("content-location").rsplit('/').next().unwrap();
        let key = planish::job::key::Key::parse(key.split('.').next().unwrap()).unwrap();
        let variant = planish::service::variant::Coding::Zstd.key(&key);
        assert!(server.app.desk.tiers.at_hand(&variant).is_some());
        for extension in ["obj", "glb", "json"] {
            server.get(&format!("/v1/artifacts/{variant}.{extension}")).await.problem(404, "not-found");
        }
    });
}

#[test]
fn while_all_threads_are_busy_a_kept_result_is_answered_as_it_is() {
    story(settings(), async |server| {
        let job = with(mesh(3), "obj");
        let plain = server.render(&job).await.ok();
        let held = server.hold().await;
        let meanwhile = render(server, &job, "gzip").await;
        assert_eq!((meanwhile.header("content-encoding"), &meanwhile.body), ("", &plain.body));
        drop(held);
        while render(server, &job, "gzip").await.header("content-encoding") != "gzip" {}
    });
}
