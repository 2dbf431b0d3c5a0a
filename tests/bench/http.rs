//! Cached answers over loopback, beside a bare axum handler that answers the same headers and bytes: same load, same
//! cores, same run.

use std::error::Error;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;

use axum::Router;
use axum::body::{Body, Bytes};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Response};
use axum::routing::get;
use axum::serve::ListenerExt;
use planish::config::Settings;
use planish::http::serve::{bind, serve};
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::sync::oneshot;

use crate::load::{Answer, Asked, ask, rate};
use crate::table::{Aim, Table, figure};

/// Rounds of each load; they take turns, so that a change of the machine's pace meets all.
const ROUNDS: usize = 7;

/// Ten quads once halved are 80 triangles: 4084 bytes of STL.
const MESH: &str = concat!(
    r#"{"input":{"mesh":{"positions":[[0,0,0],[1,0,0],[2,0,1],[3,0,0],[4,0,0],[5,0,0],[0,1,0],[1,1,0],"#,
    r#"[2,1,1],[3,1,0],[4,1,0],[5,1,0],[0,2,0],[1,2,0],[2,2,1],[3,2,0],[4,2,0],[5,2,0]],"#,
    r#""faces":[[0,1,7,6],[1,2,8,7],[2,3,9,8],[3,4,10,9],[4,5,11,10],[6,7,13,12],[7,8,14,13],[8,9,15,14],"#,
    r#"[9,10,16,15],[10,11,17,16]]}},"plan":{"preset":"bilinear"},"levels":1,"outputs":[{"format":"stl"}]}"#,
);

/// Four points five times doubled: 128 points and 128 edges of 32 bytes together, behind the header of a PLY.
const POLYGON: &str = concat!(
    r#"{"input":{"polygon":{"points":[[0,0,0],[4,0,1],[4,3,0],[0,3,1]],"closed":true}},"#,
    r#""plan":{"preset":"cubic-b-spline"},"levels":5,"outputs":[{"format":"ply"}]}"#,
);

pub(crate) fn measure(table: &mut Table) {
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().expect("threads can be started");
    let (stop, stopped) = oneshot::channel::<()>();
    let compared = start_planish(&runtime, stopped).and_then(|planish| {
        compare(table, &runtime, planish, "GET /v1/artifacts, cached", MESH, true)?;
        compare(table, &runtime, planish, "POST /v1/render, cached, polygon", POLYGON, false)?;
        compare(table, &runtime, planish, "POST /v1/render, cached, mesh", MESH, false)
    });
    compared.expect("both servers answer");
    let _ = stop.send(());
    runtime.shutdown_background();
}

/// Loads planish and a bare handler in turns.
fn compare(
    table: &mut Table,
    runtime: &Runtime,
    planish: SocketAddr,
    what: &str,
    job: &str,
    by_address: bool,
) -> Result<(), Box<dyn Error>> {
    let made = ask(planish, &post(planish, "/v1/render", job))?;
    let place = made.header("content-location").ok_or("the answer has an address")?;
    let request = |address, path| if by_address { get_from(address, path) } else { post(address, path, job) };
    let ours = Asked::new(planish, request(planish, if by_address { place } else { "/v1/render" }))?;
    let bare = start_bare(runtime, head(&ours.answer)?, Bytes::from(made.body.clone()))?;
    let theirs = Asked::new(bare, request(bare, "/bytes"))?;
    let headers = |asked: &Asked| asked.answer.headers().count();
    if headers(&ours) != headers(&theirs) || ours.answer.body != theirs.answer.body {
        return Err("the answers differ in their bytes or in the number of their headers".into());
    }
    // neighbours in time compare best
    let mut rounds = Vec::new();
    for _ in 0..ROUNDS {
        rounds.push([rate(&ours)?, rate(&theirs)?]);
    }
    let best = |of: usize| figure(rounds.iter().map(|rates| rates[of]).fold(0.0, f64::max) / 1e3);
    let (bytes, headers) = (made.body.len(), headers(&ours));
    let detail = format!("at best {} k/s, bare axum {} k/s, {bytes} bytes and {headers} headers", best(0), best(1));
    let mut ratios: Vec<f64> = rounds.iter().map(|[ours, theirs]| ours / theirs).collect();
    ratios.sort_unstable_by(f64::total_cmp);
    table.add(what, (ratios[ROUNDS / 2], "of bare axum"), "", Aim::AtLeast(0.85), &detail);
    Ok(())
}

/// The headers of an answer, but for those that the HTTP library adds by itself.
fn head(answer: &Answer) -> Result<HeaderMap, Box<dyn Error>> {
    let mut headers = HeaderMap::new();
    for (name, value) in answer.headers().filter(|(name, _)| !["content-length", "date"].contains(name)) {
        headers.append(HeaderName::try_from(name)?, HeaderValue::try_from(value)?);
    }
    Ok(headers)
}

fn get_from(address: SocketAddr, path: &str) -> String {
    format!("GET {path} HTTP/1.1\r\nhost: {address}\r\n\r\n")
}

fn post(address: SocketAddr, path: &str, job: &str) -> String {
    let length = job.len();
    format!(
        "POST {path} HTTP/1.1\r\nhost: {address}\r\ncontent-type: application/json\r\n\
         content-length: {length}\r\n\r\n{job}"
    )
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

fn start_bare(runtime: &Runtime, headers: HeaderMap, bytes: Bytes) -> Result<SocketAddr, Box<dyn Error>> {
    // the least that a handler can do: it copies the headers once
    let headers = Arc::new(headers);
    let answer = move |_: Bytes| async move {
        let mut response = Response::new(Body::from(bytes));
        response.headers_mut().clone_from(&headers);
        response
    };
    let router: Router = Router::new().route("/bytes", get(answer.clone()).post(answer));
    let listener = runtime.block_on(TcpListener::bind(("127.0.0.1", 0)))?;
    let address = listener.local_addr()?;
    let listener = listener.tap_io(|stream| {
        let _ = stream.set_nodelay(true);
    });
    runtime.spawn(async move { axum::serve(listener, router).await });
    Ok(address)
}
