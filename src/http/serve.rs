//! The server: connections with timeouts, a maximum number of them, and an orderly shutdown.

use std::future::Future;
use std::io::{self, Write};
use std::path::Path;
use std::pin::pin;
use std::sync::{Arc, LazyLock};
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use tokio::net::{TcpListener, TcpSocket, TcpStream};
use tokio::task::JoinSet;

use super::app::App;
use super::bucket_client;
use super::canary::{self, Canary};
use super::connections::{Connections, OpenConnection};
use super::gate::Gate;
use super::guard::MAX_HEAD_BYTES;
use super::memo::Memo;
use super::pace::Pace;
use super::problem;
use super::request_counts::RequestCounts;
use super::requests::ConnectionService;
use super::router::{document_text, router};
use super::short::Short;
use super::stream::Watched;
use super::working::JobReader;
use crate::config::Settings;
use crate::config::keys::KeyFileError;
use crate::fault::shortened;
use crate::job::limits::Limits;
use crate::service::account::Account;
use crate::service::batches::Batches;
use crate::service::clock::{Clock, Monotonic};
use crate::service::desk::{Desk, JobKeeping, Terms};
use crate::service::jobs::Jobs;
use crate::service::peer::Peer;
use crate::service::pool::{Lane, Pool, QueueBounds};
use crate::service::queue;
use crate::service::rate::Rates;
use crate::service::store::{Bucket, MemoryStore, Records, STORES, Store, StoreLocation, StorePurpose};
use crate::service::tiers::Tiers;
use crate::service::uploads::Uploads;
use crate::wire::batch::layout;
use crate::wire::read::reading_memory;

/// The reason why the service did not start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The service cannot listen on the address.
    #[error("cannot listen on {address}: {error}; choose another with --listen")]
    Listen {
        /// The address.
        address: std::net::SocketAddr,
        /// The cause.
        error: io::Error,
    },
    /// The data directory cannot be used.
    #[error(
        "cannot keep the cache in {path}: {error}; choose another with --data-dir, or keep nothing on disk with \
            --cache-bytes 0"
    )]
    Store {
        /// The directory.
        path: String,
        /// The cause.
        error: crate::service::store::StoreError,
    },
    /// The bucket cannot be used.
    #[error("cannot keep results in the bucket \"{bucket}\": {error}; see --s3-bucket, --s3-endpoint and --s3-region")]
    Bucket {
        /// The name of the bucket.
        bucket: String,
        /// The cause.
        error: crate::service::store::StoreError,
    },
    /// The key file cannot be read.
    #[error(transparent)]
    Keys(#[from] KeyFileError),
    /// There are no keys, and the address is reachable from the network.
    #[error(
        "there are no keys, and {address} is no loopback address, so that everybody who reaches it could have work \
         done; make a key with `planish key add --data-dir {data_dir}`, or let everybody in with --without-keys true"
    )]
    NoKeys {
        /// The address.
        address: std::net::SocketAddr,
        /// The data directory, where the keys would be.
        data_dir: String,
    },
    /// The settings name an unknown store.
    #[error(
        "there is no cache store \"{name}\"; give one of these with --cache-store: {}",
        STORES.iter().map(|kind| kind.name).collect::<Vec<_>>().join(", ")
    )]
    NoSuchStore {
        /// The unknown name.
        name: String,
    },
    /// The compute threads cannot be started.
    #[error("cannot start the compute threads: {0}; try fewer with --threads")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// Size of the socket's send buffer in bytes: what the system holds of an answer for a client that does not read it.
/// The system allocates twice as much, and a write waits until a third is free: more than a round trip of a tenth of a
/// second at 10 MB/s, and read in about a minute at the minimum rate.
const SEND_BUFFER_BYTES: u32 = 512 << 10;
/// Maximum number of connections that the system holds until they are accepted; the system may set a lower limit. Half
/// of it refuses bursts half as large; twice of it lets as many more wait.
const BACKLOG: u32 = 1024;
/// Maximum time of a computation in the short lane: four times the prediction from which on work counts as long. Half
/// of it moves work that was predicted to take half as long as it does; twice of it lets one computation hold up the
/// short ones for two seconds.
const SHORT_TIME: Duration = Duration::from_secs(1);

/// Opens stores, compute threads and listener.
///
/// # Errors
/// [`StartError`].
pub async fn bind(settings: Settings) -> Result<(TcpListener, Arc<App>), StartError> {
    bind_at(settings, Arc::new(Monotonic::default())).await
}

