//! Streamed results: sent to the client while they are made, and stored nowhere.

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
use super::peer::{Peer, QuotaKind, Ticket};
use super::pool::{Lack, Lane, panicked};
use super::read_lane::{ReadRefusal, StopOnDrop};
use super::task::Task;
use crate::job::{KeepWork, RunError};
use crate::watch::Watch;

/// Size of a chunk in bytes. Half of it would wake the connection twice as often; twice of it would take twice the
/// memory.
const CHUNK_BYTES: usize = 256 << 10;
/// Maximum number of chunks that wait for the client: 8 MiB, what a compute thread makes in two milliseconds. Half as
/// many would make threads wait for clients that are briefly late; twice as many would take twice the memory.
const MAX_WAITING_CHUNKS: usize = 32;

/// Memory of a stream besides that of its task, in bytes.
pub const STREAM_BYTES: u128 = (CHUNK_BYTES * (MAX_WAITING_CHUNKS + 2)) as u128;

/// A result being streamed; dropping it stops the computation.
#[derive(Debug)]
pub struct Streamed {
    /// Time that the stream waited for its turn.
    pub queue: Duration,
    first: Option<Bytes>,
    chunks: mpsc::Receiver<Bytes>,
    ended: Option<oneshot::Receiver<Result<(), Failure>>>,
    _stop: StopOnDrop,
    _ticket: Ticket,
}

impl Streamed {
    /// Returns the next bytes; `None` at the end.
    ///
    /// # Errors
    /// The failure of the computation; then the bytes sent before are incomplete.
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
    /// Starts a task whose bytes go to one client while they are made; returns when the first bytes exist.
    ///
    /// A stream waits for its memory in the line of the long lane. It has its own threads, so that no lane waits for
    /// its client. At most as many streams compute at once as the long lane has places; a stream that waits for its
    /// client gives its place back.
    ///
    /// # Errors
    /// [`ReadRefusal`].
    pub async fn stream(
        self: &Arc<Self>,
        task: Arc<dyn Task>,
        memory_bytes: u128,
        peer: Peer,
    ) -> Result<Streamed, ReadRefusal> {
        let start = self.clock.now();
        let ticket = self
            .ticket(peer, QuotaKind::Waiting)
            .ok_or_else(|| ReadRefusal::Busy(self.pool.busy(Lane::Long, Lack::Waiting)))?;
        let memory_bytes = memory_bytes.saturating_add(STREAM_BYTES);
        let waiting = self.pool.line_up(Lane::Long, peer, memory_bytes).map_err(ReadRefusal::Busy)?;
        let memory = self.pool.compute_place(Lane::Long, waiting).await.into_memory();
        let places = self.pool.stream_places.clone();
        let permit = places.clone().acquire_owned().await.ok();
        let queue = self.clock.now().saturating_sub(start);
        let watch = Watch::new();
        let stop = StopOnDrop(watch.clone());
        let (sender, chunks) = mpsc::channel(MAX_WAITING_CHUNKS);
        let (done, ended) = oneshot::channel();
        let pace = TimeBudget { clock: self.clock.clone(), since: self.clock.now(), left: self.terms.run_timeout };
        let mut out = ChunkSender { sender, chunk: Vec::new(), places, permit, runtime: Handle::current(), pace };
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
        self.pool.spawn_apart(making).map_err(|error| ReadRefusal::Failed(Failure::Internal(error.to_string())))?;
        let mut streamed = Streamed { queue, first: None, chunks, ended: Some(ended), _stop: stop, _ticket: ticket };
        let first = tokio::time::timeout(timeout, streamed.next()).await;
        streamed.first = first.unwrap_or(Err(Failure::TimedOut(timeout))).map_err(ReadRefusal::Failed)?;
        Ok(streamed)
    }
}

/// The writing end of a stream.
struct ChunkSender {
    sender: mpsc::Sender<Bytes>,
    chunk: Vec<u8>,
    places: Arc<Semaphore>,
    /// The place in which the stream computes; given back while the stream waits for its client.
    permit: Option<OwnedSemaphorePermit>,
    runtime: Handle,
    pace: TimeBudget,
}

/// The computing time that a stream has left.
struct TimeBudget {
    clock: Arc<dyn Clock>,
    /// The time from which computing has not yet been counted.
    since: Duration,
    left: Duration,
}

impl TimeBudget {
    /// Counts the time since the last call; returns whether none is left.
    fn is_over(&mut self) -> bool {
        let now = self.clock.now();
        self.left = self.left.saturating_sub(now.saturating_sub(self.since));
        self.since = now;
        self.left.is_zero()
    }
}

impl ChunkSender {
    fn take(&mut self, task: &dyn Task, kept: &dyn KeepWork, watch: &Watch) -> Result<(), RunError> {
        task.run(self, kept, watch)?;
        self.send().map_err(RunError::Io)
    }

    /// Sends the current chunk, and waits if the client has not yet read those before.
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

impl Write for ChunkSender {
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
