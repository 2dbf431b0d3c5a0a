//! The client that sent a request, as an extension of the request for its handlers.

use std::convert::Infallible;
use std::sync::Arc;

use axum::extract::FromRequestParts;
use axum::http::request;

use super::connections::{Connection, ConnectionPhase};
use super::problem::Problem;
use crate::job::key::Key;
use crate::service::job_key::{JobKey, Tenant};
use crate::service::peer::Peer;

/// The client that sent a request.
#[derive(Debug, Clone)]
pub(super) struct Client {
    pub(super) connection: Arc<Connection>,
    pub(super) caller: Caller,
}

/// The identity of a client, and its permission.
#[derive(Debug, Clone)]
pub(super) struct Caller {
    /// The key that the request shows or that signed its address; without a key, the IP address.
    pub(super) peer: Peer,
    /// The credentials of the request.
    pub(super) shown: Credentials,
    /// The refusal, if the request is not permitted.
    pub(super) refused: Option<Problem>,
}

/// The credentials of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Credentials {
    /// None: the service has no keys, or the resource is public.
    Nothing,
    /// A key, with its own limits of requests per minute and of requests in flight, if it has any.
    Key(Option<u64>, Option<u64>),
    /// A signed address with its expiry, seconds since 1970, and the limits of its key as for [`Self::Key`].
    Link(u64, Option<u64>, Option<u64>),
}

impl Client {
    /// Returns the peer for which the request counts.
    pub(super) fn peer(&self) -> Peer {
        self.caller.peer
    }

    /// Returns the tenant whose jobs, results and uploads the client sees.
    pub(super) fn tenant(&self) -> Tenant {
        self.peer().tenant()
    }

    /// Returns the job or the batch that the client names by an id; `None` if the text is no id.
    pub(super) fn named(&self, id: &str) -> Option<JobKey> {
        Key::parse(id).map(|id| JobKey { tenant: self.tenant(), id })
    }

    /// Returns whether shared caches must not store the answers to this client.
    pub(super) fn is_private(&self) -> bool {
        matches!(self.caller.shown, Credentials::Key(..)) && self.tenant() != Tenant::ANYONE
    }

    /// Records that the request has arrived completely.
    pub(super) fn has_sent(&self) {
        self.connection.enter(ConnectionPhase::Working);
    }
}

impl<S: Sync> FromRequestParts<S> for Client {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut request::Parts, _: &S) -> Result<Self, Infallible> {
        Ok(parts.extensions.get::<Self>().cloned().expect("every connection hands its requests on with itself"))
    }
}
