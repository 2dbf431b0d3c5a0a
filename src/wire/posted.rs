//! What may be posted as a job.

use serde::Deserialize;
use serde_json::value::RawValue;
use utoipa::ToSchema;

use super::analysis::AnalysisRequest;
use super::job::JobRequest;
use super::object;

/// A job: a render, or an analysis.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(untagged)]
pub enum PostedJob {
    /// What is refined, how, how often, and what is answered.
    Render(Box<JobRequest>),
    /// What is asked about a plan.
    Analysis(Box<AnalysisJob>),
}

/// An analysis as a job; its result is one JSON document, as POST /v1/analyses answers it.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AnalysisJob {
    /// The question.
    #[serde(deserialize_with = "object::one")]
    #[schema(value_type = AnalysisRequest)]
    pub analysis: AnalysisRequest,
}

/// The id of the upload that a job names; what is no JSON names none.
pub fn upload_of(body: &[u8]) -> Option<String> {
    #[derive(Deserialize)]
    struct Peek {
        input: Option<PeekInput>,
    }
    #[derive(Deserialize)]
    struct PeekInput {
        blob: Option<String>,
    }
    let names_it = body.windows(6).any(|word| word == b"\"blob\"");
    let peek: Peek = if names_it { serde_json::from_slice(body).ok()? } else { return None };
    peek.input?.blob
}

/// Whether a body asks for an analysis; what is no JSON asks for nothing.
pub fn asks_for_analysis(body: &[u8]) -> bool {
    #[derive(Deserialize)]
    struct Peek<'a> {
        #[serde(borrow)]
        analysis: Option<&'a RawValue>,
    }
    let names_it = body.windows(10).any(|word| word == b"\"analysis\"");
    names_it && serde_json::from_slice::<Peek<'_>>(body).is_ok_and(|peek| peek.analysis.is_some())
}
