//! The store in a folder: what survives, what is detected, what is removed.

use std::fs;
use std::path::{Path, PathBuf};

use planish::service::store::{Embedded, Manifest, PART_BYTES, Store, StoreError};

use super::{ROOMY, Scratch, get, key, n_files, noise, put, try_put};

pub(super) fn bytes_path(folder: &Path, number: u64) -> PathBuf {
    let name = key(number).to_string();
    folder.join("artifacts").join(&name[..2]).join(name)
}

pub(super) fn manifest_path(folder: &Path, number: u64) -> PathBuf {
    bytes_path(folder, number).with_extension("manifest")
}

fn change(path: &Path, change: impl FnOnce(&mut Vec<u8>)) {
    let mut bytes = fs::read(path).unwrap();
    change(&mut bytes);
    fs::write(path, bytes).unwrap();
}

pub(super) fn here(store: &dyn Store, numbers: std::ops::Range<u64>) -> Vec<u64> {
    numbers.filter(|&number| get(store, number).is_some()).collect()
}

#[test]
fn reopening_finds_everything() {
    let scratch = Scratch::new();
    let store = scratch.open(ROOMY);
    let manifests: Vec<_> = (0..20).map(|number| put(&store, number, &noise(number, 300_000))).collect();
    let before = store.usage();
    drop(store);
    let store = scratch.open(ROOMY);
    assert_eq!(store.usage(), before);
    for (number, manifest) in (0..).zip(manifests) {
        assert_eq!(store.manifest(&key(number)).unwrap(), Some(manifest));
        assert_eq!(get(&store, number).unwrap(), noise(number, 300_000));
    }
}

#[test]
fn reopening_knows_the_order_of_use_and_keeps_to_a_smaller_capacity() {
    let scratch = Scratch::new();
    let store = scratch.open(ROOMY);
    (0..6).for_each(|number| drop(put(&store, number, &noise(number, 20_000))));
    assert_eq!(here(&store, 1..3), [1, 2], "1 and 2 are the most recently used");
    drop(store);
    let store = scratch.open(80_000);
    assert_eq!(here(&store, 0..6), [1, 2, 5]);
    assert_eq!((store.usage().artifacts, store.usage().evicted), (3, 3));
    assert!(!bytes_path(&scratch.0, 0).exists() && !manifest_path(&scratch.0, 0).exists());
}

#[test]
fn what_was_evicted_is_gone_from_the_disk() {
    let scratch = Scratch::new();
    let store = scratch.open(100_000);
    (0..50).for_each(|number| drop(put(&store, number, &noise(number, 20_000))));
    let kept: usize =
        fs::read_dir(scratch.0.join("artifacts")).unwrap().map(|shard| n_files(&shard.unwrap().path())).sum();
    assert_eq!(kept as u64, 2 * store.usage().artifacts, "bytes and manifest of each");
}

#[test]
fn a_flipped_bit_is_never_served() {
    for (at, part) in [(0, 0), (PART_BYTES - 1, 0), (PART_BYTES, 1), (2 * PART_BYTES + 99, 2)] {
        let scratch = Scratch::new();
        let store = scratch.open(ROOMY);
        let manifest = put(&store, 1, &noise(1, 2 * PART_BYTES + 100));
        put(&store, 2, &noise(2, 100));
        change(&bytes_path(&scratch.0, 1), |bytes| bytes[at] ^= 4);
        for index in 0..3 {
            assert_eq!(store.part(&manifest, index).unwrap().is_none(), index >= part, "only parts before it are good");
        }
        assert_eq!(store.manifest(&key(1)).unwrap(), None, "it is dropped");
        assert_eq!((store.usage().artifacts, store.usage().damaged), (1, 1), "and counted once");
        assert!(!bytes_path(&scratch.0, 1).exists() && !manifest_path(&scratch.0, 1).exists());
        put(&store, 1, &noise(1, 2 * PART_BYTES + 100));
        assert_eq!(get(&store, 1).unwrap(), noise(1, 2 * PART_BYTES + 100), "and can be made again");
    }
}

