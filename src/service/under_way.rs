//! The table of computations under way, with the interests in them.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use super::computation::Computation;
use super::lock::lock;
use super::peer::Ticket;
use crate::job::key::Key;

/// The computations that wait or run, by key.
#[derive(Debug, Default)]
pub(super) struct UnderWay(Mutex<HashMap<Key, Arc<Computation>>>);

/// The origin of an artifact, for `Cache-Status`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Provenance {
    /// A store had the artifact.
    Hit,
    /// The artifact was computed for this request.
    Made,
    /// The artifact was being computed for another request of the same tenant.
    Joined,
}

/// An interest in a computation; when the last one is dropped, the computation stops.
#[derive(Debug)]
pub struct Interest {
    /// The computation.
    pub computation: Arc<Computation>,
    /// Whether the computation was under way already.
    pub provenance: Provenance,
    under_way: Arc<UnderWay>,
    /// Counts this interest towards the limits of its peer.
    ticket: Ticket,
}

impl Interest {
    /// Replaces the ticket, so that the interest counts towards another limit.
    pub(super) fn count_as(&mut self, ticket: Ticket) {
        drop(std::mem::replace(&mut self.ticket, ticket));
    }
}

impl Drop for Interest {
    fn drop(&mut self) {
        let mut computations = lock(&self.under_way.0);
        if self.computation.leave(self.ticket.peer().tenant()) {
            self.computation.stop();
            remove(&mut computations, &self.computation);
        }
    }
}

impl UnderWay {
    /// Joins the computation of a key, or begins it. The interest counts towards the limit of `ticket`.
    ///
    /// # Errors
    /// The error of `begin`.
    pub(super) fn join_or_begin<E>(
        self: &Arc<Self>,
        key: Key,
        ticket: Ticket,
        begin: impl FnOnce() -> Result<Arc<Computation>, E>,
    ) -> Result<Interest, E> {
        let mut computations = lock(&self.0);
        let tenant = ticket.peer().tenant();
        let running = computations.get(&key).and_then(|running| Some((running.clone(), running.join(tenant)?)));
        let (computation, provenance) = if let Some((computation, is_own)) = running {
            // a tenant must not learn what others compute
            (computation, if is_own { Provenance::Joined } else { Provenance::Made })
        } else {
            let computation = begin()?;
            computations.insert(key, computation.clone());
            (computation, Provenance::Made)
        };
        drop(computations);
        Ok(Interest { computation, provenance, under_way: self.clone(), ticket })
    }

    /// Removes a computation from the table.
    pub(super) fn remove(&self, computation: &Arc<Computation>) {
        remove(&mut lock(&self.0), computation);
    }

    /// Returns the number of computations.
    pub(super) fn len(&self) -> usize {
        lock(&self.0).len()
    }

    /// Returns the number of interests in all computations.
    pub(super) fn n_interests(&self) -> usize {
        lock(&self.0).values().map(|computation| computation.n_interests()).sum()
    }

    /// Returns any of the computations.
    pub(super) fn any(&self) -> Option<Arc<Computation>> {
        lock(&self.0).values().next().cloned()
    }

    /// Stops all computations.
    pub(super) fn stop(&self) {
        lock(&self.0).values().for_each(|computation| computation.stop());
    }
}

/// Removes a computation from the table, unless a newer one has the same key.
fn remove(computations: &mut HashMap<Key, Arc<Computation>>, computation: &Arc<Computation>) {
    if computations.get(&computation.key).is_some_and(|current| Arc::ptr_eq(current, computation)) {
        computations.remove(&computation.key);
    }
}
