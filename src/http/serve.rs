//! The server: connections with timeouts on every silence, a cap on their number, and an orderly end.

use std::future::Future;
use std::io;
use std::path::Path;
use std::pin::{Pin, pin};
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;
use tokio::time::Sleep;

use super::{App, Canary, Memo, canary, document, router};
use crate::config::Settings;
use crate::service::clock::Monotonic;
use crate::service::desk::Desk;
use crate::service::pool::Pool;
use crate::service::store::Embedded;
use crate::service::tiers::Tiers;

/// Why the service did not start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The address cannot be listened on.
    #[error("cannot listen on {address}: {error}; choose another with --listen")]
    Listen {
        /// The address.
        address: std::net::SocketAddr,
        /// Why.
        error: io::Error,
    },
    /// The data directory cannot be used.
    #[error(
        "cannot keep the cache in {path}: {error}; choose another with --data-dir, or keep nothing on disk with --cache-bytes 0"
    )]
    Store {
        /// The directory.
        path: String,
        /// Why.
        error: crate::service::store::StoreError,
    },
    /// The compute threads cannot be started.
    #[error("cannot start the compute threads: {0}; try fewer with --threads")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// The OpenAPI document as text, the way it is committed.
///
/// # Panics
/// Never: the document is plain data.
pub fn document_text() -> String {
    let mut text = document().to_pretty_json().expect("the document is plain data");
    text.push('\n');
    text
}

/// Opens stores, threads and listener.
///
/// # Errors
/// [`StartError`].
pub async fn bind(settings: Settings) -> Result<(TcpListener, Arc<App>), StartError> {
    let listener = TcpListener::bind(settings.listen)
        .await
        .map_err(|error| StartError::Listen { address: settings.listen, error })?;
    let disk = if settings.data_dir == Path::new("") || settings.cache_bytes == 0 {
        None
    } else {
        let path = settings.data_dir.display().to_string();
        let open = Embedded::open(&settings.data_dir, settings.cache_bytes);
        Some(open.map_err(|error| StartError::Store { path, error })?)
    };
    let pool = Pool::new(settings.compute_threads(), settings.max_memory_bytes, settings.max_queue)?;
    let tiers = Tiers::new(settings.memory_cache_bytes, disk);
    let run_timeout = Duration::from_secs(settings.run_timeout_s);
    let desk = Desk::new(settings.limits(), tiers, pool, run_timeout, Arc::new(Monotonic::default()));
    Ok((listener, Arc::new(App { desk: Arc::new(desk), settings, canary: Canary::default(), memo: Memo::default() })))
}

/// Serves until `stop` comes true, then lets running requests end.
pub async fn serve(listener: TcpListener, app: Arc<App>, stop: impl Future<Output = ()>) {
    let canary = tokio::spawn(canary::sing(app.clone()));
    let connections = Arc::new(Semaphore::new(app.settings.max_connections));
    let graceful = GracefulShutdown::new();
    let router = router(app.clone());
    let mut stop = pin!(stop);
    loop {
        let place = tokio::select! {
            place = connections.clone().acquire_owned() => place.expect("the semaphore is never closed"),
            () = &mut stop => break,
        };
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            () = &mut stop => break,
        };
        match accepted {
            Ok((stream, _)) => {
                let connection = connection(stream, &app.settings, router.clone());
                let watched = graceful.watch(connection);
                tokio::spawn(async move {
                    if let Err(error) = watched.await {
                        tracing::debug!(%error, "a connection ended early");
                    }
                    drop(place);
                });
            }
            Err(error) => {
                tracing::warn!(%error, "a connection could not be accepted");
                tokio::time::sleep(Duration::from_millis(50)).await;
            }
        }
    }
    drop(listener);
    let patience = Duration::from_secs(app.settings.shutdown_timeout_s);
    tracing::info!(seconds = patience.as_secs(), "stopping; running requests and jobs may end");
    let ended = async {
        graceful.shutdown().await;
        app.desk.idle().await;
    };
    if tokio::time::timeout(patience, ended).await.is_err() {
        tracing::warn!("some requests or jobs did not end in time");
        app.desk.stop();
    }
    canary.abort();
}

type Connection = http1::Connection<TokioIo<Patient>, TowerToHyperService<Router>>;

fn connection(stream: TcpStream, settings: &Settings, router: Router) -> Connection {
    // answers are written at once or in large parts; waiting for more would only delay them
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!(%error, "TCP_NODELAY was not set");
    }
    let stream = Patient { stream, silence: Duration::from_secs(settings.body_timeout_s), alarm: None };
    http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(Duration::from_secs(settings.header_timeout_s))
        .max_buf_size(64 << 10)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
}

/// A stream whose reader must not let an answer wait for longer than `silence`.
#[derive(Debug)]
struct Patient {
    stream: TcpStream,
    silence: Duration,
    alarm: Option<Pin<Box<Sleep>>>,
}

impl Patient {
    /// Starts the alarm when a write has to wait, ends it when it moves.
    fn watch<T>(&mut self, context: &mut Context<'_>, poll: Poll<io::Result<T>>) -> Poll<io::Result<T>> {
        if poll.is_ready() {
            self.alarm = None;
            return poll;
        }
        let silence = self.silence;
        let alarm = self.alarm.get_or_insert_with(|| Box::pin(tokio::time::sleep(silence)));
        match alarm.as_mut().poll(context) {
            Poll::Ready(()) => Poll::Ready(Err(io::Error::new(io::ErrorKind::TimedOut, "the client stopped reading"))),
            Poll::Pending => Poll::Pending,
        }
    }
}

impl AsyncRead for Patient {
    fn poll_read(mut self: Pin<&mut Self>, cx: &mut Context<'_>, buf: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(cx, buf)
    }
}

impl AsyncWrite for Patient {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, buf: &[u8]) -> Poll<io::Result<usize>> {
        let poll = Pin::new(&mut self.stream).poll_write(cx, buf);
        self.watch(cx, poll)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bufs: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let poll = Pin::new(&mut self.stream).poll_write_vectored(cx, bufs);
        self.watch(cx, poll)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        let poll = Pin::new(&mut self.stream).poll_flush(cx);
        self.watch(cx, poll)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}
