//! Processes that are killed, and disks that fill up, at any moment. The test binary runs itself as the victim.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use planish::job::key::Key;
use planish::service::store::{Embedded, Store, StoreError};

use super::{Scratch, get, key, n_files, noise, put, try_put};

/// The environment variable with the folder of a child; unset in the parent.
const FOLDER: &str = "PLANISH_TEST_STORE_FOLDER";
/// The environment variable with the number of the first artifact that the child writes.
const FIRST: &str = "PLANISH_TEST_STORE_FIRST";
const ROUNDS: u64 = 10;
const NUMBERS_A_ROUND: u64 = 10_000;
const CAPACITY: u64 = 8 << 30;

/// Returns the arguments with which this binary runs one test of this file only.
fn only(test: &str) -> [String; 3] {
    let module = module_path!().split_once("::").map_or("", |(_, path)| path);
    [format!("{module}::{test}"), "--exact".to_owned(), "--nocapture".to_owned()]
}

fn folder() -> Option<PathBuf> {
    std::env::var_os(FOLDER).map(PathBuf::from)
}

/// Returns the bytes of artifact `number`: none to two and a half parts, mostly short.
fn bytes(number: u64) -> Vec<u8> {
    let size = noise(number, 3);
    noise(number, usize::from(size[0]) * usize::from(size[1]) * usize::from(size[2] % 5) * 10)
}

/// The child of the test below: commits artifacts, and prints each key afterwards, until it is killed.
#[test]
fn child_writer_entry() {
    let (Some(folder), Ok(first)) = (folder(), std::env::var(FIRST)) else { return };
    let first: u64 = first.parse().unwrap();
    let store = Embedded::open(&folder, CAPACITY).unwrap();
    std::thread::scope(|scope| {
        for thread in 0..2 {
            let store = &store;
            scope.spawn(move || {
                for number in (first + thread..first + NUMBERS_A_ROUND).step_by(2) {
                    put(store, number, &bytes(number));
                    writeln!(std::io::stdout(), "\n{}", key(number)).unwrap();
                }
            });
        }
    });
}

/// Runs the child, kills it shortly after its `n_commits`th commit, and returns the keys that it printed.
fn keys_named_before_the_kill(folder: &Path, first: u64, n_commits: usize, wait: Duration) -> Vec<Key> {
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(only("child_writer_entry"))
        .env(FOLDER, folder)
        .env(FIRST, first.to_string())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut keys =
        BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok).filter_map(|line| Key::parse(&line));
    let mut named: Vec<Key> = keys.by_ref().take(n_commits).collect();
    std::thread::sleep(wait);
    child.kill().unwrap();
    child.wait().unwrap();
    named.extend(keys);
    named
}

#[test]
fn whatever_moment_it_is_killed_a_named_artifact_stays_and_none_is_wrong() {
    let scratch = Scratch::new();
    let mut named = Vec::new();
    for round in 0..ROUNDS {
        let dice = noise(1000 + round, 3);
        let wait = Duration::from_micros(u64::from(dice[1]) * u64::from(dice[2] % 64));
        let first = round * NUMBERS_A_ROUND;
        let n_commits = usize::from(dice[0] % 24);
        let new = keys_named_before_the_kill(&scratch.0, first, n_commits, wait);
        assert!(new.len() >= n_commits, "the child ended before it was killed");
        named.extend(new);

        let store = Embedded::open(&scratch.0, CAPACITY).unwrap();
        assert_eq!(n_files(&scratch.0.join("tmp")), 0, "left-overs are removed");
        let mut found = Vec::new();
        for number in (0..=round).flat_map(|round| round * NUMBERS_A_ROUND..round * NUMBERS_A_ROUND + 1000) {
            if store.manifest(&key(number)).unwrap().is_some() {
                assert_eq!(get(&store, number).expect("what has a manifest has its bytes"), bytes(number));
                found.push(key(number));
            }
        }
        assert!(named.iter().all(|key| found.contains(key)), "every named artifact is here");
        assert_eq!((store.usage().damaged, store.usage().evicted), (0, 0));
        assert_eq!(store.usage().artifacts, found.len() as u64);
    }
}

/// The child of the test below: its files cannot grow beyond the limit that its shell has set.
#[test]
fn child_on_a_full_disk_entry() {
    let Some(folder) = folder().filter(|_| std::env::var_os(FIRST).is_none()) else { return };
    let store = Embedded::open(&folder, CAPACITY).unwrap();
    put(&store, 1, &noise(1, 100_000));
    for attempt in 0..3 {
        let error = try_put(&store, key(2), &noise(2, 12 << 20)).unwrap_err();
        assert!(matches!(error, StoreError::Io(_)), "{error}");
        assert_eq!(n_files(&folder.join("tmp")), 0, "attempt {attempt} leaves nothing");
    }
    assert_eq!(get(&store, 1).unwrap(), noise(1, 100_000), "what was there is still served");
    put(&store, 3, &noise(3, 100_000));
    assert_eq!(store.usage().artifacts, 2);
}

/// Under a limit on file sizes, a write fails as on a full disk (the signal is ignored, the error remains).
#[test]
#[cfg(unix)]
fn a_full_disk_fails_one_commit_and_nothing_else() {
    let scratch = Scratch::new();
    let script = "trap '' XFSZ; ulimit -f 16384 || exit 0; exec \"$0\" \"$@\"";
    let exe = std::env::current_exe().unwrap();
    let child = Command::new("sh")
        .args(["-c", script])
        .arg(exe)
        .args(only("child_on_a_full_disk_entry"))
        .env(FOLDER, &scratch.0)
        .env_remove(FIRST)
        .output()
        .unwrap();
    assert!(child.status.success(), "{}", String::from_utf8_lossy(&child.stderr));
    let store = scratch.open(CAPACITY);
    assert_eq!([1, 2, 3].map(|number| get(&store, number).is_some()), [true, false, true]);
}
