//! From the request of a job to its tasks, when it is posted and whenever it is computed.

use std::future::Future;
use std::pin::Pin;
use std::sync::Arc;

use axum::body::Bytes;
use axum::http::{HeaderMap, HeaderValue, header};

use super::analyses::AnalysisTask;
use super::app::{App, SharedApp};
use super::body::Sent;
use super::problem::Problem;
use super::reading::ReadJob;
use super::{negotiate, reading, streaming};
use crate::fault::{Fault, under};
use crate::job::key::{Key, job};
use crate::job::limits::Admitted;
use crate::job::{Form, Inquiry, Output};
use crate::output::{FORMATS, Format, named};
use crate::service::batches::Batch;
use crate::service::batching::{ReadItems, Reading};
use crate::service::driving::{ReadJobs, Tasks, Unreadable};
use crate::service::job_key::JobKey;
use crate::service::jobs::{JobSummary, Predicted, Product, Record};
use crate::service::peer::{Peer, QuotaKind};
use crate::service::pool::{Lack, Lane};
use crate::service::task::{Render, Task};
use crate::wire::JobRequest;
use crate::wire::posted::{AnalysisJob, asks_for_analysis};
use crate::wire::read::{read, reading_memory};

/// The name of the only output of an analysis.
const ANALYSIS: &str = "analysis";

/// A job that was read.
#[derive(Debug)]
pub(super) enum ParsedJob {
    /// A job with outputs to be rendered.
    Render(Box<ReadJob>),
    /// The analysis of a plan.
    Analysis(Arc<AnalysisTask>, Sent),
}

/// A job that was read and admitted.
#[derive(Debug)]
pub(super) struct AdmittedJob {
    pub(super) summary: JobSummary,
    pub(super) tasks: Tasks,
}

impl ParsedJob {
    /// Returns the id of the job.
    pub(super) fn id(&self) -> Key {
        match self {
            Self::Render(read) => read.job.id(),
            Self::Analysis(task, _) => job([(ANALYSIS, &task.key())].into_iter()),
        }
    }

    /// Returns the tasks of the job, if it is within the limits of this server.
    ///
    /// # Errors
    /// A job that exceeds a limit.
    pub(super) async fn work(self, app: &Arc<App>, peer: Peer) -> Result<AdmittedJob, Problem> {
        match self {
            Self::Render(read) => {
                let ReadJob { job, input, sent } = *read;
                let admitted = reading::admit(app, peer, job).await?;
                streaming::check_kept(app, &admitted)?;
                let task =
                    |output| Arc::new(Render::new(admitted.clone(), output, Some(input.clone()))) as Arc<dyn Task>;
                let tasks = (0..admitted.job().outputs.len()).map(task).collect();
                Ok(AdmittedJob { summary: summary(&admitted, &sent), tasks })
            }
            Self::Analysis(task, sent) => {
                let format = named("json").expect("json is among the formats");
                let product = Product { name: ANALYSIS.to_owned(), format, key: task.key() };
                let (cost, count) = (task.cost(), |n: u128| u64::try_from(n).unwrap_or(u64::MAX));
                let (memory_bytes, time_ms) = (count(cost.memory_bytes), count(cost.time_ms));
                let cost = Predicted { memory_bytes, time_ms, ..Predicted::default() };
                let (details, blobs, request) = (Vec::new(), Vec::new(), sent.text());
                let summary = JobSummary { products: vec![product], cost, reached: None, details, blobs, request };
                Ok(AdmittedJob { summary, tasks: vec![task] })
            }
        }
    }
}

/// Returns the summary of an admitted job, for its record.
pub(super) fn summary(admitted: &Admitted, sent: &Sent) -> JobSummary {
    let job = admitted.job();
    let product = |(output, key): (&crate::job::Output, &Key)| Product {
        name: output.name.clone(),
        format: output.format,
        key: *key,
    };
    JobSummary {
        products: job.outputs.iter().zip(job.keys()).map(product).collect(),
        cost: admitted.estimate().into(),
        reached: job.reached,
        details: job.detail_keys().collect(),
        blobs: sent.upload_ids(),
        request: sent.text(),
    }
}

/// Reads an analysis; returns the body if it is no analysis.
async fn analysis(app: &Arc<App>, peer: Peer, sent: Sent) -> Result<Result<ParsedJob, Sent>, Problem> {
    let bytes = reading_memory(sent.bytes.len() as u64);
    let of_lane = sent.clone();
    let analysis = app.desk.read(peer, bytes, move |watch| {
        if !asks_for_analysis(&of_lane.bytes) {
            return Ok(None);
        }
        let request: AnalysisJob = read(&of_lane.bytes)?;
        let resolved: Result<Inquiry, _> = request.analysis.resolve(Form::Json, watch);
        resolved.map(Some).map_err(|faults| Problem::invalid(under("/analysis", faults)))
    });
    Ok(match analysis.await?? {
        Some(analysis) => Ok(ParsedJob::Analysis(Arc::new(AnalysisTask(analysis, Form::Json)), sent)),
        None => Err(sent),
    })
}

