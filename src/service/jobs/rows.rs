//! The records themselves, and where they are found.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::attempt::Run;
use super::record::Record;
use crate::job::key::Key;
use crate::service::job_key::{JobKey, Tenant};

/// The records, by their jobs, their numbers and their artifacts.
#[derive(Debug, Default)]
pub(super) struct Table {
    pub(super) records: HashMap<JobKey, Record>,
    pub(super) by_number: BTreeMap<u64, JobKey>,
    /// Keys of artifacts with the ids of the jobs that have them.
    pub(super) by_artifact: BTreeSet<(Tenant, Key, Key)>,
    pub(super) next: u64,
}

impl Table {
    pub(super) fn forget(&mut self, job: &JobKey) -> Option<Record> {
        let record = self.records.remove(job)?;
        self.by_number.remove(&record.number);
        for key in record.summary.artifacts() {
            self.by_artifact.remove(&(job.tenant, key, job.id));
        }
        record.ended.send_replace(true);
        Some(record)
    }

    pub(super) fn insert(&mut self, record: Record) {
        let job = record.job;
        self.by_number.insert(record.number, job);
        self.by_artifact.extend(record.summary.artifacts().map(|key| (job.tenant, key, job.id)));
        self.records.insert(job, record);
    }

    /// The record of an attempt that goes on.
    pub(super) fn running(&mut self, run: &Run) -> Option<&mut Record> {
        self.records.get_mut(&run.job).filter(|record| record.number == run.number && record.is_active())
    }

    /// Forgets the oldest settled job.
    pub(super) fn forget_oldest(&mut self) -> Option<Record> {
        let oldest = self.by_number.values().find(|job| !self.records[*job].is_active()).copied()?;
        self.forget(&oldest)
    }
}
