//! Results that go to their client while they are made, and are kept nowhere.

use std::io::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use tokio::runtime::Handle;
use tokio::sync::mpsc::error::TrySendError;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, mpsc, oneshot};

use super::clock::Clock;
use super::computation::Failure;
use super::desk::Desk;
use super::peer::{Kind, Peer, Ticket};
use super::pool::{Lane, panicked};
use super::read_lane::{StopOnDrop, Unread};
use super::task::Task;
use crate::job::{KeepWork, RunError};
use crate::watch::Watch;

/// Bytes that are sent at a time. Half of it wakes the connection twice as often; twice of it holds twice the memory.
const CHUNK_BYTES: usize = 256 << 10;
/// Chunks that may wait for the client: 8 MiB, what a compute thread makes in two milliseconds. Half of it lets threads
/// stand back for clients that are briefly late; twice of it holds twice the memory.
const CHUNKS: usize = 32;

/// Bytes that a stream holds besides the memory of its task.
pub const STREAM_BYTES: u128 = (CHUNK_BYTES * (CHUNKS + 2)) as u128;

/// A result on its way; dropping it stops the computation.
#[derive(Debug)]
pub struct Streamed {
    /// Time that passed before its turn came.
    pub queue: Duration,
    first: Option<Bytes>,
    chunks: mpsc::Receiver<Bytes>,
    ended: Option<oneshot::Receiver<Result<(), Failure>>>,
    _stop: StopOnDrop,
    _ticket: Ticket,
}

impl Streamed {
    /// The next bytes; `None` at the end.
    ///
    /// # Errors
    /// Why the computation failed: what came before is not the whole then.
    pub async fn next(&mut self) -> Result<Option<Bytes>, Failure> {
        if let Some(chunk) = self.first.take() {
            return Ok(Some(chunk));
        }
        if let Some(chunk) = self.chunks.recv().await {
            return Ok(Some(chunk));
        }
        let Some(ended) = self.ended.take() else { return Ok(None) };
        let ended = ended.await.unwrap_or_else(|_| Err(Failure::Internal("a stream lost its threads".to_owned())));
        ended.map(|()| None)
    }
}

impl Desk {
    /// Has a task made whose bytes go to one client while they are made; comes true with the first of them.
    ///
    /// Whoever waits for its memory stands in the line of the long lane. The threads are the stream's own, so that no
    /// lane waits for its client; no more streams compute at once than there are places in the long lane, and one that
    /// waits for its client computes not.
    ///
    /// # Errors
    /// [`Unread`].
    pub async fn stream(
        self: &Arc<Self>,
        task: Arc<dyn Task>,
        memory_bytes: u128,
        peer: Peer,
    ) -> Result<Streamed, Unread> {
        let start = self.clock.now();
        let ticket = self.ticket(peer, Kind::Waiting).ok_or_else(|| Unread::Busy(self.pool.busy(Lane::Long)))?;
        let memory_bytes = memory_bytes.saturating_add(STREAM_BYTES);
        let waiting = self.pool.line_up(Lane::Long, peer, memory_bytes).map_err(Unread::Busy)?;
        let memory = self.pool.turn(Lane::Long, waiting).await.into_memory();
        let places = self.pool.stream_places.clone();
        let permit = places.clone().acquire_owned().await.ok();
        let queue = self.clock.now().saturating_sub(start);
        let watch = Watch::new();
        let stop = StopOnDrop(watch.clone());
        let (sender, chunks) = mpsc::channel(CHUNKS);
        let (done, ended) = oneshot::channel();
        let pace = Pace { clock: self.clock.clone(), since: self.clock.now(), left: self.terms.run_timeout };
        let mut out = Channel { sender, chunk: Vec::new(), places, permit, runtime: Handle::current(), pace };
        let timeout = self.terms.run_timeout;
        let desk = self.clone();
        let making = move || {
            let made = catch_unwind(AssertUnwindSafe(|| out.take(&*task, &desk.work, &watch)));
            let timed_out = out.pace.left.is_zero();
            drop((out, memory));
            let _ = done.send(match made {
                Ok(Ok(())) => Ok(()),
                Ok(Err(_)) if timed_out => Err(Failure::TimedOut(timeout)),
                Ok(Err(error)) => Err(Failure::of(error)),
                Err(panic) => Err(Failure::Internal(format!("a computation panicked: {}", panicked(&*panic)))),
            });
        };
        self.pool.spawn_apart(making).map_err(|error| Unread::Failed(Failure::Internal(error.to_string())))?;
        let mut streamed = Streamed { queue, first: None, chunks, ended: Some(ended), _stop: stop, _ticket: ticket };
        let first = tokio::time::timeout(timeout, streamed.next()).await;
        streamed.first = first.unwrap_or(Err(Failure::TimedOut(timeout))).map_err(Unread::Failed)?;
        Ok(streamed)
    }
}

/// The way of bytes to their client.
struct Channel {
    sender: mpsc::Sender<Bytes>,
    chunk: Vec<u8>,
    places: Arc<Semaphore>,
    /// The place in which this stream computes; given back while its client is waited for.
    permit: Option<OwnedSemaphorePermit>,
    runtime: Handle,
    pace: Pace,
}

/// How long a stream may still compute.
struct Pace {
    clock: Arc<dyn Clock>,
    /// Since when it has been computing.
    since: Duration,
    left: Duration,
}

impl Pace {
    /// Counts the time since it was last asked.
    fn is_over(&mut self) -> bool {
        let now = self.clock.now();
        self.left = self.left.saturating_sub(now.saturating_sub(self.since));
        self.since = now;
        self.left.is_zero()
    }
}

impl Channel {
    fn take(&mut self, task: &dyn Task, kept: &dyn KeepWork, watch: &Watch) -> Result<(), RunError> {
        task.run(self, kept, watch)?;
        self.send().map_err(RunError::Io)
    }

    /// Sends what was gathered, and waits for the client where it has enough to read already.
    fn send(&mut self) -> io::Result<()> {
        if self.pace.is_over() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        let chunk = std::mem::take(&mut self.chunk);
        if chunk.is_empty() {
            return Ok(());
        }
        let left = || io::Error::from(io::ErrorKind::BrokenPipe);
        match self.sender.try_send(chunk.into()) {
            Ok(()) => Ok(()),
            Err(TrySendError::Closed(_)) => Err(left()),
            Err(TrySendError::Full(chunk)) => {
                self.permit = None;
                self.sender.blocking_send(chunk).map_err(|_| left())?;
                self.permit = self.runtime.block_on(self.places.clone().acquire_owned()).ok();
                self.pace.since = self.pace.clock.now();
                Ok(())
            }
        }
    }
}

impl Write for Channel {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.chunk.capacity() == 0 {
            self.chunk.reserve_exact(CHUNK_BYTES);
        }
        let taken = bytes.len().min(CHUNK_BYTES - self.chunk.len());
        self.chunk.extend_from_slice(&bytes[..taken]);
        if self.chunk.len() == CHUNK_BYTES {
            self.send()?;
        }
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
