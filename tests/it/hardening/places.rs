//! Places: no work blocks the event loop, the lanes or the memory of a lane for others.

use std::time::Duration;

use planish::config::Settings;
use planish::service::peer::Peer;
use planish::service::pool::Lane;
use serde_json::json;
use tokio::io::AsyncWriteExt;

use crate::http::jobs::{endless, mesh, polygon, with};
use crate::http::server::{rest, settings, story, until};

#[test]
fn m2_a_long_job_that_waits_for_memory_does_not_hold_short_ones_up() {
    story(settings(), async |server| {
        let pool = &server.app.desk.pool;
        let all = u128::from(server.app.desk.account.long.capacity);
        let held = pool.compute_place(Lane::Long, pool.line_up(Lane::Long, Peer::SELF, all).unwrap()).await;
        let waiting = pool.line_up(Lane::Long, Peer::SELF, all).unwrap();
        assert_eq!(pool.waiting(), [0, 1]);
        server.render(&mesh(2)).await.ok();
        drop(held);
        drop(pool.compute_place(Lane::Long, waiting).await);
    });
}

#[test]
fn h3_work_that_takes_longer_than_a_second_moves_to_the_long_lane() {
    story(settings(), async |server| {
        // with no patience in the short lane, all work that begins there is restarted in the long one
        let desk = &server.app.desk;
        let task = slow::Task::new();
        let interest = desk.compute(task.clone(), Peer::SELF).unwrap();
        until("it runs in the short lane", || task.runs() == 1).await;
        until("it has begun again in the long one", || task.runs() == 2).await;
        assert_eq!(desk.account.short.usage().taken, 0, "its place in the short lane is free");
        assert!(desk.account.long.usage().taken > 0);
        server.render(&mesh(2)).await.ok();
        task.end();
        assert!(interest.computation.finished().await.is_final());
        assert_eq!(task.runs(), 2, "and nothing is begun a third time");
    });
}

#[test]
fn h3_work_that_moves_finds_the_long_lane_full_and_says_so() {
    story(Settings { max_queue: 1, max_queue_per_peer: 1, ..settings() }, async |server| {
        let desk = &server.app.desk;
        let long = server.turn(Lane::Long).await;
        let waiting = desk.pool.line_up(Lane::Long, Peer::SELF, 0).unwrap();
        let task = slow::Task::new();
        let peer = Peer::new([10, 0, 0, 1].into());
        let interest = desk.compute(task.clone(), peer).unwrap();
        let ended = interest.computation.finished().await;
        assert!(format!("{ended:?}").contains("Busy"), "{ended:?}");
        drop((long, waiting));
    });
}

#[test]
fn c3_requests_are_read_few_at_once_while_health_goes_on() {
    story(settings(), async |server| {
        let held = server.turn(Lane::Reading).await;
        let request = server.request("/v1/render", "connection: close\r\n", &mesh(1).to_string());
        let mut clients = Vec::new();
        for n in 1..=5 {
            clients.push(server.said(&request).await);
            until("it waits", || server.app.desk.pool.waiting_to_be_read() == n).await;
        }
        assert_eq!(server.get("/livez").await.status, 200);
        assert_eq!(server.app.desk.n_under_way(), 0);
        drop(held);
        for client in clients {
            assert!(rest(client).await.starts_with("HTTP/1.1 200"));
        }
    });
}

#[test]
fn c3_a_client_that_leaves_while_it_waits_to_be_read_leaves_the_line() {
    story(settings(), async |server| {
        let held = server.turn(Lane::Reading).await;
        let client = server.said(&server.request("/v1/render", "", &mesh(1).to_string())).await;
        until("it waits", || server.app.desk.pool.waiting_to_be_read() == 1).await;
        drop(client);
        until("it has left", || server.app.desk.pool.waiting_to_be_read() == 0).await;
        drop(held);
    });
}

#[test]
fn m4_short_bodies_are_read_and_checked_off_the_event_loop_like_long_ones() {
    let tiny = json!({ "input": { "text": { "format": "gltf", "data": "{}" } }, "levels": 0 });
    let asks =
        [("/v1/render", mesh(0)), ("/v1/estimate", mesh(0)), ("/v1/validate", tiny.clone()), ("/v1/render", tiny)];
    story(settings(), async |server| {
        for (path, job) in asks {
            let held = server.turn(Lane::Reading).await;
            let client = server.said(&server.request(path, "connection: close\r\n", &job.to_string())).await;
            until("it waits for its lane", || server.app.desk.pool.waiting_to_be_read() == 1).await;
            drop(held);
            assert!(rest(client).await.starts_with("HTTP/1.1 "), "{path}");
        }
    });
}

