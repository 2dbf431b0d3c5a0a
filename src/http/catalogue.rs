//! The catalogue of what clients can use: presets, operators, formats, readers, and the limits.

use axum::Json;
use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

use super::app::SharedApp;
use super::problem::{self, Problem};
use super::segment::PathSegment;
use crate::config::Setting;
use crate::fault::{did_you_mean, shortened};
use crate::wire::catalogue::{self, FormatEntry, OperatorEntry, PresetEntry, ReaderEntry};

/// All presets.
#[utoipa::path(
    get, path = "/v1/presets", tag = "catalogue",
    responses((status = 200, description = "The presets", body = Vec<PresetEntry>,
        example = json!(&catalogue::presets()[..1])))
)]
pub(super) async fn presets() -> Json<Vec<PresetEntry>> {
    Json(catalogue::presets())
}

/// One preset.
#[utoipa::path(
    get, path = "/v1/presets/{name}", tag = "catalogue",
    params(("name" = String, Path, description = "Name of the preset", example = json!(catalogue::presets()[0].name))),
    responses((status = 200, description = "The preset", body = PresetEntry))
)]
pub(super) async fn preset(PathSegment(name): PathSegment) -> Result<Json<PresetEntry>, Problem> {
    let presets = catalogue::presets();
    let meant = did_you_mean(&name, presets.iter().map(|preset| preset.name));
    let found = presets.into_iter().find(|preset| preset.name == name);
    found.map(Json).ok_or_else(|| unknown("preset", &name, &meant, "/v1/presets"))
}

/// All operators.
#[utoipa::path(
    get, path = "/v1/operators", tag = "catalogue",
    responses((status = 200, description = "The operators", body = Vec<OperatorEntry>,
        example = json!(&catalogue::operators()[..1])))
)]
pub(super) async fn operators() -> Json<Vec<OperatorEntry>> {
    Json(catalogue::operators())
}

/// One operator.
#[utoipa::path(
    get, path = "/v1/operators/{letter}", tag = "catalogue",
    params(("letter" = String, Path, description = "Letter of the operator", example = "U")),
    responses((status = 200, description = "The operator", body = OperatorEntry))
)]
pub(super) async fn operator(PathSegment(letter): PathSegment) -> Result<Json<OperatorEntry>, Problem> {
    let found = catalogue::operators().into_iter().find(|operator| letter == operator.letter.to_string());
    found.map(Json).ok_or_else(|| unknown("operator", &letter, "", "/v1/operators"))
}

/// All formats.
#[utoipa::path(
    get, path = "/v1/formats", tag = "catalogue",
    responses((status = 200, description = "The formats", body = Vec<FormatEntry>,
        example = json!(&catalogue::formats()[..1])))
)]
pub(super) async fn formats() -> Json<Vec<FormatEntry>> {
    Json(catalogue::formats())
}

/// All readers of mesh files.
#[utoipa::path(
    get, path = "/v1/readers", tag = "catalogue",
    responses((status = 200, description = "The readers", body = Vec<ReaderEntry>,
        example = json!(&catalogue::readers()[..1])))
)]
pub(super) async fn readers() -> Json<Vec<ReaderEntry>> {
    Json(catalogue::readers())
}

/// One limit.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub(super) struct LimitEntry {
    /// Its name; that of a setting, where it is one.
    name: &'static str,
    /// Its value.
    value: u64,
    /// What it counts.
    unit: &'static str,
    /// What it bounds.
    doc: String,
}

/// The limits of this server.
#[utoipa::path(
    get, path = "/v1/limits", tag = "operations",
    responses((status = 200, description = "The limits", body = Vec<LimitEntry>,
        example = json!([{ "name": "max_levels", "value": 64, "unit": "levels", "doc": "Most levels of any plan." }])))
)]
pub(super) async fn limits(State(app): State<SharedApp>) -> Json<Vec<LimitEntry>> {
    let fixed = [
        ("max_levels", u64::from(crate::scheme::plan::MAX_PLAN_LEVELS), "levels", "Most levels of any plan."),
        (
            "max_word_letters",
            crate::scheme::word::MAX_LETTERS as u64,
            "letters",
            "Most letters of a word, powers written out.",
        ),
        ("max_expression_bytes", crate::math::expression::MAX_EXPRESSION_BYTES as u64, "bytes", "Longest expression."),
        ("max_outputs", crate::wire::output::MAX_OUTPUTS as u64, "outputs", "Most outputs of one job."),
        ("max_polygons", crate::wire::polygon::MAX_POLYGONS as u64, "polygons", "Most polygons of one job."),
        (
            "max_wait_s",
            super::negotiate::MAX_GRANTED_WAIT.as_secs(),
            "seconds",
            "Longest wait that `Prefer` is granted.",
        ),
    ];
    let fixed = fixed.map(|(name, value, unit, doc)| LimitEntry { name, value, unit, doc: doc.to_owned() });
    let settings = app.settings.list().into_iter().filter_map(|Setting { name, value, unit, doc, .. }| {
        let value = value.parse().ok()?;
        Some(LimitEntry { name, value, unit, doc })
    });
    Json(settings.chain(fixed).collect())
}

fn unknown(kind: &str, name: &str, meant: &str, list: &str) -> Problem {
    Problem::new(problem::NOT_FOUND, format!("there is no {kind} \"{}\"; {meant}{list} lists them", shortened(name)))
}
