//! The records of jobs that outlast their request: bounded in number and bytes; finished ones leave first.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

use bytes::Bytes;

use super::account::Full;
use super::computation::{Computation, Failure, Timings};
use super::peer::Paid;
use super::store::Manifest;
use super::under_way::Interest;
use crate::job::JobEntries;
use crate::job::Resolved;
use crate::job::key::Key;
use crate::job::limits::Estimate;
use crate::output::Format;

/// Most records held.
/// With [`RECORD_BYTES`] each they take 80 MiB. Half of it forgets jobs sooner; twice of it may take twice that.
const MAX_RECORDS: usize = 10_000;
/// Charged for a record besides its request: its counts a level, its names, its places in the maps.
/// Half of it is less than a job of many levels takes; twice of it holds half as many records in their share.
const RECORD_BYTES: u64 = 8 << 10;

/// What is known of a job without its input.
#[derive(Debug, Clone)]
pub struct JobSummary {
    /// Name, format and key of its output.
    pub output: (String, &'static dyn Format, Key),
    /// Where its request has what may be at fault.
    pub entries: JobEntries,
    /// What it was to come to.
    pub estimate: Estimate,
    /// The level that was found, where the request left it to be found.
    pub reached: Option<Resolved>,
    /// Keys of the results to which its output refers.
    pub details: Vec<Key>,
    /// The request as it was sent, so that an evicted result can be made again.
    pub request: Bytes,
}

impl JobSummary {
    /// The keys of its output and of all that it refers to.
    fn artifacts(&self) -> impl Iterator<Item = Key> + '_ {
        std::iter::once(self.output.2).chain(self.details.iter().copied())
    }
}

/// One tenant's interest in a computation, by the job's id.
#[derive(Debug, Clone)]
pub struct Record {
    /// Id of the job.
    pub id: Key,
    /// What the job is.
    pub summary: Arc<JobSummary>,
    /// How often it was queued.
    pub attempts: u32,
    /// How it stands.
    pub state: State,
    _memory: Arc<Paid>,
}

/// How a job stands.
#[derive(Debug, Clone)]
pub enum State {
    /// Its computation goes on.
    Active(Arc<Interest>),
    /// Its artifact was made, in so much time.
    Done(Arc<Manifest>, Timings),
    /// It ended without a result.
    Failed(Failure),
}

/// All records.
#[derive(Debug, Default)]
pub struct Jobs(Mutex<Table>);

#[derive(Debug, Default)]
struct Table {
    records: HashMap<Key, (u64, Record)>,
    by_age: BTreeMap<u64, Key>,
    /// Keys of artifacts with the ids of the jobs that have them.
    by_artifact: BTreeSet<(Key, Key)>,
    next: u64,
}

impl Jobs {
    fn table(&self) -> std::sync::MutexGuard<'_, Table> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The record of a job.
    pub fn get(&self, id: &Key) -> Option<Record> {
        self.table().records.get(id).map(|(_, record)| record.clone())
    }

    /// The record of a job whose artifact has this key.
    pub fn of_artifact(&self, artifact: &Key) -> Option<Record> {
        let table = self.table();
        let (_, id) = table.by_artifact.range((*artifact, Key::LEAST)..).next().filter(|(key, _)| key == artifact)?;
        table.records.get(id).map(|(_, record)| record.clone())
    }

    /// Adds a record or takes the place of the one with the same id, whose attempts are added. `memory` takes bytes for
    /// it; where it finds none, the oldest jobs that are finished are forgotten.
    ///
    /// # Errors
    /// [`Full`] when there is no room beside the jobs that go on; then all is as it was, but for those.
    pub fn put(
        &self,
        memory: impl Fn(u64) -> Result<Paid, Full>,
        id: Key,
        summary: JobSummary,
        attempts: u32,
        state: State,
    ) -> Result<(), Full> {
        let bytes = RECORD_BYTES + summary.request.len() as u64;
        let mut forgotten = Vec::new(); // dropped after the lock: an interest asks the desk
        let mut table = self.table();
        let memory = loop {
            if table.records.len() < MAX_RECORDS
                && let Ok(memory) = memory(bytes)
            {
                break memory;
            }
            let finished = |id: &&Key| !matches!(table.records[*id].1.state, State::Active(_));
            let oldest = table.by_age.values().find(finished).copied().ok_or(Full)?;
            drop(table.forget(&oldest)); // it is finished, so only its memory comes back
        };
        let before = table.forget(&id);
        let attempts = before.as_ref().map_or(1, |record| record.attempts + attempts);
        forgotten.extend(before);
        let age = table.next;
        table.next += 1;
        table.by_age.insert(age, id);
        table.by_artifact.extend(summary.artifacts().map(|key| (key, id)));
        let record = Record { id, summary: Arc::new(summary), attempts, state, _memory: Arc::new(memory) };
        table.records.insert(id, (age, record));
        drop(table);
        drop(forgotten);
        Ok(())
    }

    /// Forgets a job; what goes on only for it ends. False when it was not known.
    pub fn remove(&self, id: &Key) -> bool {
        let removed = self.table().forget(id);
        removed.is_some()
    }

    /// Changes how a job stands, if it still stands for this computation.
    pub fn settle(&self, id: &Key, computation: &Arc<Computation>, state: State) {
        let mut table = self.table();
        let Some((_, record)) = table.records.get_mut(id) else { return };
        if matches!(&record.state, State::Active(interest) if Arc::ptr_eq(&interest.computation, computation)) {
            let before = std::mem::replace(&mut record.state, state);
            drop(table);
            drop(before); // an interest asks the desk, so not under the lock
        }
    }

    /// Whether a job goes on with this computation.
    pub fn follows(&self, id: &Key, computation: &Arc<Computation>) -> bool {
        let table = self.table();
        let state = table.records.get(id).map(|(_, record)| &record.state);
        matches!(state, Some(State::Active(interest)) if Arc::ptr_eq(&interest.computation, computation))
    }

    /// How many jobs are known.
    pub fn len(&self) -> usize {
        self.table().records.len()
    }

    /// Whether no job is known.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Table {
    fn forget(&mut self, id: &Key) -> Option<Record> {
        let (age, record) = self.records.remove(id)?;
        self.by_age.remove(&age);
        for key in record.summary.artifacts() {
            self.by_artifact.remove(&(key, *id));
        }
        Some(record)
    }
}