#[test]
fn h5_the_search_of_a_client_that_leaves_is_stopped_and_refusals_are_remembered() {
    story(settings(), async |server| {
        let mut job = with(mesh(1), "stats");
        job["input"]["mesh"]["positions"][0] = json!([1e6, 1e6, 1e6]);
        job["levels"] = json!({ "tolerance": 0.05 });
        let held = server.hold().await;
        let client = server.said(&server.request("/v1/render", "", &job.to_string())).await;
        until("it waits", || server.app.desk.n_under_way() == 1).await;
        let second = server.said(&server.request("/v1/estimate", "", &job.to_string())).await;
        until("the second has joined", || server.app.desk.n_interests() == 2).await;
        drop((client, second));
        until("the search is given up", || server.app.desk.n_under_way() == 0).await;
        drop(held);
        let mut job = with(polygon(1), "stats");
        job["levels"] = json!({ "tolerance": 1e-300 });
        let first = server.render(&job).await;
        let problem = first.problem(422, "invalid-job");
        assert_eq!(problem["errors"][0]["pointer"], "/levels/tolerance", "{problem}");
        // a remembered failure needs no place
        let held = server.hold().await;
        let again = server.render(&job).await.problem(422, "invalid-job");
        assert_eq!(again["detail"], problem["detail"]);
        drop(held);
    });
}

#[test]
fn a_body_that_arrives_more_slowly_than_at_the_least_rate_is_answered_408() {
    let settings = Settings { body_timeout_s: 1, least_rate_bytes_s: 1 << 30, ..settings() };
    story(settings, async |server| {
        let request = server.request("/v1/render", "connection: close\r\n", &mesh(1).to_string());
        let mut stream = server.said(&request[..request.len() - 200]).await;
        let (mut reader, mut writer) = stream.split();
        // never silent for a second, and never complete
        let dripping = async {
            while writer.write_all(b" ").await.is_ok() {
                tokio::time::sleep(Duration::from_millis(100)).await;
            }
        };
        let mut answer = [0; 12];
        let read = tokio::io::AsyncReadExt::read_exact(&mut reader, &mut answer);
        tokio::select! {
            () = dripping => {}
            read = read => {
                read.unwrap();
                assert_eq!(&answer, b"HTTP/1.1 408");
            }
        }
    });
}

#[test]
fn a_head_has_64_kib_however_it_arrives() {
    story(settings(), async |server| {
        for (length, status) in [(60_000, "200"), (66_000, "431"), (100_000, "431"), (120_000, "431")] {
            let x = "a".repeat(length);
            let mut stream = server
                .said(&format!("GET /livez HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\nx: {}", &x[..30_000]))
                .await;
            let _ = stream.write_all(format!("{}\r\n\r\n", &x[30_000..]).as_bytes()).await;
            let answer = rest(stream).await;
            assert!(
                answer.starts_with(&format!("HTTP/1.1 {status} ")),
                "{length}: {}",
                &answer[..answer.len().min(99)]
            );
        }
    });
}

