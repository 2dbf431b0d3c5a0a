//! Processing of batches: puts their jobs into the queue a few at a time, and records the result of each.

use std::future::Future;
use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;

use tokio::task::JoinSet;

use super::accepting::NotAccepted;
use super::account::Full;
use super::batches::{Batch, BatchRun, BatchStanding, Ending, NewBatch, ParsedBatch};
use super::desk::Desk;
use super::driving::{LEAST_PAUSE, Unreadable, stored_result};
use super::job_key::{JobKey, JobTerms};
use super::jobs::{Holder, JobState, JobSummary, OutputResult};
use super::peer::{Paid, Peer, QuotaKind};
use super::pool::{Lack, Lane};
use super::store::StoreError;

/// Pause before a job is put into the queue again after the disk failed to take its record. Half of it would retry on a
/// full disk twice as often; twice of it would delay a batch longer after the disk has room again.
const DISK_PAUSE: Duration = Duration::from_secs(5);

/// Reads single jobs of accepted batches.
pub trait ReadItems: Send + Sync {
    /// Reads job number `at` of a batch; returns its key and summary.
    fn item(self: Arc<Self>, batch: Batch, at: usize) -> Reading;
}

/// The reading of one job of a batch, under way.
pub type Reading = Pin<Box<dyn Future<Output = Result<(JobKey, JobSummary), Unreadable>> + Send>>;

