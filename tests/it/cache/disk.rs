//! Results on disk: they outlast the process, and damage is detected.

use std::path::{Path, PathBuf};

use planish::config::Settings;
use planish::service::store::Usage;
use serde_json::Value;

use crate::http::jobs::{mesh, polygon, with};
use crate::http::server::{Answer, Folder, Server, settings, story, until};

/// Returns the settings of a server with a data directory.
fn on(folder: &Folder) -> Settings {
    Settings { data_dir: folder.path().to_owned(), ..settings() }
}

/// Returns the settings of a server with a data directory and no memory cache.
fn on_disk_alone(folder: &Folder) -> Settings {
    Settings { memory_cache_bytes: 0, ..on(folder) }
}

/// Returns three jobs with results of different sizes; the last one takes several parts of the store.
fn jobs() -> [Value; 3] {
    [with(polygon(2), "svg"), mesh(2), with(mesh(7), "json")]
}

async fn all(server: &Server) -> Vec<Answer> {
    let mut answers = Vec::new();
    for job in jobs() {
        answers.push(server.render(&job).await.ok());
    }
    answers
}

fn disk(server: &Server) -> Usage {
    server.app.desk.tiers.usage().into_iter().find(|(name, _)| *name == "disk").unwrap().1
}

/// Returns every file below a folder, in order.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}

#[test]
fn a_new_process_answers_from_disk_what_the_last_one_made() {
    let folder = Folder::new();
    for settings in [on(&folder), on_disk_alone(&folder)] {
        let made = story(on(&folder), async |server| all(server).await);
        story(settings, async |server| {
            let held = server.hold().await;
            for (job, made) in jobs().iter().zip(&made) {
                let answer = server.render(job).await.ok();
                assert_eq!(answer.header("cache-status"), "planish; hit");
                assert_eq!(answer.body, made.body);
                let kept = server.get(made.header("content-location")).await.ok();
                assert_eq!(kept.body, made.body);
                assert_eq!(kept.header("etag"), made.header("etag"));
            }
            drop(held);
        });
    }
}

#[test]
fn a_result_that_outlasted_its_request_is_on_disk_like_all_others() {
    let folder = Folder::new();
    let href = story(on(&folder), async |server| {
        let held = server.hold().await;
        let later = server.post_with("/v1/render", &mesh(2), &[("prefer", "wait=0")]).await;
        drop(held);
        let status = server.settled(later.header("location")).await;
        status["outputs"][0]["href"].as_str().unwrap().to_owned()
    });
    story(on(&folder), async |server| {
        server.get(&href).await.ok();
        assert_eq!(server.render(&mesh(2)).await.ok().header("cache-status"), "planish; hit");
    });
}

#[test]
fn a_flipped_bit_is_recomputed_and_never_served() {
    let folder = Folder::new();
    let made = story(on(&folder), async |server| all(server).await);
    for settings in [on(&folder), on_disk_alone(&folder)] {
        for half in 0..3 {
            for path in files(&folder.path().join("artifacts")) {
                let mut bytes = std::fs::read(&path).unwrap();
                let place = (bytes.len() - 1) * half / 2;
                bytes[place] ^= 1 << (place % 8);
                std::fs::write(&path, bytes).unwrap();
            }
            let damaged = story(settings.clone(), async |server| {
                for (job, made) in jobs().iter().zip(&made) {
                    // damage after the first part aborts the answer; no wrong byte is sent
                    let first = server.client.post(server.url("/v1/render")).json(job).send().await.unwrap();
                    let cache = first.headers()["cache-status"].to_str().unwrap().to_owned();
                    match first.bytes().await {
                        Ok(bytes) => assert_eq!(bytes, made.body),
                        Err(_) => assert_eq!(cache, "planish; hit"),
                    }
                    let second = server.render(job).await.ok();
                    assert_eq!(second.body, made.body);
                }
                disk(server).damaged
            });
            assert!(damaged >= 3, "{damaged} found damaged");
        }
    }
}

