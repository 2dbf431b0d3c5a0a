//! The contract of stores, checked on each of them.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

pub(crate) mod bucket;
mod codec;
mod crash;
mod disk;
mod faults;
pub(crate) mod faulty;
mod records;
mod shared;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use planish::job::key::Key;
use planish::service::job_key::Tenant;
use planish::service::store::{
    ArtifactDescription, Embedded, Manifest, MemoryStore, Owners, PART_BYTES, Store, StoreError,
};

pub(crate) const ROOMY: u64 = 1 << 30;

/// A temporary folder for one test, removed on drop.
pub(crate) struct Scratch(pub(crate) PathBuf);

impl Scratch {
    pub(crate) fn new() -> Self {
        static COUNTER: AtomicU32 = AtomicU32::new(0);
        let name = format!("planish-store-{}-{}", std::process::id(), COUNTER.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(crate) fn open(&self, capacity: u64) -> Embedded {
        Embedded::open(&self.0, capacity).unwrap()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn on_every_store(capacity: u64, check: impl Fn(&dyn Store)) {
    check(&MemoryStore::new(capacity));
    let scratch = Scratch::new();
    check(&scratch.open(capacity));
    assert_eq!(n_files(&scratch.0.join("tmp")), 0, "nothing stays in tmp");
}

pub(crate) fn key(number: u64) -> Key {
    Key::from_bytes(*blake3::hash(&number.to_le_bytes()).as_bytes())
}

/// Returns `length` pseudorandom bytes that depend on `seed` only.
pub(crate) fn noise(seed: u64, length: usize) -> Vec<u8> {
    let mut bytes = vec![0; length];
    blake3::Hasher::new().update(&seed.to_le_bytes()).finalize_xof().fill(&mut bytes);
    bytes
}

pub(crate) fn description() -> ArtifactDescription {
    ArtifactDescription {
        media_type: "model/gltf-binary".to_owned(),
        warnings: vec!["one vertex was split".to_owned()],
        owners: Owners::default(),
    }
}

fn try_put(store: &dyn Store, key: Key, bytes: &[u8]) -> Result<Arc<Manifest>, StoreError> {
    let mut spool = store.spool(key)?;
    spool.write_all(bytes)?;
    spool.commit(description())
}

fn put(store: &dyn Store, number: u64, bytes: &[u8]) -> Arc<Manifest> {
    try_put(store, key(number), bytes).unwrap()
}

fn read(store: &dyn Store, manifest: &Manifest) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    for index in 0..manifest.parts.len() {
        bytes.extend_from_slice(&store.part(manifest, index).unwrap()?);
    }
    Some(bytes)
}

fn get(store: &dyn Store, number: u64) -> Option<Vec<u8>> {
    let manifest = store.manifest(&key(number)).unwrap()?;
    read(store, &manifest)
}

fn n_files(folder: &Path) -> usize {
    std::fs::read_dir(folder).map_or(0, Iterator::count)
}

#[test]
fn what_was_put_is_got_at_every_length_around_a_part() {
    on_every_store(ROOMY, |store| {
        let lengths = [0, 1, 4096, PART_BYTES - 1, PART_BYTES, PART_BYTES + 1, 3 * PART_BYTES + PART_BYTES / 2];
        for (number, &length) in (0..).zip(&lengths) {
            let bytes = noise(number, length);
            let manifest = put(store, number, &bytes);
            assert_eq!(store.manifest(&key(number)).unwrap().unwrap(), manifest);
            assert_eq!((manifest.key, manifest.length), (key(number), length as u64));
            assert_eq!(manifest.content.as_bytes(), blake3::hash(&bytes).as_bytes());
            let hashes = bytes.chunks(PART_BYTES).map(|part| Key::from_bytes(*blake3::hash(part).as_bytes()));
            assert!(manifest.parts.iter().copied().eq(hashes), "one hash a part");
            assert_eq!(
                (&manifest.media_type, &manifest.warnings),
                (&description().media_type, &description().warnings)
            );
            assert_eq!(get(store, number).unwrap(), bytes);
            assert_eq!(store.part(&manifest, manifest.parts.len()).unwrap(), None, "no part after the last");
            assert_eq!(store.part(&manifest, usize::MAX).unwrap(), None);
        }
        assert_eq!(store.usage().artifacts, lengths.len() as u64);
        assert_eq!(store.usage().damaged, 0);
        assert_eq!(store.manifest(&key(99)).unwrap(), None);
    });
}

#[test]
fn small_writes_make_the_same_artifact_as_one_large_write() {
    on_every_store(ROOMY, |store| {
        let bytes = noise(1, 2 * PART_BYTES + 4321);
        let whole = put(store, 1, &bytes);
        let mut spool = store.spool(key(2)).unwrap();
        bytes.chunks(977).for_each(|piece| spool.write_all(piece).unwrap());
        let pieces = spool.commit(description()).unwrap();
        assert_eq!((pieces.content, &pieces.parts), (whole.content, &whole.parts));
        assert_eq!(get(store, 2).unwrap(), bytes);
    });
}

#[test]
fn owners_that_are_added_count_in_the_size_of_an_artifact() {
    let kept = |store: &dyn Store, owners: std::ops::Range<u64>| {
        let mut spool = store.spool(key(1)).unwrap();
        spool.write_all(&noise(1, 5000)).unwrap();
        // with the later owners the manifest takes a second block of the disk
        let (warnings, owners) = (vec!["x".repeat(3000)], owners.map(Tenant).collect());
        spool.commit(ArtifactDescription { warnings, owners, ..description() }).unwrap();
        store.usage().bytes
    };
    on_every_store(ROOMY, |store| {
        let (few, more) = (kept(store, 1..2), kept(store, 1..250));
        assert!(few < more, "{few} {more}");
        store.remove(&key(1)).unwrap();
        assert_eq!(store.usage().bytes, 0);
        assert_eq!(kept(store, 1..250), more, "as if all had come at once");
    });
}

#[test]
fn the_least_recently_used_artifact_leaves_first() {
    on_every_store(100_000, |store| {
        let bytes = noise(0, 20_000);
        (0..4).for_each(|number| drop(put(store, number, &bytes)));
        assert_eq!((store.usage().artifacts, store.usage().evicted), (4, 0));
        assert!(get(store, 0).is_some(), "0 is used, so 1 is the oldest now");
        put(store, 4, &bytes);
        put(store, 5, &bytes);
        let here = [0, 1, 2, 3, 4, 5].map(|number| store.manifest(&key(number)).unwrap().is_some());
        assert_eq!(here, [true, false, false, true, true, true]);
        assert_eq!((store.usage().artifacts, store.usage().evicted), (4, 2));
    });
}

#[test]
fn the_capacity_is_never_exceeded() {
    on_every_store(200_000, |store| {
        for number in 0..300 {
            let length = usize::from(noise(number, 1)[0]) * 350;
            put(store, number, &noise(number, length));
            let usage = store.usage();
            assert!(usage.bytes <= usage.capacity, "{usage:?}");
            assert!(store.manifest(&key(number)).unwrap().is_some(), "the newest is here");
        }
        assert_eq!(store.usage().artifacts + store.usage().evicted, 300);
    });
}

#[test]
fn empty_artifacts_cost_something_too() {
    on_every_store(100_000, |store| {
        (0..300).for_each(|number| drop(put(store, number, &[])));
        assert!(store.usage().artifacts < 200);
        assert_eq!(get(store, 299), Some(Vec::new()));
    });
}

#[test]
fn a_dropped_spool_leaves_nothing() {
    on_every_store(ROOMY, |store| {
        let mut spool = store.spool(key(1)).unwrap();
        spool.write_all(&noise(1, 2 * PART_BYTES + 1)).unwrap();
        assert_eq!(store.manifest(&key(1)).unwrap(), None, "nothing is visible before the commit");
        drop(spool);
        assert_eq!(store.manifest(&key(1)).unwrap(), None);
        assert_eq!((store.usage().artifacts, store.usage().bytes), (0, 0));
    });
}

#[test]
fn the_same_bytes_again_change_nothing() {
    on_every_store(ROOMY, |store| {
        let first = put(store, 1, &noise(1, 5000));
        let before = store.usage();
        let mut spool = store.spool(key(1)).unwrap();
        spool.write_all(&noise(1, 5000)).unwrap();
        let second = spool
            .commit(ArtifactDescription {
                media_type: "text/plain".to_owned(),
                warnings: Vec::new(),
                owners: Owners::default(),
            })
            .unwrap();
        assert_eq!(second, first, "the first one is kept");
        assert_eq!(store.usage(), before);
    });
}

#[test]
fn other_bytes_under_the_same_key_replace_the_old_ones() {
    on_every_store(ROOMY, |store| {
        let old = put(store, 1, &noise(1, PART_BYTES + 5));
        let new = put(store, 1, &noise(2, PART_BYTES + 5));
        assert_eq!(get(store, 1).unwrap(), noise(2, PART_BYTES + 5));
        assert_eq!(store.part(&old, 0).unwrap(), None, "a reader of the old bytes is never given the new ones");
        assert!(store.part(&new, 0).unwrap().is_some(), "and it does not make them damaged");
        assert_eq!((store.usage().artifacts, store.usage().damaged, store.usage().evicted), (1, 0, 0));
    });
}

#[test]
fn a_removed_artifact_is_gone() {
    on_every_store(ROOMY, |store| {
        let manifest = put(store, 1, &noise(1, 100));
        store.remove(&key(1)).unwrap();
        store.remove(&key(1)).unwrap();
        assert_eq!(store.manifest(&key(1)).unwrap(), None);
        assert_eq!(store.part(&manifest, 0).unwrap(), None);
        assert_eq!((store.usage().artifacts, store.usage().bytes, store.usage().damaged), (0, 0, 0));
    });
}

#[test]
fn what_is_larger_than_half_the_store_is_refused_at_once() {
    on_every_store(100_000, |store| {
        put(store, 1, &noise(1, 10_000));
        let mut spool = store.spool(key(2)).unwrap();
        spool.write_all(&noise(2, 50_000)).unwrap();
        let error = StoreError::from(spool.write_all(&[0]).unwrap_err());
        assert!(matches!(error, StoreError::TooLarge { capacity: 50_000 }), "{error}");
        assert!(spool.write_all(&[0]).is_err(), "it accepts nothing more");
        assert!(matches!(spool.commit(description()), Err(StoreError::TooLarge { .. })));
        let error = try_put(store, key(3), &noise(3, 50_000)).unwrap_err();
        assert!(matches!(error, StoreError::TooLarge { .. }), "its record counts too: {error}");
        assert!(get(store, 1).is_some(), "nothing left for it");
        assert_eq!((store.usage().artifacts, store.usage().evicted), (1, 0));
    });
}

#[test]
fn a_store_without_room_refuses_everything_and_works() {
    on_every_store(0, |store| {
        assert!(matches!(try_put(store, key(1), &[]), Err(StoreError::TooLarge { .. })));
        assert_eq!(store.manifest(&key(1)).unwrap(), None);
        assert_eq!(store.usage().bytes, 0);
    });
}

#[test]
fn eight_threads_put_and_get_and_see_whole_artifacts_only() {
    on_every_store(3 << 20, |store| {
        std::thread::scope(|scope| {
            for thread in 0..8 {
                scope.spawn(move || {
                    for step in 0..40_u64 {
                        let number = (thread * 7 + step * 13) % 24;
                        let bytes = noise(number, usize::try_from(number).unwrap() * 10_007);
                        if step % 3 == 0 {
                            put(store, number, &bytes);
                        } else if step % 17 == 0 {
                            store.remove(&key(number)).unwrap();
                        } else if let Some(found) = get(store, number) {
                            assert_eq!(found, bytes);
                        }
                        assert!(store.usage().bytes <= 3 << 20);
                    }
                });
            }
        });
        assert_eq!(store.usage().damaged, 0, "races are not damage");
    });
}