impl Desk {
    /// Returns a function that takes memory for the record of a batch. Batches take at most half of the memory of
    /// records, one peer at most half of that, so that the other half is left to jobs.
    fn batch_memory(&self, peer: Peer) -> impl Fn(u64) -> Result<Paid, Full> + '_ {
        let capacity = self.account.records.capacity;
        let of_peer = if peer == Peer::SELF { capacity } else { capacity / 4 };
        move |bytes| {
            let most = (of_peer, capacity / 2);
            self.peers.charge_under(&self.account.records, QuotaKind::BatchBytes, peer, bytes, most)
        }
    }

    /// Returns the maximum length of the text of one job in a batch, in bytes: an eighth of the memory of records, so
    /// that its record fits beside those of the batches, whatever else is recorded.
    pub fn most_item_bytes(&self) -> u64 {
        self.account.records.capacity / 8
    }

    /// Returns the maximum size of a batch in bytes, including the records of its items.
    pub fn most_batch_bytes(&self) -> u64 {
        self.account.records.capacity / 4
    }

    /// Accepts a batch: records it and starts its jobs; if jobs outlast the process, the batch continues after a
    /// restart. A batch that is active or done already is not started again; of one that failed or was cancelled, the
    /// missing jobs are done.
    ///
    /// # Errors
    /// [`NotAccepted`].
    pub async fn accept_batch(
        self: &Arc<Self>,
        batch: JobKey,
        request: ParsedBatch,
        terms: JobTerms,
        peer: Peer,
    ) -> Result<(), NotAccepted> {
        let busy = |lack| self.pool.busy_behind(Lane::Long, lack, self.queue.waiting(Lane::Long));
        let most = (self.terms.most_a_peer / 4).max(1);
        let ticket = self
            .peers
            .take(peer, QuotaKind::Batch, 1, most, self.terms.most_jobs as u64)
            .ok_or_else(|| busy(Lack::Batches))?;
        let new = NewBatch { batch, request: Arc::new(request), terms, peer, ticket };
        let begun = self.batches.accept(self.batch_memory(peer), new).map_err(|Full| busy(Lack::Records))?;
        // a task of its own, which continues if the client disconnects here
        let desk = self.clone();
        let written = tokio::spawn(async move {
            let written = desk.batches.written(batch).await;
            match (begun, &written) {
                (Some(run), Ok(())) => desk.begun.put(run),
                (Some(_), Err(_)) => drop(desk.batches.remove(&batch)),
                (None, _) => {}
            }
            written
        });
        Ok(written.await.map_err(|error| NotAccepted::Unwritten(error.to_string()))??)
    }

    /// Returns the state and progress of a batch, if the batch is known.
    pub fn batch_standing(&self, batch: &JobKey) -> Option<BatchStanding> {
        self.batches.get(batch).map(|batch| self.standing_of_batch(batch))
    }

    /// Returns the state and progress of a batch and its jobs.
    pub fn standing_of_batch(&self, batch: Batch) -> BatchStanding {
        let ids: Vec<_> = batch.items.iter().map(|item| item.job).collect();
        let tenant = batch.batch.tenant;
        BatchStanding::of(batch, |at| self.standing(&JobKey { tenant, id: ids[at]? }))
    }

    /// Cancels an active batch, and those of its jobs that nobody else wants. Returns false if the batch is not active.
    pub fn cancel_batch(&self, batch: &JobKey) -> bool {
        let left = self.batches.end(batch, None, JobState::Cancelled);
        left.map(|left| self.leave_all(batch, &left)).is_some()
    }

    /// Cancels and forgets a batch. Returns false if the batch is not known.
    pub fn forget_batch(&self, batch: &JobKey) -> bool {
        let left = self.batches.remove(batch);
        left.map(|left| self.leave_all(batch, &left)).is_some()
    }

    /// Waits until the records of a batch, and of the jobs that it no longer wants, are written durably.
    ///
    /// # Errors
    /// [`NotAccepted::Unwritten`].
    pub async fn batch_written(&self, batch: &JobKey) -> Result<(), NotAccepted> {
        // records of jobs are written in the order of their changes, so waiting for this key waits for all jobs before
        // it
        self.jobs.written(*batch).await?;
        Ok(self.batches.written(*batch).await?)
    }

    fn leave_all(&self, batch: &JobKey, jobs: &[JobKey]) {
        for job in jobs.iter().filter(|job| self.jobs.leave(job, &batch.id)) {
            self.cancel(job);
        }
    }

    /// Resumes the active batches of an earlier process, and returns their number.
    ///
    /// # Errors
    /// When the records cannot be read.
    pub fn recover_batches(&self) -> Result<usize, StoreError> {
        let runs = self.batches.recover(self.batch_memory(Peer::SELF))?;
        let n = runs.len();
        runs.into_iter().for_each(|run| self.begun.put(run));
        Ok(n)
    }

    /// Processes all started batches concurrently, until the service ends.
    pub async fn do_batches(self: Arc<Self>, reader: Arc<dyn ReadItems>) {
        let mut under_way = JoinSet::new();
        loop {
            tokio::select! {
                biased;
                () = self.ended() => return,
                run = self.begun.next() => drop(under_way.spawn(self.clone().do_batch(run, reader.clone()))),
                Some(_) = under_way.join_next() => {}
            }
        }
    }

    /// Returns the maximum number of jobs of one batch that are queued or running at once: enough to keep every place
    /// busy, and at most half of those that its peer may have.
    fn max_items_at_once(&self) -> usize {
        let places = 2 * self.pool.places(Lane::Short) + 2;
        places.min(usize::try_from(self.terms.most_a_peer / 2).unwrap_or(usize::MAX)).max(1)
    }

    async fn do_batch(self: Arc<Self>, run: BatchRun, reader: Arc<dyn ReadItems>) {
        let Some(batch) = self.batches.get(&run.batch) else { return };
        let open: Vec<usize> = (0..batch.items.len()).filter(|at| batch.items[*at].ending.is_none()).collect();
        drop(batch);
        let (mut open, mut under_way) = (open.into_iter(), JoinSet::new());
        loop {
            while under_way.len() < self.max_items_at_once()
                && let Some(at) = open.next()
            {
                under_way.spawn(self.clone().do_item(run.clone(), at, reader.clone()));
            }
            if under_way.join_next().await.is_none() {
                break;
            }
        }
        self.close_batch(&run);
    }

    /// Settles an attempt at a batch after all its jobs have ended.
    fn close_batch(&self, run: &BatchRun) {
        let Some(batch) = self.batches.get(&run.batch).filter(Batch::is_active) else { return };
        let endings = batch.items.iter().filter_map(|item| item.ending.as_ref());
        let n_done = endings.filter(|ending| ending.state == JobState::Done).count();
        let (n, left) = (batch.items.len(), batch.items.len() - n_done);
        let state =
            if left == 0 { JobState::Done } else { JobState::Failed(format!("{left} of {n} jobs were not done")) };
        self.batches.end(&run.batch, Some(run), state);
    }

    /// Processes one job of a batch and records its result; tries again as long as there is no room for the job.
    async fn do_item(self: Arc<Self>, run: BatchRun, at: usize, reader: Arc<dyn ReadItems>) {
        let mut ended = run.ended.clone();
        loop {
            if *ended.borrow() {
                return;
            }
            let pause = match self.try_item(&run, at, &reader).await {
                Ok(()) => return,
                Err(pause) => pause.max(LEAST_PAUSE),
            };
            tokio::select! {
                () = self.clock.sleep(pause) => {}
                // the record keeps the sender alive
                _ = ended.wait_for(|ended| *ended) => return,
            }
        }
    }

    /// Tries once to process one job of a batch.
    ///
    /// # Errors
    /// The time to wait before the next try, when there is no room for the job now.
    async fn try_item(
        self: &Arc<Self>,
        run: &BatchRun,
        at: usize,
        reader: &Arc<dyn ReadItems>,
    ) -> Result<(), Duration> {
        let Some(batch) = self.batches.get(&run.batch) else { return Ok(()) };
        let (terms, peer, read_before) = (batch.terms, batch.peer, batch.items[at].job);
        let (job, summary) = match reader.clone().item(batch, at).await {
            Ok(read) => read,
            Err(Unreadable::Later(pause)) => return Err(pause),
            Err(Unreadable::Never(reason)) => {
                let ending = Ending { state: JobState::Failed(reason), outputs: Vec::new() };
                self.batches.settle_item(run, at, ending);
                return Ok(());
            }
        };
        if read_before == Some(job.id) && self.jobs.get(&job).is_some_and(|known| !known.is_active()) {
            // the job ended as part of this batch, in this process or an earlier one
            self.see_item(run, at, job, (&summary, peer)).await;
            return Ok(());
        }
        let made = self.all_kept(&summary, peer).await;
        let is_done = self.jobs.get(&job).is_some_and(|known| known.state == JobState::Done);
        let (is_hit, holder, of) = (is_done || !made.is_empty(), Holder::Batch(run.batch.id), summary.clone());
        match self.accept(job, of, terms, (peer, holder), made).await {
            Ok(()) => {}
            Err(NotAccepted::Busy(busy)) => return Err(busy.retry_after),
            Err(NotAccepted::Unwritten(_)) => return Err(DISK_PAUSE),
        }
        if self.batches.read(run, at, job.id, is_hit) {
            self.see_item(run, at, job, (&summary, peer)).await;
        } else {
            self.leave_all(&run.batch, &[job]);
        }
        Ok(())
    }

    /// Waits for the end of one job of a batch, and records its result.
    async fn see_item(self: &Arc<Self>, run: &BatchRun, at: usize, job: JobKey, (summary, peer): (&JobSummary, Peer)) {
        let mut over = run.ended.clone();
        let ended = self.jobs.get(&job).map(|record| record.ended.subscribe());
        if let Some(mut ended) = ended {
            tokio::select! {
                _ = ended.wait_for(|ended| *ended) => {}
                _ = over.wait_for(|ended| *ended) => return,
            }
        }
        let settled = self.jobs.get(&job).filter(|record| !record.is_active());
        let ending = if let Some(record) = settled {
            let outputs = record.summary.products.iter().cloned().zip(record.made.iter().cloned());
            Ending { state: record.state.clone(), outputs: outputs.collect() }
        } else {
            // the job was forgotten, or its record made room for others
            let made = self.all_kept(summary, peer).await;
            let state = if made.is_empty() { JobState::Cancelled } else { JobState::Done };
            let products = summary.products.iter().cloned();
            Ending { state, outputs: products.zip(made.into_iter().map(Some)).collect() }
        };
        self.batches.settle_item(run, at, ending);
    }

    /// Returns what is known of all outputs of a job, if the stores have all of them; otherwise an empty list.
    pub async fn all_kept(self: &Arc<Self>, summary: &JobSummary, peer: Peer) -> Vec<OutputResult> {
        let mut made = Vec::with_capacity(summary.products.len());
        for product in &summary.products {
            let Some(manifest) = self.find_artifact(product.key, peer).await else { return Vec::new() };
            made.push(stored_result(&manifest));
        }
        made
    }
}
