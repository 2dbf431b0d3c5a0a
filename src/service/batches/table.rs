//! The table of records of batches.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use bytes::Bytes;
use tokio::sync::watch;

use super::layout::BatchLayout;
use super::record::{Batch, BatchItem, BatchRun, Ending, NewBatch, ParsedBatch};
use super::written::{BatchRow, DecodedRow, KeptBatch, decode, encode, encode_item, is_of_batch};
use crate::job::key::Key;
use crate::service::account::Full;
use crate::service::clock::Clock;
use crate::service::job_key::{JobKey, Tenant};
use crate::service::jobs::JobState;
use crate::service::journal::Journal;
use crate::service::lock::lock;
use crate::service::peer::{Paid, Peer};
use crate::service::store::{Records, StoreError};

/// Maximum number of batches. Half of it would forget batches sooner; twice of it may take twice their share of the
/// memory for records.
const MAX_BATCHES: usize = 1000;

/// Finds the jobs in the text of an accepted batch; `None` if the text can no longer be interpreted.
pub type ReadLayout = fn(&Bytes) -> Option<BatchLayout>;

/// The records of all batches.
#[derive(Debug)]
pub struct Batches {
    table: Arc<Mutex<BatchTable>>,
    clock: Arc<dyn Clock>,
    layout: ReadLayout,
    /// Writes batches to durable storage, if there is any.
    journal: Option<Journal<BatchRow>>,
}

#[derive(Debug, Default)]
struct BatchTable {
    batches: HashMap<JobKey, Batch>,
    by_number: BTreeMap<u64, JobKey>,
    /// The artifacts of batches: tenant, key of the artifact, id of the batch, index of the item.
    by_artifact: BTreeSet<(Tenant, Key, Key, usize)>,
    next: u64,
}

impl BatchTable {
    fn insert(&mut self, batch: Batch) {
        self.by_number.insert(batch.number, batch.batch);
        let endings = batch.items.iter().enumerate().filter_map(|(at, item)| Some((at, item.ending.clone()?)));
        for (at, ending) in endings {
            self.find_by(batch.batch, at, &ending);
        }
        self.batches.insert(batch.batch, batch);
    }

    fn find_by(&mut self, batch: JobKey, at: usize, ending: &Ending) {
        let places = ending.outputs.iter().map(|(product, _)| (batch.tenant, product.key, batch.id, at));
        self.by_artifact.extend(places);
    }

    fn forget(&mut self, batch: &JobKey) -> Option<Batch> {
        let known = self.batches.remove(batch)?;
        self.by_number.remove(&known.number);
        for (at, item) in known.items.iter().enumerate() {
            for (product, _) in item.ending.iter().flat_map(|ending| &ending.outputs) {
                self.by_artifact.remove(&(batch.tenant, product.key, batch.id, at));
            }
        }
        known.ended.send_replace(true);
        Some(known)
    }

    /// Returns whether a batch is active or done. One that is done counts as newly settled, so that its record is kept
    /// for the full time to live.
    fn join(&mut self, batch: &JobKey, now: Duration) -> bool {
        let Some(known) = self.batches.get_mut(batch) else { return false };
        if known.state == JobState::Done {
            self.by_number.remove(&known.number);
            (known.number, known.settled) = (self.next, Some(now));
            self.by_number.insert(self.next, *batch);
            self.next += 1;
        }
        known.is_active() || known.state == JobState::Done
    }

    /// Returns the batch of an attempt that is still active.
    fn running(&mut self, run: &BatchRun) -> Option<&mut Batch> {
        self.batches.get_mut(&run.batch).filter(|batch| batch.number == run.number && batch.is_active())
    }
}

impl Batches {
    /// Creates an empty table; if `records` is given, its batches outlast the process.
    pub fn new(records: Option<Arc<dyn Records>>, clock: Arc<dyn Clock>, layout: ReadLayout) -> Self {
        let table = Arc::new(Mutex::new(BatchTable::default()));
        let journal = records.map(|records| {
            let (table, clock) = (table.clone(), clock.clone());
            Journal::new(records, move |row| {
                let table = lock(&table);
                match row {
                    BatchRow::Batch(batch) => {
                        let batch = table.batches.get(batch)?;
                        let since = batch.settled.map(|at| clock.now().saturating_sub(at));
                        Some(encode(batch, since.map(|since| clock.wall().saturating_sub(since))))
                    }
                    BatchRow::Item(batch, at) => {
                        let item = table.batches.get(batch)?.items.get(*at as usize)?;
                        Some(encode_item(batch, *at, item))
                    }
                }
            })
        });
        Self { table, clock, layout, journal }
    }

