//! The store that servers share: results of one are found by others, and damaged ones are never returned.

use std::sync::Arc;
use std::sync::atomic::Ordering::SeqCst;
use std::time::Duration;

use planish::job::key::{Key, RESULTS_VERSION, content};
use planish::service::clock::Manual;
use planish::service::job_key::Tenant;
use planish::service::store::{ArtifactDescription, Manifest, Owners, PART_BYTES, Store, StoreError};
use planish::service::tiers::Tiers;

use super::bucket::FaultyBucket;
use super::{ROOMY, description, key, noise, put, read, try_put};

fn found(store: &dyn Store, number: u64) -> Option<Vec<u8>> {
    let manifest = store.look_up(&key(number)).unwrap()?;
    read(store, &manifest)
}

fn of(owners: &[u64]) -> Owners {
    owners.iter().map(|number| Tenant(*number)).collect()
}

#[test]
fn what_one_server_has_put_another_finds() {
    let bucket = FaultyBucket::new();
    let (a, b) = (bucket.open(), bucket.open());
    for (number, length) in (0..).zip([0, 1, PART_BYTES, 2 * PART_BYTES + 7]) {
        assert_eq!(found(&b, number), None);
        let manifest = put(&a, number, &noise(number, length));
        assert_eq!(b.manifest(&key(number)).unwrap(), None, "what is known here needs no network");
        assert_eq!(b.look_up(&key(number)).unwrap().unwrap(), manifest);
        assert_eq!(b.manifest(&key(number)).unwrap().unwrap(), manifest, "known from now on");
        assert_eq!(found(&b, number).unwrap(), noise(number, length));
    }
    assert_eq!(bucket.names("checks"), [], "what was tried at the start is gone");
}

#[test]
fn two_servers_that_make_the_same_artifact_have_one() {
    let bucket = FaultyBucket::new();
    let (a, b) = (bucket.open(), bucket.open());
    let bytes = noise(1, PART_BYTES + 10);
    let first = put(&a, 1, &bytes);
    let before = (bucket.names("parts"), bucket.bytes(&bucket.names("manifests")[0]));
    assert_eq!(put(&b, 1, &bytes), first);
    assert_eq!((bucket.names("parts"), bucket.bytes(&bucket.names("manifests")[0])), before, "nothing was replaced");
}

#[test]
fn tenants_of_two_servers_may_both_see_what_both_have_made() {
    let bucket = FaultyBucket::new();
    let (a, b) = (bucket.open(), bucket.open());
    for (store, owner) in [(&a, 1), (&b, 2), (&a, 3), (&b, 3)] {
        let mut spool = store.spool(key(1)).unwrap();
        std::io::Write::write_all(&mut spool, &noise(1, 100)).unwrap();
        let made = spool.commit(ArtifactDescription { owners: of(&[owner]), ..description() }).unwrap();
        assert!(made.owners.contain(Tenant(owner)));
    }
    assert_eq!(bucket.open().look_up(&key(1)).unwrap().unwrap().owners, of(&[1, 2, 3]));
}

#[test]
fn a_flipped_byte_in_any_part_is_never_given_and_the_artifact_is_made_again() {
    let bucket = FaultyBucket::new();
    let bytes = noise(1, 2 * PART_BYTES + 100);
    put(&bucket.open(), 1, &bytes);
    for name in bucket.names("parts") {
        let store = bucket.open();
        let mut damaged = bucket.bytes(&name);
        let at = damaged.len() / 2;
        damaged[at] ^= 1;
        bucket.write(&name, damaged);
        assert_eq!(found(&store, 1), None);
        assert_eq!(store.usage().damaged, 1);
        assert_eq!(found(&store, 1), None, "it is gone");
        assert!(!bucket.names("parts").contains(&name), "with the part that was damaged");
        assert_eq!(store.usage().damaged, 1);
        put(&store, 1, &bytes);
        assert_eq!(found(&store, 1).unwrap(), bytes);
    }
}

#[test]
fn a_part_that_is_damaged_beside_its_manifest_is_mended_when_the_artifact_is_made_again() {
    let bucket = FaultyBucket::new();
    put(&bucket.open(), 1, &noise(1, 100));
    for name in bucket.names("planish/") {
        bucket.write(&name, vec![0; 100]);
    }
    let store = bucket.open();
    assert_eq!(found(&store, 1), None);
    put(&store, 1, &noise(1, 100));
    assert_eq!(found(&bucket.open(), 1).unwrap(), noise(1, 100), "nobody has read the damaged part");
}