/// Binds the server like [`bind`], with the given clock.
///
/// # Errors
/// [`StartError`].
pub async fn bind_at(mut settings: Settings, clock: Arc<dyn Clock>) -> Result<(TcpListener, Arc<App>), StartError> {
    let gate = Gate::open(&settings.data_dir, clock.clone())?;
    if !gate.is_shut() && !settings.listen.ip().is_loopback() && !settings.without_keys {
        let data_dir = settings.data_dir.display().to_string();
        return Err(StartError::NoKeys { address: settings.listen, data_dir });
    }
    let listener = listen(settings.listen).map_err(|error| StartError::Listen { address: settings.listen, error })?;
    let account = Account::new(settings.max_memory_bytes, settings.memory_cache_bytes);
    let (disk, records, uploads) = stores(&settings, &account, &clock)?;
    settings.max_body_bytes = settings.max_body_bytes.min(longest_body(&account));
    let bounds = QueueBounds { queue: settings.max_queue, queue_a_peer: settings.max_queue_per_peer };
    let pool = Pool::new(settings.compute_threads(), &account, bounds)?;
    let tiers = Tiers::new(account.cache_bytes, disk);
    let terms = Terms {
        run_timeout: Duration::from_secs(settings.run_timeout_s),
        short_time: SHORT_TIME,
        most_a_peer: settings.max_queue_per_peer as u64,
        // a quarter of the connections is reserved for requests that do not wait
        most_waiting: (settings.max_connections - settings.max_connections / 4) as u64,
        most_jobs: settings.max_queue,
        job_ttl: Duration::from_secs(settings.job_ttl_s),
    };
    let connections = Connections::new(settings.max_connections, settings.max_connections_per_peer, clock.clone());
    let limits = settings.limits();
    // a job is refused if it would not get its memory even when nothing else runs
    let limits = Limits { max_job_bytes: limits.max_job_bytes.min(account.long.capacity), ..limits };
    let batches = Batches::new(records.clone(), clock.clone(), |text| layout(text).ok());
    let (jobs, queue) = (Jobs::new(records, clock.clone()), Arc::new(queue::LocalQueue::default()));
    let keeping = JobKeeping { jobs, batches, queue, uploads };
    let desk = Arc::new(Desk::new(limits, tiers, pool, account, keeping, (terms, clock)));
    let path = || settings.data_dir.display().to_string();
    let taken_up = desk.recover().await.map_err(|error| StartError::Store { path: path(), error })?;
    let batches = desk.recover_batches().map_err(|error| StartError::Store { path: path(), error })?;
    if taken_up > 0 || batches > 0 {
        tracing::info!(jobs = taken_up, batches, "jobs of an earlier process are taken up");
    }
    let (canary, memo, short) = (Arc::<Canary>::default(), Memo::default(), Short::default());
    let (gate, rates) = (Arc::new(gate), Rates::new(desk.clock()));
    let openapi = LazyLock::new(document_text as fn() -> String);
    Ok((
        listener,
        Arc::new(App {
            desk,
            settings,
            gate,
            rates,
            canary,
            memo,
            short,
            requests: RequestCounts::default(),
            connections,
            openapi,
        }),
    ))
}

/// Stores of results, of job records, and of uploads; the first two are `None` if nothing is kept on disk.
type DurableStores = (Option<Arc<dyn Store>>, Option<Arc<dyn Records>>, Uploads);

/// Opens the stores of the settings.
fn stores(settings: &Settings, account: &Account, clock: &Arc<dyn Clock>) -> Result<DurableStores, StartError> {
    let name = &settings.cache_store;
    let kind = STORES.iter().find(|kind| kind.name == name);
    let kind = kind.ok_or_else(|| StartError::NoSuchStore { name: shortened(name) })?;
    let has_folder = settings.data_dir != Path::new("");
    if settings.cache_bytes == 0 || kind.in_folder && !has_folder {
        return Ok((None, None, Uploads::new(Arc::new(MemoryStore::new(account.uploads_bytes)))));
    }
    let bucket = Bucket {
        name: settings.s3_bucket.clone(),
        prefix: settings.s3_prefix.clone(),
        endpoint: settings.s3_endpoint.clone(),
        region: settings.s3_region.clone(),
    };
    let dir = settings.data_dir.clone();
    let place = |room, capacity_bytes| StoreLocation {
        dir: dir.clone(),
        bucket: bucket.clone(),
        room,
        capacity_bytes,
        connect: bucket_client::connect,
        clock: clock.clone(),
    };
    let path = dir.display().to_string();
    let failed = |error| {
        if kind.in_folder {
            StartError::Store { path: path.clone(), error }
        } else {
            StartError::Bucket { bucket: shortened(&bucket.name), error }
        }
    };
    let store = (kind.open)(&place(StorePurpose::Results, settings.cache_bytes)).map_err(failed)?;
    let records = if has_folder { Some((kind.records)(&dir)) } else { None };
    let records = records.transpose().map_err(|error| StartError::Store { path: path.clone(), error })?;
    let uploads = (kind.open)(&place(StorePurpose::Uploads, settings.uploads_bytes)).map_err(failed)?;
    Ok((Some(store), records, Uploads::new(uploads)))
}

