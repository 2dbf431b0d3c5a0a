//! Shared helpers for tests of disks, and the effect of uses of artifacts on the disk.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use planish::http::App;
use planish::http::serve::{bind, serve};
use planish::service::result_buffer::ResultBuffer;
use planish::service::store::Store;
use planish::service::tiers::{Stored, Tiers};
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::sync::oneshot;

use crate::http::server::{PATIENCE, Server, settings, until};
use crate::store::faulty::Faulty;
use crate::store::{ROOMY, Scratch, description, key, noise};

/// A runtime that does not wait for hanging threads when it is dropped.
struct Leaving(Option<Runtime>);

impl Drop for Leaving {
    fn drop(&mut self) {
        self.0.take().into_iter().for_each(Runtime::shutdown_background);
    }
}

/// Runs a test to its end.
pub(super) fn run<T>(story: impl Future<Output = T>) -> T {
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().unwrap();
    let runtime = Leaving(Some(runtime));
    let told = async { tokio::time::timeout(PATIENCE, story).await.expect("the story has an end") };
    runtime.0.as_ref().unwrap().block_on(told)
}

/// Creates a service over these stores. Its short lane has the full time limit, so that slow machines restart nothing
/// in the long lane.
pub(super) async fn app(tiers: Tiers) -> (TcpListener, Arc<App>) {
    let (listener, mut app) = bind(settings()).await.unwrap();
    let desk = &mut Arc::get_mut(&mut app).expect("it does not serve yet").desk;
    let desk = Arc::get_mut(desk).expect("it does not serve yet");
    desk.tiers = tiers;
    desk.terms.short_time = desk.terms.run_timeout;
    (listener, app)
}

/// Serves over these stores during a test.
pub(super) async fn served<T>(tiers: Tiers, tell: impl AsyncFnOnce(&Server) -> T) -> T {
    let (listener, app) = app(tiers).await;
    let address = listener.local_addr().unwrap();
    let (stop, stopped) = oneshot::channel::<()>();
    let served = tokio::spawn(serve(listener, app.clone(), async {
        let _ = stopped.await;
    }));
    let client = crate::http::server::client_builder().build().unwrap();
    let server = Server { address, app, client };
    let told = tell(&server).await;
    stop.send(()).unwrap();
    served.await.unwrap();
    told
}

/// Keeps an artifact as the desk does.
pub(super) fn make(tiers: &Tiers, number: u64, length: usize) -> Stored {
    let mut buffer = ResultBuffer::new(tiers, key(number), length as u128);
    buffer.write_all(&noise(number, length)).unwrap();
    let kept = buffer.commit(description()).unwrap();
    if kept.loose.is_none() {
        tiers.persist(&kept.manifest);
    }
    kept
}

/// Reads the bytes of an artifact as an answer does.
pub(super) async fn bytes(tiers: &Tiers, kept: &Stored) -> Option<Vec<u8>> {
    if let Some(loose) = &kept.loose {
        return Some(loose.to_vec());
    }
    let mut bytes = Vec::new();
    for index in 0..kept.manifest.parts.len() {
        bytes.extend_from_slice(&tiers.part(&kept.manifest, index).await?);
    }
    Some(bytes)
}

/// Waits until no write is pending on the disk.
pub(super) async fn written(tiers: &Tiers) {
    until("nothing waits for the disk", || tiers.disk_backlog() == (0, 0)).await;
}

pub(super) fn n(counter: &AtomicU64) -> u64 {
    counter.load(Ordering::Relaxed)
}

#[test]
fn m7_uses_in_memory_keep_an_artifact_on_disk() {
    let scratch = Scratch::new();
    run(async {
        // four artifacts of 20,000 bytes fit on the disk, with their records, in whole blocks
        let tiers = Tiers::new(1 << 20, Some(Arc::new(scratch.open(100_000))));
        for number in 0..4 {
            make(&tiers, number, 20_000);
            written(&tiers).await;
        }
        for _ in 0..60 {
            assert!(tiers.at_hand(&key(0)).is_some(), "it is in memory");
        }
        for number in 4..6 {
            make(&tiers, number, 20_000);
            written(&tiers).await;
        }
        assert!(tiers.close(PATIENCE));
    });
    let store = scratch.open(100_000);
    let here = [0, 1, 2, 3, 4, 5].map(|number| store.manifest(&key(number)).unwrap().is_some());
    assert_eq!(here, [true, false, false, true, true, true], "what was used stays, what was not leaves");
}

#[test]
fn l_a_result_whose_place_on_disk_is_occupied_is_answered_and_counted() {
    let (scratch, disk) = (Scratch::new(), Faulty::new());
    let name = key(1).to_string();
    std::fs::create_dir_all(scratch.0.join("artifacts").join(&name[..2]).join(&name)).unwrap();
    run(async {
        let tiers = Tiers::new(64 << 10, Some(Arc::new(disk.store(&scratch.0, ROOMY))));
        for (times, length) in [(1, 1_000), (2, 10_000)] {
            let kept = make(&tiers, 1, length);
            assert_eq!(bytes(&tiers, &kept).await.unwrap(), noise(1, length));
            assert_eq!(n(&tiers.disk_counts().dropped_unfit), times);
        }
        assert_eq!(n(&tiers.disk_counts().dropped_failed), 0);
        assert_eq!(disk.writes.load(Ordering::Relaxed), 0, "nothing is written in vain");
        assert_eq!(tiers.disk_trouble(), None, "the disk itself is well");
    });
}
