//! The service, killed at random moments under a mixed load: no accepted job is lost, and no byte is wrong.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::http::jobs::{mesh, polygon};
use crate::http::server::{Folder, PATIENCE};

/// Default number of times that the service is killed.
const KILLS: u64 = 10;
/// The environment variable with the number of kills: 200 and more in manual runs.
const NUMBER: &str = "PLANISH_TEST_KILLS";
/// Number of different moments of a kill, in steps of a few milliseconds; each round has one of them.
const MOMENTS: u64 = 60;

/// Number of jobs in a batch of the load.
const BATCH: usize = 3;

/// The path of a job or a batch, and the numbers of its jobs.
type Accepted = (String, Vec<u64>);

/// A process of the service, killed when the value is dropped.
pub(crate) struct Service {
    child: Child,
    pub(crate) url: String,
}

impl Service {
    fn start(data: &Path) -> Self {
        Self::run(&mut Command::new(env!("CARGO_BIN_EXE_planish")), data)
    }

    /// Returns the process id.
    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    /// Starts the service with a command.
    pub(crate) fn run(command: &mut Command, data: &Path) -> Self {
        let mut child = command
            .args(["serve", "--listen", "127.0.0.1:0", "--threads", "2", "--log", "error", "--data-dir"])
            .arg(data)
            // the service refuses variables that are not settings
            .env_remove(NUMBER)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut said = BufReader::new(child.stderr.take().unwrap()).lines();
        let url = said.find_map(|line| {
            let line = line.unwrap();
            line.split("listening on ").nth(1).map(str::to_owned)
        });
        std::thread::spawn(move || said.for_each(drop));
        Self { child, url: url.expect("it says where it listens") }
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Returns the job of the load with this number; different numbers give different jobs.
fn job(number: u64) -> Value {
    let mut job = if number.is_multiple_of(3) { polygon(6) } else { mesh(2 + u32::try_from(number % 3).unwrap()) };
    let places = if number.is_multiple_of(3) { "/input/polygon/points/0/0" } else { "/input/mesh/positions/0/0" };
    *job.pointer_mut(places).unwrap() = json!(0.001 * f64::from(u32::try_from(number).unwrap()));
    job["outputs"] = json!([{ "format": "json" }, { "format": "stats" }]);
    job
}

/// Computes the bytes of the outputs of a job in this process.
fn fresh(job: &Value) -> Vec<Vec<u8>> {
    let outputs = job["outputs"].as_array().unwrap();
    let alone = outputs.iter().map(|output| {
        let mut alone = job.clone();
        alone["outputs"] = json!([output]);
        crate::support::render(&alone).unwrap().0
    });
    alone.collect()
}

/// Returns a pseudorandom number, the same in every run.
fn mixed(number: u64) -> u64 {
    let mut x = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x ^= x >> 31;
    x.wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 17
}

/// Posts jobs, and occasionally a batch, until the service is gone. Returns the accepted ones by their paths, each with
/// the numbers of its jobs.
async fn load(client: reqwest::Client, url: String, first: u64) -> Vec<Accepted> {
    let mut accepted = Vec::new();
    for number in (first..).step_by(BATCH) {
        let numbers = if mixed(number).is_multiple_of(5) { number..number + BATCH as u64 } else { number..number + 1 };
        let numbers: Vec<_> = numbers.collect();
        let request = if let [one] = numbers[..] {
            client.post(format!("{url}/v1/jobs")).json(&job(one))
        } else {
            let jobs: Vec<_> = numbers.iter().copied().map(job).collect();
            client.post(format!("{url}/v1/batches")).json(&json!({ "jobs": jobs }))
        };
        let Ok(answer) = request.send().await else { break };
        let status = answer.status().as_u16();
        if status == 202 || status == 200 {
            accepted.push((answer.headers()["location"].to_str().unwrap().to_owned(), numbers));
        }
        // now and then, a request to render beside the jobs
        if mixed(number).is_multiple_of(4)
            && client.post(format!("{url}/v1/render")).json(&polygon(5)).send().await.is_err()
        {
            break;
        }
    }
    accepted
}

async fn settled(client: &reqwest::Client, place: &str) -> Value {
    let start = Instant::now();
    loop {
        let status: Value = client.get(place).send().await.unwrap().json().await.unwrap();
        if !matches!(status["state"].as_str(), Some("queued" | "running")) {
            return status;
        }
        assert!(start.elapsed() < PATIENCE, "waited in vain: {status}");
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
}

#[test]
fn whatever_moment_it_is_killed_no_accepted_job_is_lost_and_no_byte_is_wrong() {
    let kills = std::env::var(NUMBER).map_or(KILLS, |kills| kills.parse().unwrap());
    let folder = Folder::new();
    let data = folder.path().join("data");
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().unwrap();
    let client = crate::http::server::client_builder().build().unwrap();
    let (mut accepted, mut n_checked, mut n_batches) = (BTreeMap::new(), 0, 0);
    for round in 0..kills {
        let mut service = Service::start(&data);
        let posting = runtime.spawn(load(client.clone(), service.url.clone(), round * 1000));
        std::thread::sleep(Duration::from_millis(20 + 7 * (mixed(round) % MOMENTS)));
        service.child.kill().unwrap();
        service.child.wait().unwrap();
        accepted.extend(runtime.block_on(posting).unwrap());
        if round % 8 == 7 || round + 1 == kills {
            let service = Service::start(&data);
            runtime.block_on(check(&client, &service.url, &accepted));
            n_checked += accepted.values().map(Vec::len).sum::<usize>();
            n_batches += accepted.values().filter(|numbers| numbers.len() > 1).count();
            accepted.clear();
        }
    }
    assert!(n_checked as u64 >= kills, "only {n_checked} jobs were accepted");
    assert!(n_batches as u64 >= kills / 10, "only {n_batches} batches were accepted");
    drop(Service::start(&data));
    let left: Vec<_> = std::fs::read_dir(data.join("tmp")).unwrap().collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn a_job_with_which_the_process_ends_six_times_is_given_up() {
    let folder = Folder::new();
    let data = folder.path().join("data");
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().unwrap();
    let client = crate::http::server::client_builder().build().unwrap();
    let mut poison = crate::http::jobs::endless();
    poison["outputs"] = json!([{ "format": "stats" }]);
    let batch = json!({ "jobs": [job(1), poison] });
    let mut place = String::new();
    for _ in 0..6 {
        let mut service = Service::start(&data);
        runtime.block_on(async {
            let posted = client.post(format!("{}/v1/batches", service.url)).json(&batch).send().await.unwrap();
            place = posted.headers()["location"].to_str().unwrap().to_owned();
            let start = Instant::now();
            loop {
                let status: Value =
                    client.get(format!("{}{place}", service.url)).send().await.unwrap().json().await.unwrap();
                if status["items"][1]["state"] == "running" {
                    return;
                }
                assert!(start.elapsed() < PATIENCE, "waited in vain: {status}");
                tokio::time::sleep(Duration::from_millis(5)).await;
            }
        });
        // the work begun is written down by now, or soon
        std::thread::sleep(Duration::from_millis(300));
        service.child.kill().unwrap();
        service.child.wait().unwrap();
    }
    let service = Service::start(&data);
    let status = runtime.block_on(settled(&client, &format!("{}{place}", service.url)));
    assert_eq!((&status["state"], &status["attempts"]), (&"failed".into(), &7.into()), "{status}");
    let [done, poison] = [&status["items"][0], &status["items"][1]];
    assert_eq!((&done["state"], &poison["state"]), (&"done".into(), &"failed".into()), "{status}");
    assert!(poison["error"].as_str().unwrap().contains("begun 6 times"), "{poison}");
}

/// Checks that every accepted job, alone or in a batch, is known, ends, and has the bytes that this process computes.
async fn check(client: &reqwest::Client, url: &str, accepted: &BTreeMap<String, Vec<u64>>) {
    for (place, numbers) in accepted {
        let status = settled(client, &format!("{url}{place}")).await;
        assert_eq!(status["state"], "done", "jobs {numbers:?}: {status}");
        let jobs = status["items"].as_array().cloned().unwrap_or_else(|| vec![status.clone()]);
        assert_eq!(jobs.len(), numbers.len(), "{status}");
        for (status, &number) in jobs.iter().zip(numbers) {
            assert_eq!(status["state"], "done", "job {number}: {status}");
            for (output, fresh) in status["outputs"].as_array().unwrap().iter().zip(fresh(&job(number))) {
                let href = output["href"].as_str().unwrap();
                let answer = client.get(format!("{url}{href}")).send().await.unwrap();
                assert_eq!(answer.status(), 200, "job {number}: {href}");
                assert!(answer.bytes().await.unwrap() == fresh, "job {number}: {href} has other bytes");
            }
        }
    }
}