    fn note(&self, batch: JobKey) {
        self.journal.iter().for_each(|journal| journal.note(BatchRow::Batch(batch)));
    }

    fn note_items(&self, batch: JobKey, items: impl IntoIterator<Item = usize>) {
        let Some(journal) = &self.journal else { return };
        for at in items {
            journal.note(BatchRow::Item(batch, u32::try_from(at).unwrap_or(u32::MAX)));
        }
    }

    /// Waits until the current record of a batch is durable; returns at once if batches do not outlast the process.
    ///
    /// # Errors
    /// When the record cannot be written.
    pub async fn written(&self, batch: JobKey) -> Result<(), StoreError> {
        match &self.journal {
            Some(journal) => journal.written(BatchRow::Batch(batch)).await,
            None => Ok(()),
        }
    }

    /// Returns why batches cannot be written now, so that none can be accepted; `None` if they can.
    pub fn trouble(&self) -> Option<String> {
        self.journal.as_ref()?.trouble()
    }

    /// Returns a batch, if it is known.
    pub fn get(&self, batch: &JobKey) -> Option<Batch> {
        lock(&self.table).batches.get(batch).cloned()
    }

    /// Returns a batch of the tenant that has this artifact, and the index of the item that has it.
    pub fn of_artifact(&self, tenant: Tenant, artifact: &Key) -> Option<(Batch, usize)> {
        let table = lock(&self.table);
        let (owner, key, id, at) = *table.by_artifact.range((tenant, *artifact, Key::LEAST, 0)..).next()?;
        let found = owner == tenant && key == *artifact;
        found.then(|| table.batches.get(&JobKey { tenant, id }).cloned().map(|batch| (batch, at))).flatten()
    }

    /// Returns the newest `n` batches of a tenant with numbers below `before`, newest first, and whether there are
    /// more.
    pub fn page(&self, tenant: Tenant, before: u64, n: usize) -> (Vec<Batch>, bool) {
        let table = lock(&self.table);
        let own = table.by_number.range(..before).rev().filter(|(_, batch)| batch.tenant == tenant);
        let mut own = own.map(|(_, batch)| &table.batches[batch]);
        let page = own.by_ref().take(n).cloned().collect();
        let is_more = own.next().is_some();
        (page, is_more)
    }

    /// Returns whether a batch that is posted again is active or done, so that it need not be begun. One that is done
    /// counts as newly settled, so that its record is kept for the full time to live.
    pub fn join(&self, batch: &JobKey) -> bool {
        let is_joined = lock(&self.table).join(batch, self.clock.now());
        if is_joined {
            self.note(*batch);
        }
        is_joined
    }

