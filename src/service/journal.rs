//! The writer of records: one thread per table, which writes all changed records in one transaction, so that jobs that
//! arrive together share the cost of a durable write.

use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use tokio::sync::oneshot;

use super::lock::lock;
use super::store::{Records, StoreError};
use super::writer::LAST_WAIT;

/// Pause after a failed write before the remaining records are tried again. Half of it would retry on a full disk twice
/// as often; twice of it would lose the state of more jobs in a crash, which are then done once more.
const RETRY_PAUSE: Duration = Duration::from_secs(1);

/// Time without changes after which the store is checked, so that a removed file is told before the next job comes.
/// Half of it would look twice as often; twice of it would call the service ready for longer while jobs would be
/// refused.
const CHECK_INTERVAL: Duration = Duration::from_secs(1);

/// The identity of a record in a table.
pub(super) trait RowKey: Copy + Ord + Send + 'static {
    /// Returns the key of the record in the store; no two tables share a key.
    fn key(&self) -> Vec<u8>;
}

/// Encodes the record of a row; returns `None` if the record is to be removed.
type RowEncoder<R> = dyn Fn(&R) -> Option<Vec<u8>> + Send + Sync;

/// The writer of one table.
pub(super) struct Journal<R: RowKey> {
    shared: Arc<SharedJournal<R>>,
}

struct SharedJournal<R> {
    /// The store of records; `None` after the thread has ended.
    records: Mutex<Option<Arc<dyn Records>>>,
    encoded: Box<RowEncoder<R>>,
    pending: Mutex<PendingRows<R>>,
    changed: Condvar,
}

struct PendingRows<R> {
    /// The rows that have changed, each with the senders that report when it is written.
    rows: BTreeMap<R, Vec<oneshot::Sender<Result<(), String>>>>,
    /// Why the last write or check failed, if it did.
    trouble: Option<String>,
    closed: bool,
    ended: bool,
}

impl<R: RowKey> fmt::Debug for Journal<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.shared.records())
    }
}

impl<R: RowKey> Journal<R> {
    /// Starts the writer of a table; `encoded` encodes the record of a row, or returns `None` if the record is to be
    /// removed.
    pub(super) fn new(
        records: Arc<dyn Records>,
        encoded: impl Fn(&R) -> Option<Vec<u8>> + Send + Sync + 'static,
    ) -> Self {
        let pending = PendingRows { rows: BTreeMap::new(), trouble: None, closed: false, ended: false };
        let (pending, changed) = (Mutex::new(pending), Condvar::new());
        let shared = Arc::new(SharedJournal {
            records: Mutex::new(Some(records)),
            encoded: Box::new(encoded),
            pending,
            changed,
        });
        let of_thread = shared.clone();
        let started = thread::Builder::new().name("jobs".to_owned()).spawn(move || of_thread.work());
        if let Err(error) = started {
            tracing::error!(%error, "the thread that writes records of jobs could not be started");
            let mut pending = lock(&shared.pending);
            (pending.closed, pending.ended) = (true, true);
        }
        Self { shared }
    }

    /// Marks a row as changed.
    pub(super) fn note(&self, row: R) {
        lock(&self.shared.pending).rows.entry(row).or_default();
        self.shared.changed.notify_all();
    }

    /// Waits until the current state of a row is written durably.
    pub(super) async fn written(&self, row: R) -> Result<(), StoreError> {
        let (sender, written) = oneshot::channel();
        {
            let mut pending = lock(&self.shared.pending);
            if !pending.ended {
                pending.rows.entry(row).or_default().push(sender);
            }
        }
        self.shared.changed.notify_all();
        let ended = || Err("nothing is written any more".to_owned());
        let written = written.await.unwrap_or_else(|_| ended());
        written.map_err(|error| StoreError::Io(io::Error::other(error)))
    }

    /// Returns why nothing can be written now, as far as the last write or check has shown.
    pub(super) fn trouble(&self) -> Option<String> {
        lock(&self.shared.pending).trouble.clone()
    }

    /// Calls `tell` with every record in the store, including those of other tables.
    pub(super) fn each(&self, tell: &mut dyn FnMut(&[u8])) -> Result<(), StoreError> {
        match self.shared.records() {
            Some(records) => records.each(&mut |_, record| tell(record)),
            None => Ok(()),
        }
    }

    /// Writes the remaining changes, for at most `patience`; nothing is written afterwards.
    pub(super) fn close(&self, patience: Duration) {
        let mut pending = lock(&self.shared.pending);
        pending.closed = true;
        self.shared.changed.notify_all();
        let waited = self.shared.changed.wait_timeout_while(pending, patience, |pending| !pending.ended);
        drop(waited);
    }
}

impl<R: RowKey> Drop for Journal<R> {
    fn drop(&mut self) {
        self.close(LAST_WAIT);
    }
}

impl<R: RowKey> SharedJournal<R> {
    /// Returns the store of records; `None` after the thread has ended.
    fn records(&self) -> Option<Arc<dyn Records>> {
        lock(&self.records).clone()
    }

    /// Writes changes until the journal is closed, and checks the store while there are none.
    fn work(&self) {
        loop {
            let idle = |pending: &mut PendingRows<R>| pending.rows.is_empty() && !pending.closed;
            let waited = self.changed.wait_timeout_while(lock(&self.pending), CHECK_INTERVAL, idle);
            let (mut pending, _) = waited.unwrap_or_else(PoisonError::into_inner);
            let rows = std::mem::take(&mut pending.rows);
            let is_last = pending.closed;
            drop(pending);
            let changes: Vec<_> = rows.keys().map(|row| (row.key(), (self.encoded)(row))).collect();
            let written = match self.records() {
                Some(records) if changes.is_empty() => records.check(),
                Some(records) => records.write(&changes),
                None => Ok(()),
            };
            // converted to drop the prefix of a store's failure, which `written` adds again
            let written = written.map_err(|error| io::Error::from(error).to_string());
            let trouble = written.as_ref().err().cloned();
            let is_told = lock(&self.pending).trouble == trouble;
            if let Some(error) = trouble.as_ref().filter(|_| !is_told) {
                tracing::warn!(error, records = rows.len(), "records of jobs cannot be written");
            }
            if is_last {
                drop(lock(&self.records).take());
            }
            let mut pending = lock(&self.pending);
            pending.trouble = trouble;
            if is_last {
                pending.ended = true;
                self.changed.notify_all();
            } else if written.is_err() {
                // waiters get the error, but the rows stay pending until the disk takes them
                for row in rows.keys() {
                    pending.rows.entry(*row).or_default();
                }
            }
            drop(pending);
            rows.into_values().flatten().for_each(|sender| drop(sender.send(written.clone())));
            if is_last {
                return;
            }
            if written.is_err() {
                thread::sleep(RETRY_PAUSE);
            }
        }
    }
}
