//! The computations under way, and who is interested in them.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::computation::Computation;
use super::peer::Ticket;
use crate::job::key::Key;

/// The computations that wait or run, by their keys.
#[derive(Debug, Default)]
pub(super) struct UnderWay(Mutex<HashMap<Key, Arc<Computation>>>);

/// How an artifact came about, for `Cache-Status`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Provenance {
    /// It was there.
    Hit,
    /// It was made for this request.
    Made,
    /// It was being made for another request of the same tenant.
    Joined,
}

/// An interest in a computation; when the last one is dropped the computation stops.
#[derive(Debug)]
pub struct Interest {
    /// The computation.
    pub computation: Arc<Computation>,
    /// Whether it was under way already.
    pub provenance: Provenance,
    under_way: Arc<UnderWay>,
    /// Counts as one of what its peer may have.
    ticket: Ticket,
}

impl Interest {
    /// Counts as something else from now on.
    pub(super) fn count_as(&mut self, ticket: Ticket) {
        drop(std::mem::replace(&mut self.ticket, ticket));
    }
}

impl Drop for Interest {
    fn drop(&mut self) {
        let mut computations = self.under_way.computations();
        if self.computation.leave(self.ticket.peer().tenant()) {
            self.computation.stop();
            remove(&mut computations, &self.computation);
        }
    }
}

impl UnderWay {
    fn computations(&self) -> MutexGuard<'_, HashMap<Key, Arc<Computation>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Joins the computation of a key, or begins it; it is counted by `ticket`.
    ///
    /// # Errors
    /// That of `begin`.
    pub(super) fn join_or_begin<E>(
        self: &Arc<Self>,
        key: Key,
        ticket: Ticket,
        begin: impl FnOnce() -> Result<Arc<Computation>, E>,
    ) -> Result<Interest, E> {
        let mut computations = self.computations();
        let tenant = ticket.peer().tenant();
        let running = computations.get(&key).and_then(|running| Some((running.clone(), running.join(tenant)?)));
        let (computation, provenance) = if let Some((computation, is_own)) = running {
            // what others have made is nobody else's business
            (computation, if is_own { Provenance::Joined } else { Provenance::Made })
        } else {
            let computation = begin()?;
            computations.insert(key, computation.clone());
            (computation, Provenance::Made)
        };
        drop(computations);
        Ok(Interest { computation, provenance, under_way: self.clone(), ticket })
    }

    /// Takes a computation off the list.
    pub(super) fn remove(&self, computation: &Arc<Computation>) {
        remove(&mut self.computations(), computation);
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.computations().len()
    }

    /// How many interests there are in all of them.
    pub(super) fn n_interests(&self) -> usize {
        self.computations().values().map(|computation| computation.n_interests()).sum()
    }

    /// Any of them.
    pub(super) fn any(&self) -> Option<Arc<Computation>> {
        self.computations().values().next().cloned()
    }

    /// Ends all of them.
    pub(super) fn stop(&self) {
        self.computations().values().for_each(|computation| computation.stop());
    }
}

/// Takes a computation off the list, unless another one has its key by now.
fn remove(computations: &mut HashMap<Key, Arc<Computation>>, computation: &Arc<Computation>) {
    if computations.get(&computation.key).is_some_and(|current| Arc::ptr_eq(current, computation)) {
        computations.remove(&computation.key);
    }
}
