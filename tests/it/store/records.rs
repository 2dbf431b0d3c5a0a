//! Records of jobs and batches under checksums that fit, with numbers that no process writes.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use planish::job::key::content;
use planish::service::account::{Account, Full};
use planish::service::batches::Batches;
use planish::service::clock::Monotonic;
use planish::service::jobs::Jobs;
use planish::service::peer::{Paid, Peers, QuotaKind};
use planish::service::store::{Records, StoreError};
use planish::wire::batch::layout;

/// Records in memory.
#[derive(Debug)]
struct Rows(Mutex<BTreeMap<Vec<u8>, Vec<u8>>>);

impl Records for Rows {
    fn each(&self, tell: &mut dyn FnMut(&[u8], &[u8])) -> Result<(), StoreError> {
        self.0.lock().unwrap().iter().for_each(|(key, record)| tell(key, record));
        Ok(())
    }

    fn write(&self, changes: &[(Vec<u8>, Option<Vec<u8>>)]) -> Result<(), StoreError> {
        let mut rows = self.0.lock().unwrap();
        for (key, record) in changes {
            match record {
                Some(record) => rows.insert(key.clone(), record.clone()),
                None => rows.remove(key),
            };
        }
        Ok(())
    }

    fn check(&self) -> Result<(), StoreError> {
        Ok(())
    }
}

/// Sets the number at an index of the second field, which holds the standing of a job or a batch.
fn with_standing(record: &[u8], at: usize, number: u64) -> Vec<u8> {
    const HEAD: usize = 12;
    const LENGTH: usize = 8;
    let mut changed = record.to_vec();
    let length: [u8; LENGTH] = changed[HEAD + 1..HEAD + 1 + LENGTH].try_into().unwrap();
    let second = HEAD + 1 + LENGTH + usize::try_from(u64::from_le_bytes(length)).unwrap();
    let place = second + 1 + LENGTH + 8 * at;
    changed[place..place + 8].copy_from_slice(&number.to_le_bytes());
    changed
}

/// The numbers of active jobs and batches that are taken up from one record.
fn taken_up(record: &[u8]) -> [usize; 2] {
    let sealed = [record, content(record).as_bytes()].concat();
    let rows = Arc::new(Rows(Mutex::new([(vec![0], sealed)].into())));
    let (clock, peers, account) = (Arc::new(Monotonic::default()), Arc::<Peers>::default(), Account::new(1 << 30, 0));
    let memory = |bytes| -> Result<Paid, Full> { peers.charge_self(&account.records, QuotaKind::RecordBytes, bytes) };
    let jobs = Jobs::new(Some(rows.clone()), clock.clone());
    let active = jobs.recover(memory, |_| Vec::new()).unwrap().len();
    jobs.close(Duration::from_secs(10));
    let batches = Batches::new(Some(rows), clock, |text| layout(text).ok());
    let begun = batches.recover(memory).unwrap().len();
    batches.close(Duration::from_secs(10));
    [active, begun]
}

/// The record of a batch that is active; in the file that of an item follows.
fn active_batch() -> &'static [u8] {
    let rows = include_bytes!("../../fuzz/corpus/record/batch-active");
    let end = rows.windows(8).position(|eight| eight == b"plnshitm").unwrap();
    &rows[..end]
}

#[test]
fn records_whose_numbers_no_process_can_have_counted_are_left_as_they_are() {
    let job = include_bytes!("../../fuzz/corpus/record/job-active");
    let batch = active_batch();
    assert_eq!(taken_up(job), [1, 0]);
    assert_eq!(taken_up(batch), [0, 1]);
    // the number, and the attempts, beyond what they are written with
    for at in [0, 1] {
        assert_eq!(taken_up(&with_standing(job, at, u64::MAX)), [0, 0], "at {at} of a job");
        assert_eq!(taken_up(&with_standing(batch, at, u64::MAX)), [0, 0], "at {at} of a batch");
    }
}

#[test]
fn attempts_are_counted_as_far_as_they_can_be() {
    let job = include_bytes!("../../fuzz/corpus/record/job-active");
    for attempts in [u32::MAX - 1, u32::MAX] {
        assert_eq!(taken_up(&with_standing(job, 1, attempts.into())), [1, 0], "{attempts} of a job");
        assert_eq!(taken_up(&with_standing(active_batch(), 1, attempts.into())), [0, 1], "{attempts} of a batch");
    }
}

#[test]
fn a_batch_whose_outputs_take_more_memory_than_there_is_waits_for_a_next_start() {
    assert_eq!(taken_up(&with_standing(active_batch(), 4, u64::MAX)), [0, 0]);
}
