//! Jobs in addresses: the answers are those of POST, and shared caches may keep them.

use std::io::Write;

use axum::http::Method;
use base64::Engine;
use base64::engine::general_purpose::{URL_SAFE, URL_SAFE_NO_PAD};
use serde_json::Value;

use super::jobs::{endless, mesh, polygon, with};
use super::server::{settings, story};

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// Returns the address of a job, which contains it compressed.
fn link(job: &Value) -> String {
    format!("/v1/render?job={}", URL_SAFE_NO_PAD.encode(zlib(job.to_string().as_bytes())))
}

#[test]
fn a_job_in_an_address_has_the_answer_of_the_posted_job() {
    story(settings(), async |server| {
        let job = with(mesh(2), "glb");
        let text = job.to_string();
        let posted = server.render(&job).await.ok();
        let plain = format!("/v1/render?job={}", URL_SAFE_NO_PAD.encode(&text));
        let padded = format!("/v1/render?job={}", URL_SAFE.encode(zlib(text.as_bytes())));
        let kroki = URL_SAFE_NO_PAD.encode(zlib(mesh(2).to_string().as_bytes()));
        for address in [plain, padded, link(&job), format!("/kroki/glb/{kroki}")] {
            for round in 0..3 {
                let got = server.get(&address).await.ok();
                for name in ["etag", "content-location", "content-type", "vary"] {
                    assert_eq!(got.header(name), posted.header(name), "{name} of {address}, {round}");
                }
                assert_eq!(got.header("cache-control"), "public, max-age=86400");
                assert_eq!(got.body, posted.body);
            }
            let head = server.ask(Method::HEAD, &address, &[], Vec::new()).await.ok();
            assert_eq!(head.header("content-length"), posted.body.len().to_string());
            assert_eq!((head.header("etag"), head.body.len()), (posted.header("etag"), 0));
            let known = server.get_with(&address, &[("if-none-match", posted.header("etag"))]).await;
            assert_eq!((known.status, known.header("etag")), (304, posted.header("etag")));
            assert_eq!(known.header("cache-control"), "public, max-age=86400");
        }
    });
}

#[test]
fn an_address_that_comes_again_is_answered_the_short_way() {
    story(settings(), async |server| {
        let address = link(&with(polygon(3), "svg"));
        let first = server.get(&address).await.ok();
        assert_eq!(first.header("cache-status"), "planish; fwd=miss; stored");
        server.get(&address).await.ok();
        let known = server.app.short.n_answers();
        assert!(known > 0, "the answer is remembered");
        let again = server.get(&address).await.ok();
        assert_eq!((&again.body, again.header("cache-status")), (&first.body, "planish; hit"));
        let png = server.get_with(&link(&polygon(3)), &[("accept", "image/png")]).await.ok();
        assert_eq!(png.header("content-type"), "image/png", "Accept chooses where the job does not");
    });
}

#[test]
fn what_is_wrong_with_an_address_is_told() {
    story(settings(), async |server| {
        for (address, what) in [
            ("/v1/render", "says no job"),
            ("/v1/render?jop=e30", "says no job"),
            ("/v1/render?job=%20%20", "base64url"),
            ("/v1/render?job=AAAA", "neither JSON nor compressed by zlib"),
        ] {
            let problem = server.get(address).await.problem(422, "invalid-job");
            assert_eq!(problem["errors"][0]["pointer"], "?job", "{problem}");
            assert!(problem["detail"].as_str().unwrap().contains(what), "{problem}");
        }
        let mut typo = with(polygon(1), "svg");
        typo["levles"] = 2.into();
        let problem = server.get(&link(&typo)).await.problem(422, "invalid-job");
        assert_eq!(problem["errors"][0]["pointer"], "/levles");
        let half = format!("/v1/render?job={}", URL_SAFE_NO_PAD.encode("{\"input\": "));
        server.get(&half).await.problem(400, "not-json");
        let data = URL_SAFE_NO_PAD.encode(zlib(with(polygon(1), "svg").to_string().as_bytes()));
        let problem = server.get(&format!("/kroki/svg/{data}")).await.problem(422, "invalid-job");
        assert_eq!(problem["errors"][0]["pointer"], "/outputs");
        server.get(&format!("/kroki/graphviz/{data}")).await.problem(404, "not-found");
        server.get("/kroki/svg/%ff").await.problem(404, "not-found");
        let polygon = URL_SAFE_NO_PAD.encode(zlib(polygon(1).to_string().as_bytes()));
        server.get(&format!("/kroki/stl/{polygon}")).await.problem(422, "invalid-job");
    });
}

#[test]
fn addresses_are_bounded_as_they_come_and_inflated() {
    story(settings(), async |server| {
        let long = format!("/v1/render?job={}", "A".repeat(8 << 10));
        server.get(&long).await.problem(414, "address-too-long");
        server.get(&format!("/kroki/svg/{}", "A".repeat(9 << 10))).await.problem(414, "address-too-long");
        let bomb = [&b"{\"input\":"[..], &vec![b' '; 5 << 20]].concat();
        let address = format!("/v1/render?job={}", URL_SAFE_NO_PAD.encode(zlib(&bomb)));
        assert!(address.len() < 8 << 10, "{} bytes", address.len());
        server.get(&address).await.problem(413, "body-too-long");
    });
}

#[test]
fn nothing_but_the_result_is_answered_as_a_picture() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let address = link(&with(endless(), "svg"));
        let answer = server.get_with(&address, &[("prefer", "wait=0")]).await;
        answer.problem(503, "not-finished");
        assert!(answer.header("retry-after").parse::<u64>().unwrap() >= 1);
        assert_eq!(answer.header("cache-control"), "no-store");
        let address = link(&with(polygon(2), "svg"));
        server.get_with(&address, &[("prefer", "wait=0")]).await.problem(503, "not-finished");
        drop(held);
        server.app.desk.stop();
        let asked = async || server.get(&address).await;
        while asked().await.status != 200 {}
    });
}
