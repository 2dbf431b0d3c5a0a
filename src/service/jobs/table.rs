//! The table of records of jobs.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use tokio::sync::watch;

use super::attempt::{Admission, Attempt, New};
use super::record::{Holder, JobState, JobSummary, OutputResult, Record, Requesters};
use super::revived::revived;
use super::rows::JobTable;
use super::written::{decode, encode, is_job};
use crate::job::key::Key;
use crate::service::account::Full;
use crate::service::clock::Clock;
use crate::service::job_key::{JobKey, Tenant};
use crate::service::journal::{Journal, RowKey};
use crate::service::lock::lock;
use crate::service::peer::Paid;
use crate::service::store::{Pin, Records, StoreError};
use crate::service::tally::Tally;
use crate::service::under_way::Interest;

/// Maximum number of records. With 8 KiB each they take 80 MiB. Half of it would forget jobs sooner; twice of it may
/// take twice that memory.
const MAX_RECORDS: usize = 10_000;

/// The records of all jobs.
#[derive(Debug)]
pub struct Jobs {
    table: Arc<Mutex<JobTable>>,
    clock: Arc<dyn Clock>,
    tally: Arc<Tally>,
    /// Writes records to durable storage, if there is any.
    journal: Option<Journal<JobKey>>,
}

impl RowKey for JobKey {
    fn key(&self) -> Vec<u8> {
        self.to_bytes().to_vec()
    }
}

impl Jobs {
    /// Creates an empty table; if `records` is given, its records outlast the process.
    pub fn new(records: Option<Arc<dyn Records>>, clock: Arc<dyn Clock>) -> Self {
        let table = Arc::new(Mutex::new(JobTable::default()));
        let journal = records.map(|records| {
            let (table, clock) = (table.clone(), clock.clone());
            Journal::new(records, move |job| {
                let record = lock(&table).records.get(job).cloned()?;
                let since = record.settled.map(|at| clock.now().saturating_sub(at));
                Some(encode(&record, since.map(|since| clock.wall().saturating_sub(since))))
            })
        });
        Self { table, clock, tally: Arc::default(), journal }
    }

    /// Returns the counters of jobs and computations.
    pub fn tally(&self) -> &Arc<Tally> {
        &self.tally
    }

    fn note(&self, job: JobKey) {
        self.journal.iter().for_each(|journal| journal.note(job));
    }

    /// Returns whether records outlast the process.
    pub fn is_durable(&self) -> bool {
        self.journal.is_some()
    }

    /// Waits until the current record of a job is durable; returns at once if records do not outlast the process.
    ///
    /// # Errors
    /// When the record cannot be written.
    pub async fn written(&self, job: JobKey) -> Result<(), StoreError> {
        match &self.journal {
            Some(journal) => journal.written(job).await,
            None => Ok(()),
        }
    }

    /// Returns why records cannot be written now, so that no job can be accepted; `None` if they can.
    pub fn trouble(&self) -> Option<String> {
        self.journal.as_ref()?.trouble()
    }

    /// Returns the record of a job.
    pub fn get(&self, job: &JobKey) -> Option<Record> {
        lock(&self.table).records.get(job).cloned()
    }

    /// Returns the record of a job of the tenant that has this artifact.
    pub fn of_artifact(&self, tenant: Tenant, artifact: &Key) -> Option<Record> {
        let table = lock(&self.table);
        let found = table.by_artifact.range((tenant, *artifact, Key::LEAST)..).next();
        let (_, _, id) = found.filter(|(owner, key, _)| *owner == tenant && key == artifact)?;
        table.records.get(&JobKey { tenant, id: *id }).cloned()
    }

    /// Returns the newest `n` records of a tenant with numbers below `before`, newest first, and whether there are
    /// more.
    pub fn page(&self, tenant: Tenant, before: u64, n: usize) -> (Vec<Record>, bool) {
        let table = lock(&self.table);
        let own = table.by_number.range(..before).rev().filter(|(_, job)| job.tenant == tenant);
        let mut own = own.map(|(_, job)| &table.records[job]);
        let page = own.by_ref().take(n).cloned().collect();
        let is_more = own.next().is_some();
        (page, is_more)
    }

