//! Batches: lists and grids, partial failure, cancellation, restarts, events, archives.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use axum::http::Method;
use planish::config::Settings;
use planish::service::clock::Manual;
use serde_json::{Value, json};

use super::events::Listening;
use super::jobs::{detailed, endless, mesh, polygon, with};
use super::server::{Answer, Folder, Server, settings, story, story_at, until};

const WAIT: [(&str, &str); 1] = [("prefer", "wait=200")];

/// Returns a list of three small jobs, the last of which is an analysis.
fn three() -> Value {
    let question = json!({ "analysis": { "plan": { "preset": "four-point" } } });
    json!({ "jobs": [with(polygon(3), "svg"), with(mesh(1), "obj"), question] })
}

/// Returns a template with two axes, the second of which adds a field.
fn grid() -> Value {
    let mut template = with(mesh(1), "json");
    template["plan"] = json!({ "preset": "push-back", "parameters": {} });
    json!({ "template": template, "grid": [
        { "pointer": "/levels", "values": [0, 1] },
        { "pointer": "/plan/parameters/delta", "values": [0, 0.5, 1] },
    ] })
}

async fn waited(server: &Server, batch: &Value) -> (String, Value) {
    let answer = server.post_with("/v1/batches", batch, &WAIT).await.ok();
    (answer.header("location").to_owned(), answer.json())
}

async fn delete(server: &Server, place: &str) -> u16 {
    server.ask(Method::DELETE, place, &[], Vec::new()).await.status
}

async fn cancel(server: &Server, place: &str) -> Answer {
    server.ask(Method::POST, &format!("{place}/cancel"), &[], Vec::new()).await
}

fn states(batch: &Value) -> Vec<&str> {
    batch["items"].as_array().unwrap().iter().map(|item| item["state"].as_str().unwrap()).collect()
}

fn computed(server: &Server) -> u64 {
    server.app.desk.tally.computations().map(|(_, n)| n).sum()
}

/// Returns the files of an archive from its directory: names and bytes, with checksums verified.
fn unzipped(zip: &[u8]) -> Vec<(String, Vec<u8>)> {
    let number = |at: usize, n: usize| zip[at..at + n].iter().rev().fold(0, |sum, byte| sum << 8 | usize::from(*byte));
    let end = zip.len() - 22;
    assert_eq!(zip[end..end + 4], *b"PK\x05\x06");
    let (n, mut at) = (number(end + 10, 2), number(end + 16, 4));
    let mut files = Vec::new();
    for _ in 0..n {
        assert_eq!(zip[at..at + 4], *b"PK\x01\x02");
        let (crc, length, name, offset) =
            (number(at + 16, 4), number(at + 24, 4), number(at + 28, 2), number(at + 42, 4));
        let text = String::from_utf8(zip[at + 46..at + 46 + name].to_vec()).unwrap();
        assert_eq!(zip[offset..offset + 4], *b"PK\x03\x04", "{text}");
        assert_eq!((number(offset + 14, 4), number(offset + 22, 4)), (crc, length), "{text}");
        let start = offset + 30 + number(offset + 26, 2) + number(offset + 28, 2);
        let bytes = zip[start..start + length].to_vec();
        let mut sum = flate2::Crc::new();
        sum.update(&bytes);
        assert_eq!(sum.sum() as usize, crc, "{text}");
        files.push((text, bytes));
        at += 46 + name + number(at + 30, 2);
    }
    assert_eq!(at, end);
    files
}

#[test]
fn a_list_of_jobs_is_done_and_told_item_by_item() {
    story(settings(), async |server| {
        server.post_with("/v1/jobs", &with(mesh(1), "obj"), &WAIT).await.ok();
        let held = server.hold().await;
        let posted = server.post("/v1/batches", &three()).await;
        assert_eq!(posted.status, 202, "{}", posted.text());
        assert_eq!((posted.json()["priority"].clone(), posted.header("retry-after")), ("batch".into(), "1"));
        let place = posted.header("location").to_owned();
        assert_eq!(place, format!("/v1/batches/{}", posted.json()["id"].as_str().unwrap()));
        drop(held);
        let done = server.settled(&place).await;
        assert_eq!((&done["state"], &done["progress"], &done["attempts"]), (&"done".into(), &1.0.into(), &1.into()));
        let counts = json!({ "total": 3, "queued": 0, "running": 0, "done": 3, "failed": 0, "cancelled": 0,
            "cache_hits": 1 });
        assert_eq!(done["counts"], counts, "{done}");
        let caches: Vec<_> = done["items"].as_array().unwrap().iter().map(|item| item["cache"].clone()).collect();
        assert_eq!(caches, ["miss", "hit", "miss"]);
        for (at, item) in done["items"].as_array().unwrap().iter().enumerate() {
            assert_eq!(item["index"], at, "{item}");
            let alone = server.post("/v1/jobs", &three()["jobs"][at]).await.ok().json();
            assert_eq!((&alone["id"], &alone["outputs"]), (&item["job"], &item["outputs"]));
            server.get(item["outputs"][0]["href"].as_str().unwrap()).await.ok();
        }
        let before = computed(server);
        let again = server.post("/v1/batches", &three()).await.ok();
        assert_eq!((again.header("location"), again.json()), (place.as_str(), done));
        assert_eq!(computed(server), before);
        let listed = server.get("/v1/batches?limit=1").await.ok().json();
        assert_eq!(
            (listed["batches"][0]["id"].as_str(), listed["batches"][0].get("items")),
            (place.rsplit('/').next(), None)
        );
    });
}

