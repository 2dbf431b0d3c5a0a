//! Cached answers over loopback, beside a bare axum handler that answers the same bytes: same load, same cores, same run.

use std::error::Error;
use std::net::SocketAddr;
use std::path::PathBuf;

use axum::Router;
use axum::body::Bytes;
use axum::http::header;
use axum::routing::get;
use axum::serve::ListenerExt;
use planish::config::Settings;
use planish::http::serve::{bind, serve};
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::sync::oneshot;

use crate::load::{Asked, ask, rate};
use crate::table::{Aim, Table, figure};

/// Rounds of each load; they take turns, so that a change of the machine's pace meets all.
const ROUNDS: usize = 7;

/// Ten quads once halved are 80 triangles: 4084 bytes of STL.
const JOB: &str = r#"{"input":{"mesh":{"positions":[[0,0,0],[1,0,0],[2,0,1],[3,0,0],[4,0,0],[5,0,0],[0,1,0],[1,1,0],[2,1,1],[3,1,0],[4,1,0],[5,1,0],[0,2,0],[1,2,0],[2,2,1],[3,2,0],[4,2,0],[5,2,0]],"faces":[[0,1,7,6],[1,2,8,7],[2,3,9,8],[3,4,10,9],[4,5,11,10],[6,7,13,12],[7,8,14,13],[8,9,15,14],[9,10,16,15],[10,11,17,16]]}},"plan":{"preset":"bilinear"},"levels":1,"outputs":[{"format":"stl"}]}"#;

pub(crate) fn measure(table: &mut Table) {
    compare(table).expect("both servers answer");
}

fn compare(table: &mut Table) -> Result<(), Box<dyn Error>> {
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    let (stop, stopped) = oneshot::channel::<()>();
    let planish = start_planish(&runtime, stopped)?;
    let post = format!(
        "POST /v1/render HTTP/1.1\r\nhost: {planish}\r\ncontent-type: application/json\r\ncontent-length: {}\r\n\r\n{JOB}",
        JOB.len()
    );
    let made = ask(planish, &post)?;
    let place = made.header("content-location").ok_or("the answer has an address")?.to_owned();
    let bare = start_bare(&runtime, Bytes::from(made.body.clone()))?;
    let loads = [
        Asked::new(bare, format!("GET /bytes HTTP/1.1\r\nhost: {bare}\r\n\r\n"))?,
        Asked::new(planish, format!("GET {place} HTTP/1.1\r\nhost: {planish}\r\n\r\n"))?,
        Asked::new(bare, post.replace("/v1/render", "/bytes"))?,
        Asked::new(planish, post)?,
    ];
    let mut rates = [const { Vec::new() }; 4];
    for _ in 0..ROUNDS {
        for (load, rates) in loads.iter().zip(&mut rates) {
            rates.push(rate(load)?);
        }
    }
    for (what, bare, ours) in [("GET /v1/artifacts, cached", 0, 1), ("POST /v1/render, cached", 2, 3)] {
        // neighbours in time compare best
        let mut ratios: Vec<f64> = rates[ours].iter().zip(&rates[bare]).map(|(ours, bare)| ours / bare).collect();
        ratios.sort_unstable_by(f64::total_cmp);
        let best = |of: usize| figure(rates[of].iter().copied().fold(0.0, f64::max) / 1e3);
        let bytes = made.body.len();
        let detail = format!("at best {} k/s, bare axum {} k/s, {bytes} bytes", best(ours), best(bare));
        table.add(what, (ratios[ROUNDS / 2], "of bare axum"), "", Aim::AtLeast(0.5), &detail);
    }
    let _ = stop.send(());
    runtime.shutdown_background();
    Ok(())
}

fn start_planish(runtime: &Runtime, stopped: oneshot::Receiver<()>) -> Result<SocketAddr, Box<dyn Error>> {
    let settings =
        Settings { listen: SocketAddr::from(([127, 0, 0, 1], 0)), data_dir: PathBuf::new(), ..Settings::default() };
    let (listener, app) = runtime.block_on(bind(settings))?;
    let address = listener.local_addr()?;
    runtime.spawn(serve(listener, app, async {
        let _ = stopped.await;
    }));
    Ok(address)
}

fn start_bare(runtime: &Runtime, bytes: Bytes) -> Result<SocketAddr, Box<dyn Error>> {
    let answer = move |_: Bytes| async move { ([(header::CONTENT_TYPE, "model/stl")], bytes) };
    let router: Router = Router::new().route("/bytes", get(answer.clone()).post(answer));
    let listener = runtime.block_on(TcpListener::bind(("127.0.0.1", 0)))?;
    let address = listener.local_addr()?;
    let listener = listener.tap_io(|stream| {
        let _ = stream.set_nodelay(true);
    });
    runtime.spawn(async move { axum::serve(listener, router).await });
    Ok(address)
}
