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

/// An upload that a job names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedUpload {
    /// The panel of the figure that names it; none where the job itself does.
    pub panel: Option<usize>,
    /// Its id.
    pub id: String,
}

impl NamedUpload {
    /// JSON pointer to the name.
    pub fn pointer(&self) -> String {
        self.panel.map_or_else(|| "/input/blob".to_owned(), |at| format!("/figure/panels/{at}/job/input/blob"))
    }
}

/// The uploads that a job names; what is no JSON names none.
pub fn uploads_of(body: &[u8]) -> Vec<NamedUpload> {
    #[derive(Deserialize)]
    struct Peek {
        input: Option<PeekInput>,
        figure: Option<PeekFigure>,
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
    }
    let names_one = body.windows(6).any(|word| word == b"\"blob\"");
    let peek = if names_one { serde_json::from_slice(body).ok() } else { None };
    let Some(Peek { input, figure }) = peek else { return Vec::new() };
    let id = |input: Option<PeekInput>| input.and_then(|input| input.blob);
    let panels = figure.into_iter().flat_map(|figure| figure.panels).enumerate();
    let panels = panels.map(|(at, panel)| (Some(at), id(panel.job.input)));
    let all = std::iter::once((None, id(input))).chain(panels);
    all.filter_map(|(panel, id)| Some(NamedUpload { panel, id: id? })).collect()
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