/// Returns the maximum length of a body that the memory of the service allows: half of the share of bodies, and such
/// that reading it takes no more than the share of reading and three quarters of the 512 MiB that resident memory may
/// be above the total. That is 32 MiB with the default memory.
fn longest_body(account: &Account) -> u64 {
    let room = account.reading.capacity + (384 << 20);
    (account.bodies.capacity / 2).min(room / (reading_memory(1) - reading_memory(0)))
}

fn listen(address: std::net::SocketAddr) -> io::Result<TcpListener> {
    let socket = if address.is_ipv4() { TcpSocket::new_v4() } else { TcpSocket::new_v6() }?;
    socket.set_reuseaddr(cfg!(unix))?;
    socket.set_send_buffer_size(SEND_BUFFER_BYTES)?;
    socket.bind(address)?;
    socket.listen(BACKLOG)
}

/// Serves until `stop` completes, then lets running requests and jobs finish.
pub async fn serve(listener: TcpListener, app: Arc<App>, stop: impl Future<Output = ()>) {
    let canary = tokio::spawn(canary::sing(app.canary.clone(), app.desk.clone()));
    let mut working = work(&app);
    let graceful = GracefulShutdown::new();
    let router = router(app.clone());
    let mut stop = pin!(stop);
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            () = &mut stop => break,
        };
        match accepted {
            Ok((stream, address)) => match app.connections.enter(Peer::new(address.ip())) {
                Some(open) => attend(stream, open, &app, router.clone(), &graceful),
                None => turn_away(stream),
            },
            Err(error) => {
                tracing::warn!(%error, "a connection could not be accepted");
                tokio::time::sleep(Duration::from_millis(50)).await;
            }
        }
    }
    drop(listener);
    app.desk.end();
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
    working.abort_all();
}

/// Starts the background tasks: the workers of accepted jobs, one more in each lane than it has places, so that one
/// waits while the others compute; the worker of batches; tidying; and rereading the keys.
fn work(app: &Arc<App>) -> JoinSet<()> {
    let mut working = JoinSet::new();
    for lane in [Lane::Short, Lane::Long] {
        for _ in 0..=app.desk.pool.places(lane) {
            working.spawn(app.desk.clone().do_jobs(lane, Arc::new(JobReader(app.clone()))));
        }
    }
    working.spawn(app.desk.clone().do_batches(Arc::new(JobReader(app.clone()))));
    let desk = app.desk.clone();
    working.spawn(async move { desk.keep_tidy().await });
    let gate = app.gate.clone();
    working.spawn(async move { gate.keep_current().await });
    working
}

/// Answers a client that there is no free connection, as far as the system takes the bytes at once, without waiting.
fn turn_away(stream: TcpStream) {
    if let Err(error) = stream.into_std().and_then(|mut stream| stream.write(&problem::crowded())) {
        tracing::debug!(%error, "a client that was not let in was not told");
    }
}

/// Answers the requests of a connection until either side closes it.
fn attend(stream: TcpStream, open: OpenConnection, app: &Arc<App>, router: Router, graceful: &GracefulShutdown) {
    // answers are written at once or in large parts, so that Nagle's algorithm would only delay them
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!(%error, "TCP_NODELAY was not set");
    }
    let (connection, settings) = (open.connection.clone(), &app.settings);
    let pace = Pace { grace: Duration::from_secs(settings.body_timeout_s), least_rate: settings.least_rate_bytes_s };
    let stream = Watched::new(stream, connection.clone(), pace);
    let served = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(Duration::from_secs(settings.header_timeout_s))
        .max_buf_size(MAX_HEAD_BYTES)
        .serve_connection(TokioIo::new(stream), ConnectionService::new(app.clone(), router, connection.clone()));
    let served = graceful.watch(served);
    tokio::spawn(async move {
        let _open = open;
        tokio::select! {
            ended = served => {
                if let Err(error) = ended {
                    tracing::debug!(%error, "a connection ended early");
                }
            }
            () = connection.closed() => tracing::debug!("a connection made room for another"),
        }
    });
}
