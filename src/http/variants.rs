//! Answers in the content coding that their clients like best: from variants that are made when they are first asked
//! for, and kept.

use std::sync::Arc;
use std::time::Duration;

use axum::http::HeaderMap;

use super::answer::{Artifact, Form, PartReader};
use super::app::App;
use super::negotiate;
use crate::output::{Content, FORMATS};
use crate::service::computation::Phase;
use crate::service::store::Manifest;
use crate::service::variant::{Coding, Compress};

/// Least bytes of an artifact that has variants: fewer fit into one packet with their headers.
/// Half of it compresses for nothing; twice of it leaves small curves as long as they are.
const LEAST_BYTES: u64 = 1 << 10;
/// Most bytes of an artifact that has variants, which is what is kept unless the client asks for more: one of them
/// takes about a second. Twice of it lets a client wait for two; half of it sends results as they are that are kept.
const MOST_BYTES: u64 = 64 << 20;

/// How long an answer waits for a variant that is being made; after it the client gets the bytes as they are, and the
/// variant is finished for the next one. In this time some 50 MiB are compressed on a machine that is idle.
/// Half of it sends more of the first answers as they are; twice of it makes clients of a machine that is busy wait
/// twice as long for what is there already.
const PATIENCE: Duration = Duration::from_secs(1);

/// An artifact in the coding that its client likes best; as it is where that does not pay, or cannot be had now.
pub(super) async fn coded(app: &Arc<App>, headers: &HeaderMap, found: Artifact) -> Artifact {
    let Some(coding) = negotiate::coding(headers).filter(|_| has_variants(&found)) else { return found };
    let kept = match app.desk.find(coding.key(&found.manifest.key), found.peer).await {
        Some(variant) => Some(variant),
        None => made(app, &found, coding).await,
    };
    let form = match kept {
        Some(variant) if variant.length > 0 => Form::Coded(coding, variant),
        Some(_) => Form::Plain,
        None => Form::PlainForNow,
    };
    Artifact { form, ..found }
}

/// Whether it is kept, neither short nor very long, and not compressed by its format.
fn has_variants(found: &Artifact) -> bool {
    let of_type = |media_type: &str| FORMATS.iter().find(|format| format.media_type() == media_type);
    let is_packed = |media_type| of_type(media_type).is_some_and(|format| format.facts().content == Content::Packed);
    let is_fit = (LEAST_BYTES..=MOST_BYTES).contains(&found.manifest.length);
    is_fit && found.loose.is_none() && !is_packed(&found.manifest.media_type)
}

/// The variant, made in its turn like any computation; what fails here is answered as it is.
async fn made(app: &Arc<App>, found: &Artifact, coding: Coding) -> Option<Arc<Manifest>> {
    let parts = PartReader::of(app, found.peer, found.manifest.clone()).ok()?.all().await.ok()?;
    let task = Arc::new(Compress::new(&found.manifest.key, coding, parts));
    let interest = app.desk.compute(task, found.peer).ok()?;
    let phase = tokio::time::timeout(PATIENCE, interest.computation.finished()).await;
    match phase {
        Ok(Phase::Done(outcome)) if outcome.loose.is_none() => Some(outcome.manifest.clone()),
        Ok(_) => None,
        Err(_) => {
            // whoever asks next finds it
            tokio::spawn(async move { interest.computation.finished().await });
            None
        }
    }
}