#[test]
fn a_truncated_or_missing_file_is_noticed_when_read() {
    let scratch = Scratch::new();
    let store = scratch.open(ROOMY);
    (0..2).for_each(|number| drop(put(&store, number, &noise(number, 5000))));
    change(&bytes_path(&scratch.0, 0), |bytes| bytes.truncate(4999));
    fs::remove_file(bytes_path(&scratch.0, 1)).unwrap();
    assert!(here(&store, 0..2).is_empty());
    assert_eq!((store.usage().artifacts, store.usage().bytes, store.usage().damaged), (0, 0, 2));
}

#[test]
fn opening_removes_damaged_artifacts() {
    let scratch = Scratch::new();
    let store = scratch.open(ROOMY);
    (0..6).for_each(|number| drop(put(&store, number, &noise(number, 5000))));
    drop(store);
    change(&bytes_path(&scratch.0, 0), |bytes| bytes.truncate(4999));
    change(&bytes_path(&scratch.0, 1), |bytes| bytes.push(0));
    change(&manifest_path(&scratch.0, 2), |bytes| bytes[40] ^= 1);
    change(&manifest_path(&scratch.0, 3), |bytes| bytes.truncate(100));
    fs::copy(manifest_path(&scratch.0, 5), manifest_path(&scratch.0, 4)).unwrap();
    let store = scratch.open(ROOMY);
    assert_eq!(here(&store, 0..6), [5]);
    assert_eq!((store.usage().artifacts, store.usage().damaged), (1, 5));
    assert!((0..5).all(|number| !bytes_path(&scratch.0, number).exists()));
    assert!((0..5).all(|number| !manifest_path(&scratch.0, number).exists()));
}

#[test]
fn opening_removes_left_overs_and_nothing_else() {
    let scratch = Scratch::new();
    let store = scratch.open(ROOMY);
    (0..3).for_each(|number| drop(put(&store, number, &noise(number, 5000))));
    drop(store);
    let left_over = scratch.0.join("tmp").join(format!("{}.7.tmp", key(9)));
    fs::write(&left_over, "half").unwrap();
    fs::remove_file(manifest_path(&scratch.0, 0)).unwrap();
    fs::remove_file(bytes_path(&scratch.0, 1)).unwrap();
    let foreign = [scratch.0.join("tmp/notes.txt"), scratch.0.join("artifacts/notes.txt"), scratch.0.join("notes.txt")];
    for path in &foreign {
        fs::write(path, "not yours").unwrap();
    }
    let store = scratch.open(ROOMY);
    assert_eq!(here(&store, 0..3), [2]);
    assert_eq!(store.usage().damaged, 0, "left-overs are no damage");
    assert!(!left_over.exists() && !bytes_path(&scratch.0, 0).exists() && !manifest_path(&scratch.0, 1).exists());
    assert!(foreign.iter().all(|path| path.exists()), "files of others are left alone");
}

#[test]
fn artifacts_of_another_results_version_are_removed() {
    let scratch = Scratch::new();
    let store = scratch.open(ROOMY);
    (0..2).for_each(|number| drop(put(&store, number, &noise(number, 5000))));
    drop(store);
    change(&manifest_path(&scratch.0, 0), |bytes| {
        let mut manifest = Manifest::decode(bytes).unwrap();
        manifest.results_version += 1;
        *bytes = manifest.encode();
    });
    let store = scratch.open(ROOMY);
    assert_eq!(here(&store, 0..2), [1]);
    assert_eq!(store.usage().damaged, 0);
    assert!(!bytes_path(&scratch.0, 0).exists() && !manifest_path(&scratch.0, 0).exists());
}

