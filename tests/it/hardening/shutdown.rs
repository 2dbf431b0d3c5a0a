//! The shutdown of the service.

use std::future::Future;

use planish::config::Settings;
use planish::http::serve::{bind, serve};
use tokio::sync::oneshot;
use tokio::task::JoinHandle;

use crate::http::jobs::{endless, mesh, with};
use crate::http::server::{PATIENCE, Server, rest, settings, until};

/// Runs a test with a server that the test stops itself.
fn ending<F: Future<Output = ()>>(
    settings: Settings,
    tell: impl FnOnce(Server, oneshot::Sender<()>, JoinHandle<()>) -> F,
) {
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().unwrap();
    runtime.block_on(async {
        let (listener, app) = bind(settings).await.unwrap();
        let address = listener.local_addr().unwrap();
        let (stop, stopped) = oneshot::channel::<()>();
        let served = tokio::spawn(serve(listener, app.clone(), async {
            let _ = stopped.await;
        }));
        let client = crate::http::server::client_builder().build().unwrap();
        let told = tell(Server { address, app, client }, stop, served);
        tokio::time::timeout(PATIENCE, told).await.expect("the story has an end");
    });
}

#[test]
fn a_job_under_way_is_answered_though_the_service_is_stopping() {
    ending(settings(), async |server, stop, mut served| {
        let held = server.hold().await;
        let stream = server.said(&server.request("/v1/render", "", &mesh(2).to_string())).await;
        until("it waits", || server.app.desk.n_under_way() == 1).await;
        stop.send(()).unwrap();
        until("nobody is let in", || std::net::TcpStream::connect(server.address).is_err()).await;
        assert!(!served.is_finished(), "the request is waited for");
        drop(held);
        let answer = rest(stream).await;
        assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
        (&mut served).await.unwrap();
    });
}

#[test]
fn a_job_that_outlasted_its_request_may_end_too() {
    ending(settings(), async |server, stop, served| {
        let held = server.hold().await;
        let later = server.post_with("/v1/render", &mesh(2), &[("prefer", "wait=0")]).await;
        assert_eq!(later.status, 202);
        stop.send(()).unwrap();
        until("nobody is let in", || std::net::TcpStream::connect(server.address).is_err()).await;
        drop(held);
        served.await.unwrap();
        assert_eq!(server.app.desk.tiers.usage()[0].1.artifacts, 1, "its result is there");
    });
}

#[test]
fn what_does_not_end_in_time_is_stopped() {
    ending(Settings { shutdown_timeout_s: 0, ..settings() }, async |server, stop, served| {
        let job = with(endless(), "stats");
        let later = server.post_with("/v1/render", &job, &[("prefer", "wait=0")]).await;
        assert_eq!(later.status, 202);
        until("it runs", || server.app.desk.pool.waiting() == [0, 0]).await;
        stop.send(()).unwrap();
        served.await.unwrap();
        until("it has stopped", || server.app.desk.n_under_way() == 0).await;
    });
}

#[test]
fn idle_connections_do_not_hold_the_service_up() {
    ending(Settings { header_timeout_s: 600, ..settings() }, async |server, stop, served| {
        let idle = server.connect().await;
        server.get("/livez").await.ok();
        stop.send(()).unwrap();
        served.await.unwrap();
        assert_eq!(rest(idle).await, "");
    });
}
