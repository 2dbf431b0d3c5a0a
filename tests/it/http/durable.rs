//! Jobs across restarts of the service.

use std::path::Path;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use planish::config::Settings;
use planish::http::serve::bind;
use planish::service::clock::{Clock, Manual, Monotonic};
use planish::service::job_key::JobKey;
use serde_json::Value;

use super::jobs::{endless, mesh, with};
use super::operations::ready;
use super::server::{Folder, settings, story, story_at, until};

fn lasting(folder: &Folder) -> Settings {
    Settings { data_dir: folder.path().join("data"), shutdown_timeout_s: 0, ..settings() }
}

fn two() -> Value {
    let mut job = mesh(3);
    job["outputs"] = serde_json::json!([{ "format": "stats" }, { "format": "obj" }]);
    job
}

/// Returns every file below a folder with its bytes.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let path = entry.path();
        if path.is_dir() {
            found.push((path.display().to_string(), Vec::new()));
            found.extend(files(&path));
        } else {
            found.push((path.display().to_string(), std::fs::read(&path).unwrap()));
        }
    }
    found.sort();
    found
}

fn refusal(settings: Settings) -> String {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    runtime.block_on(async { bind(settings).await.expect_err("it does not start").to_string() })
}

#[test]
fn jobs_that_were_accepted_are_finished_by_the_next_process() {
    let folder = Folder::new();
    let (waiting, running, location) = story(lasting(&folder), async |server| {
        let running = server.post("/v1/jobs?run_timeout_s=1", &with(endless(), "stats")).await;
        until("it runs", || server.app.desk.n_under_way() == 1 && server.app.desk.pool.waiting() == [0, 0]).await;
        let held = server.turn(planish::service::pool::Lane::Short).await;
        let waiting = server.post("/v1/jobs?priority=batch", &two()).await;
        let detached = server.post_with("/v1/render", &with(mesh(2), "obj"), &[("prefer", "wait=0")]).await;
        drop(held);
        assert_eq!([running.status, waiting.status, detached.status], [202; 3]);
        let [running, waiting, detached] = [&running, &waiting, &detached].map(|job| job.header("location").to_owned());
        (waiting, running, detached)
    });
    story(lasting(&folder), async |server| {
        for location in [&waiting, &location] {
            let done = server.settled(location).await;
            assert_eq!(done["state"], "done", "{done}");
            for output in done["outputs"].as_array().unwrap() {
                server.get(output["href"].as_str().unwrap()).await.ok();
            }
        }
        assert_eq!(server.get(&waiting).await.ok().json()["priority"], "batch");
        let stopped = server.settled(&running).await;
        assert_eq!((&stopped["state"], &stopped["attempts"]), (&"failed".into(), &2.into()), "{stopped}");
    });
}

#[test]
fn what_is_known_of_settled_jobs_lasts_and_evicted_results_are_made_again() {
    let folder = Folder::new();
    let (location, done, bytes) = story(lasting(&folder), async |server| {
        let posted = server.post_with("/v1/jobs", &two(), &[("prefer", "wait=60")]).await.ok();
        let done = posted.json();
        let bytes = server.get(done["outputs"][1]["href"].as_str().unwrap()).await.ok().body;
        let gone = server.post_with("/v1/jobs", &with(mesh(1), "stats"), &[("prefer", "wait=60")]).await.ok();
        let forgotten = server.ask(axum::http::Method::DELETE, gone.header("location"), &[], Vec::new()).await;
        assert_eq!(forgotten.status, 204);
        (posted.header("location").to_owned(), done, bytes)
    });
    std::fs::remove_dir_all(folder.path().join("data/artifacts")).unwrap();
    story(lasting(&folder), async |server| {
        assert_eq!(server.app.desk.jobs.n_known(), 1, "what was forgotten stays so");
        let again = server.get(&location).await.ok().json();
        for field in ["id", "state", "attempts", "cost", "outputs", "warnings"] {
            assert_eq!(again[field], done[field], "{field}");
        }
        let made = server.get(done["outputs"][1]["href"].as_str().unwrap()).await.ok();
        assert_eq!((made.header("cache-status"), &made.body), ("planish; fwd=miss; stored", &bytes));
        assert_eq!(server.post("/v1/jobs", &two()).await.ok().json()["state"], "done");
    });
}

