//! The memory of request bodies: charged to the account, and to the peer's part of it, before it is allocated.

use super::app::App;
use super::client::Client;
use super::problem::Problem;
use crate::service::account::Reservation;
use crate::service::peer::{QuotaKind, Ticket};
use crate::service::pool::{Lack, Lane};

/// Maximum length of bodies that are not charged, in bytes: as there is one per connection, the number of connections
/// bounds them, and a small request is read although large ones have taken the whole share. Twice of it may hold twice
/// as much uncharged memory for each connection; half of it lets more small requests wait for the account.
const SHORT_BYTES: usize = 16 << 10;

/// The memory that is charged for a body, in the account and to its peer.
#[derive(Debug, Default)]
pub(super) struct Charge {
    memory: Option<Reservation>,
    ticket: Option<Ticket>,
}

impl Charge {
    /// Raises the charge to a buffer of `bytes` bytes in total, before it is allocated; short bodies are free.
    pub(super) fn cover(&mut self, app: &App, client: &Client, bytes: usize) -> Result<(), Problem> {
        let more = (bytes as u64).saturating_sub(self.memory.as_ref().map_or(0, Reservation::bytes));
        if bytes <= SHORT_BYTES || more == 0 {
            return Ok(());
        }
        let bodies = &app.desk.account.bodies;
        let most_a_peer = bodies.capacity / 2;
        let peers = &app.desk.peers;
        let is_fair = if let Some(ticket) = &mut self.ticket {
            ticket.grow(more, most_a_peer, bodies.capacity)
        } else {
            self.ticket = peers.take(client.peer(), QuotaKind::BodyBytes, more, most_a_peer, bodies.capacity);
            self.ticket.is_some()
        };
        let is_there = is_fair
            && if let Some(memory) = &mut self.memory {
                memory.grow(more).is_ok()
            } else {
                self.memory = bodies.try_take(more).ok();
                self.memory.is_some()
            };
        if is_there { Ok(()) } else { Err(app.desk.pool.busy(Lane::Reading, Lack::Bodies).into()) }
    }
}
