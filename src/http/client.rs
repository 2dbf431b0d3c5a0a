//! The client that sent a request, which goes with it to the handlers.

use std::convert::Infallible;
use std::sync::Arc;

use axum::extract::FromRequestParts;
use axum::http::request;

use super::connections::{Connection, Phase};
use crate::service::peer::Peer;

/// The client that sent a request.
#[derive(Debug, Clone)]
pub(super) struct Client(pub(super) Arc<Connection>);

impl Client {
    /// Who it is.
    pub(super) fn peer(&self) -> Peer {
        self.0.peer
    }

    /// Says that the request has arrived whole.
    pub(super) fn has_sent(&self) {
        self.0.enter(Phase::Working);
    }
}

impl<S: Sync> FromRequestParts<S> for Client {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut request::Parts, _: &S) -> Result<Self, Infallible> {
        Ok(parts.extensions.get::<Self>().cloned().expect("every connection hands its requests on with itself"))
    }
}
