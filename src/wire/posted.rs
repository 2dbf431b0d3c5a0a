//! The requests that can be posted as jobs.

use serde::Deserialize;
use serde_json::value::RawValue;
use utoipa::ToSchema;

use super::analysis::AnalysisRequest;
use super::job::JobRequest;
use super::object;
use super::place::InputPlace;

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

/// An upload that a job names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedUpload {
    /// The input that names the upload.
    pub place: InputPlace,
    /// The id of the upload.
    pub id: String,
}

impl NamedUpload {
    /// Returns the JSON pointer to the id.
    pub fn pointer(&self) -> String {
        format!("{}/blob", self.place.pointer())
    }
}

/// Returns the uploads that a job names; none if the body is not JSON.
pub fn uploads_of(body: &[u8]) -> Vec<NamedUpload> {
    #[derive(Deserialize)]
    struct PeekPosted {
        figure: Option<PeekFigure>,
        #[serde(flatten)]
        job: PeekJob,
    }
    #[derive(Deserialize)]
    struct PeekInput {
        blob: Option<String>,
    }
    #[derive(Deserialize)]
    struct PeekFigure {
        panels: Vec<PeekPanel>,
    }
    #[derive(Deserialize)]
    struct PeekPanel {
        job: PeekJob,
    }
    #[derive(Deserialize)]
    struct PeekJob {
        input: Option<PeekInput>,
        distance_to: Option<PeekOther>,
    }
    #[derive(Deserialize)]
    struct PeekOther {
        input: Option<PeekInput>,
    }
    let names_one = body.windows(6).any(|word| word == b"\"blob\"");
    let peek = if names_one { serde_json::from_slice(body).ok() } else { None };
    let Some(PeekPosted { job, figure }) = peek else { return Vec::new() };
    let panels = figure.into_iter().flat_map(|figure| figure.panels).enumerate();
    let jobs = std::iter::once((None, job)).chain(panels.map(|(at, panel)| (Some(at), panel.job)));
    let mut all = Vec::new();
    for (panel, PeekJob { input, distance_to }) in jobs {
        let inputs = [(false, input), (true, distance_to.and_then(|other| other.input))];
        all.extend(inputs.into_iter().filter_map(|(is_other, input)| {
            Some(NamedUpload { place: InputPlace { panel, is_other }, id: input?.blob? })
        }));
    }
    all
}

/// Whether a body requests an analysis; false if it is not JSON.
pub fn asks_for_analysis(body: &[u8]) -> bool {
    #[derive(Deserialize)]
    struct PeekAnalysis<'a> {
        #[serde(borrow)]
        analysis: Option<&'a RawValue>,
    }
    let names_it = body.windows(10).any(|word| word == b"\"analysis\"");
    names_it && serde_json::from_slice::<PeekAnalysis<'_>>(body).is_ok_and(|peek| peek.analysis.is_some())
}
