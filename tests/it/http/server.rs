//! A real server on a free port, for one test.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::http::{HeaderMap, Method};
use planish::config::Settings;
use planish::http::App;
use planish::http::serve::{bind_at, serve};
use planish::service::clock::{Clock, Monotonic};
use planish::service::peer::Peer;
use planish::service::pool::{ComputePlace, Lane};
use serde_json::Value;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::sync::oneshot;

/// Upper bound of every wait in a test, however slow the machine.
pub(crate) const PATIENCE: Duration = Duration::from_mins(4);

/// Returns the settings of a server that keeps nothing on disk, with one place in each lane.
pub(crate) fn settings() -> Settings {
    Settings {
        listen: SocketAddr::from(([127, 0, 0, 1], 0)),
        data_dir: PathBuf::new(),
        threads: 1,
        ..Default::default()
    }
}

/// A temporary folder for one test, removed on drop.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new() -> Self {
        static COUNTER: AtomicU32 = AtomicU32::new(0);
        let name = format!("planish-http-{}-{}", std::process::id(), COUNTER.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A running server with a client.
pub(crate) struct Server {
    pub(crate) address: SocketAddr,
    pub(crate) app: Arc<App>,
    pub(crate) client: reqwest::Client,
}

/// Runs a server for the duration of a test and shuts it down completely at the end.
pub(crate) fn story<T>(settings: Settings, tell: impl AsyncFnOnce(&Server) -> T) -> T {
    story_at(settings, Arc::new(Monotonic::default()), tell)
}

/// Runs a server as [`story`] does, with this clock.
pub(crate) fn story_at<T>(settings: Settings, clock: Arc<dyn Clock>, tell: impl AsyncFnOnce(&Server) -> T) -> T {
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().unwrap();
    runtime.block_on(async {
        let (listener, app) = bind_at(settings, clock).await.unwrap();
        let address = listener.local_addr().unwrap();
        let (stop, stopped) = oneshot::channel::<()>();
        let served = tokio::spawn(serve(listener, app.clone(), async {
            let _ = stopped.await;
        }));
        let client = client_builder().build().unwrap();
        let desk = app.desk.clone();
        let server = Server { address, app, client };
        let told = tokio::time::timeout(2 * PATIENCE, tell(&server)).await.expect("the story has an end");
        drop(server);
        let _ = stop.send(());
        tokio::time::timeout(PATIENCE, served).await.expect("the server stops").unwrap();
        // a stopped computation may hold the desk for a while
        desk.tiers.close(PATIENCE);
        desk.jobs.close(PATIENCE);
        desk.batches.close(PATIENCE);
        desk.uploads.close();
        told
    })
}

/// Waits until a condition holds.
pub(crate) async fn until(what: &str, mut yes: impl FnMut() -> bool) {
    let start = Instant::now();
    while !yes() {
        assert!(start.elapsed() < PATIENCE, "waited in vain: {what}");
        tokio::time::sleep(Duration::from_millis(2)).await;
    }
}

/// An answer with all its bytes.
#[derive(Debug, Clone)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) headers: HeaderMap,
    pub(crate) body: Bytes,
}

impl Answer {
    pub(crate) async fn of(response: reqwest::Response) -> Self {
        let (status, headers) = (response.status().as_u16(), response.headers().clone());
        Self { status, headers, body: response.bytes().await.unwrap() }
    }

    /// Returns a header as text; empty if it is missing.
    pub(crate) fn header(&self, name: &str) -> &str {
        self.headers.get(name).map_or("", |value| value.to_str().unwrap())
    }

    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {}", self.text()))
    }

    /// Returns the answer and checks that its status is 200.
    pub(crate) fn ok(self) -> Self {
        assert_eq!(self.status, 200, "{}", self.text());
        self
    }

    /// Returns the problem and checks that it is complete and has this status and kind.
    pub(crate) fn problem(&self, status: u16, kind: &str) -> Value {
        assert_eq!(self.status, status, "{}", self.text());
        assert_eq!(self.header("content-type"), "application/problem+json");
        let problem = self.json();
        assert_eq!(problem["type"], format!("/docs/problems/{kind}"), "{problem}");
        assert_eq!(problem["status"], status, "{problem}");
        for field in ["title", "detail", "trace_id"] {
            assert!(problem[field].as_str().is_some_and(|text| !text.is_empty()), "{field} of {problem}");
        }
        problem
    }
}

