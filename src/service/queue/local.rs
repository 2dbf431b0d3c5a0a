//! The queue of one process, in memory.

use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Mutex};

use tokio::sync::Notify;

use super::interface::{Later, Lease, Leased, Queue, QueueError, QueuedJob};
use crate::service::job_key::{JobKey, Priority};
use crate::service::lock::lock;
use crate::service::peer::Peer;
use crate::service::pool::Lane;

/// One turn in this many goes to batch jobs while interactive jobs wait, too. Half of it would give batch jobs a
/// quarter of all turns; twice of it would make them wait twice as long while interactive jobs always wait.
const TURNS_A_BATCH: u64 = 8;

/// The queue of one process. Clones share it.
#[derive(Debug, Clone, Default)]
pub struct LocalQueue(Arc<SharedQueue>);

#[derive(Debug, Default)]
struct SharedQueue {
    state: Mutex<QueueState>,
    /// Notified when a job enters the short lane (first) or the long lane (second).
    came: [Notify; 2],
}

#[derive(Debug, Default)]
struct QueueState {
    lanes: [LaneQueue; 2],
    known: HashMap<JobKey, QueuedJob>,
}

/// The waiting jobs of a lane.
#[derive(Debug, Default)]
struct LaneQueue {
    /// By priority, the non-empty queues of clients in the order of their turns.
    lines: [VecDeque<(Peer, VecDeque<JobKey>)>; 2],
    taken: u64,
}

fn lane_number(lane: Lane) -> usize {
    usize::from(lane == Lane::Long)
}

fn line_number(priority: Priority) -> usize {
    usize::from(priority == Priority::Batch)
}

impl SharedQueue {
    /// Adds a job that is not in the queue yet: at the front of its priority if `first`, else behind its client's other
    /// jobs.
    fn put(&self, item: QueuedJob, first: bool) {
        let mut state = lock(&self.state);
        if state.known.insert(item.job, item).is_none() {
            let line = &mut state.lanes[lane_number(item.lane)].lines[line_number(item.priority)];
            let own = line.iter().position(|(peer, _)| *peer == item.peer);
            match own {
                Some(at) if first => {
                    let mut queue = line.remove(at).expect("it was just found");
                    queue.1.push_front(item.job);
                    line.push_front(queue);
                }
                Some(at) => line[at].1.push_back(item.job),
                None if first => line.push_front((item.peer, VecDeque::from([item.job]))),
                None => line.push_back((item.peer, VecDeque::from([item.job]))),
            }
        }
        drop(state);
        self.came[lane_number(item.lane)].notify_one();
    }

    fn next(&self, lane: Lane) -> Option<QueuedJob> {
        let mut state = lock(&self.state);
        let job = state.lanes[lane_number(lane)].next()?;
        let item = state.known.remove(&job);
        if state.lanes[lane_number(lane)].len() > 0 {
            // Wakes a further waiter, because there is a job for it as well.
            self.came[lane_number(lane)].notify_one();
        }
        item
    }
}

impl LaneQueue {
    fn len(&self) -> usize {
        self.lines.iter().flatten().map(|(_, queue)| queue.len()).sum()
    }

    fn next(&mut self) -> Option<JobKey> {
        let batch_turn = self.taken % TURNS_A_BATCH == TURNS_A_BATCH - 1;
        let [interactive, batch] = &mut self.lines;
        let line = if interactive.is_empty() || batch_turn && !batch.is_empty() { batch } else { interactive };
        let (peer, mut queue) = line.pop_front()?;
        let job = queue.pop_front()?;
        if !queue.is_empty() {
            line.push_back((peer, queue));
        }
        self.taken += 1;
        Some(job)
    }

    /// Returns how many jobs come before a job, not counting the turns that batch jobs get before interactive ones.
    fn ahead(&self, item: &QueuedJob) -> Option<usize> {
        let at = line_number(item.priority);
        let before: usize = self.lines[..at].iter().flatten().map(|(_, queue)| queue.len()).sum();
        let line = &self.lines[at];
        let own = line.iter().position(|(peer, _)| *peer == item.peer)?;
        let place = line[own].1.iter().position(|job| *job == item.job)?;
        let others = line.iter().enumerate().filter(|(at, _)| *at != own);
        let others: usize = others.map(|(at, (_, queue))| queue.len().min(place + usize::from(at < own))).sum();
        Some(before + place + others)
    }
}

