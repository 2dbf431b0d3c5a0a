//! Calls to an object store over a network, for threads that may block. Every call has a time limit; during an outage
//! calls fail at once, except one every few seconds that tests whether the store is back.

use std::future::Future;
use std::io;
use std::sync::mpsc;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use bytes::Bytes;
use object_store::path::Path;
use object_store::{Error, ObjectStore, ObjectStoreExt, PutMode, PutPayload};
use tokio::runtime::{Builder, Runtime};

use super::error::StoreError;
use crate::fault::cut;
use crate::service::clock::Clock;
use crate::service::lock::lock;

/// Time limit of one call in total, retries included; it is shorter than the time a response waits for a part. Half of
/// it would cut off a mebibyte that arrives at 250 kB/s; twice of it would outlast the waiting response.
pub(super) const CALL_TIMEOUT: Duration = Duration::from_secs(8);
/// Time limit of a manifest lookup; it is shorter than the time a request waits for the lookup before it computes. Half
/// of it would give up on busy stores on another continent; twice of it would outlast the request's own limit.
pub(super) const MANIFEST_TIMEOUT: Duration = Duration::from_millis(1500);
/// Time after a failure during which calls fail at once; then one call is let through. Half of it would try an
/// unreachable store twice as often, each time for up to the time limit of a call; twice of it would ignore a recovered
/// store for longer.
const FAILURE_PAUSE: Duration = Duration::from_secs(5);
/// Maximum length of an error reason in characters. Half of it would cut off addresses; twice of it is more than one
/// log line shows.
const MAX_REASON_CHARS: usize = 400;

/// Ends the outage, if there is one.
fn end(outage: &Mutex<Option<Outage>>, clock: &dyn Clock) {
    if let Some(outage) = lock(outage).take() {
        let lasted = clock.now().saturating_sub(outage.since).as_secs();
        tracing::warn!(lasted_s = lasted, "the shared store answers again");
    }
}

/// A client of an object store over a network.
#[derive(Debug)]
pub(super) struct Calls {
    objects: Arc<dyn ObjectStore>,
    /// The runtime whose single thread drives all calls, so that no other blocked task delays a call.
    runtime: Option<Runtime>,
    outage: Arc<Mutex<Option<Outage>>>,
    clock: Arc<dyn Clock>,
}

/// An outage: the store has not answered a call successfully since it began.
#[derive(Debug)]
struct Outage {
    since: Duration,
    /// The time at which the next call is let through.
    next: Duration,
    reason: String,
    refuses: bool,
}

impl Outage {
    fn to_error(&self) -> StoreError {
        StoreError::Away { reason: self.reason.clone(), refuses: self.refuses }
    }
}

/// The result of fetching an object.
#[derive(Debug)]
pub(super) enum Fetched {
    /// There is no such object.
    Missing,
    /// The object is longer than anything this service writes under that name.
    TooLong,
    /// The bytes of the object.
    Bytes(Bytes),
}

/// The outcome of a call that the store answered.
enum Answer<T> {
    Done(T),
    Missing,
    Present,
}

impl Calls {
    pub(super) fn new(objects: Arc<dyn ObjectStore>, clock: Arc<dyn Clock>) -> io::Result<Self> {
        let runtime = Builder::new_multi_thread().worker_threads(1).thread_name("shared-store").enable_all().build()?;
        Ok(Self { objects, runtime: Some(runtime), outage: Arc::default(), clock })
    }

    /// Fetches an object of at most `most` bytes.
    pub(super) fn get(&self, path: &Path, most: u64, patience: Duration) -> Result<Fetched, StoreError> {
        let path = path.clone();
        let answer = self.ask(patience, |objects| async move {
            let found = objects.get(&path).await?;
            if found.meta.size > most { Ok(Fetched::TooLong) } else { found.bytes().await.map(Fetched::Bytes) }
        })?;
        Ok(if let Answer::Done(fetched) = answer { fetched } else { Fetched::Missing })
    }

    /// Creates an object unless one exists under this path; returns whether it was created.
    pub(super) fn create(&self, path: &Path, bytes: Bytes) -> Result<bool, StoreError> {
        self.put(path, bytes, PutMode::Create)
    }

    /// Writes an object, replacing any existing one.
    pub(super) fn replace(&self, path: &Path, bytes: Bytes) -> Result<(), StoreError> {
        self.put(path, bytes, PutMode::Overwrite).map(drop)
    }

    fn put(&self, path: &Path, bytes: Bytes, mode: PutMode) -> Result<bool, StoreError> {
        let place = path.clone();
        let put = |objects: Arc<dyn ObjectStore>| async move {
            objects.put_opts(&place, PutPayload::from_bytes(bytes), mode.into()).await.map(drop)
        };
        match self.ask(CALL_TIMEOUT, put)? {
            Answer::Done(()) => Ok(true),
            Answer::Present => Ok(false),
            Answer::Missing => Err(self.away("there is no such bucket".to_owned(), true)),
        }
    }

