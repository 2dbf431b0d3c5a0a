//! The requests of one connection: handed to the router together with the connection they came by.

use std::convert::Infallible;
use std::future::Future;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::task::{Context, Poll};

use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::FromRequestParts;
use axum::http::{Request, Response, request};
use http_body::{Body as _, Frame, SizeHint};
use hyper::body::Incoming;
use hyper::service::Service;
use tower::ServiceExt;

use super::connections::{Connection, Phase};
use crate::service::peer::Peer;

/// Hands requests on, and keeps the state of their connection.
#[derive(Debug, Clone)]
pub(super) struct Requests {
    router: Router,
    connection: Arc<Connection>,
}

impl Requests {
    pub(super) fn new(router: Router, connection: Arc<Connection>) -> Self {
        Self { router, connection }
    }
}

impl Service<Request<Incoming>> for Requests {
    type Response = Response<Ending>;
    type Error = Infallible;
    type Future = Pin<Box<dyn Future<Output = Result<Self::Response, Infallible>> + Send>>;

    fn call(&self, mut request: Request<Incoming>) -> Self::Future {
        let connection = self.connection.clone();
        connection.serving.store(true, Ordering::Relaxed);
        connection.answering.store(true, Ordering::Relaxed);
        connection.begin();
        // a request whose body is still to come keeps the service waiting; see `body::collect`
        if request.body().is_end_stream() {
            connection.enter(Phase::Working);
        }
        request.extensions_mut().insert(Client(connection.clone()));
        let answer = self.router.clone().oneshot(request.map(Body::new));
        Box::pin(async move {
            let response = answer.await.unwrap_or_else(|never| match never {});
            connection.enter(Phase::Working);
            Ok(response.map(|body| Ending { body, connection }))
        })
    }
}

/// The body of an answer; when it ends, so does the answer.
#[derive(Debug)]
pub(super) struct Ending {
    body: Body,
    connection: Arc<Connection>,
}

impl http_body::Body for Ending {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        Pin::new(&mut self.body).poll_frame(cx)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

impl Drop for Ending {
    fn drop(&mut self) {
        self.connection.serving.store(false, Ordering::Relaxed);
    }
}

/// The client that sent a request.
#[derive(Debug, Clone)]
pub(super) struct Client(Arc<Connection>);

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