#[test]
fn refusals_of_the_http_library_are_problems_too() {
    story(settings(), async |server| {
        let long = format!("GET / HTTP/1.1\r\nhost: localhost\r\nx: {}\r\n\r\n", "a".repeat(300_000));
        let many = format!("GET / HTTP/1.1\r\nhost: localhost\r\n{}\r\n", "a: b\r\n".repeat(200));
        let address = format!("GET /{} HTTP/1.1\r\nhost: localhost\r\n\r\n", "a".repeat(70_000));
        for (request, status, kind) in [
            ("GET / HTTP/9.9\r\n\r\n", "400 Bad Request", "not-http"),
            ("\0\0\0\0\r\n\r\n", "400 Bad Request", "not-http"),
            (long.as_str(), "431 Request Header Fields Too Large", "head-too-long"),
            (many.as_str(), "431 Request Header Fields Too Large", "head-too-long"),
            (address.as_str(), "414 URI Too Long", "address-too-long"),
        ] {
            let mut stream = server.connect().await;
            let _ = stream.write_all(request.as_bytes()).await;
            let answer = rest(stream).await;
            assert!(answer.starts_with(&format!("HTTP/1.1 {status}\r\n")), "{kind}: {answer}");
            let (head, body) = answer.split_once("\r\n\r\n").unwrap();
            assert!(head.contains("content-type: application/problem+json"), "{head}");
            assert!(head.contains(&format!("content-length: {}", body.len())), "{head}");
            let problem: serde_json::Value = serde_json::from_str(body).unwrap();
            assert_eq!(problem["type"], format!("/docs/problems/{kind}"));
        }
        // after answers of our own, the refusal is one as well
        let both = "GET /livez HTTP/1.1\r\nhost: localhost\r\n\r\n\u{16}\u{3}\u{1}\r\n\r\n";
        let answer = rest(server.said(both).await).await;
        assert!(answer.starts_with("HTTP/1.1 200") && answer.contains("alive"), "{answer}");
    });
}

#[test]
fn a_computation_that_panics_fails_alone_and_gives_back_what_it_held() {
    story(settings(), async |server| {
        let desk = &server.app.desk;
        let task = slow::Task::new();
        task.panic();
        let interest = desk.compute(task, Peer::SELF).unwrap();
        let ended = format!("{:?}", interest.computation.finished().await);
        assert!(ended.contains("Internal") && ended.contains("a task that panics"), "{ended}");
        until("its memory is back", || desk.account.short.usage().taken == 0).await;
        let read = desk.read(Peer::SELF, 1 << 20, |_| panic!("reading that panics")).await;
        let _: () = read.map_err(|error| assert!(format!("{error:?}").contains("Internal"))).unwrap_or_default();
        assert_eq!(desk.account.reading.usage().taken, 0);
        server.render(&mesh(2)).await.ok();
    });
}

/// A task that is predicted to be quick and runs until it is ended.
mod slow {
    use std::io::Write;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

    use planish::job::key::{Key, content};
    use planish::job::{KeepWork, Report, RunError};
    use planish::service::task::Cost;
    use planish::watch::Watch;

    #[derive(Debug, Default)]
    pub(super) struct Task {
        runs: AtomicU32,
        is_over: AtomicBool,
        panics: AtomicBool,
    }

    impl Task {
        pub(super) fn new() -> Arc<Self> {
            Arc::default()
        }

        pub(super) fn runs(&self) -> u32 {
            self.runs.load(Ordering::SeqCst)
        }

        pub(super) fn panic(&self) {
            self.panics.store(true, Ordering::SeqCst);
        }

        pub(super) fn end(&self) {
            self.is_over.store(true, Ordering::SeqCst);
        }
    }

    impl planish::service::task::Task for Task {
        fn key(&self) -> Key {
            content(b"a slow task")
        }

        fn cost(&self) -> Cost {
            Cost { memory_bytes: 1 << 20, time_ms: 1, work: 1, result_bytes: 1 }
        }

        fn media_type(&self) -> &'static str {
            "text/plain"
        }

        fn run(&self, out: &mut dyn Write, _: &dyn KeepWork, watch: &Watch) -> Result<Report, RunError> {
            self.runs.fetch_add(1, Ordering::SeqCst);
            assert!(!self.panics.load(Ordering::SeqCst), "a task that panics");
            while !self.is_over.load(Ordering::SeqCst) {
                watch.check().map_err(RunError::Stopped)?;
                std::thread::yield_now();
            }
            out.write_all(b"done").map_err(RunError::Io)?;
            Ok(Report::default())
        }
    }
}

/// Long work without waiting clients is stopped, in whatever lane it is.
#[test]
fn long_work_ends_with_the_last_interest() {
    story(settings(), async |server| {
        let client = server.said(&server.request("/v1/render", "", &with(endless(), "stats").to_string())).await;
        until("it runs", || server.app.desk.n_under_way() == 1 && server.app.desk.pool.waiting() == [0, 0]).await;
        drop(client);
        until("it has stopped", || server.app.desk.n_under_way() == 0).await;
        until("its memory is back", || server.app.desk.account.long.usage().taken == 0).await;
    });
}