impl Queue for LocalQueue {
    fn push(&self, item: QueuedJob) -> Later<'_, Result<(), QueueError>> {
        self.0.put(item, false);
        Box::pin(std::future::ready(Ok(())))
    }

    fn take(&self, lane: Lane) -> Later<'_, Leased> {
        Box::pin(async move {
            loop {
                let came = self.0.came[lane_number(lane)].notified();
                if let Some(item) = self.0.next(lane) {
                    return Leased { item, lease: Box::new(Back { queue: self.0.clone(), item: Some(item) }) };
                }
                came.await;
            }
        })
    }

    fn withdraw(&self, job: &JobKey) {
        let mut state = lock(&self.0.state);
        let Some(item) = state.known.remove(job) else { return };
        let line = &mut state.lanes[lane_number(item.lane)].lines[line_number(item.priority)];
        for (_, queue) in line.iter_mut() {
            queue.retain(|waiting| waiting != job);
        }
        line.retain(|(_, queue)| !queue.is_empty());
    }

    fn ahead(&self, job: &JobKey) -> Option<usize> {
        let state = lock(&self.0.state);
        let item = state.known.get(job)?;
        state.lanes[lane_number(item.lane)].ahead(item)
    }

    fn waiting(&self, lane: Lane) -> usize {
        lock(&self.0.state).lanes[lane_number(lane)].len()
    }
}

/// Returns a job to the front of the queue when it is dropped without [`done`](Lease::done).
#[derive(Debug)]
struct Back {
    queue: Arc<SharedQueue>,
    item: Option<QueuedJob>,
}

impl Lease for Back {
    fn done(mut self: Box<Self>) {
        self.item = None;
    }
}

impl Drop for Back {
    fn drop(&mut self) {
        if let Some(item) = self.item.take() {
            self.queue.put(item, true);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::net::{IpAddr, Ipv4Addr};

    use super::*;
    use crate::job::key::Key;

    fn item(peer: u8, number: u8, priority: Priority) -> QueuedJob {
        let job = JobKey::of_anyone(Key::from_bytes([number; 32]));
        QueuedJob { job, lane: Lane::Short, priority, peer: Peer::new(IpAddr::V4(Ipv4Addr::new(10, 0, 0, peer))) }
    }

    fn number(item: &QueuedJob) -> u8 {
        item.job.id.as_bytes()[0]
    }

    fn queue(items: &[QueuedJob]) -> LocalQueue {
        let queue = LocalQueue::default();
        items.iter().for_each(|item| queue.0.put(*item, false));
        queue
    }

    #[test]
    fn peers_take_turns_and_a_job_in_line_knows_how_many_come_before_it() {
        let items =
            [(1, 1), (1, 2), (1, 3), (2, 4), (3, 5), (2, 6)].map(|(peer, n)| item(peer, n, Priority::Interactive));
        let line = queue(&items);
        let counted_ahead: Vec<_> = items.iter().map(|item| line.ahead(&item.job)).collect();
        let mut order = Vec::new();
        while let Some(item) = line.0.next(Lane::Short) {
            order.push(number(&item));
        }
        assert_eq!(order, [1, 4, 5, 2, 6, 3]);
        for (item, ahead) in items.iter().zip(counted_ahead) {
            assert_eq!(ahead, order.iter().position(|n| *n == number(item)), "{}", number(item));
        }
    }

    #[test]
    fn the_batch_stands_back_but_has_one_turn_in_eight() {
        let first: Vec<_> = (0..20).map(|n| item(1, n, Priority::Batch)).collect();
        let second: Vec<_> = (20..60).map(|n| item(1, n, Priority::Interactive)).collect();
        let line = queue(&[first, second].concat());
        let order: Vec<_> = std::iter::from_fn(|| line.0.next(Lane::Short)).collect();
        let places: Vec<_> = (0..20).filter(|at| order[*at].priority == Priority::Batch).collect();
        assert_eq!((order.len(), places), (60, vec![7, 15]));
    }

    #[test]
    fn a_job_that_is_taken_and_not_done_is_the_first_in_line_again() {
        let line = queue(&[item(1, 1, Priority::Batch), item(1, 2, Priority::Batch)]);
        let runtime = tokio::runtime::Builder::new_current_thread().build().expect("a runtime");
        runtime.block_on(async {
            let taken = line.take(Lane::Short).await;
            assert_eq!((number(&taken.item), line.waiting(Lane::Short)), (1, 1));
            drop(taken);
            let taken = line.take(Lane::Short).await;
            assert_eq!(number(&taken.item), 1);
            taken.done();
            line.withdraw(&item(1, 2, Priority::Batch).job);
            assert_eq!((line.waiting(Lane::Short), line.0.next(Lane::Short)), (0, None));
        });
    }

    #[test]
    fn a_job_is_in_line_once() {
        let line = queue(&[item(1, 1, Priority::Batch), item(2, 1, Priority::Interactive)]);
        assert_eq!(line.waiting(Lane::Short), 1);
    }
}