#[test]
fn parts_that_are_too_short_or_too_long_or_gone_are_never_given() {
    for (length, counted) in [(Some(0), 1), (Some(99), 1), (Some(101), 1), (Some(3 * PART_BYTES), 1), (None, 0)] {
        let bucket = FaultyBucket::new();
        let store = bucket.open();
        put(&store, 1, &noise(1, 100));
        let name = &bucket.names("parts")[0];
        match length {
            Some(length) => bucket.write(name, noise(1, length)),
            None => bucket.erase(name),
        }
        assert_eq!(found(&store, 1), None, "{length:?}");
        assert_eq!(bucket.names("manifests"), [], "{length:?}: it is no artifact any more");
        assert_eq!(store.usage().damaged, counted, "{length:?}: what left by the rules of the bucket is not damaged");
    }
}

#[test]
fn a_manifest_that_is_damaged_foreign_or_of_another_artifact_is_dropped_and_counted() {
    let bucket = FaultyBucket::new();
    put(&bucket.open(), 2, &noise(2, 100));
    let other = bucket.bytes(&bucket.names("manifests")[0]);
    put(&bucket.open(), 1, &noise(1, 100));
    let name = bucket.names("manifests").into_iter().find(|name| name.as_ref().ends_with(&key(1).to_string())).unwrap();
    let sound = bucket.bytes(&name);
    let mut flipped = sound.clone();
    flipped[40] ^= 1;
    let all = [flipped, other, b"hello".to_vec(), Vec::new(), sound[..sound.len() - 1].to_vec(), vec![7; 3 << 20]];
    for (number, bytes) in all.into_iter().enumerate() {
        let store = bucket.open();
        bucket.write(&name, bytes);
        assert_eq!(store.look_up(&key(1)).unwrap(), None, "{number}");
        assert_eq!((store.usage().damaged, bucket.names("manifests").contains(&name)), (1, false), "{number}");
    }
    put(&bucket.open(), 1, &noise(1, 100));
    assert_eq!(found(&bucket.open(), 1).unwrap(), noise(1, 100));
}

#[test]
fn an_artifact_of_another_results_version_is_none_and_stays_for_those_who_want_it() {
    let bucket = FaultyBucket::new();
    let store = bucket.open();
    let made = put(&store, 1, &noise(1, 100));
    let name = &bucket.names("manifests")[0];
    let older = Manifest { results_version: RESULTS_VERSION - 1, ..(*made).clone() };
    bucket.write(name, older.encode());
    assert_eq!((store.look_up(&key(1)).unwrap(), store.usage().damaged), (None, 0));
    assert_eq!(bucket.bytes(name), older.encode());
    // an upload is named by its own bytes, which do not depend on a version
    let id: Key = content(&noise(1, 100));
    let upload = Manifest { key: id, ..older };
    let at = format!("planish/results/manifests/{:02x}/{id}", id.as_bytes()[0]);
    bucket.write(&at.into(), upload.encode());
    assert!(store.look_up(&id).unwrap().is_some());
}

#[test]
fn a_store_that_replaces_what_it_should_not_is_refused_at_the_start() {
    let bucket = FaultyBucket::new();
    bucket.replaces.store(true, SeqCst);
    let error = bucket.open_at(ROOMY, Arc::new(Manual::default())).unwrap_err().to_string();
    assert!(error.contains("If-None-Match"), "{error}");
}

#[test]
fn a_store_that_forbids_is_refused_at_the_start_without_a_word_of_its_credentials() {
    let bucket = FaultyBucket::new();
    bucket.forbids.store(true, SeqCst);
    let error = bucket.open_at(ROOMY, Arc::new(Manual::default())).unwrap_err().to_string();
    assert!(error.contains("access is denied") && error.contains("ListBucket"), "{error}");
    assert!(!error.contains("KEYID"), "{error}");
}

#[test]
fn a_store_that_is_away_at_the_start_is_used_when_it_is_back_and_only_if_it_is_sound() {
    for replaces in [false, true] {
        let (bucket, clock) = (FaultyBucket::new(), Arc::new(Manual::default()));
        bucket.away.store(true, SeqCst);
        let store = bucket.open_at(ROOMY, clock.clone()).unwrap();
        assert!(store.usage().away);
        bucket.away.store(false, SeqCst);
        bucket.replaces.store(replaces, SeqCst);
        clock.advance(Duration::from_mins(1));
        let put = try_put(&store, key(1), &noise(1, 100));
        assert_eq!(put.is_err(), replaces);
        assert_eq!(bucket.names("parts").len(), usize::from(!replaces), "a store that is unsound is given nothing");
        assert!(!store.usage().away);
    }
}

#[test]
fn while_the_store_is_away_one_call_is_made_now_and_then_and_nothing_waits() {
    let (bucket, clock) = (FaultyBucket::new(), Arc::new(Manual::default()));
    let store = bucket.open_at(ROOMY, clock.clone()).unwrap();
    let made = put(&store, 1, &noise(1, 100));
    bucket.away.store(true, SeqCst);
    let before = bucket.n_calls();
    for round in 1..4 {
        for number in 0..10 {
            let error = store.look_up(&key(number)).unwrap_err();
            assert!(matches!(error, StoreError::Away { .. }) && !error.to_string().contains("KEYID"), "{error}");
            assert!(matches!(store.part(&made, 0), Err(StoreError::Away { .. })));
            assert!(matches!(try_put(&store, key(9), &[1]), Err(StoreError::Away { .. })));
        }
        assert_eq!(bucket.n_calls(), before + round, "one call a round");
        assert!(store.usage().away);
        clock.advance(Duration::from_secs(6));
    }
    bucket.away.store(false, SeqCst);
    assert_eq!(found(&store, 1).unwrap(), noise(1, 100), "it is there again");
    assert!(!store.usage().away);
    assert_eq!(store.usage().damaged, 0, "what could not be read was not damaged");
}