#[test]
fn an_evicted_result_whose_upload_is_gone_is_gone() {
    let folder = Folder::new();
    let href = story(lasting(&folder), async |server| {
        let file = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n".to_vec();
        let headers = [("content-type", "model/obj")];
        let kept = server.ask(axum::http::Method::POST, "/v1/blobs", &headers, file).await.json();
        let mut job = with(mesh(1), "ply");
        job["input"] = serde_json::json!({ "blob": kept["id"] });
        let done = server.post_with("/v1/jobs", &job, &[("prefer", "wait=60")]).await.ok().json();
        done["outputs"][0]["href"].as_str().unwrap().to_owned()
    });
    for room in ["artifacts", "uploads"] {
        std::fs::remove_dir_all(folder.path().join("data").join(room)).unwrap();
    }
    story(lasting(&folder), async |server| {
        let gone = server.get(&href).await;
        assert_eq!(gone.status, 410, "{}", gone.json());
        assert!(gone.json()["detail"].as_str().unwrap().contains("/v1/blobs"), "{}", gone.json());
    });
}

/// Other systems let nobody remove or rename what is open.
#[test]
#[cfg(unix)]
fn jobs_are_refused_while_the_data_directory_is_gone() {
    let folder = Folder::new();
    let (data, aside) = (folder.path().join("data"), folder.path().join("aside"));
    let location = story(lasting(&folder), async |server| {
        ready(server).await;
        std::fs::rename(&data, &aside).unwrap();
        until("it is noticed without a job", || server.app.desk.jobs.trouble().is_some()).await;
        let told = server.get("/readyz").await.problem(503, "not-ready");
        assert!(told["detail"].as_str().unwrap().contains("jobs.redb"), "{told}");
        for (path, body) in [("/v1/jobs", two()), ("/v1/batches", serde_json::json!({ "jobs": [two()] }))] {
            let refused = server.post(path, &body).await.problem(507, "unwritten");
            assert!(refused["detail"].as_str().unwrap().contains("removed or replaced"), "{refused}");
        }
        assert_eq!(server.app.desk.jobs.n_known(), 0);
        std::fs::rename(&aside, &data).unwrap();
        ready(server).await;
        let accepted = server.post("/v1/jobs", &two()).await;
        assert_eq!(accepted.status, 202, "{}", accepted.text());
        accepted.header("location").to_owned()
    });
    story(lasting(&folder), async |server| assert_eq!(server.settled(&location).await["state"], "done"));
}

/// A manual clock, whose wall clock can be set.
#[derive(Debug)]
struct Jumping {
    start: Duration,
    passed: Manual,
    wall_s: AtomicU64,
}

impl Jumping {
    fn at(start_s: u64) -> Arc<Self> {
        let start = Duration::from_secs(start_s);
        Arc::new(Self { start, passed: Manual::default(), wall_s: AtomicU64::new(start_s) })
    }
}

impl Clock for Jumping {
    fn now(&self) -> Duration {
        self.start + self.passed.now()
    }

    fn wall(&self) -> Duration {
        Duration::from_secs(self.wall_s.load(Ordering::SeqCst))
    }

    fn sleep(&self, time: Duration) -> Pin<Box<dyn Future<Output = ()> + Send + '_>> {
        self.passed.sleep(time)
    }
}

#[test]
fn the_machines_clock_counts_on_from_the_wall_clock() {
    let clock = Monotonic::default();
    let (now, wall) = (clock.now(), clock.wall());
    assert!(now.abs_diff(wall) < Duration::from_hours(1), "{now:?} {wall:?}");
}

