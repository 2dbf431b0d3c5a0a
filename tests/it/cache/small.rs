//! Caches of small or zero capacity.

use std::path::PathBuf;

use planish::config::Settings;

use crate::http::jobs::{mesh, polygon, with};
use crate::http::server::{Folder, settings, story, until};

/// Returns settings with room for a few results of [`job`].
fn small() -> Settings {
    Settings { memory_cache_bytes: 20_000, ..settings() }
}

/// Returns one of twelve jobs with results of about 2.5 KiB each.
fn job(degree: u32) -> serde_json::Value {
    let mut job = with(polygon(5), "json");
    job["plan"] = serde_json::json!({ "preset": "b-spline", "parameters": { "degree": degree } });
    job
}

#[test]
fn without_a_data_directory_and_with_no_room_for_one_all_is_answered() {
    let folder = Folder::new();
    let tables = [
        Settings { data_dir: PathBuf::new(), ..settings() },
        Settings { data_dir: folder.path().to_owned(), cache_bytes: 0, ..settings() },
    ];
    for settings in tables {
        story(settings, async |server| {
            assert_eq!(server.render(&mesh(2)).await.ok().header("cache-status"), "planish; fwd=miss; stored");
            assert_eq!(server.render(&mesh(2)).await.ok().header("cache-status"), "planish; hit");
        });
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing was written");
}

#[test]
fn without_any_cache_every_answer_is_computed_and_right() {
    let kept = story(settings(), async |server| server.render(&with(mesh(2), "obj")).await.ok());
    story(Settings { memory_cache_bytes: 0, ..settings() }, async |server| {
        for _ in 0..2 {
            let answer = server.render(&with(mesh(2), "obj")).await.ok();
            assert_eq!(answer.header("cache-status"), "planish; fwd=miss");
            assert_eq!(answer.body, kept.body);
            assert_eq!(answer.header("etag"), kept.header("etag"));
            assert_eq!(answer.header("content-length"), kept.body.len().to_string());
        }
        server.get(kept.header("content-location")).await.problem(404, "not-found");
    });
}

#[test]
fn without_any_cache_a_finished_job_still_leads_to_its_result() {
    story(Settings { memory_cache_bytes: 0, ..settings() }, async |server| {
        let held = server.hold().await;
        let later = server.post_with("/v1/render", &mesh(2), &[("prefer", "wait=0")]).await;
        drop(held);
        let status = server.settled(later.header("location")).await;
        assert_eq!(status["state"], "done");
        server.get(status["outputs"][0]["href"].as_str().unwrap()).await.ok();
    });
}

#[test]
fn a_small_memory_cache_forgets_the_least_recently_used() {
    story(small(), async |server| {
        let status = async |degree| server.render(&job(degree)).await.ok().header("cache-status").to_owned();
        assert_eq!(status(1).await, "planish; fwd=miss; stored");
        for degree in 2..12 {
            assert_eq!(status(degree).await, "planish; fwd=miss; stored", "degree {degree}");
            assert_eq!(status(1).await, "planish; hit", "it was used lately");
        }
        assert_eq!(status(2).await, "planish; fwd=miss; stored", "it was not");
    });
}

#[test]
fn a_small_disk_cache_keeps_within_its_bounds() {
    let folder = Folder::new();
    let settings =
        Settings { data_dir: folder.path().to_owned(), memory_cache_bytes: 0, cache_bytes: 60_000, ..settings() };
    story(settings, async |server| {
        let mut evicted = 0;
        for levels in 1..8 {
            let job = with(polygon(levels), "json");
            let first = server.render(&job).await.ok();
            let again = server.render(&job).await.ok();
            assert_eq!(first.body, again.body);
            until("it is on disk", || server.app.desk.tiers.disk_backlog().0 == 0).await;
            let (_, usage) = server.app.desk.tiers.usage().pop().unwrap();
            assert!(usage.bytes <= usage.capacity, "{usage:?}");
            evicted = usage.evicted;
        }
        assert!(evicted > 0, "something had to go");
    });
}

#[test]
fn an_evicted_result_is_made_again_under_its_address_while_its_job_is_known() {
    story(small(), async |server| {
        let held = server.hold().await;
        let later = server.post_with("/v1/render", &job(1), &[("prefer", "wait=0")]).await;
        drop(held);
        let status = server.settled(later.header("location")).await;
        let href = status["outputs"][0]["href"].as_str().unwrap();
        let first = server.get(href).await.ok();
        for degree in 2..12 {
            server.render(&job(degree)).await.ok();
        }
        assert!(server.app.desk.tiers.usage()[0].1.evicted > 0, "something had to go");
        let again = server.get(href).await.ok();
        assert_eq!(again.body, first.body);
    });
}