    /// Accepts a job. A job that is active or done is only joined, unless `again` requests that a done job be done
    /// again; a job that failed or was cancelled starts a further attempt. `memory` allocates bytes for the record; if
    /// it fails, the oldest settled jobs are removed.
    ///
    /// # Errors
    /// [`Full`] if active jobs leave no room; then only settled jobs have been removed.
    pub fn accept(&self, memory: impl Fn(u64) -> Result<Paid, Full>, new: New, again: bool) -> Result<Admission, Full> {
        let bytes = new.summary.record_bytes();
        let mut table = lock(&self.table);
        let known = table.records.get(&new.job);
        if known.is_some_and(|known| known.is_active() || known.state == JobState::Done && !again) {
            table.join(&new.job, new.holder, self.clock.now());
            self.note(new.job);
            return Ok(Admission::Known(Box::new(table.records[&new.job].clone())));
        }
        let memory = loop {
            if table.records.len() < MAX_RECORDS
                && let Ok(memory) = memory(bytes)
            {
                break memory;
            }
            match table.forget_oldest() {
                Some(oldest) => self.note(oldest.job),
                None => return Err(Full),
            }
        };
        let before = table.forget(&new.job);
        let attempts = before.map_or(0, |record| record.attempts).saturating_add(new.made.is_empty().into());
        let number = table.next;
        table.next += 1;
        let record = self.record(new, number, attempts, memory);
        let (job, ended) = (record.job, record.ended.subscribe());
        let placed = if record.is_active() {
            Admission::New(Attempt { job, number, ended })
        } else {
            Admission::Known(Box::new(record.clone()))
        };
        table.insert(record);
        drop(table);
        self.note(job);
        Ok(placed)
    }

    fn record(&self, new: New, number: u64, attempts: u32, memory: Paid) -> Record {
        let New { job, summary, terms, peer, holder, ticket, made, pins } = new;
        let now = self.clock.now();
        let is_done = !made.is_empty();
        Record {
            job,
            number,
            attempts,
            starts: 0,
            terms,
            peer,
            wanted: Requesters::by(holder),
            state: if is_done { JobState::Done } else { JobState::Active },
            made: if is_done { made.into_iter().map(Some).collect() } else { vec![None; summary.products.len()] },
            summary: Arc::new(summary),
            computing: None,
            queued: now,
            begun: None,
            settled: is_done.then_some(now),
            ended: Arc::new(watch::channel(is_done).0),
            _memory: Arc::new(memory),
            pins,
            ticket: ticket.map(Arc::new),
        }
    }

    /// Loads the records of an earlier process and returns the attempts of jobs that are not settled, oldest first.
    /// Records for which there is no room are skipped and stay in durable storage.
    ///
    /// # Errors
    /// When the records cannot be read.
    pub fn recover(
        &self,
        memory: impl Fn(u64) -> Result<Paid, Full>,
        pins: impl Fn(&JobSummary) -> Vec<Arc<Pin>>,
    ) -> Result<Vec<Attempt>, StoreError> {
        let Some(journal) = &self.journal else { return Ok(Vec::new()) };
        let mut kept = Vec::new();
        journal.each(&mut |record| match decode(record) {
            _ if !is_job(record) => {}
            Some(record) => kept.push(record),
            None => tracing::warn!("a record of a job cannot be read; it is left as it is"),
        })?;
        kept.sort_by_key(|kept| kept.number);
        let (now, wall) = (self.clock.now(), self.clock.wall());
        let mut table = lock(&self.table);
        // jobs that wait for a next start keep their numbers, too
        table.next = table.next.max(kept.last().map_or(0, |last| last.number + 1));
        let (mut runs, mut failed) = (Vec::new(), Vec::new());
        for kept in kept {
            let was_active = kept.state == JobState::Active;
            let Ok(memory) = memory(kept.summary.record_bytes()) else {
                tracing::warn!(job = %kept.job.id, "no room for the record of a job; it waits for a next start");
                continue;
            };
            let mut record = revived(kept, memory, now, wall);
            if record.is_active() {
                record.pins = pins(&record.summary);
                runs.push(Attempt { job: record.job, number: record.number, ended: record.ended.subscribe() });
            } else if was_active {
                failed.push(record.job);
            }
            table.insert(record);
        }
        drop(table);
        // its time to live counts from this start, not from each
        failed.into_iter().for_each(|job| self.note(job));
        Ok(runs)
    }

    /// Returns the current attempt of an active job, with its record.
    pub fn current_attempt(&self, job: &JobKey) -> Option<(Attempt, Record)> {
        let record = self.get(job).filter(Record::is_active)?;
        let run = Attempt { job: *job, number: record.number, ended: record.ended.subscribe() };
        Some((run, record))
    }

    /// Records that the turn of a job has come. The start is written to durable storage, so that a job that repeatedly
    /// ends the process can be recognised; from the second start on, this waits for the write.
    pub async fn begin(&self, run: &Attempt) {
        let now = self.clock.now();
        let was_begun = {
            let mut table = lock(&self.table);
            let Some(record) = table.running(run) else { return };
            record.begun.get_or_insert(now);
            record.starts += 1;
            record.starts > 1
        };
        if !was_begun {
            self.note(run.job);
        } else if let Err(error) = self.written(run.job).await {
            tracing::warn!(%error, job = %run.job.id, "that a job was begun could not be written down");
        }
    }

