//! Bodies that are long, deep or not what their headers claim.

use std::io::Write;

use planish::config::Settings;
use serde_json::json;
use tokio::io::AsyncWriteExt;

use crate::http::jobs::mesh;
use crate::http::server::{rest, settings, story};

#[test]
fn a_mebibyte_of_brackets_is_refused() {
    story(settings(), async |server| {
        for (text, what) in [("[".repeat(1 << 20), "lists"), ("{\"a\":".repeat(1 << 18), "objects")] {
            let answer = server.post_text("/v1/render", text, &[]).await;
            assert!(matches!(answer.status, 400 | 422), "{what}: {}", answer.text());
        }
    });
}

#[test]
fn deep_nesting_is_refused_wherever_it_stands() {
    story(settings(), async |server| {
        let deep = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
        let object = format!("{}1{}", "{\"a\":".repeat(100_000), "}".repeat(100_000));
        for nest in [deep, object] {
            for place in
                ["\"input\": X", "\"plan\": {\"parameters\": {\"delta\": X}}", "\"outputs\": [{\"camera\": X}]"]
            {
                let text = format!("{{{}}}", place.replace('X', &nest));
                let answer = server.post_text("/v1/render", text, &[]).await;
                assert!(matches!(answer.status, 400 | 422), "{}: {}", answer.status, answer.text());
            }
        }
    });
}

#[test]
fn a_body_of_ten_mebibytes_is_answered_413_though_it_is_sent_whole() {
    story(Settings { max_body_bytes: 4 << 20, ..settings() }, async |server| {
        let body = " ".repeat(10 << 20);
        for _ in 0..5 {
            server.post_text("/v1/render", body.clone(), &[]).await.problem(413, "body-too-long");
            let form = [("content-type", "application/x-www-form-urlencoded")];
            server.post_text("/v1/render", body.clone(), &form).await.problem(413, "body-too-long");
            server.post_text("/v1/estimate", body.clone(), &form).await.problem(415, "unsupported-media-type");
        }
    });
}

#[test]
fn a_length_beyond_all_bounds_is_refused_at_once() {
    story(settings(), async |server| {
        let head = "POST /v1/render HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: ";
        for (length, status) in
            [("99999999999999", "413"), ("18446744073709551615", "4"), ("-1", "400"), ("1e3", "400")]
        {
            let answer = rest(server.said(&format!("{head}{length}\r\nconnection: close\r\n\r\n")).await).await;
            assert!(answer.starts_with(&format!("HTTP/1.1 {status}")), "{length}: {answer}");
        }
    });
}

#[test]
fn a_client_that_asks_before_it_sends_is_told_no_before_it_has() {
    story(settings(), async |server| {
        let head = "POST /v1/render HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\n\
                    expect: 100-continue\r\ncontent-length: 99999999\r\n\r\n";
        let answer = rest(server.said(head).await).await;
        assert!(answer.starts_with("HTTP/1.1 413"), "{answer}");
    });
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn zstd(bytes: &[u8]) -> Vec<u8> {
    zstd::bulk::compress(bytes, 3).unwrap()
}

#[test]
fn a_compressed_job_is_the_job() {
    story(settings(), async |server| {
        let job = mesh(2).to_string();
        let plain = server.post_text("/v1/render", job.clone(), &[]).await.ok();
        for (coding, packed) in
            [("gzip", gzip(job.as_bytes())), ("X-GZIP", gzip(job.as_bytes())), ("zstd", zstd(job.as_bytes()))]
        {
            let coding = [("content-encoding", coding)];
            let answer = server.post_text("/v1/render", packed.clone(), &coding).await.ok();
            assert_eq!((answer.header("etag"), &answer.body), (plain.header("etag"), &plain.body));
            server.post_text("/v1/estimate", packed.clone(), &coding).await.ok();
            // a coded body that ends early, or has trailing bytes, is not accepted as a whole
            let more = [&packed[..], b"more"].concat();
            for broken in [&packed[..packed.len() - 5], &more, job.as_bytes()] {
                server.post_text("/v1/render", broken, &coding).await.problem(400, "not-coded");
            }
        }
    });
}

#[test]
fn a_bomb_is_inflated_no_further_than_a_body_may_be_long() {
    let settings = Settings { max_body_bytes: 1 << 20, ..settings() };
    story(settings, async |server| {
        let zeros = vec![b' '; 512 << 20];
        for (coding, bomb) in [("gzip", gzip(&zeros)), ("zstd", zstd(&zeros))] {
            assert!(bomb.len() < 1 << 20, "{} bytes", bomb.len());
            let answer = server.post_text("/v1/render", bomb, &[("content-encoding", coding)]).await;
            let problem = answer.problem(413, "body-too-long");
            assert!(problem["detail"].as_str().unwrap().contains("--max-body-bytes"), "{problem}");
        }
        let bodies = server.app.desk.account.bodies.usage();
        assert_eq!(bodies.taken, 0, "all memory came back");
        assert!(bodies.most <= 4 << 20, "{} bytes were taken for bodies", bodies.most);
    });
}

#[test]
fn a_frame_that_asks_for_a_large_window_is_refused() {
    story(settings(), async |server| {
        // a frame of an empty raw block whose window is 2 GiB
        let frame = [0x28, 0xb5, 0x2f, 0xfd, 0x00, 21 << 3, 0x01, 0x00, 0x00];
        let answer = server.post_text("/v1/render", frame, &[("content-encoding", "zstd")]).await;
        answer.problem(400, "not-coded");
    });
}

#[test]
fn a_body_that_ends_early_is_no_job() {
    story(settings(), async |server| {
        let request = server.request("/v1/render", "", &mesh(1).to_string());
        let mut stream = server.said(&request[..request.len() - 9]).await;
        stream.shutdown().await.unwrap();
        let answer = rest(stream).await;
        assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 400"), "{answer}");
        server.render(&mesh(1)).await.ok();
    });
}

#[test]
fn requests_that_could_be_read_in_two_ways_are_refused() {
    story(settings(), async |server| {
        let head = "POST /v1/render HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\n";
        for (lengths, what) in [
            ("content-length: 2\r\ncontent-length: 3\r\n", "two lengths"),
            ("transfer-encoding: gzip\r\n", "an unknown coding"),
            ("transfer-encoding: chunked, identity\r\n", "chunks inside something"),
        ] {
            let answer = rest(server.said(&format!("{head}{lengths}\r\n{{}}")).await).await;
            assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 4"), "{what}: {answer}");
        }
    });
}

#[test]
fn long_lists_are_refused_in_words_not_in_kind() {
    story(settings(), async |server| {
        let many: Vec<_> = (0..5000).map(|_| json!({ "format": "json" })).collect();
        let mut job = mesh(1);
        job["outputs"] = json!(many);
        server.post("/v1/estimate", &job).await.problem(422, "invalid-job");
        let faults: Vec<_> = (0..20_000).map(|_| json!([0, 0, 0])).collect();
        let mut job = mesh(1);
        job["input"]["mesh"]["faces"] = json!(faults);
        let answer = server.render(&job).await;
        answer.problem(422, "invalid-job");
        assert!(answer.body.len() < 1 << 20, "{} bytes of faults", answer.body.len());
    });
}
