//! The map of records with its indexes.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::time::Duration;

use super::attempt::Attempt;
use super::record::{Holder, JobState, Record};
use crate::job::key::Key;
use crate::service::job_key::{JobKey, Tenant};

/// The records, with indexes by number and by artifact.
#[derive(Debug, Default)]
pub(super) struct JobTable {
    pub(super) records: HashMap<JobKey, Record>,
    pub(super) by_number: BTreeMap<u64, JobKey>,
    /// The artifacts of jobs: tenant, key of the artifact, id of the job.
    pub(super) by_artifact: BTreeSet<(Tenant, Key, Key)>,
    pub(super) next: u64,
}

impl JobTable {
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

    /// Returns the record of an attempt that is still active.
    pub(super) fn running(&mut self, run: &Attempt) -> Option<&mut Record> {
        self.records.get_mut(&run.job).filter(|record| record.number == run.number && record.is_active())
    }

    /// Adds a party to a job that is active or done and returns the job's state; `None` if there is no such job. A job
    /// that is done counts as newly settled, so that its record is kept for the full time to live.
    pub(super) fn join(&mut self, job: &JobKey, holder: Holder, now: Duration) -> Option<JobState> {
        let record = self.records.get_mut(job).filter(|record| record.may_be_made_again())?;
        record.wanted.add(holder);
        let state = record.state.clone();
        if state == JobState::Done {
            self.by_number.remove(&record.number);
            (record.number, record.settled) = (self.next, Some(now));
            self.by_number.insert(self.next, *job);
            self.next += 1;
        }
        Some(state)
    }

    /// Removes the oldest settled job.
    pub(super) fn forget_oldest(&mut self) -> Option<Record> {
        let oldest = self.by_number.values().find(|job| !self.records[*job].is_active()).copied()?;
        self.forget(&oldest)
    }
}