    /// Adds a party to a job that is active or done and returns the job's state; `None` if there is no such job. A job
    /// that is done counts as newly settled, so that its record is kept for the full time to live.
    pub fn join(&self, job: &JobKey, holder: Holder) -> Option<JobState> {
        let state = lock(&self.table).join(job, holder, self.clock.now())?;
        self.note(*job);
        Some(state)
    }

    /// Removes a batch from the parties that want a job; returns true if the job is active and nobody else wants it.
    pub fn leave(&self, job: &JobKey, batch: &Key) -> bool {
        let mut table = lock(&self.table);
        let left = table.records.get_mut(job).filter(|record| record.is_active());
        left.is_some_and(|record| record.wanted.remove(batch))
    }

    /// Ties an interest in the computation of an output to the job, so that it is dropped with it; returns false if the
    /// attempt is over.
    pub fn attach(&self, run: &Attempt, output: usize, interest: Interest) -> bool {
        let interest = Arc::new(interest); // dropped after unlocking: its drop calls the desk
        let mut table = lock(&self.table);
        let Some(record) = table.running(run) else { return false };
        let before = record.computing.replace((output, interest.clone()));
        drop(table);
        drop(before);
        true
    }

    /// Records the result of an output.
    pub fn record_output(&self, run: &Attempt, output: usize, key: Key, made: OutputResult) {
        let mut table = lock(&self.table);
        let Some(record) = table.running(run) else { return };
        let before = record.computing.take();
        if let Some(place) = record.made.get_mut(output) {
            *place = Some(made);
        }
        // An output computed under another results version has another key than the record.
        if record.summary.products.get(output).is_some_and(|product| product.key != key) {
            let mut summary = (*record.summary).clone();
            let old = std::mem::replace(&mut summary.products[output].key, key);
            record.summary = Arc::new(summary);
            table.by_artifact.remove(&(run.job.tenant, old, run.job.id));
            table.by_artifact.insert((run.job.tenant, key, run.job.id));
        }
        drop(table);
        drop(before);
    }

    /// Ends an attempt that is still active.
    pub fn settle(&self, run: &Attempt, state: JobState) {
        self.end(&run.job, state, |record| record.number == run.number);
    }

    /// Ends a job if it is active and `is_so` holds for its record; returns whether it was ended.
    pub fn end(&self, job: &JobKey, state: JobState, is_so: impl Fn(&Record) -> bool) -> bool {
        let now = self.clock.now();
        let mut table = lock(&self.table);
        let found = table.records.get_mut(job).filter(|record| record.is_active() && is_so(record));
        let Some(record) = found else { return false };
        self.tally.count_settled(&state);
        record.state = state;
        record.settled = Some(now);
        let left = (record.computing.take(), record.ticket.take(), std::mem::take(&mut record.pins));
        let ended = record.ended.clone();
        drop(table);
        drop(left);
        self.note(*job);
        ended.send_replace(true);
        true
    }

    /// Removes a job; computations that only this job needs end. Returns false if the job was not known.
    pub fn remove(&self, job: &JobKey) -> bool {
        let removed = lock(&self.table).forget(job);
        let was_known = removed.is_some();
        drop(removed); // dropped after unlocking: dropping an interest calls the desk
        self.note(*job);
        was_known
    }

    /// Returns the jobs that have waited longer than they may, and the jobs settled at least `time_to_live` ago.
    pub fn overdue(&self, time_to_live: Duration) -> (Vec<JobKey>, Vec<JobKey>) {
        let (now, table) = (self.clock.now(), lock(&self.table));
        let waits_too_long = |record: &&Record| {
            let longest = record.terms.queue_timeout_s.map(Duration::from_secs);
            let is_waiting = record.is_active() && record.begun.is_none();
            is_waiting && longest.is_some_and(|longest| now.saturating_sub(record.queued) >= longest)
        };
        let is_old = |record: &&Record| record.settled.is_some_and(|at| now.saturating_sub(at) >= time_to_live);
        let jobs = |is: &dyn Fn(&&Record) -> bool| table.records.values().filter(is).map(|record| record.job).collect();
        (jobs(&waits_too_long), jobs(&is_old))
    }

    /// Returns the number of jobs.
    pub fn n_known(&self) -> usize {
        lock(&self.table).records.len()
    }

    /// Returns an arbitrary active job.
    pub fn any_active(&self) -> Option<Record> {
        lock(&self.table).records.values().find(|record| record.is_active()).cloned()
    }

    /// Writes all pending records, waiting at most `patience`, and nothing afterwards. It takes back the start of each
    /// running job: this process ends regularly, not because of the job.
    pub fn close(&self, patience: Duration) {
        if let Some(journal) = &self.journal {
            for record in
                lock(&self.table).records.values_mut().filter(|record| record.is_active() && record.starts > 0)
            {
                record.starts -= 1;
                journal.note(record.job);
            }
            journal.close(patience);
        }
    }
}