    /// Accepts a batch; returns `None` if it is active or done already. A batch that failed or was cancelled is begun
    /// again, with those of its jobs that were not done. `memory` allocates bytes for the record; if it fails, the
    /// oldest settled batches are removed.
    ///
    /// # Errors
    /// [`Full`] if active batches leave no room.
    pub fn accept(&self, memory: impl Fn(u64) -> Result<Paid, Full>, new: NewBatch) -> Result<Option<BatchRun>, Full> {
        let mut table = lock(&self.table);
        if table.join(&new.batch, self.clock.now()) {
            drop(table);
            self.note(new.batch);
            return Ok(None);
        }
        let before = table.forget(&new.batch);
        let (attempts, items) = before.as_ref().map_or((0, Vec::new()), |old| (old.attempts, old.items.clone()));
        let mut forgotten = Vec::new();
        let memory = loop {
            let is_room = table.batches.len() < MAX_BATCHES;
            if let Some(memory) = is_room.then(|| memory(new.request.bytes()).ok()).flatten() {
                break Ok(memory);
            }
            let oldest = table.by_number.values().find(|batch| !table.batches[*batch].is_active()).copied();
            match oldest.and_then(|oldest| table.forget(&oldest)) {
                Some(oldest) => forgotten.push(oldest),
                None => break Err(Full),
            }
        };
        let number = table.next;
        table.next += 1;
        let begun = memory.map(|memory| {
            let batch = self.begun(new, number, (attempts.saturating_add(1), items), memory);
            let run = BatchRun { batch: batch.batch, number, ended: batch.ended.subscribe() };
            table.insert(batch);
            run
        });
        if let (Err(Full), Some(before)) = (&begun, &before) {
            table.insert(before.clone());
        }
        drop(table);
        for batch in forgotten {
            self.note(batch.batch);
            self.note_items(batch.batch, 0..batch.items.len());
        }
        let run = begun?;
        // what is to be done again must not come back as failed after a restart
        self.note_items(run.batch, 0..before.map_or(0, |before| before.items.len()));
        self.note(run.batch);
        Ok(Some(run))
    }

    fn begun(&self, new: NewBatch, number: u64, (attempts, before): (u32, Vec<BatchItem>), memory: Paid) -> Batch {
        let NewBatch { batch, request, terms, peer, ticket } = new;
        let is_done = |item: &BatchItem| item.ending.as_ref().is_some_and(|ending| ending.state == JobState::Done);
        let mut items: Vec<BatchItem> =
            before.into_iter().map(|item| if is_done(&item) { item } else { BatchItem::default() }).collect();
        items.resize(request.n(), BatchItem::default());
        Batch {
            batch,
            number,
            request,
            attempts,
            terms,
            peer,
            state: JobState::Active,
            items,
            queued: self.clock.now(),
            settled: None,
            ended: Arc::new(watch::channel(false).0),
            _memory: Arc::new(memory),
            ticket: Some(Arc::new(ticket)),
        }
    }

    /// Loads the batches of an earlier process and returns the attempts of batches that are not settled, oldest first.
    /// Batches for which there is no room are skipped and stay in durable storage.
    ///
    /// # Errors
    /// When the batches cannot be read.
    pub fn recover(&self, memory: impl Fn(u64) -> Result<Paid, Full>) -> Result<Vec<BatchRun>, StoreError> {
        let Some(journal) = &self.journal else { return Ok(Vec::new()) };
        let (mut kept, mut items) = (Vec::new(), HashMap::<JobKey, Vec<(usize, BatchItem)>>::new());
        journal.each(&mut |record| match is_of_batch(record).then(|| decode(record)) {
            Some(Some(DecodedRow::Batch(batch))) => kept.push(*batch),
            Some(Some(DecodedRow::Item { batch, at, item })) => items.entry(batch).or_default().push((at, item)),
            Some(None) => tracing::warn!("a record of a batch cannot be read; it is left as it is"),
            None => {}
        })?;
        kept.sort_by_key(|kept| kept.number);
        let (mut table, mut runs) = (lock(&self.table), Vec::new());
        for kept in kept {
            let (key, number) = (kept.batch, kept.number);
            let Some(layout) = (self.layout)(&kept.text) else {
                tracing::warn!(batch = %key.id, "the jobs of a batch cannot be told any more; it is left as it is");
                continue;
            };
            let request = ParsedBatch { text: kept.text.clone(), layout, n_outputs: kept.n_outputs };
            let Ok(memory) = memory(request.bytes()) else {
                tracing::warn!(batch = %key.id, "no room for the record of a batch; it waits for a next start");
                continue;
            };
            table.next = table.next.max(number + 1);
            let batch = self.revived(kept, request, items.remove(&key).unwrap_or_default(), memory);
            if batch.is_active() {
                runs.push(BatchRun { batch: key, number, ended: batch.ended.subscribe() });
            }
            table.insert(batch);
        }
        Ok(runs)
    }

