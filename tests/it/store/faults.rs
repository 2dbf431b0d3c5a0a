//! The store on a full disk, and in a folder with foreign files.

use std::fs;
use std::sync::atomic::Ordering;

use planish::service::store::{Embedded, Store, StoreError};

use super::disk::{bytes_path, here, manifest_path};
use super::faulty::Faulty;
use super::{ROOMY, Scratch, get, key, n_files, noise, put, try_put};

#[test]
fn m6_a_full_disk_evicts_the_least_recently_used_until_the_new_artifact_fits() {
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    let store = disk.store(&scratch.0, ROOMY);
    (0..4).for_each(|number| drop(put(&store, number, &noise(number, 20_000))));
    disk.limit(&scratch.0, 90_000);
    assert!(get(&store, 0).is_some(), "0 is used, so 1 is the oldest now");
    put(&store, 4, &noise(4, 20_000));
    assert_eq!(here(&store, 0..5), [0, 2, 3, 4]);
    assert_eq!((store.usage().artifacts, store.usage().evicted), (4, 1));
    put(&store, 5, &noise(5, 60_000));
    assert_eq!(here(&store, 0..6), [4, 5], "as many leave as it takes");
    assert!(!bytes_path(&scratch.0, 2).exists() && !manifest_path(&scratch.0, 2).exists());
}

#[test]
fn m6_a_full_disk_with_nothing_left_to_evict_refuses_and_works_again_with_room() {
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    let store = disk.store(&scratch.0, ROOMY);
    put(&store, 0, &noise(0, 5_000));
    disk.limit(&scratch.0, 10_000);
    let error = try_put(&store, key(1), &noise(1, 20_000)).unwrap_err();
    assert!(error.is_full(), "{error}");
    assert_eq!((store.usage().artifacts, store.usage().evicted), (0, 1));
    assert_eq!(n_files(&scratch.0.join("tmp")), 0, "nothing stays in tmp");
    disk.limit(&scratch.0, 30_000);
    put(&store, 1, &noise(1, 20_000));
    assert_eq!(get(&store, 1).unwrap(), noise(1, 20_000));
}

#[test]
fn m6_a_disk_that_finds_itself_full_at_a_sync_evicts_and_writes_again() {
    // one commit syncs the bytes, the record, and the folder
    for full in 1..4 {
        let (scratch, disk) = (Scratch::new(), Faulty::new());
        let store = disk.store(&scratch.0, ROOMY);
        (0..5).for_each(|number| drop(put(&store, number, &noise(number, 20_000))));
        disk.full_syncs.store(full, Ordering::Relaxed);
        let before = disk.writes.load(Ordering::Relaxed);
        put(&store, 5, &noise(5, 20_000));
        assert!(disk.writes.load(Ordering::Relaxed) > before + 2, "bytes of a failed sync are written anew");
        assert_eq!(get(&store, 5).unwrap(), noise(5, 20_000));
        assert_eq!(store.usage().evicted, full as u64, "one leaves for each failure");
        drop(store);
        let store = scratch.open(ROOMY);
        assert_eq!(get(&store, 5).unwrap(), noise(5, 20_000), "it is there to stay");
    }
}

#[test]
fn l_a_folder_in_place_of_an_artifact_stops_neither_the_start_nor_other_artifacts() {
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    let store = disk.store(&scratch.0, ROOMY);
    (0..4).for_each(|number| drop(put(&store, number, &noise(number, 5_000))));
    drop(store);
    let folders = [bytes_path(&scratch.0, 0), manifest_path(&scratch.0, 1), bytes_path(&scratch.0, 7)];
    for path in &folders {
        let _ = fs::remove_file(path);
        fs::create_dir_all(path.join("inside")).unwrap();
    }
    fs::create_dir_all(scratch.0.join("tmp").join(format!("{}.7.tmp", key(9)))).unwrap();

    let store = disk.store(&scratch.0, ROOMY);
    assert_eq!(here(&store, 0..8), [2, 3]);
    let before = disk.writes.load(Ordering::Relaxed);
    for number in [0, 1, 7] {
        let error = try_put(&store, key(number), &noise(number, 5_000)).unwrap_err();
        assert!(matches!(error, StoreError::Occupied { .. }), "{error}");
        assert!(error.to_string().contains("remove it"), "{error}");
    }
    assert_eq!(disk.writes.load(Ordering::Relaxed), before, "nothing is written in vain");
    assert!(folders.iter().all(|path| path.join("inside").exists()), "folders of others are left alone");
    put(&store, 4, &noise(4, 5_000));
}

#[test]
fn l_a_folder_that_takes_the_place_of_an_artifact_costs_one_write() {
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    let store = disk.store(&scratch.0, ROOMY);
    put(&store, 0, &noise(0, 5_000));
    for path in [bytes_path(&scratch.0, 0), bytes_path(&scratch.0, 1), manifest_path(&scratch.0, 2)] {
        let _ = fs::remove_file(&path);
        fs::create_dir_all(path).unwrap();
    }
    assert_eq!(get(&store, 0), None, "it counts as damaged");
    assert_eq!((store.usage().artifacts, store.usage().damaged), (0, 1));
    for number in 0..3 {
        assert!(matches!(try_put(&store, key(number), &noise(number, 5)), Err(StoreError::Occupied { .. })));
        let before = disk.writes.load(Ordering::Relaxed);
        assert!(matches!(try_put(&store, key(number), &noise(number, 5)), Err(StoreError::Occupied { .. })));
        assert_eq!(disk.writes.load(Ordering::Relaxed), before);
    }
    assert_eq!(n_files(&scratch.0.join("tmp")), 0, "nothing stays in tmp");
}

#[test]
#[cfg(unix)]
fn l_removing_the_lock_file_lets_no_second_store_in() {
    let scratch = Scratch::new();
    let store = scratch.open(ROOMY);
    fs::remove_file(scratch.0.join("lock")).unwrap();
    let error = Embedded::open(&scratch.0, ROOMY).unwrap_err().to_string();
    assert!(error.contains("is in use by another process"), "{error}");
    put(&store, 1, &noise(1, 10));
    drop(store);
    assert!(get(&scratch.open(ROOMY), 1).is_some());
}