#[test]
fn the_end_of_an_outage_is_noticed_though_nobody_needs_the_store() {
    let (bucket, clock) = (FaultyBucket::new(), Arc::new(Manual::default()));
    let store = bucket.open_at(ROOMY, clock.clone()).unwrap();
    bucket.away.store(true, SeqCst);
    store.look_up(&key(1)).unwrap_err();
    for _ in 0..3 {
        clock.advance(Duration::from_secs(6));
        assert!(store.usage().away);
    }
    bucket.away.store(false, SeqCst);
    clock.advance(Duration::from_secs(6));
    store.usage();
    assert!((0..1000).any(|_| {
        std::thread::sleep(Duration::from_millis(5));
        !store.usage().away
    }));
}

#[test]
fn a_store_that_hangs_holds_a_look_for_a_moment_only() {
    let (bucket, clock) = (FaultyBucket::new(), Arc::new(Manual::default()));
    let store = bucket.open_at(ROOMY, clock).unwrap();
    bucket.hangs.store(true, SeqCst);
    let before = bucket.n_calls();
    let error = store.look_up(&key(1)).unwrap_err();
    assert!(error.to_string().contains("no answer within"), "{error}");
    assert!(store.look_up(&key(2)).is_err());
    assert_eq!(bucket.n_calls(), before + 1, "the second look was not made");
}

#[test]
fn what_is_larger_than_half_the_room_is_refused_before_its_last_byte_is_sent() {
    let bucket = FaultyBucket::new();
    let store = bucket.open_at(4 * PART_BYTES as u64, Arc::new(Manual::default())).unwrap();
    assert!(matches!(try_put(&store, key(1), &noise(1, 2 * PART_BYTES + 1)), Err(StoreError::TooLarge { .. })));
    assert_eq!(bucket.names("manifests"), []);
    put(&store, 2, &noise(2, 2 * PART_BYTES));
}

#[test]
fn a_dropped_spool_leaves_no_artifact() {
    let bucket = FaultyBucket::new();
    let store = bucket.open();
    let mut spool = store.spool(key(1)).unwrap();
    std::io::Write::write_all(&mut spool, &noise(1, PART_BYTES + 1)).unwrap();
    assert_eq!(bucket.names("parts").len(), 1, "a full part is on its way at once and is held by nobody");
    drop(spool);
    assert_eq!((bucket.names("manifests"), found(&store, 1)), (Vec::new(), None));
}

#[tokio::test]
async fn a_result_that_one_server_has_made_is_found_by_another_and_an_outage_is_none_of_the_answer() {
    let bucket = FaultyBucket::new();
    let (clock, of_b) = (Arc::new(Manual::default()), Arc::new(Manual::default()));
    let (a, b) = {
        let open = |clock: Arc<Manual>| bucket.open_at(ROOMY, clock).unwrap();
        (open(clock), open(of_b.clone()))
    };
    for (number, length) in [(1, 5000), (2, 5 * PART_BYTES)] {
        put(&a, number, &noise(number, length));
    }
    let tiers = Tiers::new(64 << 20, Some(Arc::new(b)));
    for (number, length) in [(1, 5000), (2, 5 * PART_BYTES)] {
        assert!(tiers.at_hand(&key(number)).is_none());
        let manifest = tiers.find(&key(number)).await.unwrap();
        let mut bytes = Vec::new();
        for index in 0..manifest.parts.len() {
            bytes.extend_from_slice(&tiers.part(&manifest, index).await.unwrap());
        }
        assert_eq!(bytes, noise(number, length));
    }
    assert!(tiers.at_hand(&key(1)).is_some(), "small ones are in memory now");
    bucket.away.store(true, SeqCst);
    for number in 3..8 {
        assert!(tiers.find(&key(number)).await.is_none());
    }
    let counts = tiers.disk_counts();
    assert_eq!((counts.reads_away.load(SeqCst), counts.reads_failed.load(SeqCst)), (5, 0));
    assert!(tiers.disk_trouble().is_none(), "a server without its shared store is ready all the same");
    assert!(tiers.usage().iter().any(|(name, usage)| *name == "disk" && usage.away));
    bucket.away.store(false, SeqCst);
    of_b.advance(Duration::from_secs(6));
    put(&a, 9, &noise(9, 10));
    assert!(tiers.find(&key(9)).await.is_some());
}
