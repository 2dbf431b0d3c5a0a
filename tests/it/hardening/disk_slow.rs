//! Disks that are slow or do not answer: they take few threads and little memory, and no answer waits for them.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use futures_util::future::join_all;
use planish::service::clock::Manual;
use planish::service::pool::Lane;
use planish::service::store::{Embedded, Store};
use planish::service::tiers::Tiers;

use super::disk::{app, bytes, make, n, run, served, written};
use crate::http::jobs::{mesh, with};
use crate::http::server::{PATIENCE, until};
use crate::store::faulty::Faulty;
use crate::store::{ROOMY, Scratch, key, noise};
use crate::support;

#[test]
fn h4_a_disk_that_hangs_holds_two_threads_and_a_bounded_number_of_artifacts() {
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    let tiers = Tiers::new(64 << 20, Some(Arc::new(disk.store(&scratch.0, ROOMY))));
    disk.syncs.close();
    run(async {
        for number in 0..1000 {
            make(&tiers, number, 1000);
        }
        until("the writers hang", || disk.syncs.waiting() == 2).await;
        assert_eq!(tiers.disk_backlog(), (256, 256_000));
        assert_eq!(n(&tiers.disk_counts().dropped_full), 744);
        assert!((0..1000).all(|number| tiers.at_hand(&key(number)).is_some()), "all are in memory");
        disk.syncs.open();
        assert!(tiers.close(PATIENCE));
    });
    assert_eq!(disk.syncs.most(), 2);
    assert_eq!(n(&tiers.disk_counts().written), 256);
    assert_eq!(scratch.open(ROOMY).usage().artifacts, 256);
}

#[test]
fn h4_what_waits_for_the_disk_holds_no_more_memory_than_an_eighth_of_the_cache() {
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    let tiers = Tiers::new(8 << 20, Some(Arc::new(disk.store(&scratch.0, ROOMY))));
    disk.syncs.close();
    run(async {
        for number in 0..100 {
            let kept = make(&tiers, number, 300_000);
            assert!(tiers.disk_backlog().1 <= 1 << 20);
            assert_eq!(bytes(&tiers, &kept).await.unwrap(), noise(number, 300_000));
        }
        assert_eq!((tiers.disk_backlog().0, n(&tiers.disk_counts().dropped_full)), (3, 97));
        assert!(tiers.at_hand(&key(0)).is_some(), "what waits is at hand though it has left the cache");
        disk.syncs.open();
        written(&tiers).await;
        assert!(tiers.at_hand(&key(0)).is_none());
        assert!(tiers.find(&key(0)).await.is_some(), "now it is on disk");
    });
}

#[test]
fn h4_large_results_beyond_the_backlog_come_back_into_memory() {
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    let tiers = Tiers::new(64 << 10, Some(Arc::new(disk.store(&scratch.0, ROOMY))));
    disk.syncs.close();
    run(async {
        let kept: Vec<_> = (0..20).map(|number| make(&tiers, number, 10_000)).collect();
        assert_eq!(tiers.disk_backlog(), (16, 0), "they wait in files");
        assert_eq!(n(&tiers.disk_counts().taken_back), 4);
        for (number, kept) in (0..).zip(&kept) {
            assert_eq!(bytes(&tiers, kept).await.unwrap(), noise(number, 10_000));
        }
        disk.syncs.open();
        written(&tiers).await;
        assert_eq!(n(&tiers.disk_counts().written), 16);
    });
}

#[test]
fn h4_results_of_any_size_are_answered_though_no_sync_ends() {
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    // all but the smallest results go to disk at once
    let tiers = Tiers::new(8 << 10, Some(Arc::new(disk.store(&scratch.0, ROOMY))));
    disk.syncs.close();
    run(served(tiers, async |server| {
        for levels in 1..6 {
            let job = with(mesh(levels), "obj");
            let (expected, _) = support::render(&job).unwrap();
            for cache in ["planish; fwd=miss; stored", "planish; hit"] {
                let answer = server.render(&job).await.ok();
                assert_eq!(answer.header("cache-status"), cache, "level {levels}");
                assert_eq!(answer.body, expected);
            }
        }
        until("the writers hang", || disk.syncs.waiting() == 2).await;
        drop(server.turn(Lane::Long).await);
        drop(server.turn(Lane::Short).await);
        disk.syncs.open();
        written(&server.app.desk.tiers).await;
        assert_eq!(n(&server.app.desk.tiers.disk_counts().dropped_failed), 0);
    }));
}

