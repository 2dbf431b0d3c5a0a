//! Caches without room and failing disks: nothing is computed twice, and the disk reports its trouble.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use planish::job::limits::Limits;
use planish::service::clock::Manual;
use planish::service::computation::Phase;
use planish::service::peer::Peer;
use planish::service::store::PART_BYTES;
use planish::service::task::Render;
use planish::service::tiers::Stored;
use planish::service::tiers::Tiers;
use serde_json::Value;

use super::disk::{app, bytes, make, n, run, written};
use crate::http::jobs::{mesh, with};
use crate::http::server::{Folder, until};
use crate::killed::Service;
use crate::store::faulty::Faulty;
use crate::store::{ROOMY, Scratch, key};
use crate::support;

/// Returns a job whose result takes three parts of a store.
fn job() -> Value {
    with(mesh(7), "json")
}

/// Computes the job over these stores; returns the rows that were made, the bytes, and the counters of the disk.
fn computed(tiers: Tiers) -> (u64, Vec<u8>, [(&'static str, u64); 11]) {
    run(async {
        let (_, app) = app(tiers).await;
        let admitted = Limits::default().admit(support::parsed(job().to_string().as_bytes()).unwrap()).unwrap();
        let interest = app.desk.compute(Arc::new(Render::new(Arc::new(admitted), 0, None)), Peer::SELF).unwrap();
        let Phase::Done(outcome) = interest.computation.finished().await else { panic!("it is done") };
        let kept = Stored { manifest: outcome.manifest.clone(), loose: outcome.loose.clone() };
        let bytes = bytes(&app.desk.tiers, &kept).await.unwrap();
        (interest.computation.watch.done(), bytes, app.desk.tiers.disk_counts().list())
    })
}

/// Under a limit on file sizes, every write fails as on a full disk (the signal is ignored, the error remains).
#[test]
#[cfg(target_os = "linux")]
fn jobs_are_refused_while_the_disk_is_full_and_accepted_again_when_there_is_room() {
    use rustix::process::{Pid, Resource, Rlimit, prlimit};
    let folder = Folder::new();
    let mut command = std::process::Command::new("sh");
    command.args(["-c", "trap '' XFSZ; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_planish")]);
    let service = Service::run(&mut command, &folder.path().join("data"));
    let pid = Pid::from_raw(service.id().cast_signed());
    let room = |bytes: Option<u64>| {
        let _ = prlimit(pid, Resource::Fsize, Rlimit { current: bytes, maximum: None }).unwrap();
    };
    let client = crate::http::server::client_builder().build().unwrap();
    run(async {
        let post = async |levels| {
            let job = with(mesh(levels), "stl");
            let answer = client.post(format!("{}/v1/jobs", service.url)).json(&job).send().await.unwrap();
            let status = answer.status().as_u16();
            let said = answer.text().await.unwrap();
            assert!(said.matches("the store failed").count() <= 1, "told once: {said}");
            status
        };
        assert_eq!(post(1).await, 202);
        for round in 0..2 {
            room(Some(0));
            assert_eq!(post(2 + round).await, 507);
            assert_eq!(post(2 + round).await, 507, "and again");
            room(None);
            assert_eq!(post(4 + round).await, 202, "there is room again");
        }
    });
}

fn value(counts: &[(&'static str, u64)], name: &str) -> u64 {
    counts.iter().find(|(known, _)| *known == name).unwrap().1
}

#[test]
fn m5_a_result_is_computed_once_whatever_the_caches_take() {
    let (rows, expected, _) = computed(Tiers::new(512 << 20, None));
    assert!(rows > 0 && expected.len() > 2 * PART_BYTES);
    let caches = [("off", 0), ("too small", 20_000), ("too small by little", 2 * expected.len() as u64)];
    for (cache, memory_bytes) in caches {
        let (again, bytes, _) = computed(Tiers::new(memory_bytes, None));
        assert_eq!(again, rows, "the rows of one computation: {cache}");
        assert!(bytes == expected, "{cache}");
    }
}

#[test]
fn m5_a_result_is_computed_once_though_the_disk_fails_within_it() {
    let (rows, expected, _) = computed(Tiers::new(512 << 20, None));
    let room = PART_BYTES as u64 * 3 / 2;
    // the disk is full, or one artifact would take more than half of the store
    for (full, capacity) in [(room, ROOMY), (ROOMY, 2 * room)] {
        let (scratch, disk) = (Scratch::new(), Faulty::new());
        disk.limit(&scratch.0, full);
        let (again, bytes, counts) = computed(Tiers::new(8 << 10, Some(Arc::new(disk.store(&scratch.0, capacity)))));
        assert_eq!((again, value(&counts, "taken_back"), value(&counts, "lost")), (rows, 1, 0));
        assert!(bytes == expected);
    }
}

#[test]
fn m5_only_what_the_disk_has_lost_is_computed_again() {
    let (rows, expected, _) = computed(Tiers::new(512 << 20, None));
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    disk.limit(&scratch.0, PART_BYTES as u64 * 3 / 2);
    disk.broken_reads.store(1, Ordering::Relaxed);
    let (again, bytes, counts) = computed(Tiers::new(8 << 10, Some(Arc::new(disk.store(&scratch.0, ROOMY)))));
    // the mesh is kept, only its bytes are made again
    assert_eq!((again, value(&counts, "taken_back"), value(&counts, "lost")), (rows, 0, 1));
    assert!(bytes == expected);
}

#[test]
fn m6_a_full_disk_is_told_until_a_write_succeeds() {
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    let clock = Arc::new(Manual::default());
    let tiers = Tiers::with_clock(1 << 20, Some(Arc::new(disk.store(&scratch.0, ROOMY))), clock.clone());
    run(async {
        make(&tiers, 0, 1000);
        written(&tiers).await;
        assert_eq!(tiers.disk_trouble(), None);
        disk.limit(&scratch.0, 0);
        for number in 1..3 {
            make(&tiers, number, 1000);
            written(&tiers).await;
            clock.advance(Duration::from_secs(7));
            let trouble = tiers.disk_trouble().unwrap();
            assert_eq!((trouble.duration, trouble.failures), (Duration::from_secs(7 * number), number));
            assert!(trouble.reason.contains("cannot write"), "{trouble:?}");
        }
        assert_eq!(n(&tiers.disk_counts().dropped_failed), 2);
        let disk_usage = tiers.usage()[1].1;
        assert_eq!((disk_usage.artifacts, disk_usage.evicted), (0, 1), "what was there had to leave");
        assert!((0..3).all(|number| tiers.at_hand(&key(number)).is_some()), "memory goes on");
        disk.limit(&scratch.0, ROOMY);
        make(&tiers, 3, 1000);
        written(&tiers).await;
        assert_eq!(tiers.disk_trouble(), None);
        until("it is counted", || n(&tiers.disk_counts().written) == 2).await;
        disk.limit(&scratch.0, 0);
        make(&tiers, 4, 1000);
        written(&tiers).await;
        clock.advance(Duration::from_secs(59));
        assert!(tiers.disk_trouble().is_some());
        clock.advance(Duration::from_secs(1));
        assert_eq!(tiers.disk_trouble(), None, "without writes it would never be well again");
    });
}

#[test]
fn m6_large_results_evict_from_a_full_disk_while_they_are_made() {
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    let tiers = Tiers::new(8 << 10, Some(Arc::new(disk.store(&scratch.0, ROOMY))));
    run(async {
        for number in 0..4 {
            make(&tiers, number, PART_BYTES);
            written(&tiers).await;
        }
        disk.limit(&scratch.0, 9 * PART_BYTES as u64 / 2);
        let kept = make(&tiers, 4, 3 * PART_BYTES);
        assert!(kept.loose.is_none());
        written(&tiers).await;
        let usage = tiers.usage()[1].1;
        assert_eq!((usage.artifacts, usage.evicted), (2, 3));
        assert_eq!(n(&tiers.disk_counts().taken_back), 0);
        assert!(tiers.find(&key(4)).await.is_some());
    });
}
