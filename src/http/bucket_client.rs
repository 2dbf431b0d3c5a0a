//! The HTTP client for the bucket of a shared store: HTTP/1.1, plain or over TLS with the certificates of the system.

use std::time::Duration;

use async_trait::async_trait;
use http_body_util::BodyExt;
use hyper_rustls::{HttpsConnector, HttpsConnectorBuilder};
use hyper_util::client::legacy::Client;
use hyper_util::client::legacy::connect::HttpConnector as Tcp;
use hyper_util::rt::TokioExecutor;
use object_store::client::{
    HttpClient, HttpError, HttpErrorKind, HttpRequest, HttpRequestBody, HttpResponse, HttpResponseBody, HttpService,
};

use super::trust;

/// Maximum time to establish a connection: a tenth of a second reaches the other side of the world. Half of it gives up
/// on busy stores; twice of it notices later that a machine is gone.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(1);
/// Number of idle connections that are kept: as many as calls are made at once. Half of it connects anew under load;
/// twice of it holds unused connections.
const MAX_IDLE_CONNECTIONS: usize = 16;

/// A client with a pool of connections.
#[derive(Debug)]
struct ConnectionPool(Client<HttpsConnector<Tcp>, HttpRequestBody>);

/// Creates a client for the shared store.
///
/// # Errors
/// When TLS cannot be set up.
pub(super) fn connect() -> object_store::Result<HttpClient> {
    let tls = trust::tls().map_err(|error| object_store::Error::Generic { store: "S3", source: error.into() })?;
    let mut tcp = Tcp::new();
    tcp.enforce_http(false);
    tcp.set_nodelay(true);
    tcp.set_connect_timeout(Some(CONNECT_TIMEOUT));
    let https = HttpsConnectorBuilder::new().with_tls_config(tls).https_or_http().enable_http1().wrap_connector(tcp);
    let client = Client::builder(TokioExecutor::new()).pool_max_idle_per_host(MAX_IDLE_CONNECTIONS).build(https);
    Ok(HttpClient::new(ConnectionPool(client)))
}

#[async_trait]
impl HttpService for ConnectionPool {
    async fn call(&self, request: HttpRequest) -> Result<HttpResponse, HttpError> {
        let answer = self.0.request(request).await.map_err(|error| {
            let kind = if error.is_connect() { HttpErrorKind::Connect } else { HttpErrorKind::Interrupted };
            HttpError::new(kind, error)
        })?;
        let broken = |error| HttpError::new(HttpErrorKind::Interrupted, error);
        Ok(answer.map(|body| HttpResponseBody::new(body.map_err(broken))))
    }
}
