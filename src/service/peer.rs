//! Clients, told apart by the key that they show or by their network address, and what each may hold at once.

use std::collections::HashMap;
use std::net::{IpAddr, Ipv6Addr};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::account::{Full, Held, Share};
use super::job_key::Tenant;

/// A client as far as the service can tell, and the tenant for whom it asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Peer {
    who: Who,
    tenant: Tenant,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
enum Who {
    Service,
    Address(IpAddr),
    Key(u64),
}

impl Peer {
    /// The service itself.
    pub const SELF: Self = Self::service(Tenant::ANYONE);

    /// The service itself, on behalf of a tenant whose client is not there any more.
    pub const fn service(tenant: Tenant) -> Self {
        Self { who: Who::Service, tenant }
    }

    /// The client at an address: one IPv4 address, or the 64-bit network of an IPv6 address, as a single customer is
    /// given at least that much of it.
    pub fn new(address: IpAddr) -> Self {
        let address = match address.to_canonical() {
            IpAddr::V6(v6) => IpAddr::V6(Ipv6Addr::from(u128::from(v6) >> 64 << 64)),
            v4 @ IpAddr::V4(_) => v4,
        };
        Self { who: Who::Address(address), tenant: Tenant::ANYONE }
    }

    /// The client that shows a key of this number, which belongs to this tenant.
    pub fn of_key(number: u64, tenant: Tenant) -> Self {
        Self { who: Who::Key(number), tenant }
    }

    /// For whom it asks.
    pub fn tenant(self) -> Tenant {
        self.tenant
    }
}

/// Something a peer may hold only so many of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// Requests that wait for a computation, joined ones included.
    Waiting,
    /// Jobs that go on without their request.
    Detached,
    /// Computations of such jobs.
    Accepted,
    /// Requests for work that are being answered.
    InFlight,
    /// Streams of events.
    Listening,
    /// Bytes of bodies.
    BodyBytes,
    /// Bytes of inputs of jobs that wait or run.
    InputBytes,
    /// Bytes of answers that are on their way.
    AnswerBytes,
    /// Bytes of records of jobs.
    RecordBytes,
    /// Batches under way.
    Batch,
    /// Bytes of records of batches.
    BatchBytes,
}

/// What all peers hold.
#[derive(Debug, Default)]
pub struct Peers(Mutex<Table>);

#[derive(Debug, Default)]
struct Table {
    of_peer: HashMap<(Peer, Kind), u64>,
    of_all: HashMap<Kind, u64>,
}

/// Something held by a peer, until it is dropped.
#[derive(Debug)]
pub struct Ticket {
    peers: Arc<Peers>,
    peer: Peer,
    kind: Kind,
    amount: u64,
}

/// Bytes of a share, taken for a peer, until they are dropped.
#[derive(Debug)]
pub struct Paid {
    _held: Held,
    _ticket: Ticket,
}

impl Peers {
    fn table(&self) -> MutexGuard<'_, Table> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes an amount for a peer, if it then holds at most `most`, and all peers together at most `most_of_all`.
    pub fn take(self: &Arc<Self>, peer: Peer, kind: Kind, amount: u64, most: u64, most_of_all: u64) -> Option<Ticket> {
        let mut table = self.table();
        let held = table.of_peer.get(&(peer, kind)).copied().unwrap_or(0).saturating_add(amount);
        let all = table.of_all.get(&kind).copied().unwrap_or(0).saturating_add(amount);
        if held > most || all > most_of_all {
            return None;
        }
        table.of_peer.insert((peer, kind), held);
        table.of_all.insert(kind, all);
        Some(Ticket { peers: Arc::clone(self), peer, kind, amount })
    }

    /// Takes bytes of a share for a peer, which gets half of it at most.
    ///
    /// # Errors
    /// [`Full`].
    pub fn charge(self: &Arc<Self>, share: &Arc<Share>, kind: Kind, peer: Peer, bytes: u64) -> Result<Paid, Full> {
        self.charge_under(share, kind, peer, bytes, (share.capacity / 2, u64::MAX))
    }

    /// As [`Peers::charge`], for the service itself, which gets all of it: what was accepted before comes first.
    ///
    /// # Errors
    /// [`Full`].
    pub fn charge_self(self: &Arc<Self>, share: &Arc<Share>, kind: Kind, bytes: u64) -> Result<Paid, Full> {
        self.charge_under(share, kind, Peer::SELF, bytes, (u64::MAX, u64::MAX))
    }

    /// As [`Peers::charge`], for a peer that gets so much at most, and all peers together so much.
    ///
    /// # Errors
    /// [`Full`].
    pub fn charge_under(
        self: &Arc<Self>,
        share: &Arc<Share>,
        kind: Kind,
        peer: Peer,
        bytes: u64,
        (most, most_of_all): (u64, u64),
    ) -> Result<Paid, Full> {
        let ticket = self.take(peer, kind, bytes, most, most_of_all).ok_or(Full)?;
        Ok(Paid { _held: share.try_take(bytes)?, _ticket: ticket })
    }

    /// How much of a kind all peers hold.
    pub fn held(&self, kind: Kind) -> u64 {
        self.table().of_all.get(&kind).copied().unwrap_or(0)
    }
}

impl Ticket {
    /// Whose it is.
    pub(super) fn peer(&self) -> Peer {
        self.peer
    }

    /// Takes more of the same, under the same bounds; what was held stays in any case.
    pub fn grow(&mut self, amount: u64, most: u64, most_of_all: u64) -> bool {
        let Some(mut more) = self.peers.take(self.peer, self.kind, amount, most, most_of_all) else { return false };
        self.amount += std::mem::take(&mut more.amount);
        true
    }
}

impl Drop for Ticket {
    fn drop(&mut self) {
        let mut table = self.peers.table();
        let key = (self.peer, self.kind);
        let left = table.of_peer.get(&key).copied().unwrap_or(0).saturating_sub(self.amount);
        if left == 0 {
            table.of_peer.remove(&key);
        } else {
            table.of_peer.insert(key, left);
        }
        let all = table.of_all.entry(self.kind).or_default();
        *all = all.saturating_sub(self.amount);
    }
}