#[test]
fn an_index_that_is_gone_or_garbage_is_made_anew() {
    let scratch = Scratch::new();
    drop(scratch.open(ROOMY));
    let index = scratch.0.join("index.redb");
    let sound = fs::read(&index).unwrap();
    let mut broken = vec![Vec::new(), b"garbage".to_vec(), noise(1, 100_000), sound[..sound.len() / 2].to_vec()];
    for seed in 0..40 {
        let mut bytes = sound.clone();
        for place in noise(seed, 16).chunks(2) {
            let place = usize::from(u16::from_le_bytes([place[0], place[1]])) * 3 % bytes.len();
            bytes[place] ^= 0x55;
        }
        broken.push(bytes);
    }
    put(&scratch.open(ROOMY), 0, &noise(0, 5000));
    fs::remove_file(&index).unwrap();
    assert_eq!(here(&scratch.open(ROOMY), 0..1), [0]);
    for (number, bytes) in (1..).zip(broken) {
        fs::write(&index, bytes).unwrap();
        let store = scratch.open(ROOMY);
        assert_eq!(store.usage().artifacts, number);
        put(&store, number, &noise(number, 5000));
        drop(store);
        assert!(fs::metadata(&index).unwrap().len() > 0);
    }
}

#[test]
fn without_an_index_the_order_is_that_of_the_commits() {
    let scratch = Scratch::new();
    let store = scratch.open(ROOMY);
    for number in 0..4 {
        put(&store, number, &noise(number, 20_000));
        let written = std::time::SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(1000 - number);
        fs::File::open(manifest_path(&scratch.0, number)).unwrap().set_modified(written).unwrap();
    }
    drop(store);
    fs::remove_file(scratch.0.join("index.redb")).unwrap();
    assert_eq!(here(&scratch.open(60_000), 0..4), [0, 1], "the times say that 3 was the first");
}

#[test]
fn artifacts_that_an_old_index_does_not_know_are_the_newest() {
    let scratch = Scratch::new();
    let index = scratch.0.join("index.redb");
    let put_two = |first: u64| {
        let store = scratch.open(ROOMY);
        (first..first + 2).for_each(|number| drop(put(&store, number, &noise(number, 20_000))));
    };
    put_two(0);
    let old = fs::read(&index).unwrap();
    put_two(2);
    fs::write(&index, old).unwrap();
    assert_eq!(here(&scratch.open(60_000), 0..4), [2, 3]);
}

#[test]
fn a_folder_serves_one_store_at_a_time() {
    let scratch = Scratch::new();
    let store = scratch.open(ROOMY);
    put(&store, 1, &noise(1, 10));
    let error = Embedded::open(&scratch.0, ROOMY).unwrap_err().to_string();
    assert!(error.contains("is in use by another process"), "{error}");
    assert!(get(&store, 1).is_some(), "the first one goes on");
    drop(store);
    assert!(get(&scratch.open(ROOMY), 1).is_some());
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let scratch = Scratch::new();
    let file = scratch.0.join("file");
    fs::write(&file, "").unwrap();
    let error = Embedded::open(&file, ROOMY).unwrap_err().to_string();
    assert!(error.contains(&file.display().to_string()), "{error}");
}

#[test]
fn folders_that_vanish_cost_one_answer_and_come_back() {
    let scratch = Scratch::new();
    let store = scratch.open(ROOMY);
    put(&store, 1, &noise(1, 5000));
    let mut spool = store.spool(key(2)).unwrap();
    spool.write_all(&noise(2, PART_BYTES + 1)).unwrap();
    fs::remove_dir_all(scratch.0.join("tmp")).unwrap();
    let error = spool.commit(super::description()).unwrap_err();
    assert!(matches!(&error, StoreError::Io(error) if error.kind() == std::io::ErrorKind::NotFound), "{error}");
    assert_eq!(here(&store, 1..3), [1], "the store is intact");
    assert_eq!(store.usage().artifacts, 1);

    fs::remove_dir_all(scratch.0.join("tmp")).unwrap();
    fs::write(scratch.0.join("tmp"), "in the way").unwrap();
    assert!(matches!(try_put(&store, key(3), &noise(3, 10)), Err(StoreError::Io(_))));
    fs::remove_file(scratch.0.join("tmp")).unwrap();
    put(&store, 3, &noise(3, 10));
    fs::remove_dir_all(scratch.0.join("artifacts")).unwrap();
    assert!(here(&store, 1..4).is_empty());
    put(&store, 4, &noise(4, 10));
    assert_eq!(here(&store, 1..5), [4]);
    assert_eq!(n_files(&scratch.0.join("tmp")), 0);
}