    /// Deletes an object. A missing object or a refusal is not an error; a failure is only logged.
    pub(super) fn delete(&self, path: &Path) {
        let gone = path.clone();
        let deleted = self.ask(CALL_TIMEOUT, |objects| async move {
            match objects.delete(&gone).await {
                Err(error) if is_refusal(&error) => {
                    tracing::warn!(object = %gone, reason = reason(&error), "an object may not be removed");
                    Ok(())
                }
                deleted => deleted,
            }
        });
        if let Err(error) = deleted {
            tracing::debug!(object = %path, %error, "an object was not removed");
        }
    }

    /// Returns whether the store is in an outage, that is, whether the last call failed. After a pause the object
    /// `probe` is asked for in the background, so that the end of an outage is noticed even if nobody needs the store.
    pub(super) fn is_away(&self, probe: &Path) -> bool {
        if lock(&self.outage).is_none() {
            return false;
        }
        if let (Ok(()), Some(runtime)) = (self.let_through(), &self.runtime) {
            let (objects, probe) = (Arc::clone(&self.objects), probe.clone());
            let (outage, clock) = (Arc::clone(&self.outage), Arc::clone(&self.clock));
            runtime.spawn(async move {
                if let Ok(Ok(_) | Err(Error::NotFound { .. })) =
                    tokio::time::timeout(MANIFEST_TIMEOUT, objects.head(&probe)).await
                {
                    end(&outage, &*clock);
                }
            });
        }
        true
    }

    /// Runs a call on the runtime and blocks until it ends.
    fn ask<T, F>(
        &self,
        patience: Duration,
        call: impl FnOnce(Arc<dyn ObjectStore>) -> F,
    ) -> Result<Answer<T>, StoreError>
    where
        T: Send + 'static,
        F: Future<Output = object_store::Result<T>> + Send + 'static,
    {
        self.let_through()?;
        let (sender, receiver) = mpsc::sync_channel(1);
        let calling = call(Arc::clone(&self.objects));
        if let Some(runtime) = &self.runtime {
            runtime.spawn(async move {
                // The send fails only if the receiver is gone, and then nobody needs the answer.
                let _ = sender.send(tokio::time::timeout(patience, calling).await);
            });
        }
        let answer = match receiver.recv() {
            Ok(Ok(Ok(done))) => Answer::Done(done),
            Ok(Ok(Err(Error::NotFound { .. }))) => Answer::Missing,
            Ok(Ok(Err(Error::AlreadyExists { .. } | Error::Precondition { .. }))) => Answer::Present,
            Ok(Ok(Err(error))) => return Err(self.away(reason(&error), is_refusal(&error))),
            Ok(Err(_)) => return Err(self.away(format!("no answer within {patience:?}"), false)),
            Err(_) => return Err(self.away("a call was lost".to_owned(), false)),
        };
        end(&self.outage, &*self.clock);
        Ok(answer)
    }

    /// Lets a call through unless the store failed less than [`FAILURE_PAUSE`] ago.
    fn let_through(&self) -> Result<(), StoreError> {
        let now = self.clock.now();
        match &mut *lock(&self.outage) {
            Some(outage) if now < outage.next => Err(outage.to_error()),
            Some(outage) => {
                outage.next = now + FAILURE_PAUSE;
                Ok(())
            }
            None => Ok(()),
        }
    }

    /// Records a failed call as an outage and returns the error for the caller.
    fn away(&self, reason: String, refuses: bool) -> StoreError {
        let now = self.clock.now();
        let mut outage = lock(&self.outage);
        if outage.is_none() {
            tracing::warn!(reason, "the shared store is away; results are computed and answered without it");
        }
        let since = outage.as_ref().map_or(now, |outage| outage.since);
        outage.insert(Outage { since, next: now + FAILURE_PAUSE, reason, refuses }).to_error()
    }
}

impl Drop for Calls {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            // Dropping a runtime blocks, which panics inside an async context; this shutdown does not block.
            runtime.shutdown_background();
        }
    }
}

/// Returns whether the store answered that these credentials do not permit the operation.
fn is_refusal(error: &Error) -> bool {
    matches!(error, Error::PermissionDenied { .. } | Error::Unauthenticated { .. })
}

/// Describes an error in one line, without the XML document of the store, which contains the id of the access key.
fn reason(error: &Error) -> String {
    match error {
        Error::PermissionDenied { .. } => return "access is denied".to_owned(),
        Error::Unauthenticated { .. } => return "the credentials are not accepted".to_owned(),
        _ => {}
    }
    let mut inner: &dyn std::error::Error = error;
    while let Some(source) = inner.source() {
        inner = source;
    }
    let line = |text: &str| text.split(['<', '\n']).next().unwrap_or_default().trim_end().to_owned();
    let (whole, inner) = (line(&error.to_string()), line(&inner.to_string()));
    let text = if whole.contains(&inner) { whole } else { format!("{whole}: {inner}") };
    cut(&text, MAX_REASON_CHARS).into_owned()
}