/// Reads a job that a client sent.
///
/// # Errors
/// Every fault of the job; 503 if too much is being read already.
pub(super) async fn read_job(
    app: &Arc<App>,
    peer: Peer,
    headers: &HeaderMap,
    sent: Sent,
) -> Result<ParsedJob, Problem> {
    let sent = match analysis(app, peer, sent).await? {
        Ok(analysis) => return Ok(analysis),
        Err(sent) => sent,
    };
    let headers = headers.clone();
    // the answer about a job is JSON, whatever its outputs are, so that `Accept` chooses a format only without outputs
    let settle = move |request: &mut JobRequest| {
        if request.outputs.is_empty() { negotiate::settle(&headers, request) } else { Ok(()) }
    };
    Ok(ParsedJob::Render(Box::new(reading::job(app, peer, sent, usize::MAX, settle).await?)))
}

/// Reads a job that was accepted before, whose first output had this format.
///
/// # Errors
/// Every fault that the job has now; 503 if too much is being read already.
pub(super) async fn read_again(
    app: &Arc<App>,
    peer: Peer,
    request: Bytes,
    format: &'static dyn Format,
) -> Result<ParsedJob, Problem> {
    // `Accept` may have chosen the format at first
    let headers = HeaderMap::from_iter([(header::ACCEPT, HeaderValue::from_static(format.media_type()))]);
    read_job(app, peer, &headers, Sent::job(request)).await
}

/// Checks a job of a batch, except the search for the level of a tolerance; returns the number of its outputs.
///
/// # Errors
/// Every fault of the job, and exceeded limits; 503 if too much is being read already.
pub(super) async fn check(app: &Arc<App>, peer: Peer, sent: Sent) -> Result<usize, Problem> {
    let Err(sent) = analysis(app, peer, sent).await? else { return Ok(1) };
    let settle = |request: &mut JobRequest| negotiate::settle(&HeaderMap::new(), request);
    match reading::draft(app, peer, sent, usize::MAX, settle).await? {
        reading::ReadStage::Complete(read) => {
            fits_an_archive(&read.job.outputs)?;
            let n = read.job.outputs.len();
            let admitted = reading::admit(app, peer, read.job).await?;
            streaming::check_kept(app, &admitted)?;
            Ok(n)
        }
        reading::ReadStage::Search(search, ..) => {
            fits_an_archive(search.outputs())?;
            Ok(search.outputs().len())
        }
    }
}

/// Refuses outputs that refer to further files.
fn fits_an_archive(outputs: &[Output]) -> Result<(), Problem> {
    let Some(at) = outputs.iter().position(|output| output.format.details(&output.options).is_some()) else {
        return Ok(());
    };
    let detail = "levels of detail have buffers of their own, which the archive of a batch does not hold; leave it \
                  out, or post this job by itself";
    Err(Problem::invalid(vec![Fault::new(format!("/outputs/{at}/lod"), detail)]))
}

/// Reads jobs for the workers.
#[derive(Debug)]
pub(super) struct JobReader(pub(super) SharedApp);

impl ReadJobs for JobReader {
    fn tasks<'a>(&'a self, record: &'a Record) -> Pin<Box<dyn Future<Output = Result<Tasks, Unreadable>> + Send + 'a>> {
        Box::pin(async move {
            let tasks = async {
                let format = record.summary.products.first().map_or(FORMATS[0], |product| product.format);
                let asked = read_again(&self.0, record.peer, record.summary.request.clone(), format).await?;
                Ok::<_, Problem>(asked.work(&self.0, record.peer).await?.tasks)
            };
            tasks.await.map_err(Problem::unreadable)
        })
    }
}

impl ReadItems for JobReader {
    fn item(self: Arc<Self>, batch: Batch, at: usize) -> Reading {
        Box::pin(async move {
            let (app, peer, tenant) = (&self.0, batch.peer, batch.batch.tenant);
            let (desk, text) = (&app.desk, &batch.request.text);
            // the memory of the job is charged to its own record later
            let booked = desk.peers.charge_self(&desk.account.bodies, QuotaKind::BodyBytes, text.len() as u64);
            let _paid =
                booked.map_err(|_| Unreadable::Later(desk.pool.busy(Lane::Reading, Lack::Bodies).retry_after))?;
            let text = batch.request.layout.text(text, at).into();
            let item = async {
                let asked = read_job(app, peer, &HeaderMap::new(), Sent::job(text)).await?;
                let id = asked.id();
                Ok::<_, Problem>((JobKey { tenant, id }, asked.work(app, peer).await?.summary))
            };
            item.await.map_err(Problem::unreadable)
        })
    }
}
