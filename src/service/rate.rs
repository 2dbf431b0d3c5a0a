//! Rate limits: how many requests each client may send per minute.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use super::clock::Clock;
use super::lock::lock;
use super::peer::Peer;

/// The period of the rate limit; a client may also send all requests of one period at once.
const RATE_PERIOD: Duration = Duration::from_mins(1);
/// Maximum number of clients counted; a further one replaces the one whose bucket is nearest to full, which starts anew
/// with a full bucket. Twice as many would take twice the memory, half a megabyte; half as many would forget clients
/// sooner when there are many.
const MAX_CLIENTS: usize = 4096;

/// Token buckets of clients, each stored as the time at which it is full again.
#[derive(Debug)]
pub struct Rates {
    full_at: Mutex<HashMap<Peer, Duration>>,
    clock: Arc<dyn Clock>,
}

/// The state of a client's rate limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quota {
    /// Requests per minute.
    pub limit: u64,
    /// Requests that the client may send at once now.
    pub remaining: u64,
    /// Time until the bucket is full.
    pub reset: Duration,
}

/// Refusal of a client that has sent too many requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exceeded {
    /// Time until the client may send one request.
    pub retry_after: Duration,
    /// The state of the rate limit.
    pub quota: Quota,
}

impl Rates {
    /// Creates the rate limits, with all buckets full.
    pub fn new(clock: Arc<dyn Clock>) -> Self {
        Self { full_at: Mutex::default(), clock }
    }

    /// Counts a request of a client that may send `per_minute` requests per minute.
    ///
    /// # Errors
    /// [`Exceeded`]; then the request is not counted.
    pub fn take(&self, peer: Peer, per_minute: u64) -> Result<Quota, Exceeded> {
        let (now, each) = (self.clock.now(), share(per_minute));
        let mut buckets = lock(&self.full_at);
        let before = buckets.get(&peer).copied().unwrap_or(now).max(now);
        let quota = |full_at: Duration| {
            let reset = full_at.saturating_sub(now);
            let left = RATE_PERIOD.saturating_sub(reset).as_nanos() / each.as_nanos().max(1);
            Quota { limit: per_minute, remaining: u64::try_from(left).unwrap_or(u64::MAX).min(per_minute), reset }
        };
        let after = before + each;
        let beyond = after.saturating_sub(now).saturating_sub(RATE_PERIOD);
        if !beyond.is_zero() {
            return Err(Exceeded { retry_after: beyond, quota: quota(before) });
        }
        if buckets.len() >= MAX_CLIENTS && !buckets.contains_key(&peer) {
            let fullest = buckets.iter().min_by_key(|(_, full_at)| **full_at).map(|(peer, _)| *peer);
            fullest.map(|peer| buckets.remove(&peer));
        }
        buckets.insert(peer, after);
        Ok(quota(after))
    }

    /// Takes back the count of a request that caused no work.
    pub fn give_back(&self, peer: Peer, per_minute: u64) {
        let mut buckets = lock(&self.full_at);
        if let Some(full_at) = buckets.get_mut(&peer) {
            *full_at = full_at.saturating_sub(share(per_minute));
        }
    }

    /// Returns the number of clients counted.
    pub fn n_clients(&self) -> usize {
        lock(&self.full_at).len()
    }
}

/// Returns the time in which the bucket regains one request.
fn share(per_minute: u64) -> Duration {
    Duration::from_nanos(60_000_000_000 / per_minute.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::clock::Manual;

    fn peer(number: u64) -> Peer {
        Peer::of_key(number, crate::service::job_key::Tenant::ANYONE)
    }

    #[test]
    fn a_minutes_worth_may_come_at_once_and_then_as_many_as_time_brings() {
        let clock = Arc::new(Manual::default());
        let rates = Rates::new(clock.clone());
        let left: Vec<u64> = (0..3).map(|_| rates.take(peer(1), 3).expect("there is room").remaining).collect();
        assert_eq!(left, [2, 1, 0]);
        let over = rates.take(peer(1), 3).expect_err("the minute is used up");
        assert_eq!(over.retry_after, Duration::from_secs(20));
        assert_eq!(
            rates.take(peer(2), 3).map(|quota| quota.remaining),
            Ok(2),
            "another client has a bucket of its own"
        );
        clock.advance(Duration::from_secs(20));
        assert_eq!(rates.take(peer(1), 3).map(|quota| quota.remaining), Ok(0));
        assert!(rates.take(peer(1), 3).is_err());
        rates.give_back(peer(1), 3);
        assert!(rates.take(peer(1), 3).is_ok(), "what was given back may be sent");
        clock.advance(RATE_PERIOD);
        assert_eq!(rates.take(peer(1), 3).map(|quota| quota.remaining), Ok(2), "full again, and no fuller than full");
    }

    #[test]
    fn the_table_of_clients_is_bounded_and_those_who_sent_most_stay() {
        let rates = Rates::new(Arc::new(Manual::default()));
        (0..2).for_each(|_| assert!(rates.take(peer(0), 2).is_ok()));
        (1..10_000).for_each(|number| assert!(rates.take(peer(number), 60).is_ok()));
        assert_eq!(rates.n_clients(), MAX_CLIENTS);
        assert!(rates.take(peer(0), 2).is_err());
    }
}