    /// Restores a batch of an earlier process; an active batch gets a further attempt.
    fn revived(&self, kept: KeptBatch, request: ParsedBatch, known: Vec<(usize, BatchItem)>, memory: Paid) -> Batch {
        let KeptBatch { batch, number, attempts, terms, state, settled_s, n_outputs: _, text: _ } = kept;
        let (now, wall) = (self.clock.now(), self.clock.wall());
        let mut items = vec![BatchItem::default(); request.n()];
        for (at, item) in known {
            if let Some(place) = items.get_mut(at) {
                *place = item;
            }
        }
        let is_active = state == JobState::Active;
        let age = settled_s.map(|at| wall.saturating_sub(Duration::from_secs(at)));
        Batch {
            batch,
            number,
            request: Arc::new(request),
            attempts: attempts.saturating_add(u32::from(is_active)),
            terms,
            peer: Peer::service(batch.tenant),
            state,
            items,
            queued: now,
            settled: age.map(|age| now.saturating_sub(age)),
            ended: Arc::new(watch::channel(!is_active).0),
            _memory: Arc::new(memory),
            ticket: None,
        }
    }

    /// Records the id of the job of an item; `is_hit` tells whether all its results existed already. An item with the
    /// same id keeps what is recorded of it, even from an earlier process. Returns false if the attempt is over.
    pub fn read(&self, run: &BatchRun, at: usize, job: Key, is_hit: bool) -> bool {
        let mut table = lock(&self.table);
        let Some(item) = table.running(run).and_then(|batch| batch.items.get_mut(at)) else { return false };
        if item.job != Some(job) {
            *item = BatchItem { job: Some(job), is_hit, ending: None };
        }
        drop(table);
        self.note_items(run.batch, [at]);
        true
    }

    /// Records the end of an item.
    pub fn settle_item(&self, run: &BatchRun, at: usize, ending: Ending) {
        let ending = Arc::new(ending);
        let mut table = lock(&self.table);
        let Some(item) = table.running(run).and_then(|batch| batch.items.get_mut(at)) else { return };
        item.ending = Some(ending.clone());
        table.find_by(run.batch, at, &ending);
        drop(table);
        self.note_items(run.batch, [at]);
    }

    /// Ends an active batch, or only the given attempt at it; items that have not ended become cancelled. Returns those
    /// of their jobs that were read; `None` if no such batch is active.
    pub fn end(&self, batch: &JobKey, attempt: Option<&BatchRun>, state: JobState) -> Option<Vec<JobKey>> {
        let now = self.clock.now();
        let mut table = lock(&self.table);
        let is_meant = |known: &&mut Batch| attempt.is_none_or(|run| run.number == known.number);
        let known = table.batches.get_mut(batch).filter(|known| known.is_active()).filter(is_meant)?;
        let left = known.under_way();
        let cancelled = Arc::new(Ending { state: JobState::Cancelled, outputs: Vec::new() });
        let open: Vec<usize> = (0..known.items.len()).filter(|at| known.items[*at].ending.is_none()).collect();
        for at in &open {
            known.items[*at].ending = Some(cancelled.clone());
        }
        (known.state, known.settled, known.ticket) = (state, Some(now), None);
        let ended = known.ended.clone();
        drop(table);
        self.note_items(*batch, open);
        self.note(*batch);
        ended.send_replace(true);
        Some(left)
    }

    /// Removes a batch; if it is active, returns its jobs that were read and have not ended. Returns `None` if the
    /// batch is not known.
    pub fn remove(&self, batch: &JobKey) -> Option<Vec<JobKey>> {
        let forgotten = lock(&self.table).forget(batch)?;
        self.note_items(*batch, 0..forgotten.items.len());
        self.note(*batch);
        Some(if forgotten.is_active() { forgotten.under_way() } else { Vec::new() })
    }

    /// Returns the batches settled at least `time_to_live` ago.
    pub fn overdue(&self, time_to_live: Duration) -> Vec<JobKey> {
        let now = self.clock.now();
        let is_old = |batch: &&Batch| batch.settled.is_some_and(|at| now.saturating_sub(at) >= time_to_live);
        lock(&self.table).batches.values().filter(is_old).map(|batch| batch.batch).collect()
    }

    /// Writes all pending records, waiting at most `patience`, and nothing afterwards.
    pub fn close(&self, patience: Duration) {
        self.journal.iter().for_each(|journal| journal.close(patience));
    }
}
