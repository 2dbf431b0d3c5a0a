//! The memory account: the memory of requests, records and answers is booked before it is allocated, and returned.

use std::sync::Arc;

use planish::config::Settings;
use planish::service::account::{Account, Full, Share, kept_buffers};
use planish::service::peer::{Peer, QuotaKind};
use planish::service::pool::Lane;
use serde_json::json;
use tokio::io::{AsyncReadExt, AsyncWriteExt};

use crate::http::jobs::{mesh, with};
use crate::http::server::{Server, settings, story, until};

/// Returns settings in which all bodies may take 8 MiB together, and records and waiting inputs a little.
fn small() -> Settings {
    Settings { max_memory_bytes: 256 << 20, ..settings() }
}

fn nothing_is_held(server: &Server) -> bool {
    let account = &server.app.desk.account;
    [&account.bodies, &account.reading, &account.inputs, &account.short, &account.long, &account.answers]
        .iter()
        .all(|share| share.usage().taken == 0)
}

#[test]
fn the_shares_of_the_account_come_to_no_more_than_the_whole() {
    for (total, cache) in [(256 << 20, 512 << 20), (2 << 30, 512 << 20), (12 << 30, 512 << 20), (1 << 50, 0)] {
        let account = Account::new(total, cache);
        let shares: u64 = account.shares().iter().map(|share| share.capacity).sum();
        let kept = account.cache_bytes + account.uploads_bytes + account.work_bytes + kept_buffers(total);
        assert_eq!(shares + kept, total, "nothing is given twice, and nothing is lost");
        assert!(account.cache_bytes <= total / 4 && account.long.capacity > total * 2 / 5);
    }
    assert!(Account::new(12 << 30, 512 << 20).long.capacity >= 8 << 30, "the default holds the largest job");
}

#[test]
fn a_share_gives_only_what_it_has_and_serves_those_who_wait_in_their_order() {
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    runtime.block_on(async {
        let share = Arc::new(Share::new("test", 100));
        let mut first = share.try_take(60).unwrap();
        assert_eq!(share.try_take(50).unwrap_err(), Full);
        assert_eq!(first.grow(41), Err(Full));
        first.grow(10).unwrap();
        let large = tokio::spawn({
            let share = share.clone();
            async move { share.take(90).await }
        });
        tokio::task::yield_now().await;
        assert_eq!(share.try_take(1).unwrap_err(), Full, "whoever waits comes first");
        let small = tokio::spawn({
            let share = share.clone();
            async move { share.take(5).await }
        });
        tokio::task::yield_now().await;
        first.shrink_to(20);
        assert!(!large.is_finished() && !small.is_finished(), "80 are free, and the first who waits wants 90");
        large.abort();
        assert!(large.await.is_err());
        drop(first);
        assert_eq!(small.await.unwrap().bytes(), 5, "whoever has left is passed by");
        let usage = share.usage();
        assert_eq!((usage.taken, usage.most, usage.refused), (0, 70, 3));
    });
}

#[test]
fn work_that_waits_for_the_memory_of_its_lane_is_not_counted_as_refused() {
    story(Settings { threads: 4, ..settings() }, async |server| {
        let (pool, share) = (&server.app.desk.pool, &server.app.desk.account.long);
        let line_up = || pool.line_up(Lane::Long, Peer::SELF, share.capacity.into()).unwrap();
        let first = pool.compute_place(Lane::Long, line_up()).await;
        let second = line_up();
        assert_eq!(pool.waiting(), [0, 1], "a place is free, but no memory");
        drop(first);
        let second = pool.compute_place(Lane::Long, second).await;
        assert_eq!((share.usage().taken, share.usage().refused), (share.capacity, 0));
        drop(second);
    });
}

#[test]
fn c2_a_record_holds_the_request_and_not_the_input() {
    story(small(), async |server| {
        let job = with(mesh(1), "stats");
        let held = server.hold().await;
        let first = server.post_with("/v1/render", &job, &[("prefer", "respond-async")]).await;
        assert_eq!(first.status, 202);
        drop(held);
        server.settled(first.header("location")).await;
        until("its memory is back", || nothing_is_held(server)).await;
        let records = server.app.desk.account.records.usage().taken;
        assert!(records < 16 << 10, "{records} bytes for a request of {}", job.to_string().len());
    });
}

#[test]
fn c2_records_leave_for_others_and_jobs_under_way_do_not() {
    story(Settings { max_queue_per_peer: 5000, max_queue: 5000, ..small() }, async |server| {
        let account = &server.app.desk.account;
        let held = server.hold().await;
        let mut refused = None;
        for i in 0..1000 {
            let mut job = with(mesh(1), "stats");
            job["input"]["mesh"]["positions"][0][0] = json!(f64::from(i));
            let answer = server.post_with("/v1/render", &job, &[("prefer", "respond-async")]).await;
            if answer.status != 202 {
                refused = Some((i, answer));
                break;
            }
        }
        let (n, answer) = refused.expect("2 MiB hold no thousand records");
        answer.problem(503, "busy");
        assert!(account.records.usage().taken <= account.records.capacity);
        drop(held);
        until("all are done", || server.app.desk.n_under_way() == 0).await;
        let jobs = server.app.desk.jobs.n_known();
        assert!(jobs >= usize::try_from(n).unwrap(), "{jobs} of {n} are known");
        // settled records make room
        let held = server.hold().await;
        let answer = server.post_with("/v1/render", &with(mesh(2), "stats"), &[("prefer", "respond-async")]).await;
        assert_eq!(answer.status, 202, "{}", answer.text());
        drop(held);
    });
}

