//! The checks of a batch before it is accepted: its bounds, and each of its jobs.

use std::collections::BTreeSet;
use std::sync::Arc;

use axum::body::Bytes;

use super::app::App;
use super::body::Sent;
use super::charge::Charge;
use super::client::Client;
use super::problem::{self, Problem};
use super::working;
use crate::fault::Fault;
use crate::job::key::{Key, content};
use crate::math::amounts::{in_bytes, thousands};
use crate::service::batches::{BatchLayout, ParsedBatch};
use crate::service::peer::Peer;
use crate::wire::batch::{layout, placed};
use crate::wire::read::reading_memory;

/// Upper bound of the texts of all jobs of a batch, in multiples of the maximum length of a body: by default 256 MiB,
/// read in some seconds. Half of it refuses grids of templates that hold a large mesh sooner; twice of it checks for
/// twice as long before the answer.
const MAX_BODIES: u64 = 8;
/// Maximum number of outputs of all jobs of a batch: its state is 2 MiB of JSON then. Half of it refuses batches of
/// 1,000 jobs with three outputs; twice of it sends 4 MiB to each listener.
const MAX_BATCH_OUTPUTS: u64 = 4096;
/// Number of faults after which no further job is checked: more than a client mends at once. Half or twice of it halves
/// or doubles the time that a wrong batch takes.
const MAX_BATCH_FAULTS: usize = 50;

/// Finds the jobs of a batch in its text, and computes its id: the hash of the texts of its jobs in their order.
///
/// # Errors
/// A body that is no batch, or a batch that is too large; 503 if too much is being read already.
pub(super) async fn read(app: &Arc<App>, peer: Peer, sent: &Sent) -> Result<(Key, BatchLayout), Problem> {
    let (text, most, bodies) = (sent.bytes.clone(), app.settings.max_batch_items, app.settings.max_body_bytes);
    let read = app.desk.read(peer, reading_memory(sent.length()), move |_| {
        let layout = layout(&text)?;
        bounded(&layout, most, MAX_BODIES * bodies).map_err(|fault| Problem::invalid(vec![fault]))?;
        let mut hashes = b"planish batch 1".to_vec();
        let n = usize::try_from(layout.n()).unwrap_or(usize::MAX);
        for at in 0..n {
            hashes.extend_from_slice(content(&layout.text(&text, at)).as_bytes());
        }
        Ok::<_, Problem>((content(&hashes), layout))
    });
    read.await?
}

/// Refuses a batch with too many jobs or bytes, before the text of any job is made.
fn bounded(layout: &BatchLayout, most: u64, most_bytes: u64) -> Result<(), Fault> {
    let (n, bytes) = (layout.n(), layout.bytes());
    let (place, factors) = match layout {
        BatchLayout::List(_) => ("/jobs", String::new()),
        BatchLayout::Grid { axes, .. } => {
            let lengths: Vec<String> = axes.iter().map(|axis| axis.values.len().to_string()).collect();
            ("/grid", format!("{} = ", lengths.join(" x ")))
        }
    };
    if n > u128::from(most) {
        let (n, most) = (thousands(n), thousands(most.into()));
        let detail = format!("{factors}{n} jobs; a batch has at most {most} here; send several batches");
        return Err(Fault::new(place, detail));
    }
    if bytes > u128::from(most_bytes) {
        let (bytes, most) = (in_bytes(bytes), in_bytes(most_bytes.into()));
        let remedy = "send large meshes to /v1/blobs once, and name them by input.blob";
        return Err(Fault::new(place, format!("its jobs have {bytes} together, at most {most} here; {remedy}")));
    }
    Ok(())
}

/// Checks every job of a batch in the same way as when it is computed.
///
/// # Errors
/// All faults of its jobs, each with its place in the batch; a batch that is too large; 503 if too much is being read.
pub(super) async fn checked(
    app: &Arc<App>,
    client: &Client,
    sent: &Sent,
    layout: BatchLayout,
) -> Result<ParsedBatch, Problem> {
    let n = usize::try_from(layout.n()).unwrap_or(usize::MAX);
    let (mut faults, mut reported, mut n_outputs) = (Vec::new(), BTreeSet::new(), 0);
    let (mut charge, most) = (Charge::default(), app.desk.most_item_bytes());
    for at in 0..n {
        let text = Bytes::from(layout.text(&sent.bytes, at));
        charge.cover(app, client, text.len())?;
        if text.len() as u64 > most {
            let fault = Fault::new("", too_long("the job has", text.len() as u64, most));
            return Err(Problem::invalid(vec![placed(&layout, at, fault)]));
        }
        match working::check(app, client.peer(), Sent::job(text)).await {
            Ok(n) => n_outputs += n as u64,
            Err(problem) => {
                let of_job = problem.placed(at, |fault| placed(&layout, at, fault)).faults()?;
                faults.extend(
                    of_job.into_iter().filter(|fault| reported.insert((fault.pointer.clone(), fault.detail.clone()))),
                );
            }
        }
        if faults.len() >= MAX_BATCH_FAULTS {
            break;
        }
    }
    if !faults.is_empty() {
        return Err(Problem::invalid(faults));
    }
    if n_outputs > MAX_BATCH_OUTPUTS {
        let (n, most) = (thousands(n_outputs.into()), thousands(MAX_BATCH_OUTPUTS.into()));
        let detail = format!("its jobs have {n} outputs together, at most {most}; send several batches");
        return Err(Problem::new(problem::TOO_LARGE, detail));
    }
    let request = ParsedBatch { text: sent.text(), layout, n_outputs };
    let (bytes, most) = (request.bytes(), app.desk.most_batch_bytes());
    if bytes > most {
        return Err(Problem::new(problem::TOO_LARGE, too_long("the batch takes", bytes, most)));
    }
    Ok(request)
}

fn too_long(what: &str, bytes: u64, most: u64) -> String {
    let (bytes, most) = (in_bytes(bytes.into()), in_bytes(most.into()));
    let remedy = "send large meshes to /v1/blobs and name them by input.blob, or raise --max-memory-bytes";
    format!("{what} {bytes}; this server keeps at most {most} of it; {remedy}")
}
