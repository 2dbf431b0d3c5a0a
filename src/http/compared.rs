//! The two sides of a comparison: artifacts, uploads and jobs, found or computed.

use std::any::Any;
use std::sync::Arc;

use axum::body::Bytes;
use serde_json::Value;

use super::app::App;
use super::blobs::{self, PICTURE};
use super::body::{Attached, Sent};
use super::inflate::too_long;
use super::problem::{self, Problem};
use super::reading::{self, ReadJob};
use crate::fault::{Fault, shortened, under};
use crate::input::Alone;
use crate::job::key::Key;
use crate::job::{PngFile, Side};
use crate::service::peer::{Paid, Peer};
use crate::service::store::Manifest;
use crate::service::task::Render;
use crate::wire::JobRequest;
use crate::wire::output::OutputRequest;
use crate::wire::place::InputPlace;
use crate::wire::text::MeshFile;

/// The job for a mesh file that is compared unrefined.
const FILE_JOB: &[u8] = br#"{"input":{},"outputs":[{"format":"stats"}]}"#;

/// The charge for the memory of a side, as long as it is held.
pub(super) type Booked = Arc<dyn Any + Send + Sync>;

/// One side of a comparison, with the charge for its memory.
#[derive(Debug)]
pub(super) struct FoundSide {
    pub(super) side: Side,
    pub(super) paid: Booked,
}

/// Returns the side at `place` of the request.
///
/// # Errors
/// An unknown or unsuitable side, with a pointer to it.
pub(super) async fn side(app: &Arc<App>, peer: Peer, place: &str, named: &Value) -> Result<FoundSide, Problem> {
    let fault = |detail: String| Problem::invalid(vec![Fault::new(place, detail)]);
    match named {
        Value::String(id) if id.starts_with("b3-") => {
            let (key, manifest, bytes, paid) = blobs::loaded(app, peer, id, place).await?;
            let holds = Holds::of(&manifest.media_type).map_err(fault)?;
            of_file(app, peer, place, (key, holds), (bytes, paid), false).await
        }
        Value::String(id) => {
            let key = Key::parse(id).ok_or_else(|| {
                fault(format!(
                    "\"{}\" is no id; an artifact has 64 hexadecimal digits, an upload b3- before them",
                    shortened(id)
                ))
            })?;
            let missing = || fault(format!("there is no artifact {key} here; give the job that makes it"));
            let manifest = app.desk.find_artifact(key, peer).await.ok_or_else(missing)?;
            let holds = Holds::of(&manifest.media_type).map_err(fault)?;
            of_file(app, peer, place, (key, holds), whole(app, peer, &manifest).await?, true).await
        }
        Value::Object(_) => {
            of_job(app, peer, named).await.map_err(|problem| problem.at(|pointer| format!("{place}{pointer}")))
        }
        _ => Err(fault("expected the id of an artifact or of an upload, or a job".to_owned())),
    }
}

