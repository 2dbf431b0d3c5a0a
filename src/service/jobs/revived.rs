//! Records of jobs of an earlier process, for this one.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::watch;

use super::record::{JobState, MAX_STARTS, Record, Requesters};
use super::written::DecodedRecord;
use crate::service::peer::{Paid, Peer};

/// Restores a record of an earlier process; an active job gets a further attempt, or fails if it was started too often.
pub(super) fn revived(kept: DecodedRecord, memory: Paid, now: Duration, wall: Duration) -> Record {
    let DecodedRecord { job, number, attempts, starts, is_posted, terms, state, made, settled_s, summary } = kept;
    let is_poison = state == JobState::Active && starts >= MAX_STARTS;
    let state = if is_poison { JobState::poisoned(starts) } else { state };
    let is_active = state == JobState::Active;
    let age = settled_s.map(|at| wall.saturating_sub(Duration::from_secs(at)));
    Record {
        job,
        number,
        attempts: attempts.saturating_add(u32::from(is_active)),
        starts,
        terms,
        peer: Peer::service(job.tenant),
        wanted: Requesters { is_posted, ..Requesters::default() },
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