#[test]
fn a_grid_is_row_major_with_the_last_axis_fastest() {
    story(settings(), async |server| {
        let (_, done) = waited(server, &grid()).await;
        assert_eq!(done["counts"]["done"], 6, "{done}");
        let mut at = 0;
        for (i, levels) in [0, 1].into_iter().enumerate() {
            for (j, delta) in [0.0, 0.5, 1.0].into_iter().enumerate() {
                let mut job = with(mesh(levels), "json");
                job["plan"] = json!({ "preset": "push-back", "parameters": { "delta": delta } });
                let alone = server.post("/v1/jobs", &job).await.ok().json();
                assert_eq!(done["items"][at]["at"], json!([i, j]));
                assert_eq!(done["items"][at]["job"], alone["id"], "{at}");
                at += 1;
            }
        }
    });
}

#[test]
fn a_fault_points_to_the_job_or_to_the_axis_and_nothing_is_begun() {
    story(Settings { max_batch_items: 20, ..settings() }, async |server| {
        let mut list = three();
        list["jobs"][1]["levels"] = "many".into();
        list["jobs"][2]["analysis"]["plan"]["preset"] = "nothing".into();
        let mut wrong_axis = grid();
        wrong_axis["grid"][1]["values"][2] = json!("x+");
        let mut wrong_template = grid();
        wrong_template["template"]["input"]["mesh"]["faces"][0] = json!([0, 1]);
        let mut many = grid();
        many["grid"][0]["values"] = json!([0, 1, 2, 3, 4, 5, 6]);
        let mut searched = detailed();
        searched["levels"] = json!({ "tolerance": 0.1 });
        for (batch, pointers) in [
            (&list, &["/jobs/1/levels", "/jobs/2/analysis/plan/preset"][..]),
            (&wrong_axis, &["/grid/1/values/2"]),
            (&wrong_template, &["/template/input/mesh/faces/0"]),
            (&many, &["/grid"]),
            (&json!({ "jobs": vec![mesh(1); 21] }), &["/jobs"]),
            (&json!({ "jobs": [5, detailed()] }), &["/jobs/0", "/jobs/1/outputs/0/lod"]),
            (&json!({ "jobs": [searched] }), &["/jobs/0/outputs/0/lod"]),
            (
                &json!({ "template": mesh(1), "grid": [{ "pointer": "/plan/nothing/delta", "values": [1] }] }),
                &["/grid/0/pointer"],
            ),
        ] {
            let problem = server.post("/v1/batches", batch).await.problem(422, "invalid-job");
            let found: Vec<_> = problem["errors"].as_array().unwrap().iter().map(|error| &error["pointer"]).collect();
            assert_eq!(found, pointers, "{problem}");
        }
        let problem = server.post("/v1/batches", &many).await.problem(422, "invalid-job");
        let detail = problem["detail"].as_str().unwrap();
        assert!(
            ["7 x 3 = 21 jobs", "at most 20", "several batches"].iter().all(|part| detail.contains(part)),
            "{detail}"
        );
        let large = json!({ "jobs": [mesh(1), mesh(40)] });
        let problem = server.post("/v1/batches", &large).await.problem(422, "too-large");
        assert_eq!(problem["errors"][0]["pointer"], "/jobs/1/levels", "{problem}");
        assert!(problem["detail"].as_str().unwrap().starts_with("job 1: "), "{problem}");
        let missing = json!({ "jobs": [{ "input": { "blob": format!("b3-{}", "0".repeat(64)) } }] });
        let problem = server.post("/v1/batches", &missing).await.problem(422, "invalid-job");
        assert_eq!(problem["errors"][0]["pointer"], "/jobs/0/input/blob");
        assert_eq!(server.get("/v1/batches").await.ok().json(), json!({ "batches": [] }));
        assert!(server.app.desk.jobs.n_known() == 0);
    });
}