#[test]
fn an_address_whose_bytes_are_damaged_is_made_again_where_its_job_is_known_and_gone_elsewhere() {
    let folder = Folder::new();
    story(on_disk_alone(&folder), async |server| {
        let held = server.hold().await;
        let later = server.post_with("/v1/render", &mesh(2), &[("prefer", "wait=0")]).await;
        drop(held);
        let status = server.settled(later.header("location")).await;
        let href = status["outputs"][0]["href"].as_str().unwrap();
        let sound = server.get(href).await.ok();
        damage(server, &folder).await;
        assert_eq!(server.get(href).await.ok().body, sound.body, "its job is known");
        let other = server.render(&mesh(1)).await.ok();
        damage(server, &folder).await;
        server.get(other.header("content-location")).await.problem(404, "not-found");
        assert_eq!(server.render(&mesh(1)).await.ok().body, other.body);
    });
}

/// Flips a bit in the bytes of every artifact, once all are on disk.
async fn damage(server: &Server, folder: &Folder) {
    until("all is on disk", || server.app.desk.tiers.disk_backlog().0 == 0).await;
    for path in files(&folder.path().join("artifacts")).iter().filter(|path| path.extension().is_none()) {
        let mut bytes = std::fs::read(path).unwrap();
        bytes[9] ^= 4;
        std::fs::write(path, bytes).unwrap();
    }
}

#[test]
fn whatever_happens_to_the_other_files_every_answer_is_right() {
    let folder = Folder::new();
    let made = story(on(&folder), async |server| all(server).await);
    let right = || {
        story(on(&folder), async |server| {
            for (answer, made) in all(server).await.iter().zip(&made) {
                assert_eq!(answer.body, made.body);
            }
        });
    };
    std::fs::write(folder.path().join("index.redb"), b"no index").unwrap();
    right();
    for path in files(&folder.path().join("artifacts")) {
        let length = std::fs::metadata(&path).unwrap().len();
        std::fs::File::options().write(true).open(&path).unwrap().set_len(length / 2).unwrap();
    }
    right();
    std::fs::remove_dir_all(folder.path().join("artifacts")).unwrap();
    right();
}

#[test]
fn two_services_do_not_share_a_folder() {
    let folder = Folder::new();
    story(on(&folder), async |_| {
        let error = planish::http::serve::bind(on(&folder)).await.map(drop).unwrap_err().to_string();
        assert!(error.contains("--data-dir"), "it says what to do: {error}");
    });
}

#[test]
fn l_a_bit_flipped_behind_the_first_part_cuts_one_answer_and_drops_the_artifact() {
    let folder = Folder::new();
    let job = with(mesh(7), "json");
    story(on_disk_alone(&folder), async |server| {
        let made = server.render(&job).await.ok();
        let address = made.header("content-location");
        until("it is on disk", || server.app.desk.tiers.disk_backlog().0 == 0).await;
        let flip = || {
            let path = files(&folder.path().join("artifacts")).into_iter().find(|path| path.extension().is_none());
            let mut bytes = std::fs::read(path.as_ref().unwrap()).unwrap();
            bytes[(1 << 20) + 99] ^= 8;
            std::fs::write(path.unwrap(), bytes).unwrap();
        };
        flip();
        let cut = server.client.get(server.url(address)).send().await.unwrap();
        assert_eq!(cut.headers()["content-length"], made.body.len().to_string().as_str());
        assert!(cut.bytes().await.is_err(), "the answer is cut, never wrong");
        assert_eq!((disk(server).artifacts, disk(server).damaged), (0, 1), "the artifact is dropped and counted");
        let gone = server.get(address).await.problem(404, "not-found");
        assert!(gone["detail"].as_str().unwrap().contains("send its job"), "{gone}");
        assert_eq!(server.render(&job).await.ok().body, made.body, "its job makes it again");
        until("it is on disk", || server.app.desk.tiers.disk_backlog().0 == 0).await;
        flip();
        let range = server.get_with(address, &[("range", "bytes=1048576-1048999")]).await;
        range.problem(404, "not-found");
        assert_eq!(disk(server).damaged, 2, "found before a byte is sent");
        assert_eq!(server.render(&job).await.ok().body, made.body);
        assert_eq!(server.get(address).await.ok().body, made.body);
    });
}
