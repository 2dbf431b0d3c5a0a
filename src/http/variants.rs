//! Answers in the content coding that the client prefers, from variants of artifacts that are made at the first request
//! and stored.

use std::sync::Arc;
use std::time::Duration;

use axum::http::HeaderMap;

use super::answer::{Artifact, ArtifactForm, PartReader};
use super::app::App;
use super::negotiate;
use crate::output::{Content, FORMATS};
use crate::service::store::Manifest;
use crate::service::variant::{Coding, Compress};

/// Minimum length of an artifact that has variants, in bytes: shorter ones fit into one packet with their headers. Half
/// of it compresses for nothing; twice of it leaves small curves uncompressed.
const LEAST_BYTES: u64 = 1 << 10;
/// Maximum length of an artifact that has variants, in bytes: the length up to which results are stored unless the
/// client asks for more. Compressing it takes about a second. Twice of it lets a client wait for two; half of it sends
/// some stored results uncompressed.
const MAX_COMPRESSIBLE_BYTES: u64 = 64 << 20;

/// Maximum time that an answer waits for a variant that is being made; then the client gets the uncompressed bytes, and
/// the variant is finished for the next one. In this time some 50 MiB are compressed on an idle machine. Half of it
/// sends more of the first answers uncompressed; twice of it makes clients of a busy machine wait twice as long for
/// bytes that exist already.
const VARIANT_PATIENCE: Duration = Duration::from_secs(1);

/// Returns an artifact in the coding that the client prefers; uncompressed if compression does not pay or cannot be had
/// now.
pub(super) async fn coded(app: &Arc<App>, headers: &HeaderMap, found: Artifact) -> Artifact {
    let Some(coding) = negotiate::coding(headers).filter(|_| has_variants(&found)) else { return found };
    let kept = match app.desk.find_artifact(coding.key(&found.manifest.key), found.peer).await {
        Some(variant) => Some(variant),
        None => made(app, &found, coding).await,
    };
    let form = match kept {
        Some(variant) if variant.length > 0 => ArtifactForm::Coded(coding, variant),
        Some(_) => ArtifactForm::Plain,
        None => ArtifactForm::PlainForNow,
    };
    Artifact { form, ..found }
}

/// Returns whether an artifact has variants: it is stored, neither short nor very long, and not compressed by its
/// format.
fn has_variants(found: &Artifact) -> bool {
    let of_type = |media_type: &str| FORMATS.iter().find(|format| format.media_type() == media_type);
    let is_packed = |media_type| of_type(media_type).is_some_and(|format| format.facts().content == Content::Packed);
    let is_fit = (LEAST_BYTES..=MAX_COMPRESSIBLE_BYTES).contains(&found.manifest.length);
    is_fit && found.loose.is_none() && !is_packed(&found.manifest.media_type)
}

/// Computes a variant in the queue, like any other task; `None` on failure, and if it takes longer than
/// [`VARIANT_PATIENCE`].
async fn made(app: &Arc<App>, found: &Artifact, coding: Coding) -> Option<Arc<Manifest>> {
    let parts = PartReader::of(app, found.peer, found.manifest.clone()).ok()?.all().await.ok()?;
    let task = Arc::new(Compress::new(&found.manifest.key, coding, parts));
    let interest = app.desk.compute(task, found.peer).ok()?;
    match tokio::time::timeout(VARIANT_PATIENCE, interest.computation.outcome()).await {
        Ok(Ok(outcome)) if outcome.loose.is_none() => Some(outcome.manifest.clone()),
        Ok(_) => None,
        Err(_) => {
            // the variant is finished for the next request
            tokio::spawn(async move { interest.computation.finished().await });
            None
        }
    }
}
