//! Pages for people and tools: the OpenAPI document, the reference, and the kinds of problems.

use std::sync::OnceLock;

use axum::extract::State;
use axum::http::header;
use axum::response::{Html, IntoResponse, Response};
use quick_xml::escape::escape;

use super::app::SharedApp;
use super::problem::{self, KINDS, Problem};
use super::reference;
use super::segment::PathSegment;
use crate::fault::shortened;

/// The OpenAPI 3.1 document of this interface.
#[utoipa::path(
    get, path = "/openapi.json", tag = "operations",
    responses((status = 200, description = "This document", body = Object, content_type = "application/json",
        example = json!({ "openapi": "3.1.0" })))
)]
pub(super) async fn openapi(State(app): State<SharedApp>) -> Response {
    ([(header::CONTENT_TYPE, "application/json")], app.openapi.clone()).into_response()
}

/// The reference: this document for people to read. The page needs nothing from elsewhere and runs no scripts.
#[utoipa::path(
    get, path = "/docs", tag = "operations",
    responses((status = 200, description = "A page", body = String, content_type = "text/html",
        example = "<!doctype html>"))
)]
pub(super) async fn docs(State(app): State<SharedApp>) -> Response {
    // the document does not change while the process lives
    static REFERENCE_PAGE: OnceLock<String> = OnceLock::new();
    let written = || reference::page(&serde_json::from_str(&app.openapi).unwrap_or_default());
    let policy = [(header::CONTENT_SECURITY_POLICY, reference::policy())];
    (policy, Html(REFERENCE_PAGE.get_or_init(written).clone())).into_response()
}

/// What a kind of problem means.
#[utoipa::path(
    get, path = "/docs/problems/{kind}", tag = "operations",
    params(("kind" = String, Path, description = "The last part of a problem's type", example = "too-large")),
    responses((status = 200, description = "A page", body = String, content_type = "text/html"))
)]
pub(super) async fn problem(PathSegment(kind): PathSegment) -> Result<Html<String>, Problem> {
    let unknown = || format!("there is no kind of problem \"{}\"", shortened(&kind));
    let found = KINDS.iter().find(|known| known.slug == kind);
    let kind = found.ok_or_else(|| Problem::new(problem::NOT_FOUND, unknown()))?;
    let doc = escape(kind.doc);
    Ok(page(kind.title, &format!("<p>Status {}</p><p>{doc}</p>", kind.status.as_u16())))
}

fn page(title: &str, content: &str) -> Html<String> {
    Html(format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>{title}</title><style>body{{font:16px/1.5 \
         system-ui,sans-serif;max-width:40rem;margin:3rem auto;padding:0 1rem}}</style>\
         <h1>{title}</h1>{content}</html>\n"
    ))
}
