//! The requests of one connection: answered the short way, or passed to the router together with the connection.

use std::convert::Infallible;
use std::future::{Future, Ready, ready};
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::task::{Context, Poll};

use axum::body::{Body, Bytes};
use axum::http::{Method, Request, Response, header, request};
use axum::{BoxError, Router};
use futures_util::future::Either;
use http_body::{Body as _, Frame, SizeHint};
use http_body_util::Full;
use hyper::body::Incoming;
use hyper::service::Service;
use tower::ServiceExt;
use tracing::Instrument;

use super::address::RENDER;
use super::app::App;
use super::client::{Caller, Client};
use super::connections::{Connection, ConnectionPhase};
use super::early::Early;
use super::guard;
use super::quota::Counted;
use super::short::PlainResource;
use super::trace::Trace;
use crate::service::peer::Ticket;

/// The HTTP service of one connection, which also keeps the state of the connection.
#[derive(Debug, Clone)]
pub(super) struct ConnectionService {
    app: Arc<App>,
    router: Router,
    connection: Arc<Connection>,
}

impl ConnectionService {
    pub(super) fn new(app: Arc<App>, router: Router, connection: Arc<Connection>) -> Self {
        Self { app, router, connection }
    }

    /// Returns the remembered answer to a plain request, and counts it.
    fn again(&self, asked: Option<PlainResource>, parts: &request::Parts) -> Option<Response<AnswerBody>> {
        let asked = asked?;
        let answer = self.app.short.answer(&self.app.desk.tiers, &asked, parts)?;
        self.app.desk.count_hit();
        self.app.requests.count(&parts.method, asked.route(), answer.status().as_u16());
        Some(answer.map(|bytes| AnswerBody::Left(Full::new(bytes))))
    }

    /// Answers a request whose body has not been read.
    async fn answer(
        self,
        mut parts: request::Parts,
        body: Incoming,
        (mut caller, is_accepted, by_address): (Caller, bool, Option<PlainResource>),
    ) -> (Response<AnswerBody>, Option<Ticket>) {
        let counted = Counted::new(&self.app, &mut caller, &parts);
        let is_let_in = caller.refused.is_none();
        let (client, mut asked) = (Client { connection: self.connection.clone(), caller }, by_address);
        let is_job = parts.method == Method::POST && parts.uri.path() == RENDER;
        let body = if is_job && is_let_in && is_accepted {
            let early = Early::read(&self.app, &client, &parts, body).await;
            asked = PlainResource::render(&parts, early.identity);
            if let Some(answer) = self.again(asked, &parts) {
                counted.give_back(&self.app);
                return (answer, None);
            }
            parts.extensions.insert(early);
            Body::empty()
        } else {
            Body::new(body)
        };
        parts.extensions.insert(client);
        let origin = parts.headers.get(header::ORIGIN).cloned();
        let routed = self.router.oneshot(Request::from_parts(parts, body)).await;
        let mut response = routed.unwrap_or_else(|never| match never {});
        if let Some(asked) = asked {
            self.app.short.remember(asked, origin, &mut response);
        }
        let in_flight = counted.add_headers(&self.app, response.headers_mut());
        (response.map(AnswerBody::Right), in_flight)
    }
}

impl Service<Request<Incoming>> for ConnectionService {
    type Response = Response<ReleasingBody>;
    type Error = Infallible;
    type Future = Either<
        Ready<Result<Self::Response, Infallible>>,
        Pin<Box<dyn Future<Output = Result<Self::Response, Infallible>> + Send>>,
    >;

    fn call(&self, request: Request<Incoming>) -> Self::Future {
        let connection = self.connection.clone();
        connection.serving.store(true, Ordering::Relaxed);
        connection.answering.store(true, Ordering::Relaxed);
        connection.begin();
        // until its body has arrived, a request keeps the service waiting; see `body::collect`
        if request.body().is_end_stream() {
            connection.enter(ConnectionPhase::Working);
        }
        let (parts, body) = request.into_parts();
        let caller = self.app.gate.who(&parts, connection.peer);
        let trace = Trace::of(&parts.headers);
        let is_accepted = caller.refused.is_none() && guard::head(&parts, &self.app.settings).is_ok();
        let asked = PlainResource::get(&parts, caller.peer.tenant()).filter(|_| is_accepted);
        if let Some(mut response) = self.again(asked, &parts) {
            trace.add_headers(response.headers_mut());
            let app = self.app.clone();
            let ending = |content| ReleasingBody { content, app, connection, _in_flight: None };
            return Either::Left(ready(Ok(response.map(ending))));
        }
        let (app, answer) = (self.app.clone(), self.clone().answer(parts, body, (caller, is_accepted, asked)));
        Either::Right(Box::pin(async move {
            // every log line of the request has its trace id
            let span = tracing::error_span!("request", trace_id = trace.id());
            let (mut response, in_flight) = trace.clone().within(answer).instrument(span).await;
            trace.add_headers(response.headers_mut());
            connection.enter(ConnectionPhase::Working);
            Ok(response.map(|content| ReleasingBody { content, app, connection, _in_flight: in_flight }))
        }))
    }
}

/// The body of an answer: bytes that are all in memory, or a body from the router.
type AnswerBody = http_body_util::Either<Full<Bytes>, Body>;

/// The body of an answer with the resources that are released at its end.
#[derive(Debug)]
pub(super) struct ReleasingBody {
    content: AnswerBody,
    app: Arc<App>,
    connection: Arc<Connection>,
    _in_flight: Option<Ticket>,
}

impl http_body::Body for ReleasingBody {
    type Data = Bytes;
    type Error = BoxError;

    fn poll_frame(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<Option<Result<Frame<Bytes>, BoxError>>> {
        let frame = Pin::new(&mut self.content).poll_frame(cx);
        if let Poll::Ready(Some(Ok(frame))) = &frame {
            self.app.requests.sent(frame.data_ref().map_or(0, Bytes::len));
        }
        frame
    }

    fn is_end_stream(&self) -> bool {
        self.content.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.content.size_hint()
    }
}

impl Drop for ReleasingBody {
    fn drop(&mut self) {
        self.connection.serving.store(false, Ordering::Relaxed);
    }
}
