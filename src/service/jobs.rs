//! The records of jobs that outlast their request: bounded, in memory; finished ones leave first.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

use super::computation::{Computation, Failure, Timings};
use super::desk::Interest;
use super::store::Manifest;
use crate::job::key::Key;
use crate::job::limits::Admitted;

/// Most records held.
const MAX_RECORDS: usize = 10_000;

/// One tenant's interest in a computation, by the job's id.
#[derive(Debug, Clone)]
pub struct Record {
    /// Id of the job.
    pub id: Key,
    /// The job, so that an evicted result can be made again.
    pub admitted: Arc<Admitted>,
    /// Key of its artifact.
    pub artifact: Key,
    /// How often it was queued.
    pub attempts: u32,
    /// How it stands.
    pub state: State,
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
    by_artifact: HashMap<Key, Key>,
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
        let id = table.by_artifact.get(artifact)?;
        table.records.get(id).map(|(_, record)| record.clone())
    }

    /// Adds or replaces a record; makes room by forgetting the oldest that are finished, then the oldest.
    pub fn put(&self, record: Record) {
        let mut table = self.table();
        table.forget(&record.id);
        while table.records.len() >= MAX_RECORDS {
            let finished = |id: &&Key| !matches!(table.records[*id].1.state, State::Active(_));
            let oldest = table.by_age.values().find(finished).or_else(|| table.by_age.values().next()).copied();
            let Some(oldest) = oldest else { break };
            table.forget(&oldest);
        }
        let age = table.next;
        table.next += 1;
        table.by_age.insert(age, record.id);
        table.by_artifact.insert(record.artifact, record.id);
        table.records.insert(record.id, (age, record));
    }

    /// Changes how a job stands, if it still stands for this computation.
    pub fn settle(&self, id: &Key, computation: &Arc<Computation>, state: State) {
        let mut table = self.table();
        let Some((_, record)) = table.records.get_mut(id) else { return };
        if matches!(&record.state, State::Active(interest) if Arc::ptr_eq(&interest.computation, computation)) {
            record.state = state;
        }
    }
}

impl Table {
    fn forget(&mut self, id: &Key) {
        if let Some((age, record)) = self.records.remove(id) {
            self.by_age.remove(&age);
            self.by_artifact.remove(&record.artifact);
        }
    }
}
