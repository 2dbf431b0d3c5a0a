//! The open connections: their number in total and by peer, and the choice of one to close when there are too many.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use tokio::sync::Notify;

use crate::service::clock::Clock;
use crate::service::lock::lock;
use crate::service::peer::Peer;

/// The event that a connection waits for, in the order in which connections are closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub(super) enum ConnectionPhase {
    /// The client, to send a request or the rest of one.
    Listening,
    /// The client, to read an answer.
    Blocked,
    /// The service.
    Working,
}

/// The open connections of a service.
#[derive(Debug)]
pub struct Connections {
    table: Mutex<ConnectionTable>,
    most: usize,
    most_a_peer: usize,
    clock: Arc<dyn Clock>,
    made_room: AtomicU64,
    refused: AtomicU64,
}

#[derive(Debug, Default)]
struct ConnectionTable {
    next: u64,
    open: HashMap<u64, Arc<Connection>>,
    of_peer: HashMap<Peer, usize>,
}

/// One connection.
#[derive(Debug)]
pub(super) struct Connection {
    /// The peer at the other end, by its IP address.
    pub(super) peer: Peer,
    number: u64,
    phase: AtomicU8,
    /// The time at which the phase began, in microseconds of the clock.
    since_us: AtomicU64,
    clock: Arc<dyn Clock>,
    closing: Notify,
    /// Whether a request is being answered.
    pub(super) serving: AtomicBool,
    /// Whether the bytes being written belong to an answer of a handler, not of the HTTP library.
    pub(super) answering: AtomicBool,
}

/// An open connection, which is counted until this is dropped.
#[derive(Debug)]
pub(super) struct OpenConnection {
    pub(super) connection: Arc<Connection>,
    connections: Arc<Connections>,
}

impl Connections {
    /// Creates the table for at most `most` connections, and `most_a_peer` of one peer.
    pub(super) fn new(most: usize, most_a_peer: usize, clock: Arc<dyn Clock>) -> Arc<Self> {
        let counters = (AtomicU64::new(0), AtomicU64::new(0));
        Arc::new(Self { table: Mutex::default(), most, most_a_peer, clock, made_room: counters.0, refused: counters.1 })
    }

    /// Admits a connection. If there are too many, the one that has kept the service waiting for longest is closed for
    /// it: of the same peer if this peer has its maximum, else of the peer with the most connections. `None` if all of
    /// them wait for the service.
    pub(super) fn enter(self: &Arc<Self>, peer: Peer) -> Option<OpenConnection> {
        let mut table = lock(&self.table);
        let own = table.of_peer.get(&peer).copied().unwrap_or(0);
        if own >= self.most_a_peer || table.open.len() >= self.most {
            let from = if own >= self.most_a_peer { Some(peer) } else { None };
            let Some(slowest) = table.slowest(from) else {
                self.refused.fetch_add(1, Ordering::Relaxed);
                return None;
            };
            self.made_room.fetch_add(1, Ordering::Relaxed);
            table.remove(&slowest);
            slowest.closing.notify_one();
        }
        let number = table.next;
        table.next += 1;
        let connection = Arc::new(Connection {
            peer,
            number,
            phase: AtomicU8::new(ConnectionPhase::Listening as u8),
            since_us: AtomicU64::new(micros(self.clock.now())),
            clock: self.clock.clone(),
            closing: Notify::new(),
            serving: AtomicBool::new(false),
            answering: AtomicBool::new(false),
        });
        table.open.insert(number, connection.clone());
        *table.of_peer.entry(peer).or_default() += 1;
        Some(OpenConnection { connection, connections: Arc::clone(self) })
    }

    /// Returns the number of open connections.
    pub fn n_open(&self) -> usize {
        lock(&self.table).open.len()
    }

    /// Returns how many connections were closed to make room, and how many were refused.
    pub fn crowding(&self) -> [u64; 2] {
        [&self.made_room, &self.refused].map(|counter| counter.load(Ordering::Relaxed))
    }
}

impl ConnectionTable {
    /// Returns the connection to be closed, of this peer if one is given: one that waits for a request before one that
    /// is not read, then of the peer with the most connections, then the one that has waited longest.
    fn slowest(&self, of: Option<Peer>) -> Option<Arc<Connection>> {
        let rank = |connection: &&Arc<Connection>| {
            let crowd = self.of_peer.get(&connection.peer).copied().unwrap_or(0);
            let crowd = if of.is_some() { 0 } else { crowd };
            let phase = connection.phase.load(Ordering::Relaxed);
            (phase, usize::MAX - crowd, connection.since_us.load(Ordering::Relaxed), connection.number)
        };
        let waiting = self.open.values().filter(|connection| of.is_none_or(|peer| connection.peer == peer));
        let waiting =
            waiting.filter(|connection| connection.phase.load(Ordering::Relaxed) != ConnectionPhase::Working as u8);
        waiting.min_by_key(rank).cloned()
    }

    fn remove(&mut self, connection: &Connection) {
        if self.open.remove(&connection.number).is_some()
            && let Some(own) = self.of_peer.get_mut(&connection.peer)
        {
            *own -= 1;
            if *own == 0 {
                self.of_peer.remove(&connection.peer);
            }
        }
    }
}

impl Connection {
    /// Sets what the connection is waiting for from now on.
    pub(super) fn enter(&self, phase: ConnectionPhase) {
        if self.phase.swap(phase as u8, Ordering::Relaxed) != phase as u8 {
            self.since_us.store(micros(self.clock.now()), Ordering::Relaxed);
        }
    }

    /// Records that a request has begun to arrive.
    pub(super) fn begin(&self) {
        self.phase.store(ConnectionPhase::Listening as u8, Ordering::Relaxed);
        self.since_us.store(micros(self.clock.now()), Ordering::Relaxed);
    }

    /// Records that the client has read bytes of an answer; a connection that waits for a request keeps its phase.
    pub(super) fn is_read(&self) {
        let (blocked, working) = (ConnectionPhase::Blocked as u8, ConnectionPhase::Working as u8);
        let _ = self.phase.compare_exchange(blocked, working, Ordering::Relaxed, Ordering::Relaxed);
    }

    /// Completes when the connection is to be closed for another.
    pub(super) async fn closed(&self) {
        self.closing.notified().await;
    }
}

impl Drop for OpenConnection {
    fn drop(&mut self) {
        lock(&self.connections.table).remove(&self.connection);
    }
}

fn micros(time: Duration) -> u64 {
    u64::try_from(time.as_micros()).unwrap_or(u64::MAX)
}
