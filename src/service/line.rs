//! The line before a lane: each peer has its own queue, and the queues take turns, so that a peer with few requests
//! does not wait behind one with many.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use tokio::sync::oneshot;

use super::account::{Reservation, Share};
use super::lock::lock;
use super::peer::Peer;

/// The line is full, or the peer has too many requests in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Crowded;

/// A bounded number of places, and the requests that wait for one.
#[derive(Debug)]
pub(super) struct WaitingLine {
    state: Mutex<LineState>,
    /// The memory of the requests that have a place.
    share: Arc<Share>,
    most: usize,
    most_a_peer: usize,
}

#[derive(Debug)]
struct LineState {
    free: usize,
    n_waiting: usize,
    next_number: u64,
    /// The queues of peers in the order of their turns; none is empty.
    queues: VecDeque<(Peer, VecDeque<Request>)>,
}

#[derive(Debug)]
struct Request {
    number: u64,
    bytes: u64,
    grant: oneshot::Sender<LinePlace>,
}

/// A request in line; it leaves the line when dropped.
#[derive(Debug)]
pub struct WaitingRequest {
    line: Arc<WaitingLine>,
    peer: Peer,
    number: u64,
    granted: oneshot::Receiver<LinePlace>,
}

/// A place, with the memory that belongs to it.
#[derive(Debug)]
pub(super) struct LinePlace {
    line: Arc<WaitingLine>,
    /// The memory of the request; taken out if it is needed longer than the place.
    pub(super) memory: Option<LaneMemory>,
}

/// Memory of a lane; when it is given back, the line grants it to the next request.
#[derive(Debug)]
pub struct LaneMemory {
    line: Arc<WaitingLine>,
    held: Option<Reservation>,
}

impl LaneMemory {
    /// Gives back all but `bytes` of the memory.
    pub fn shrink_to(&mut self, bytes: u64) {
        self.held.iter_mut().for_each(|held| held.shrink_to(bytes));
        self.line.serve();
    }
}

impl Drop for LaneMemory {
    fn drop(&mut self) {
        drop(self.held.take());
        self.line.serve();
    }
}

impl WaitingLine {
    /// Creates a line before `places` places, with at most `most` waiting requests, and at most `most_a_peer` of each
    /// peer.
    pub(super) fn new(places: usize, share: Arc<Share>, most: usize, most_a_peer: usize) -> Arc<Self> {
        let state = LineState { free: places.max(1), n_waiting: 0, next_number: 0, queues: VecDeque::new() };
        Arc::new(Self { state: Mutex::new(state), share, most, most_a_peer })
    }

    /// Joins the line for a place with `bytes` of memory; a request for more than the share has takes the whole share.
    pub(super) fn join(self: &Arc<Self>, peer: Peer, bytes: u64) -> Result<WaitingRequest, Crowded> {
        self.join_behind(peer, bytes, self.most_a_peer)
    }

    /// Joins the line regardless of the number of requests that the peer has in it.
    pub(super) fn join_again(self: &Arc<Self>, peer: Peer, bytes: u64) -> Result<WaitingRequest, Crowded> {
        self.join_behind(peer, bytes, usize::MAX)
    }

    fn join_behind(self: &Arc<Self>, peer: Peer, bytes: u64, most_a_peer: usize) -> Result<WaitingRequest, Crowded> {
        let mut state = lock(&self.state);
        let own = state.queues.iter().find(|(other, _)| *other == peer).map_or(0, |(_, queue)| queue.len());
        if state.n_waiting >= self.most || own >= most_a_peer {
            return Err(Crowded);
        }
        let number = state.next_number;
        state.next_number += 1;
        state.n_waiting += 1;
        let (grant, granted) = oneshot::channel();
        let request = Request { number, bytes: bytes.min(self.share.capacity), grant };
        match state.queues.iter_mut().find(|(other, _)| *other == peer) {
            Some((_, queue)) => queue.push_back(request),
            None => state.queues.push_back((peer, VecDeque::from([request]))),
        }
        drop(state);
        self.serve();
        Ok(WaitingRequest { line: Arc::clone(self), peer, number, granted })
    }

    /// Grants free places to the next requests in turn.
    fn serve(self: &Arc<Self>) {
        loop {
            let mut state = lock(&self.state);
            if state.free == 0 {
                return;
            }
            let Some(bytes) = state.queues.front().and_then(|(_, queue)| queue.front()).map(|request| request.bytes)
            else {
                return;
            };
            // the first request waits for its memory and holds up the others: overtaken, it might wait forever
            let Some(held) = self.share.take_if_free(bytes) else { return };
            let memory = LaneMemory { line: Arc::clone(self), held: Some(held) };
            let (peer, mut queue) = state.queues.pop_front().expect("it was just looked at");
            let request = queue.pop_front().expect("no queue is empty");
            if !queue.is_empty() {
                state.queues.push_back((peer, queue));
            }
            state.n_waiting -= 1;
            state.free -= 1;
            drop(state);
            // a request that left in the meantime drops its place, which frees it again
            drop(request.grant.send(LinePlace { line: Arc::clone(self), memory: Some(memory) }));
        }
    }

    /// Removes a request from the line.
    fn leave(self: &Arc<Self>, peer: Peer, number: u64) {
        let mut state = lock(&self.state);
        let Some(at) = state.queues.iter().position(|(other, _)| *other == peer) else { return };
        let queue = &mut state.queues[at].1;
        let Some(place) = queue.iter().position(|request| request.number == number) else { return };
        let _ = queue.remove(place);
        let is_empty = queue.is_empty();
        if is_empty {
            let _ = state.queues.remove(at);
        }
        state.n_waiting -= 1;
        drop(state);
        self.serve();
    }

    /// Returns the number of waiting requests.
    pub(super) fn waiting(&self) -> usize {
        lock(&self.state).n_waiting
    }

    /// Returns whether the line is full.
    pub(super) fn is_full(&self) -> bool {
        lock(&self.state).n_waiting >= self.most
    }
}

impl WaitingRequest {
    /// Waits for a place.
    pub(super) async fn place(mut self) -> LinePlace {
        (&mut self.granted).await.expect("a line grants each request that stays")
    }
}

impl Drop for WaitingRequest {
    fn drop(&mut self) {
        self.line.leave(self.peer, self.number);
    }
}

impl Drop for LinePlace {
    fn drop(&mut self) {
        drop(self.memory.take());
        lock(&self.line.state).free += 1;
        self.line.serve();
    }
}
