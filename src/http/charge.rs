//! The memory of bodies: taken from the account, and from their peer's part of it, before it is allocated.

use super::app::App;
use super::client::Client;
use super::problem::Problem;
use crate::service::account::Held;
use crate::service::peer::{Kind, Ticket};
use crate::service::pool::Lane;

/// Bodies up to this length take nothing from the account: with one a connection they are bounded by the connections,
/// and a small request gets in though large ones have taken all there is.
/// Twice of it may hold twice as much beside the account for each connection; half of it lets more small requests wait
/// for the account.
const SHORT_BYTES: usize = 16 << 10;

/// What a body takes from the account, and from its peer's part of it.
#[derive(Debug, Default)]
pub(super) struct Charge {
    memory: Option<Held>,
    ticket: Option<Ticket>,
}

impl Charge {
    /// Takes what a buffer of so many bytes needs in all, before it is allocated; short bodies are free, as there can
    /// only be one a connection.
    pub(super) fn cover(&mut self, app: &App, client: &Client, bytes: usize) -> Result<(), Problem> {
        let more = (bytes as u64).saturating_sub(self.memory.as_ref().map_or(0, Held::bytes));
        if bytes <= SHORT_BYTES || more == 0 {
            return Ok(());
        }
        let bodies = &app.desk.account.bodies;
        let most_a_peer = bodies.capacity / 2;
        let peers = &app.desk.peers;
        let is_fair = if let Some(ticket) = &mut self.ticket {
            ticket.grow(more, most_a_peer, bodies.capacity)
        } else {
            self.ticket = peers.take(client.peer(), Kind::BodyBytes, more, most_a_peer, bodies.capacity);
            self.ticket.is_some()
        };
        let is_there = is_fair
            && if let Some(memory) = &mut self.memory {
                memory.grow(more).is_ok()
            } else {
                self.memory = bodies.try_take(more).ok();
                self.memory.is_some()
            };
        if is_there { Ok(()) } else { Err(app.desk.pool.busy(Lane::Reading).into()) }
    }
}