#[test]
fn h4_the_service_ends_though_the_disk_hangs() {
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    let tiers = Tiers::new(1 << 20, Some(Arc::new(disk.store(&scratch.0, ROOMY))));
    make(&tiers, 0, 1000);
    assert!(tiers.close(PATIENCE));
    drop(tiers);
    let tiers = Tiers::new(1 << 20, Some(Arc::new(disk.store(&scratch.0, ROOMY))));
    let (syncs, reads) = (&disk.syncs, &disk.reads);
    syncs.close();
    run(async {
        served(tiers, async |server| {
            for levels in 1..6 {
                server.render(&with(mesh(levels), "obj")).await.ok();
            }
            let tiers = &server.app.desk.tiers;
            reads.close();
            assert_eq!(tiers.find(&key(0)).await, None, "a read hangs");
            until("the writers hang", || syncs.waiting() == 2 && reads.waiting() == 1).await;
            assert!(!tiers.close(Duration::ZERO), "the command gives up here");
            assert!(n(&tiers.disk_counts().dropped_at_end) >= 3, "the rest is dropped");
        })
        .await;
    });
    assert!(Embedded::open(&scratch.0, ROOMY).is_err(), "what hangs still has the folder");
    syncs.open();
    reads.open();
    run(until("the threads end", || Embedded::open(&scratch.0, ROOMY).is_ok()));
}

#[test]
fn h4_reads_of_a_disk_that_hangs_hold_four_threads_and_count_as_misses() {
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    let tiers = Tiers::new(1 << 20, Some(Arc::new(disk.store(&scratch.0, ROOMY))));
    (0..12).for_each(|number| drop(make(&tiers, number, 1000)));
    assert!(tiers.close(PATIENCE));
    drop(tiers);
    let tiers = Tiers::new(1 << 20, Some(Arc::new(disk.store(&scratch.0, ROOMY))));
    disk.reads.close();
    run(async {
        let keys: Vec<_> = (0..12).map(key).collect();
        let found = join_all(keys.iter().map(|key| tiers.find(key))).await;
        assert!(found.iter().all(Option::is_none));
        assert_eq!((disk.reads.waiting(), disk.reads.most()), (4, 4));
        assert_eq!(n(&tiers.disk_counts().reads_given_up), 12);
        disk.reads.open();
        until("the places are free", || disk.reads.waiting() == 0).await;
        for key in &keys {
            assert!(tiers.find(key).await.is_some());
        }
    });
}

#[test]
fn h4_a_disk_that_does_not_end_a_write_is_in_trouble_and_left_alone() {
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    let clock = Arc::new(Manual::default());
    let tiers = Tiers::with_clock(64 << 10, Some(Arc::new(disk.store(&scratch.0, ROOMY))), clock.clone());
    disk.syncs.close();
    run(async {
        make(&tiers, 0, 1000);
        until("a writer hangs", || disk.syncs.waiting() == 1).await;
        clock.advance(Duration::from_secs(29));
        assert_eq!(tiers.disk_trouble(), None);
        clock.advance(Duration::from_secs(2));
        let trouble = tiers.disk_trouble().unwrap();
        assert_eq!((trouble.duration, trouble.failures), (Duration::from_secs(31), 0), "{trouble:?}");
        let before = disk.writes.load(Ordering::Relaxed);
        let kept = make(&tiers, 1, 20_000);
        assert_eq!(disk.writes.load(Ordering::Relaxed), before, "no computation writes to it");
        assert_eq!(bytes(&tiers, &kept).await.unwrap(), noise(1, 20_000));
        disk.syncs.open();
        written(&tiers).await;
        assert_eq!(tiers.disk_trouble(), None);
    });
}

#[test]
fn what_waits_is_written_before_an_orderly_end() {
    let scratch = Scratch::new();
    run(async {
        let (_, app) = app(Tiers::new(1 << 20, Some(Arc::new(scratch.open(ROOMY))))).await;
        (0..40).for_each(|number| drop(make(&app.desk.tiers, number, 1000)));
        drop(app);
    });
    assert_eq!(scratch.open(ROOMY).usage().artifacts, 40);
}
