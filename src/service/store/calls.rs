//! Calls to a store across a network, made by threads that may wait: each call ends in its time, and while the store is
//! away one is made now and then instead of all.

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
use super::lock::lock;
use crate::fault::cut;
use crate::service::clock::Clock;

/// How long a call may take in all, tries included: less than answers wait for a part.
/// Half of it cuts a mebibyte off that comes at 250 kB/s; twice of it outlasts those who wait for it.
pub(super) const PATIENCE: Duration = Duration::from_secs(8);
/// How long a look for an artifact may take: less than a request waits for it before it computes.
/// Half of it gives up on stores that are a continent away and busy; twice of it outlasts the request's own patience.
pub(super) const LOOK: Duration = Duration::from_millis(1500);
/// After a failure nothing is asked for so long; then one call tries.
/// Half of it asks a store that is away twice as often, each time for a call's patience; twice of it goes without a
/// store that is back for longer.
const PAUSE: Duration = Duration::from_secs(5);
/// Most characters of a reason. Half of it cuts addresses off; twice of it is more than a line of a log shows.
const REASON: usize = 400;

/// A store across a network.
#[derive(Debug)]
pub(super) struct Calls {
    objects: Arc<dyn ObjectStore>,
    /// One thread of its own drives all calls, so that nothing else that waits holds them up.
    runtime: Option<Runtime>,
    outage: Mutex<Option<Outage>>,
    clock: Arc<dyn Clock>,
}

/// The store does not answer.
#[derive(Debug)]
struct Outage {
    since: Duration,
    /// When the next call is let through.
    next: Duration,
    reason: String,
    refuses: bool,
}

impl Outage {
    fn told(&self) -> StoreError {
        StoreError::Away { reason: self.reason.clone(), refuses: self.refuses }
    }
}

/// What an object turned out to be.
#[derive(Debug)]
pub(super) enum Fetched {
    /// There is none.
    Missing,
    /// It has more bytes than anything that was put there.
    TooLong,
    /// Its bytes.
    Bytes(Bytes),
}

/// What became of a call that the store answered.
enum Answer<T> {
    Done(T),
    Missing,
    Present,
}

impl Calls {
    pub(super) fn new(objects: Arc<dyn ObjectStore>, clock: Arc<dyn Clock>) -> io::Result<Self> {
        let runtime = Builder::new_multi_thread().worker_threads(1).thread_name("shared-store").enable_all().build()?;
        Ok(Self { objects, runtime: Some(runtime), outage: Mutex::default(), clock })
    }

    /// The bytes of an object, if these are at most so many.
    pub(super) fn get(&self, path: &Path, most: u64, patience: Duration) -> Result<Fetched, StoreError> {
        let path = path.clone();
        let answer = self.ask(patience, |objects| async move {
            let found = objects.get(&path).await?;
            if found.meta.size > most { Ok(Fetched::TooLong) } else { found.bytes().await.map(Fetched::Bytes) }
        })?;
        Ok(if let Answer::Done(fetched) = answer { fetched } else { Fetched::Missing })
    }

    /// Puts an object where there is none; says whether there was none.
    pub(super) fn create(&self, path: &Path, bytes: Bytes) -> Result<bool, StoreError> {
        self.put(path, bytes, PutMode::Create)
    }

    /// Puts an object in place of whatever is there.
    pub(super) fn replace(&self, path: &Path, bytes: Bytes) -> Result<(), StoreError> {
        self.put(path, bytes, PutMode::Overwrite).map(drop)
    }

    fn put(&self, path: &Path, bytes: Bytes, mode: PutMode) -> Result<bool, StoreError> {
        let place = path.clone();
        let put = |objects: Arc<dyn ObjectStore>| async move {
            objects.put_opts(&place, PutPayload::from_bytes(bytes), mode.into()).await.map(drop)
        };
        match self.ask(PATIENCE, put)? {
            Answer::Done(()) => Ok(true),
            Answer::Present => Ok(false),
            Answer::Missing => Err(self.away("there is no such bucket".to_owned(), true)),
        }
    }

    /// Removes an object, if it is there and that is allowed.
    pub(super) fn delete(&self, path: &Path) {
        let gone = path.clone();
        let deleted = self.ask(PATIENCE, |objects| async move {
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

    /// Whether the last call failed.
    pub(super) fn is_away(&self) -> bool {
        lock(&self.outage).is_some()
    }

    /// Has a call made on the runtime and waits for its end.
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
        let (tell, told) = mpsc::sync_channel(1);
        let calling = call(Arc::clone(&self.objects));
        if let Some(runtime) = &self.runtime {
            runtime.spawn(async move {
                // nobody waits any more when the store is dropped
                let _ = tell.send(tokio::time::timeout(patience, calling).await);
            });
        }
        let answer = match told.recv() {
            Ok(Ok(Ok(done))) => Answer::Done(done),
            Ok(Ok(Err(Error::NotFound { .. }))) => Answer::Missing,
            Ok(Ok(Err(Error::AlreadyExists { .. } | Error::Precondition { .. }))) => Answer::Present,
            Ok(Ok(Err(error))) => return Err(self.away(reason(&error), is_refusal(&error))),
            Ok(Err(_)) => return Err(self.away(format!("no answer within {patience:?}"), false)),
            Err(_) => return Err(self.away("a call was lost".to_owned(), false)),
        };
        if let Some(outage) = lock(&self.outage).take() {
            let lasted = self.clock.now().saturating_sub(outage.since).as_secs();
            tracing::warn!(lasted_s = lasted, "the shared store answers again");
        }
        Ok(answer)
    }

    /// Lets a call through, unless the store failed a moment ago.
    fn let_through(&self) -> Result<(), StoreError> {
        let now = self.clock.now();
        match &mut *lock(&self.outage) {
            Some(outage) if now < outage.next => Err(outage.told()),
            Some(outage) => {
                outage.next = now + PAUSE;
                Ok(())
            }
            None => Ok(()),
        }
    }

    /// Notes that the store is away.
    fn away(&self, reason: String, refuses: bool) -> StoreError {
        let now = self.clock.now();
        let mut outage = lock(&self.outage);
        if outage.is_none() {
            tracing::warn!(reason, "the shared store is away; results are computed and answered without it");
        }
        let since = outage.as_ref().map_or(now, |outage| outage.since);
        outage.insert(Outage { since, next: now + PAUSE, reason, refuses }).told()
    }
}

impl Drop for Calls {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            // a runtime that is dropped otherwise waits, which threads of another one may not
            runtime.shutdown_background();
        }
    }
}

/// Whether the store answered that this may not be done with these credentials.
fn is_refusal(error: &Error) -> bool {
    matches!(error, Error::PermissionDenied { .. } | Error::Unauthenticated { .. })
}

/// What a call failed of, in a line without the store's own document: that names the id of the key.
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
    cut(&text, REASON).into_owned()
}
