//! Records of jobs of an earlier process, for this one.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::watch;

use super::record::{MOST_STARTS, Record, State, Wanted};
use super::written::Kept;
use crate::service::peer::{Paid, Peer};

/// Restores a record of an earlier process; an active job gets a further attempt, or fails if it was started too often.
pub(super) fn revived(kept: Kept, memory: Paid, now: Duration, wall: Duration) -> Record {
    let Kept { job, number, attempts, starts, is_posted, terms, state, made, settled_s, summary } = kept;
    let is_poison = state == State::Active && starts >= MOST_STARTS;
    let state = if is_poison { State::poisoned(starts) } else { state };
    let is_active = state == State::Active;
    let age = settled_s.map(|at| wall.saturating_sub(Duration::from_secs(at)));
    Record {
        job,
        number,
        attempts: attempts + u32::from(is_active),
        starts,
        terms,
        peer: Peer::service(job.tenant),
        wanted: Wanted { is_posted, ..Wanted::default() },
        state,
        made: if is_active { vec![None; made.len()] } else { made },
        summary: Arc::new(summary),
        computing: None,
        queued: now,
        begun: None,
        settled: age.map(|age| now.saturating_sub(age)).or(is_poison.then_some(now)),
        ended: Arc::new(watch::channel(!is_active).0),
        _memory: Arc::new(memory),
        pins: Vec::new(),
        ticket: None,
    }
}
