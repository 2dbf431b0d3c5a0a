//! Large results that are sent while they are computed, and not stored.

use std::io;
use std::sync::Arc;
use std::time::Duration;

use axum::body::Body;
use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};
use futures_util::stream;

use super::answer::ResultHeaders;
use super::app::App;
use super::client::Client;
use super::problem::{self, Problem};
use crate::fault::{Fault, shortened};
use crate::job::limits::Admitted;
use crate::math::amounts::in_bytes;
use crate::output::Size;
use crate::service::computation::Timings;
use crate::service::peer::Paid;
use crate::service::pool::{Busy, Lack};
use crate::service::read_lane::ReadRefusal;
use crate::service::task::{Render, Task};
use crate::shape::mesh::Mesh;

/// Returns whether a query asks to store the result.
///
/// # Errors
/// A value of `keep` that is neither true nor false.
pub(super) fn asks_to_keep(query: Option<&str>) -> Result<bool, Problem> {
    let pairs = query.unwrap_or_default().split('&');
    let asked =
        pairs.filter_map(|pair| pair.strip_prefix("keep").filter(|rest| rest.is_empty() || rest.starts_with('=')));
    asked.map(|said| said.trim_start_matches('=')).try_fold(false, |keep, said| match said {
        "" | "true" | "1" => Ok(true),
        "false" | "0" => Ok(keep),
        other => {
            let detail = format!("\"{}\" is neither true nor false", shortened(other));
            Err(Problem::invalid(vec![Fault::new("?keep", detail)]))
        }
    })
}

/// Returns whether a result is sent while it is computed: it is large, the client did not ask for an asynchronous
/// answer, and the first bytes are expected in time. A solid is stored if there is memory for it: it is complete before
/// its first byte, most are far smaller than their forecast, and its certificate is sent in a header.
pub(super) fn streams(app: &App, admitted: &Admitted, (patience, said): (Duration, bool)) -> bool {
    let estimate = admitted.estimate();
    let comes_back = said && patience.is_zero();
    let in_time = estimate.on_demand || estimate.time_ms < patience.as_millis();
    if admitted.job().outputs[0].format.is_of_limit() && check_kept(app, admitted).is_ok() {
        return false;
    }
    !comes_back && in_time && estimate.outputs[0].1.bytes() > app.settings.keep_at_most_bytes.into()
}

/// Refuses to store a result that would not fit into memory if the disk does not take it.
///
/// # Errors
/// [`problem::TOO_LARGE`].
pub(super) fn check_kept(app: &App, admitted: &Admitted) -> Result<(), Problem> {
    let (bytes, most) = (admitted.estimate().kept_memory_bytes(), app.desk.limits.max_job_bytes);
    if bytes <= most.into() {
        return Ok(());
    }
    let (bytes, most) = (in_bytes(bytes), in_bytes(most.into()));
    let detail = format!(
        "the job needs {bytes} of memory if its result is to be kept, this server allows {most}; ask without \
         `keep=true` and `respond-async`, or for fewer levels"
    );
    Err(Problem::new(problem::TOO_LARGE, detail))
}

/// Returns the refusal of a job that cannot be computed in time.
pub(super) fn too_busy() -> Problem {
    Busy { lack: Lack::Patience, retry_after: Duration::from_secs(1) }.into()
}

/// Returns an answer that carries a result while it is computed, or `None` if the first bytes do not come within
/// `patience`. The answer begins with the first bytes, so that a job that fails before them is refused as usual.
///
/// # Errors
/// The reason why there are no bytes.
pub(super) async fn streamed(
    app: &Arc<App>,
    client: &Client,
    admitted: Arc<Admitted>,
    input: Arc<Paid>,
    patience: Duration,
) -> Result<Option<Response>, Problem> {
    let (estimate, job) = (admitted.estimate(), admitted.job());
    let (memory_bytes, (key, size)) = (estimate.memory_bytes, estimate.outputs[0]);
    let (entries, swept) = (job.entries(&job.outputs[0]), estimate.on_demand || job.is_swept());
    let mut warnings = job.input.mesh().map(Mesh::warnings).unwrap_or_default();
    let output = &job.outputs[0];
    warnings.extend(output.format.leaves_out(job.input.attachments(), &output.options));
    let task = Render::new(admitted.clone(), 0, Some(input));
    let media_type = task.media_type().to_owned();
    let streaming = app.desk.stream(Arc::new(task), memory_bytes, client.peer());
    let streamed = match tokio::time::timeout(patience, streaming).await {
        Ok(Ok(streamed)) => streamed,
        Ok(Err(ReadRefusal::Failed(failure))) => {
            return Err(Problem::of_failure(failure, |fault| entries.fault(fault)));
        }
        Ok(Err(ReadRefusal::Busy(busy))) => return Err(busy.into()),
        Err(_) => return Ok(None),
    };
    let timings = Timings { queue: streamed.queue, swept, ..Timings::default() };
    let cache = "planish; fwd=miss";
    let mut headers =
        ResultHeaders { key, coding: None, media_type: &media_type, warnings: &warnings, cache, timings: &timings }
            .headers();
    headers.insert(header::ACCEPT_RANGES, HeaderValue::from_static("none"));
    if let Size::Exact(bytes) = size
        && let Ok(bytes) = u64::try_from(bytes)
    {
        headers.insert(header::CONTENT_LENGTH, bytes.into());
    }
    let chunks = stream::unfold(streamed, |mut streamed| async move {
        // an error breaks the connection, so that a cut answer never looks complete
        let next = streamed.next().await.map_err(|failure| {
            tracing::warn!(?failure, "a result ended before its end");
            io::Error::other("the computation failed")
        });
        next.transpose().map(|chunk| (chunk, streamed))
    });
    Ok(Some((headers, Body::from_stream(chunks)).into_response()))
}