#[test]
fn a_grid_is_counted_before_any_of_its_jobs_is_made() {
    story(Settings { max_body_bytes: 64 << 10, ..settings() }, async |server| {
        let values: Vec<u32> = (0..1000).collect();
        let axes: Vec<_> = (0..8).map(|at| json!({ "pointer": format!("/input/{at}"), "values": values })).collect();
        let bomb = json!({ "template": { "input": {} }, "grid": axes });
        let problem = server.post("/v1/batches", &bomb).await.problem(422, "invalid-job");
        assert_eq!(problem["errors"][0]["pointer"], "/grid");
        assert!(problem["detail"].as_str().unwrap().contains("at most 1,000"), "{problem}");
        // twenty copies of 40 KiB, while eight bodies of 64 KiB are allowed
        let long = json!({ "template": { "input": "x".repeat(40 << 10) },
            "grid": [{ "pointer": "/levels", "values": (0..20).collect::<Vec<u32>>() }] });
        let problem = server.post("/v1/batches", &long).await.problem(422, "invalid-job");
        assert_eq!(problem["errors"][0]["pointer"], "/grid");
        assert!(problem["detail"].as_str().unwrap().contains("input.blob"), "{problem}");
    });
}

/// Returns three jobs; the outputs of the second cannot all be written, as its numbers are beyond f32.
fn one_fails() -> Value {
    let mut job = mesh(1);
    job["input"]["mesh"]["positions"][0][0] = json!(1e200);
    job["outputs"] = json!([{ "format": "stl" }, { "format": "json" }]);
    json!({ "jobs": [with(mesh(2), "obj"), job, with(polygon(2), "json")] })
}

#[test]
fn a_job_that_fails_leaves_the_others_and_stands_in_the_manifest() {
    story(settings(), async |server| {
        let (place, failed) = waited(server, &one_fails()).await;
        assert_eq!((&failed["state"], &failed["error"]), (&"failed".into(), &"1 of 3 jobs were not done".into()));
        assert_eq!(states(&failed), ["done", "failed", "done"]);
        assert_eq!(failed["items"][1]["error"], failed["items"][1]["outputs"][0]["error"]);
        let archive = server.get(failed["archive"].as_str().unwrap()).await.ok();
        assert_eq!(archive.header("content-length"), archive.body.len().to_string());
        let files = unzipped(&archive.body);
        let names: Vec<_> = files.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["manifest.json", "0000/obj.obj", "0001/json.json", "0002/json.json"]);
        let manifest: Value = serde_json::from_slice(&files[0].1).unwrap();
        assert_eq!((&manifest["state"], &manifest["items"][1]["state"]), (&"failed".into(), &"failed".into()));
        assert_eq!(manifest["items"][1]["error"], failed["items"][1]["error"]);
        assert_eq!(manifest["items"][1]["outputs"][1]["file"], "0001/json.json");
        let alone = server.render(&with(mesh(2), "obj")).await.ok();
        assert_eq!(files[1].1, alone.body);
        // posted again, only the failed job is computed again
        let (again, tried) = waited(server, &one_fails()).await;
        assert_eq!((again, &tried["attempts"], &tried["counts"]["done"]), (place, &2.into(), &2.into()));
    });
}