/// Returns a builder of clients for plain addresses; reqwest, as it is configured, requires a TLS configuration
/// nevertheless.
pub(crate) fn client_builder() -> reqwest::ClientBuilder {
    let ring = std::sync::Arc::new(rustls::crypto::ring::default_provider());
    let tls = rustls::ClientConfig::builder_with_provider(ring).with_safe_default_protocol_versions().unwrap();
    let tls = tls.with_root_certificates(rustls::RootCertStore::empty()).with_no_client_auth();
    reqwest::Client::builder().no_proxy().tls_backend_preconfigured(tls)
}

impl Server {
    pub(crate) fn url(&self, path: &str) -> String {
        format!("http://{}{path}", self.address)
    }

    pub(crate) async fn ask(&self, method: Method, path: &str, headers: &[(&str, &str)], body: Vec<u8>) -> Answer {
        let request = headers
            .iter()
            .fold(self.client.request(method, self.url(path)), |request, (name, value)| request.header(*name, *value));
        let request = if body.is_empty() { request } else { request.body(body) };
        Answer::of(request.send().await.unwrap()).await
    }

    pub(crate) async fn get(&self, path: &str) -> Answer {
        self.get_with(path, &[]).await
    }

    pub(crate) async fn get_with(&self, path: &str, headers: &[(&str, &str)]) -> Answer {
        self.ask(Method::GET, path, headers, Vec::new()).await
    }

    pub(crate) async fn post(&self, path: &str, body: &Value) -> Answer {
        self.post_with(path, body, &[]).await
    }

    pub(crate) async fn post_with(&self, path: &str, body: &Value, headers: &[(&str, &str)]) -> Answer {
        self.post_text(path, body.to_string(), headers).await
    }

    pub(crate) async fn post_text(&self, path: &str, body: impl Into<Vec<u8>>, headers: &[(&str, &str)]) -> Answer {
        let json = ("content-type", "application/json");
        let own = headers.iter().any(|(name, _)| *name == json.0);
        let headers: Vec<_> = headers.iter().copied().chain((!own).then_some(json)).collect();
        self.ask(Method::POST, path, &headers, body.into()).await
    }

    pub(crate) async fn render(&self, job: &Value) -> Answer {
        self.post("/v1/render", job).await
    }

    /// Takes every place in both lanes: until they are dropped, nothing is computed.
    pub(crate) async fn hold(&self) -> Vec<ComputePlace> {
        let threads = self.app.settings.compute_threads();
        let mut turns = Vec::new();
        for (lane, places) in [(Lane::Short, threads), (Lane::Long, threads.div_ceil(2))] {
            for _ in 0..places {
                turns.push(self.turn(lane).await);
            }
        }
        turns
    }

    /// Takes a place in a lane.
    pub(crate) async fn turn(&self, lane: Lane) -> ComputePlace {
        let pool = &self.app.desk.pool;
        let waiting = pool.line_up(lane, Peer::SELF, 0).unwrap();
        pool.compute_place(lane, waiting).await
    }

    /// Polls a job until it is settled.
    pub(crate) async fn settled(&self, location: &str) -> Value {
        let start = Instant::now();
        loop {
            let status = self.get(location).await.ok().json();
            if !matches!(status["state"].as_str().unwrap(), "queued" | "running") {
                return status;
            }
            assert!(start.elapsed() < PATIENCE, "waited in vain: {status}");
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    }

    pub(crate) async fn connect(&self) -> TcpStream {
        TcpStream::connect(self.address).await.unwrap()
    }

    /// Opens a connection and writes these bytes.
    pub(crate) async fn said(&self, text: &str) -> TcpStream {
        let mut stream = self.connect().await;
        stream.write_all(text.as_bytes()).await.unwrap();
        stream
    }

    /// Returns the text of a request with a JSON body.
    pub(crate) fn request(&self, path: &str, headers: &str, body: &str) -> String {
        let host = self.address;
        let length = body.len();
        format!(
            "POST {path} HTTP/1.1\r\nhost: {host}\r\ncontent-type: application/json\r\n\
             content-length: {length}\r\n{headers}\r\n{body}"
        )
    }
}

/// Reads until the other side closes.
pub(crate) async fn rest(mut stream: TcpStream) -> String {
    let mut bytes = Vec::new();
    // a reset ends the reading like an orderly close
    let _ = tokio::time::timeout(PATIENCE, stream.read_to_end(&mut bytes)).await.expect("the connection is closed");
    String::from_utf8_lossy(&bytes).into_owned()
}