#[test]
fn a_wall_clock_that_jumps_ends_no_job_and_keeps_none_for_ever() {
    const START_S: u64 = 1_800_000_000;
    const YEARS_S: u64 = 300_000_000;
    let folder = Folder::new();
    let lasting = || Settings { job_ttl_s: 1000, ..lasting(&folder) };
    let clock = Jumping::at(START_S);
    let (waiting, done, held) = story_at(lasting(), clock.clone(), async |server| {
        let done = server.post_with("/v1/jobs", &with(mesh(1), "stats"), &[("prefer", "wait=60")]).await.ok();
        // when a job was settled is written by the wall clock, so that has happened before the clock jumps
        let id = planish::job::key::Key::parse(done.json()["id"].as_str().unwrap()).unwrap();
        server.app.desk.jobs.written(JobKey::of_anyone(id)).await.unwrap();
        let held = server.turn(planish::service::pool::Lane::Short).await;
        let waiting = server.post("/v1/jobs?queue_timeout_s=30&run_timeout_s=30", &two()).await;
        for wall_s in [START_S + YEARS_S, START_S - YEARS_S] {
            clock.wall_s.store(wall_s, Ordering::SeqCst);
            server.app.desk.tidy();
            assert_eq!(server.get(waiting.header("location")).await.ok().json()["state"], "queued");
            assert_eq!(server.get(done.header("location")).await.ok().json()["state"], "done");
        }
        clock.wall_s.store(START_S, Ordering::SeqCst);
        // the place is held to the end, so that the waiting job is left to the next process
        (waiting.header("location").to_owned(), done.header("location").to_owned(), held)
    });
    drop(held);
    // the next process starts 900 s later; settled jobs continue to age, and accepted ones are finished
    story_at(lasting(), Jumping::at(START_S + 900), async |server| {
        assert_eq!(server.settled(&waiting).await["state"], "done");
        assert_eq!(server.get(&done).await.ok().json()["state"], "done");
    });
    let clock = Jumping::at(START_S + 950);
    story_at(lasting(), clock.clone(), async |server| {
        clock.passed.advance(Duration::from_secs(100));
        server.app.desk.tidy();
        assert_eq!(server.get(&done).await.status, 404);
        assert_eq!(server.get(&waiting).await.ok().json()["state"], "done");
    });
    // a process whose clock is years behind keeps settled jobs for their time from its start, not for years
    let clock = Jumping::at(START_S - YEARS_S);
    story_at(lasting(), clock.clone(), async |server| {
        assert_eq!(server.get(&waiting).await.ok().json()["state"], "done");
        clock.passed.advance(Duration::from_secs(1000));
        server.app.desk.tidy();
        assert_eq!(server.get(&waiting).await.status, 404);
    });
}

#[test]
fn a_folder_of_something_else_is_refused_and_stays_as_it_is() {
    let folder = Folder::new();
    let data = folder.path().join("data");
    std::fs::create_dir_all(data.join("photos")).unwrap();
    std::fs::write(data.join("photos/one.jpg"), b"not ours").unwrap();
    let before = files(folder.path());
    let told = refusal(lasting(&folder));
    assert!(told.contains("photos") && told.contains("--data-dir"), "{told}");
    assert_eq!(files(folder.path()), before);
    // folders that systems put at the root of a disk do not prevent the start
    std::fs::remove_dir_all(data.join("photos")).unwrap();
    std::fs::create_dir(data.join("lost+found")).unwrap();
    story(lasting(&folder), async |server| drop(server.get("/livez").await.ok()));
}

#[test]
fn damaged_records_are_refused_and_stay_as_they_are() {
    let folder = Folder::new();
    story(lasting(&folder), async |server| {
        server.post_with("/v1/jobs", &two(), &[("prefer", "wait=60")]).await.ok();
    });
    let records = folder.path().join("data/jobs.redb");
    let whole = std::fs::read(&records).unwrap();
    for damage in [Vec::new(), b"garbage".to_vec(), vec![0; whole.len()], whole[..whole.len() / 2].to_vec()] {
        std::fs::write(&records, &damage).unwrap();
        let before = files(folder.path());
        let told = refusal(lasting(&folder));
        assert!(told.contains("jobs.redb") && told.contains("backup"), "{told}");
        assert_eq!(files(folder.path()), before);
    }
    std::fs::write(&records, &whole).unwrap();
    story(lasting(&folder), async |server| assert_eq!(server.app.desk.jobs.n_known(), 1));
}

#[test]
fn a_folder_in_use_is_refused_and_the_other_service_goes_on() {
    let folder = Folder::new();
    story(lasting(&folder), async |server| {
        let location = server.post_with("/v1/jobs", &two(), &[("prefer", "wait=60")]).await.ok();
        let told = bind(lasting(&folder)).await.expect_err("it does not start").to_string();
        assert!(told.contains("in use by another process"), "{told}");
        server.get(location.header("location")).await.ok();
    });
}
