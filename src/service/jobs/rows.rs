//! The records themselves, and where they are found.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::time::Duration;

use super::attempt::Run;
use super::record::{Holder, Record, State};
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

    /// A job that goes on or is done is wanted by one more; tells its state. One that is done stays known for as
    /// long as if it were done now. None where there is no such job.
    pub(super) fn join(&mut self, job: &JobKey, holder: Holder, now: Duration) -> Option<State> {
        let record = self.records.get_mut(job).filter(|record| record.may_be_made_again())?;
        record.wanted.add(holder);
        let state = record.state.clone();
        if state == State::Done {
            self.by_number.remove(&record.number);
            (record.number, record.settled) = (self.next, Some(now));
            self.by_number.insert(self.next, *job);
            self.next += 1;
        }
        Some(state)
    }

    /// Forgets the oldest settled job.
    pub(super) fn forget_oldest(&mut self) -> Option<Record> {
        let oldest = self.by_number.values().find(|job| !self.records[*job].is_active()).copied()?;
        self.forget(&oldest)
    }
}