#[test]
fn an_archive_is_the_same_to_the_byte_and_what_left_the_cache_is_made_again() {
    story(settings(), async |server| {
        let (place, _) = waited(server, &grid()).await;
        let path = format!("{place}/archive.zip");
        let first = server.get(&path).await.ok();
        assert_eq!(first.header("content-type"), "application/zip");
        let files = unzipped(&first.body);
        assert_eq!(files.len(), 7);
        let manifest: Value = serde_json::from_slice(&files[0].1).unwrap();
        assert_eq!(manifest["grid"], grid()["grid"]);
        let etag = first.header("etag").to_owned();
        assert_eq!(server.get_with(&path, &[("if-none-match", &etag)]).await.status, 304);
        // at level 0, all values of delta give the same result
        let keys = manifest["items"].as_array().unwrap().iter().map(|item| item["outputs"][0]["key"].as_str().unwrap());
        let keys: BTreeSet<_> = keys.map(|key| planish::job::key::Key::parse(key).unwrap()).collect();
        assert_eq!(keys.len(), 4);
        // the results are removed, and so are the records of the jobs
        for job in manifest["items"].as_array().unwrap() {
            delete(server, &format!("/v1/jobs/{}", job["job"].as_str().unwrap())).await;
        }
        keys.iter().for_each(|key| server.app.desk.tiers.remove(key).unwrap());
        // a client that reads the first bytes only causes no computation
        let before = computed(server);
        let head = server.ask(Method::HEAD, &path, &[], Vec::new()).await;
        assert_eq!((head.status, head.header("content-length")), (200, first.header("content-length")));
        assert_eq!(computed(server), before, "what is not read is not made");
        let again = server.get(&path).await.ok();
        assert!(again.body == first.body, "other bytes");
        assert_eq!(computed(server), before + 4);
        // one result is missing and its place is taken: a client that disconnects before it causes no computation
        keys.iter().for_each(|key| server.app.desk.tiers.remove(key).unwrap());
        let held = server.hold().await;
        let mut cut = server.client.get(server.url(&path)).send().await.unwrap();
        cut.chunk().await.unwrap().unwrap();
        until("it is asked for", || server.app.desk.n_under_way() == 1).await;
        drop(cut);
        until("nobody wants it", || server.app.desk.n_under_way() == 0).await;
        drop(held);
        assert_eq!(computed(server), before + 5, "the one that was begun is cancelled, and no other is made");
    });
}

#[test]
fn an_archive_of_a_batch_that_goes_on_is_to_be_asked_for_later() {
    story(settings(), async |server| {
        let posted = server.post("/v1/batches", &json!({ "jobs": [with(endless(), "stats")] })).await;
        let place = posted.header("location").to_owned();
        let answer = server.get(&format!("{place}/archive.zip")).await;
        answer.problem(503, "not-finished");
        assert_eq!(answer.header("retry-after"), "1");
        assert_eq!(delete(server, &place).await, 204);
        until("its job is gone", || server.app.desk.n_under_way() == 0).await;
        server.get(&format!("{place}/archive.zip")).await.problem(404, "not-found");
    });
}

#[test]
fn a_cancelled_batch_leaves_what_is_done_and_the_jobs_that_others_want() {
    story(settings(), async |server| {
        let (own, shared) = (with(endless(), "stats"), with(endless(), "json"));
        let batch = json!({ "jobs": [with(polygon(2), "svg"), own, shared, with(mesh(3), "glb")] });
        let place = server.post("/v1/batches?priority=interactive", &batch).await.header("location").to_owned();
        let posted = server.post("/v1/jobs", &shared).await;
        assert_eq!(posted.status, 202);
        let shared = posted.header("location").to_owned();
        let is_done = async || server.get(&place).await.ok().json()["counts"]["done"] == 2;
        while !is_done().await {}
        let cancelled = cancel(server, &place).await;
        assert_eq!(cancelled.status, 202);
        let cancelled = cancelled.json();
        assert_eq!(cancelled["state"], "cancelled");
        assert_eq!(states(&cancelled), ["done", "cancelled", "cancelled", "done"]);
        let own = cancelled["items"][1]["job"].as_str().map(|job| format!("/v1/jobs/{job}"));
        if let Some(own) = own {
            assert_eq!(server.settled(&own).await["state"], "cancelled");
        }
        let state = server.get(&shared).await.ok().json()["state"].clone();
        assert!(state == "queued" || state == "running", "{state}");
        assert_eq!((cancel(server, &place).await.status, delete(server, &shared).await), (200, 204));
        until("all has ended", || server.app.desk.n_under_way() == 0).await;
    });
}

#[test]
fn a_listener_is_told_how_far_a_batch_is_and_comes_back_where_it_was() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let place = server.post("/v1/batches", &three()).await.header("location").to_owned();
        let mut listening = Listening::to(server, &place, None).await;
        let first = listening.event().await.unwrap();
        assert_eq!((first.name.as_str(), &first.data["counts"]["total"]), ("state", &3.into()));
        drop(held);
        let rest = listening.rest().await;
        let last = rest.last().unwrap();
        assert_eq!((last.name.as_str(), &last.data["counts"]["done"]), ("done", &3.into()));
        assert_eq!(states(&last.data), ["done"; 3]);
        let ids: Vec<u64> = std::iter::once(&first).chain(&rest).map(|event| event.id).collect();
        assert!(ids.windows(2).all(|pair| pair[0] < pair[1]), "{ids:?}");
        let missed = Listening::to(server, &place, Some(first.id)).await.rest().await;
        assert_eq!(missed.last().map(|event| event.id), Some(last.id));
        let seen = [("last-event-id", &*last.id.to_string())];
        assert_eq!(server.get_with(&format!("{place}/events"), &seen).await.status, 204);
    });
}