/// The content of a file.
enum Holds {
    Picture,
    /// A mesh in the format of this name.
    Mesh(&'static str),
}

impl Holds {
    fn of(media_type: &str) -> Result<Self, String> {
        if media_type == PICTURE {
            return Ok(Self::Picture);
        }
        let refusal = || format!("{media_type} is neither a PNG nor a mesh file that is read");
        blobs::format_of(media_type).map(Self::Mesh).ok_or_else(refusal)
    }
}

fn picture(bytes: Vec<u8>, paid: Paid, is_own: bool) -> Result<FoundSide, String> {
    let side = Side::Picture(PngFile::new(bytes.into(), is_own)?);
    Ok(FoundSide { side, paid: Arc::new(paid) })
}

/// Reads all bytes of an artifact, and charges their memory.
async fn whole(app: &Arc<App>, peer: Peer, manifest: &Arc<Manifest>) -> Result<(Vec<u8>, Paid), Problem> {
    let limit = app.settings.max_body_bytes;
    if manifest.length > limit {
        return Err(too_long(manifest.length, limit));
    }
    let paid = app.desk.charge_body(peer, manifest.length)?;
    let mut bytes = Vec::with_capacity(usize::try_from(manifest.length).unwrap_or_default());
    for part in 0..manifest.parts.len() {
        bytes.extend_from_slice(&app.desk.tiers.part(manifest, part).await.ok_or_else(lost)?);
    }
    Ok((bytes, paid))
}

/// Reads a picture, which `is_own` if this service drew it, or a mesh file unrefined.
async fn of_file(
    app: &Arc<App>,
    peer: Peer,
    place: &str,
    (key, holds): (Key, Holds),
    (bytes, paid): (Vec<u8>, Paid),
    is_own: bool,
) -> Result<FoundSide, Problem> {
    let Holds::Mesh(format) = holds else {
        return picture(bytes, paid, is_own).map_err(|detail| Problem::invalid(vec![Fault::new(place, detail)]));
    };
    let file = MeshFile { format: format.to_owned(), bytes, beside: Arc::new(Alone) };
    let attached = Arc::new(Attached::new(key, file, paid));
    let sent = Sent::job(Bytes::from_static(FILE_JOB)).with_uploads(vec![(InputPlace::default(), attached)]);
    shape(app, peer, sent).await.map_err(|problem| problem.at(|_| place.to_owned()))
}

async fn shape(app: &Arc<App>, peer: Peer, sent: Sent) -> Result<FoundSide, Problem> {
    let ReadJob { job, input, .. } = reading::job(app, peer, sent, 1, |_| Ok(())).await?;
    let admitted = reading::admit(app, peer, job).await?;
    Ok(FoundSide { side: Side::Shape(admitted), paid: input })
}

/// Returns the picture that a job draws, or its refined shape.
async fn of_job(app: &Arc<App>, peer: Peer, job: &Value) -> Result<FoundSide, Problem> {
    let sent = Sent::job(job.to_string().into());
    let prepare = |request: &mut JobRequest| {
        let is_picture = request.outputs.first().and_then(OutputRequest::format) == Some("png");
        if request.outputs.len() < 2 && !is_picture {
            let shape = OutputRequest::of_shape(request.outputs.first());
            request.outputs = vec![shape.map_err(|faults| Problem::invalid(under("/outputs/0", faults)))?];
        }
        Ok(())
    };
    let ReadJob { job, input, .. } = reading::job(app, peer, sent, 1, prepare).await?;
    let is_picture = job.outputs[0].format.media_type() == PICTURE;
    let (key, entries) = (job.keys()[0], job.entries(&job.outputs[0]));
    if is_picture && let Some(manifest) = app.desk.find_artifact(key, peer).await {
        let (bytes, paid) = whole(app, peer, &manifest).await?;
        return picture(bytes, paid, true).map_err(|detail| Problem::invalid(vec![Fault::new("", detail)]));
    }
    let admitted = reading::admit(app, peer, job).await?;
    if !is_picture {
        return Ok(FoundSide { side: Side::Shape(admitted), paid: input });
    }
    let interest = app.desk.compute(Arc::new(Render::new(admitted, 0, Some(input))), peer)?;
    let outcome = interest.computation.outcome().await;
    let outcome = outcome.map_err(|failure| Problem::of_failure(failure, |refused| entries.fault(refused)))?;
    let (bytes, paid) = match &outcome.loose {
        Some(bytes) => (bytes.to_vec(), app.desk.charge_body(peer, bytes.len() as u64)?),
        None => whole(app, peer, &outcome.manifest).await?,
    };
    picture(bytes, paid, true).map_err(|detail| Problem::invalid(vec![Fault::new("", detail)]))
}

/// Returns the refusal because bytes have just left the cache.
pub(super) fn lost() -> Problem {
    Problem::new(problem::GONE, "what is compared has just left the cache; ask again")
}