#[test]
fn h1_bodies_take_from_the_account_as_they_arrive_and_one_peer_gets_half() {
    story(small(), async |server| {
        let bodies = &server.app.desk.account.bodies;
        let whole = format!("{}{}", with(mesh(1), "stats"), " ".repeat(1 << 20));
        let request = server.request("/v1/render", "", &whole);
        let mut short = Vec::new();
        for _ in 0..3 {
            short.push(server.said(&request[..request.len() - 1000]).await);
        }
        until("three bodies are held", || bodies.usage().taken >= 3 << 20).await;
        assert!(bodies.usage().taken < 4 << 20);
        // half of 8 MiB is this peer's share; the rest that it keeps is small enough to be free
        let fourth = crate::http::server::rest(
            server.said(&server.request("/v1/render", "connection: close\r\n", &whole)).await,
        );
        let answer = fourth.await;
        assert!(answer.starts_with("HTTP/1.1 503") && answer.contains("retry-after"), "{answer}");
        server.render(&mesh(1)).await.ok();
        drop(short);
        until("their memory is back", || nothing_is_held(server)).await;
    });
}

#[test]
fn m1_answers_that_are_not_read_hold_no_more_than_their_share() {
    // answers may take 16 MiB, besides the memory of the cache
    let settings = Settings { memory_cache_bytes: 64 << 20, least_rate_bytes_s: 1, ..small() };
    story(settings, async |server| {
        let answers = &server.app.desk.account.answers;
        let mut readers = Vec::new();
        let mut refused = 0;
        for i in 0..10 {
            // 2.1 MB of JSON each, more than the buffers of a connection take
            let mut job = with(mesh(6), "json");
            job["input"]["mesh"]["positions"][0][0] = json!(f64::from(i) / 16.0 - 1.0);
            let mut stream = server.said(&server.request("/v1/render", "", &job.to_string())).await;
            let mut status = [0; 12];
            stream.read_exact(&mut status).await.unwrap();
            refused += u32::from(&status == b"HTTP/1.1 503");
            assert!(answers.usage().taken <= answers.capacity);
            readers.push(stream);
        }
        assert!(answers.usage().taken > 0, "slow readers are paid for");
        assert!(refused > 0, "and without a disk no more of them are let in than there is memory");
        for mut reader in readers {
            reader.shutdown().await.unwrap();
        }
        until("their memory is back", || nothing_is_held(server)).await;
    });
}

#[test]
fn m1_results_that_no_store_takes_are_paid_for_until_they_are_read() {
    let settings = Settings { memory_cache_bytes: 0, least_rate_bytes_s: 1, ..small() };
    story(settings, async |server| {
        let request = server.request("/v1/render", "", &with(mesh(6), "json").to_string());
        let mut stream = server.said(&request).await;
        let mut status = [0; 12];
        stream.read_exact(&mut status).await.unwrap();
        assert_eq!(&status, b"HTTP/1.1 200");
        let account = &server.app.desk.account;
        assert!(account.answers.usage().taken > 2_000_000, "{account:?}");
        drop(stream);
        until("its memory is back", || nothing_is_held(server)).await;
    });
}

#[test]
fn one_peer_gets_half_of_a_share_and_no_more() {
    story(small(), async |server| {
        let desk = &server.app.desk;
        let inputs = &desk.account.inputs;
        let peer = |last| Peer::new([10, 0, 0, last].into());
        let charge = |last, bytes| desk.peers.charge(inputs, QuotaKind::InputBytes, peer(last), bytes);
        let half = inputs.capacity / 2;
        let first = charge(1, half).unwrap();
        assert_eq!(charge(1, 1).unwrap_err(), Full);
        let second = charge(2, half).unwrap();
        assert_eq!(charge(3, 1).unwrap_err(), Full, "all is taken");
        drop(first);
        drop(charge(1, 1).unwrap());
        drop(second);
        assert_eq!((inputs.usage().taken, desk.peers.held(QuotaKind::InputBytes)), (0, 0));
    });
}

#[test]
fn readiness_names_the_share_that_is_full() {
    story(small(), async |server| {
        until("the canary has sung", || server.app.canary.last_success().is_some()).await;
        let ready = server.get("/readyz").await.ok().json();
        let names: Vec<&str> =
            ready["memory"].as_array().unwrap().iter().map(|m| m["name"].as_str().unwrap()).collect();
        assert_eq!(names, ["bodies", "reading", "inputs", "short-lane", "long-lane", "answers", "records"]);
        let inputs = &server.app.desk.account.inputs;
        let held = inputs.try_take(inputs.capacity).unwrap();
        let problem = server.get("/readyz").await.problem(503, "not-ready");
        assert!(problem["detail"].as_str().unwrap().contains("inputs"), "{problem}");
        server.render(&mesh(1)).await.problem(503, "busy");
        drop(held);
        server.render(&mesh(1)).await.ok();
        server.get("/readyz").await.ok();
    });
}