fn lasting(folder: &Folder) -> Settings {
    Settings { data_dir: folder.path().join("data"), shutdown_timeout_s: 0, ..settings() }
}

fn artifacts(folder: &Path) -> BTreeMap<String, std::time::SystemTime> {
    let files = std::fs::read_dir(folder.join("data/artifacts")).unwrap().flat_map(|entry| {
        let entry = entry.unwrap().path();
        if entry.is_dir() {
            std::fs::read_dir(entry).unwrap().map(|file| file.unwrap().path()).collect()
        } else {
            vec![entry]
        }
    });
    files.map(|file| (file.display().to_string(), file.metadata().unwrap().modified().unwrap())).collect()
}

#[test]
fn an_accepted_batch_is_finished_by_the_next_process_and_what_is_done_is_not_done_again() {
    let folder = Folder::new();
    let stopped = with(endless(), "stats");
    let batch = json!({ "jobs": [with(mesh(2), "obj"), with(polygon(2), "svg"), stopped, with(mesh(3), "stats")] });
    let place = story(lasting(&folder), async |server| {
        let posted = server.post("/v1/batches?run_timeout_s=2", &batch).await;
        assert_eq!(posted.status, 202, "{}", posted.text());
        let place = posted.header("location").to_owned();
        let is_done = async || server.get(&place).await.ok().json()["counts"]["done"].as_u64() >= Some(2);
        while !is_done().await {}
        place
    });
    let before = artifacts(folder.path());
    story(lasting(&folder), async |server| {
        let done = server.settled(&place).await;
        assert_eq!((&done["state"], &done["attempts"]), (&"failed".into(), &2.into()), "{done}");
        assert_eq!(states(&done), ["done", "done", "failed", "done"]);
        let done = |what: &str| server.app.desk.tally.computations().find(|(name, _)| *name == what).unwrap().1;
        assert!(done("done") <= 2, "{} were computed again", done("done"));
        let after = artifacts(folder.path());
        assert!(before.iter().all(|(file, at)| after.get(file) == Some(at)), "nothing is written again");
    });
    // a third process knows settled batches, but not forgotten ones
    story(lasting(&folder), async |server| {
        let known = server.get(&place).await.ok().json();
        assert_eq!(states(&known), ["done", "done", "failed", "done"]);
        let archive = server.get(&format!("{place}/archive.zip")).await.ok().body;
        assert_eq!(unzipped(&archive).len(), 4);
        assert_eq!(delete(server, &place).await, 204);
        server.get(&place).await.problem(404, "not-found");
    });
    story(lasting(&folder), async |server| drop(server.get(&place).await.problem(404, "not-found")));
}

#[test]
fn a_done_batch_that_is_posted_again_is_kept_for_its_full_time() {
    let clock = Arc::new(Manual::default());
    story_at(Settings { job_ttl_s: 1000, ..settings() }, clock.clone(), async |server| {
        let desk = &server.app.desk;
        let place = waited(server, &three()).await.0;
        let other = waited(server, &grid()).await.0;
        clock.advance(Duration::from_secs(999));
        server.post("/v1/batches", &three()).await.ok();
        let newest = server.get("/v1/batches?limit=1").await.ok().json();
        assert_eq!(newest["batches"][0]["id"].as_str(), place.rsplit('/').next());
        clock.advance(Duration::from_secs(999));
        desk.tidy();
        server.get(&place).await.ok();
        server.get(&other).await.problem(404, "not-found");
        clock.advance(Duration::from_secs(1));
        desk.tidy();
        server.get(&place).await.problem(404, "not-found");
    });
}

#[test]
fn one_client_has_so_many_batches_and_is_told_when_to_come_back() {
    story(Settings { max_queue_per_peer: 4, ..settings() }, async |server| {
        let first = server.post("/v1/batches", &json!({ "jobs": [with(endless(), "stats")] })).await;
        assert_eq!(first.status, 202, "{}", first.text());
        let refused = server.post("/v1/batches", &three()).await;
        refused.problem(503, "busy");
        assert!(refused.header("retry-after").parse::<u64>().unwrap() >= 1);
        // the same batch does not count twice
        assert_eq!(server.post("/v1/batches", &json!({ "jobs": [with(endless(), "stats")] })).await.status, 202);
        assert_eq!(delete(server, first.header("location")).await, 204);
        waited(server, &three()).await;
    });
}
