//! Clients, identified by the key they show or by their network address, and limits on what each holds at once.

use std::collections::HashMap;
use std::net::{IpAddr, Ipv6Addr};
use std::sync::{Arc, Mutex};

use super::account::{Full, Reservation, Share};
use super::job_key::Tenant;
use super::lock::lock;

/// A client, and the tenant on whose behalf it acts.
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

    /// The service itself, on behalf of a tenant whose client has left.
    pub const fn service(tenant: Tenant) -> Self {
        Self { who: Who::Service, tenant }
    }

    /// Returns the client at an address: one IPv4 address, or the 64-bit network of an IPv6 address, since a single
    /// customer gets at least that much of it.
    pub fn new(address: IpAddr) -> Self {
        let address = match address.to_canonical() {
            IpAddr::V6(v6) => IpAddr::V6(Ipv6Addr::from(u128::from(v6) >> 64 << 64)),
            v4 @ IpAddr::V4(_) => v4,
        };
        Self { who: Who::Address(address), tenant: Tenant::ANYONE }
    }

    /// Returns the client that shows the key of this number, which belongs to this tenant.
    pub fn of_key(number: u64, tenant: Tenant) -> Self {
        Self { who: Who::Key(number), tenant }
    }

    /// Returns the tenant on whose behalf the client acts.
    pub fn tenant(self) -> Tenant {
        self.tenant
    }
}

/// A kind of thing of which a peer may hold a limited amount.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum QuotaKind {
    /// Requests that wait for a computation, including joined ones.
    Waiting,
    /// Jobs that continue without their request.
    Detached,
    /// Computations of such jobs.
    Accepted,
    /// Requests for work that are being answered.
    InFlight,
    /// Event streams.
    Listening,
    /// Bytes of request bodies.
    BodyBytes,
    /// Bytes of inputs of jobs that wait or run.
    InputBytes,
    /// Bytes of responses being sent.
    AnswerBytes,
    /// Bytes of records of jobs.
    RecordBytes,
    /// Active batches.
    Batch,
    /// Bytes of records of batches.
    BatchBytes,
}

/// The amounts that all peers hold, by kind.
#[derive(Debug, Default)]
pub struct Peers(Mutex<PeerTable>);

#[derive(Debug, Default)]
struct PeerTable {
    of_peer: HashMap<(Peer, QuotaKind), u64>,
    of_all: HashMap<QuotaKind, u64>,
}

/// An amount held by a peer until it is dropped.
#[derive(Debug)]
pub struct Ticket {
    peers: Arc<Peers>,
    peer: Peer,
    kind: QuotaKind,
    amount: u64,
}

/// Bytes of a memory share, taken for a peer until they are dropped.
#[derive(Debug)]
pub struct Paid {
    _held: Reservation,
    _ticket: Ticket,
}

impl Peers {
    /// Takes an amount for a peer, if the peer then holds at most `most`, and all peers together at most `most_of_all`.
    pub fn take(
        self: &Arc<Self>,
        peer: Peer,
        kind: QuotaKind,
        amount: u64,
        most: u64,
        most_of_all: u64,
    ) -> Option<Ticket> {
        let mut table = lock(&self.0);
        let held = table.of_peer.get(&(peer, kind)).copied().unwrap_or(0).saturating_add(amount);
        let all = table.of_all.get(&kind).copied().unwrap_or(0).saturating_add(amount);
        if held > most || all > most_of_all {
            return None;
        }
        table.of_peer.insert((peer, kind), held);
        table.of_all.insert(kind, all);
        Some(Ticket { peers: Arc::clone(self), peer, kind, amount })
    }

    /// Takes bytes of a share for a peer, which may hold at most half of the share.
    ///
    /// # Errors
    /// [`Full`].
    pub fn charge(self: &Arc<Self>, share: &Arc<Share>, kind: QuotaKind, peer: Peer, bytes: u64) -> Result<Paid, Full> {
        self.charge_under(share, kind, peer, bytes, (share.capacity / 2, u64::MAX))
    }

    /// Charges like [`Peers::charge`], for the service itself, which may hold the whole share, since work accepted
    /// earlier comes first.
    ///
    /// # Errors
    /// [`Full`].
    pub fn charge_self(self: &Arc<Self>, share: &Arc<Share>, kind: QuotaKind, bytes: u64) -> Result<Paid, Full> {
        self.charge_under(share, kind, Peer::SELF, bytes, (u64::MAX, u64::MAX))
    }

    /// Charges like [`Peers::charge`] a peer that may hold at most `most` bytes, while all peers together may hold at
    /// most `most_of_all`.
    ///
    /// # Errors
    /// [`Full`].
    pub fn charge_under(
        self: &Arc<Self>,
        share: &Arc<Share>,
        kind: QuotaKind,
        peer: Peer,
        bytes: u64,
        (most, most_of_all): (u64, u64),
    ) -> Result<Paid, Full> {
        let ticket = self.take(peer, kind, bytes, most, most_of_all).ok_or(Full)?;
        Ok(Paid { _held: share.try_take(bytes)?, _ticket: ticket })
    }

    /// Returns the amount of a kind that all peers hold.
    pub fn held(&self, kind: QuotaKind) -> u64 {
        lock(&self.0).of_all.get(&kind).copied().unwrap_or(0)
    }
}

impl Ticket {
    /// Returns the peer that holds the amount.
    pub(super) fn peer(&self) -> Peer {
        self.peer
    }

    /// Takes more of the same kind, within these limits, and returns whether it could; the amount held before is kept.
    pub fn grow(&mut self, amount: u64, most: u64, most_of_all: u64) -> bool {
        let Some(mut more) = self.peers.take(self.peer, self.kind, amount, most, most_of_all) else { return false };
        self.amount += std::mem::take(&mut more.amount);
        true
    }
}

impl Drop for Ticket {
    fn drop(&mut self) {
        let mut table = lock(&self.peers.0);
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
