//! The client that sent a request, which goes with it to the handlers.

use std::convert::Infallible;
use std::sync::Arc;

use axum::extract::FromRequestParts;
use axum::http::request;

use super::connections::{Connection, Phase};
use super::problem::Problem;
use crate::service::job_key::Tenant;
use crate::service::peer::Peer;

/// The client that sent a request.
#[derive(Debug, Clone)]
pub(super) struct Client {
    pub(super) connection: Arc<Connection>,
    pub(super) caller: Caller,
}

/// Who asks, and how far that is allowed.
#[derive(Debug, Clone)]
pub(super) struct Caller {
    /// The key that the request shows or that signed its address; the address it comes from where there is none.
    pub(super) peer: Peer,
    /// What the request shows.
    pub(super) shown: Shown,
    /// Why it is not answered.
    pub(super) refused: Option<Problem>,
}

/// What a request shows of the right to ask.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shown {
    /// Nothing: there are no keys, or what it asks for is open to everybody.
    Nothing,
    /// A key with bounds of its own on requests a minute and at once, where it has these.
    Key(Option<u64>, Option<u64>),
    /// A signed address that ends at this time, seconds since 1970, and the bounds of its key.
    Link(u64, Option<u64>, Option<u64>),
}

impl Client {
    /// Who it is.
    pub(super) fn peer(&self) -> Peer {
        self.caller.peer
    }

    /// Whose jobs, results and uploads it sees.
    pub(super) fn tenant(&self) -> Tenant {
        self.peer().tenant()
    }

    /// Whether nobody between the service and the client may keep what it is answered.
    pub(super) fn is_private(&self) -> bool {
        matches!(self.caller.shown, Shown::Key(..)) && self.tenant() != Tenant::ANYONE
    }

    /// Says that the request has arrived whole.
    pub(super) fn has_sent(&self) {
        self.connection.enter(Phase::Working);
    }
}

impl<S: Sync> FromRequestParts<S> for Client {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut request::Parts, _: &S) -> Result<Self, Infallible> {
        Ok(parts.extensions.get::<Self>().cloned().expect("every connection hands its requests on with itself"))
    }
}
