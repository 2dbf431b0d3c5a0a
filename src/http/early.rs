//! Request bodies that are read before the router sees the request, so that the answer to a repeated request needs no
//! router.

use std::convert::Infallible;

use axum::body::Bytes;
use axum::extract::{FromRequest, Request};
use axum::http::request;

use super::app::SharedApp;
use super::body::{self, Sent};
use super::client::Client;
use super::content::AcceptedBodies;
use super::memo;
use super::problem::Problem;
use crate::job::key::Key;

/// The result of reading a body, and the identity of its request.
#[derive(Debug, Clone)]
pub(super) struct Early {
    pub(super) sent: Result<Sent, Problem>,
    pub(super) identity: Option<Key>,
}

impl Early {
    /// Reads the body of a request, and computes its identity.
    pub(super) async fn read<B>(app: &SharedApp, client: &Client, request: &request::Parts, body: B) -> Self
    where
        B: http_body::Body<Data = Bytes> + Unpin,
    {
        let takes = AcceptedBodies::Files(request.uri.query().unwrap_or_default());
        let sent = body::collect(app, client, &request.headers, takes, body).await;
        let identity = sent
            .as_ref()
            .ok()
            .and_then(|sent| memo::identity(client.tenant(), &request.headers, &sent.notation, &sent.bytes));
        Self { sent, identity }
    }
}

impl FromRequest<SharedApp> for Early {
    type Rejection = Infallible;

    async fn from_request(mut request: Request, _: &SharedApp) -> Result<Self, Infallible> {
        Ok(request.extensions_mut().remove().expect("every connection reads the bodies of jobs to be rendered"))
    }
}
