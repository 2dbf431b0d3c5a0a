//! The OpenAPI document: what the handlers say of themselves, and what they have in common.

use utoipa::OpenApi;
use utoipa::openapi::path::Operation;
use utoipa::openapi::schema::SchemaType;
use utoipa::openapi::{
    Content, ContentBuilder, Header, HeaderBuilder, ObjectBuilder, OpenApi as Api, Ref, RefOr, Response,
    ResponseBuilder, Type,
};

use super::problem::{self, Kind};
use crate::output::{self, FORMATS};
use crate::wire::answer::ProblemAnswer;

/// The document but for its paths.
#[derive(OpenApi)]
#[openapi(
    info(
        title = "planish",
        description = "Refines control polygons and control meshes by subdivision and answers with meshes and \
            pictures. \
                       Whatever cannot be done is answered by a problem (RFC 9457) that says why and what to do.",
        license(name = "MIT OR Apache-2.0", identifier = "MIT OR Apache-2.0")
    ),
    components(schemas(ProblemAnswer)),
    tags(
        (name = "jobs", description = "Render, and follow what takes longer."),
        (name = "questions", description = "Ask before you render."),
        (name = "catalogue", description = "What can be asked for."),
        (name = "operations", description = "Health, limits and documents.")
    )
)]
pub(super) struct Document;

/// Headers of answers, and what they say.
const HEADERS: &[(&str, &str)] = &[
    ("ETag", "The artifact's key in quotes: a strong validator"),
    ("Content-Location", "The artifact's address, for GET"),
    ("Cache-Status", "`planish; hit`, `planish; fwd=miss; stored` or `planish; fwd=miss; collapsed` (RFC 9211)"),
    (
        "Server-Timing",
        "Milliseconds by stage: queue, refine (described as `sweep` where patches were refined), render, encode",
    ),
    ("Planish-Warnings", "What was repaired or is worth knowing, as quoted texts"),
    ("Cache-Control", "Artifacts never change"),
    ("Accept-Ranges", "`bytes`"),
    ("Content-Range", "Which bytes of how many"),
    ("Location", "The job's address"),
    ("Retry-After", "Seconds after which to ask again"),
    ("Preference-Applied", "The wait that was granted"),
];

const RESULT: &[&str] = &["ETag", "Content-Location", "Cache-Status", "Server-Timing", "Planish-Warnings"];
const KEPT: &[&str] = &["Cache-Control", "Accept-Ranges"];
const QUESTION: &[Kind] =
    &[problem::NOT_JSON, problem::SLOW, problem::BODY_TOO_LONG, problem::MEDIA_TYPE, problem::INVALID];

/// Adds to every operation what the handlers need not repeat.
pub(super) fn completed(mut document: Api) -> Api {
    for (path, item) in &mut document.paths.paths {
        for operation in [&mut item.get, &mut item.post, &mut item.delete].into_iter().flatten() {
            complete(path, operation);
        }
        if path.starts_with("/v1/artifacts/") {
            item.head = item.get.as_ref().map(head);
        }
    }
    document
}

