//! The quotas of one client: requests for work per minute, and requests for work in flight.

use std::time::Duration;

use axum::http::{HeaderMap, HeaderName, HeaderValue, request};

use super::app::App;
use super::client::{Caller, Credentials};
use super::gate::{Need, needed};
use super::problem::Problem;
use crate::config::keys::KeyRole;
use crate::service::peer::{Peer, QuotaKind, Ticket};
use crate::service::rate::{Exceeded, Quota};

/// A request that counts against the quotas of its client while it is answered.
#[derive(Debug, Default)]
pub(super) struct Counted {
    /// The client that sent the request, and its limit per minute.
    taken: Option<(Peer, u64)>,
    quota: Option<Quota>,
    in_flight: Option<Ticket>,
}

impl Counted {
    /// Counts a request for work; sets `caller.refused` if its client exceeds a quota.
    pub(super) fn new(app: &App, caller: &mut Caller, request: &request::Parts) -> Self {
        let works = match needed(&request.method, request.uri.path()) {
            Need::Role(role) => role == KeyRole::Render,
            Need::Signature { works } => works,
            Need::Nothing => false,
        };
        if !works || caller.refused.is_some() {
            return Self::default();
        }
        let (per_minute, at_once) = match caller.shown {
            Credentials::Nothing => (None, None),
            Credentials::Key(per_minute, at_once) | Credentials::Link(_, per_minute, at_once) => (per_minute, at_once),
        };
        let per_minute = per_minute.unwrap_or(app.settings.requests_per_minute);
        let at_once = at_once.unwrap_or(app.settings.requests_in_flight);
        let mut counted = Self::default();
        if at_once > 0 {
            counted.in_flight = app.desk.peers.take(caller.peer, QuotaKind::InFlight, 1, at_once, u64::MAX);
            if counted.in_flight.is_none() {
                caller.refused = Some(too_many_at_once(at_once));
                return counted;
            }
        }
        if per_minute > 0 {
            match app.rates.take(caller.peer, per_minute) {
                Ok(quota) => {
                    counted.taken = Some((caller.peer, per_minute));
                    counted.quota = Some(quota);
                }
                Err(Exceeded { retry_after, quota }) => {
                    caller.refused = Some(too_many(per_minute, retry_after));
                    counted.quota = Some(quota);
                }
            }
        }
        counted
    }

    /// Takes the request back from the quota per minute, as it was answered without any work.
    pub(super) fn give_back(self, app: &App) {
        if let Some((peer, per_minute)) = self.taken {
            app.rates.give_back(peer, per_minute);
        }
    }

    /// Adds the remaining quota to the headers of an answer; a cache hit is taken back from the quota instead. The
    /// returned ticket is the request's place among those in flight.
    pub(super) fn add_headers(mut self, app: &App, headers: &mut HeaderMap) -> Option<Ticket> {
        if headers.get("cache-status").is_some_and(|status| status == "planish; hit") {
            let in_flight = self.in_flight.take();
            self.give_back(app);
            return in_flight;
        }
        if let Some(Quota { limit, remaining, reset }) = self.quota {
            let reset = whole_seconds(reset);
            let policy = format!("\"requests\";q={limit};w=60");
            let left = format!("\"requests\";r={remaining};t={reset}");
            for (name, value) in [("ratelimit-policy", policy), ("ratelimit", left)] {
                headers.extend(HeaderValue::try_from(value).map(|value| (HeaderName::from_static(name), value)));
            }
        }
        self.in_flight
    }
}

fn too_many(per_minute: u64, retry_after: Duration) -> Problem {
    let seconds = whole_seconds(retry_after).max(1);
    let detail = format!("one client may send {per_minute} requests for work a minute; come back in {seconds} s");
    Problem::quota(detail, Duration::from_secs(seconds))
}

fn too_many_at_once(at_once: u64) -> Problem {
    let detail = format!(
        "{at_once} requests of yours are being answered, the most that one client may have; send the next one when one \
         of them is done"
    );
    Problem::quota(detail, Duration::from_secs(1))
}

fn whole_seconds(time: Duration) -> u64 {
    time.as_secs() + u64::from(time.subsec_nanos() > 0)
}