fn complete(path: &str, operation: &mut Operation) {
    match path {
        "/v1/render" => {
            bytes(operation, "200", &[RESULT, &["Accept-Ranges"]].concat());
            headers(operation, "202", &["Location", "Retry-After", "Preference-Applied"]);
            headers(operation, "304", &["ETag", "Content-Location", "Cache-Status"]);
            refuse(operation, QUESTION);
            let own = [problem::TOO_LARGE, problem::TIMED_OUT, problem::NOT_ACCEPTABLE, problem::GONE];
            refuse(operation, &own);
            refuse(operation, &[problem::CANCELLED, problem::BUSY, problem::INTERNAL]);
        }
        "/v1/estimate" => {
            refuse(operation, QUESTION);
            refuse(operation, &[problem::TOO_LARGE, problem::BUSY]);
        }
        "/v1/validate" => refuse(operation, QUESTION),
        "/v1/analyses" => {
            headers(operation, "200", RESULT);
            headers(operation, "304", &["ETag", "Content-Location"]);
            refuse(operation, QUESTION);
            refuse(
                operation,
                &[problem::TIMED_OUT, problem::GONE, problem::CANCELLED, problem::BUSY, problem::INTERNAL],
            );
        }
        path if path.starts_with("/v1/artifacts/") => {
            bytes(operation, "200", &[RESULT, KEPT].concat());
            bytes(operation, "206", &[RESULT, KEPT, &["Content-Range"]].concat());
            headers(operation, "304", &[RESULT, KEPT].concat());
            refuse(operation, &[problem::NOT_FOUND, problem::GONE, problem::RANGE, problem::BUSY, problem::INTERNAL]);
        }
        "/readyz" => refuse(operation, &[problem::NOT_READY]),
        path if path.contains('{') => refuse(operation, &[problem::NOT_FOUND]),
        _ => {}
    }
    if path.starts_with("/v1/jobs/") {
        headers(operation, "200", &["Cache-Control", "Retry-After"]);
    }
    refuse(operation, &[problem::HOST]);
    let other = ResponseBuilder::new().description("Any other problem").content("application/problem+json", refused());
    operation.responses.responses.insert("default".to_owned(), other.into());
}

/// The operation as HEAD: the same headers, no content.
fn head(get: &Operation) -> Operation {
    let mut head = get.clone();
    head.operation_id = Some("artifact_head".to_owned());
    head.summary = Some("What GET would answer, without the bytes.".to_owned());
    head.responses.responses.remove("206");
    head.responses.responses.remove("416");
    for response in head.responses.responses.values_mut() {
        if let RefOr::T(response) = response {
            response.content.clear();
        }
    }
    head
}

/// The answer of a status, if the handler named it.
fn answer<'a>(operation: &'a mut Operation, status: &str) -> Option<&'a mut Response> {
    match operation.responses.responses.get_mut(status)? {
        RefOr::T(response) => Some(response),
        RefOr::Ref(_) => None,
    }
}

fn headers(operation: &mut Operation, status: &str, names: &[&str]) {
    let Some(response) = answer(operation, status) else { return };
    for (name, doc) in HEADERS.iter().filter(|(name, _)| names.contains(name)) {
        response.headers.insert((*name).to_owned(), RefOr::T(header(doc)));
    }
}

fn header(doc: &str) -> Header {
    let text = ObjectBuilder::new().schema_type(SchemaType::new(Type::String));
    HeaderBuilder::new().schema(Some(text)).description(Some(doc)).build()
}

/// An answer that carries an artifact: bytes of any format, with these headers.
fn bytes(operation: &mut Operation, status: &str, names: &[&str]) {
    headers(operation, status, names);
    let Some(response) = answer(operation, status) else { return };
    for format in FORMATS {
        response.content.insert(format.media_type().to_owned(), RefOr::T(content(format.facts().content)));
    }
}

/// JSON is an object, text a string; of other bytes OpenAPI 3.1 says nothing.
fn content(bytes: output::Content) -> Content {
    let of = |kind| ObjectBuilder::new().schema_type(SchemaType::new(kind));
    match bytes {
        output::Content::Json => ContentBuilder::new().schema(Some(of(Type::Object))).build(),
        output::Content::Text => ContentBuilder::new().schema(Some(of(Type::String))).build(),
        output::Content::Binary => ContentBuilder::new().build(),
    }
}

fn refused() -> Content {
    ContentBuilder::new().schema(Some(Ref::from_schema_name("ProblemAnswer"))).build()
}

/// Adds problems; those of the same status share an entry.
fn refuse(operation: &mut Operation, kinds: &[Kind]) {
    for kind in kinds {
        let status = kind.status.as_u16().to_string();
        let text = format!("{} (`{}`)", kind.title, kind.slug);
        let before = answer(operation, &status).map(|response| response.description.clone());
        let description = before.map_or(text.clone(), |before| format!("{before}; {text}"));
        let mut response =
            ResponseBuilder::new().description(description).content("application/problem+json", refused());
        if kind.slug == problem::BUSY.slug {
            response = response.header("Retry-After", header("Seconds after which to ask again"));
        }
        operation.responses.responses.insert(status, RefOr::T(response.build()));
    }
}
