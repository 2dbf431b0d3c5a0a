//! The OpenAPI document: the descriptions at the handlers, and the parts that they have in common.

use axum::http::Method;
use utoipa::OpenApi;
use utoipa::openapi::path::Operation;
use utoipa::openapi::schema::SchemaType;
use utoipa::openapi::security::{HttpAuthScheme, HttpBuilder, SecurityRequirement, SecurityScheme};
use utoipa::openapi::server::ServerBuilder;
use utoipa::openapi::{
    Content, ContentBuilder, Header, HeaderBuilder, KnownFormat, ObjectBuilder, OpenApi as Api, Ref, RefOr, Required,
    Response, ResponseBuilder, SchemaFormat, Type,
};

use super::document_examples;
use super::gate::{Need, needed};
use super::problem::{self, ProblemKind};
use crate::config::keys::KeyRole;
use crate::input::READERS;
use crate::output::{self, FORMATS};
use crate::wire::answer::ProblemAnswer;
use crate::wire::query_parameters;

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
pub(super) struct ApiDocument;

/// Headers of answers, with their descriptions.
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
    (
        "Content-Encoding",
        "`zstd`, `br` or `gzip`, where `Accept-Encoding` asks for it and it spares an eighth at least",
    ),
    ("Vary", "`Accept` and `Accept-Encoding`"),
    ("Location", "The job's address"),
    ("Retry-After", "Seconds after which to ask again"),
    ("Preference-Applied", "The wait that was granted"),
];

const RESULT_HEADERS: &[&str] =
    &["ETag", "Content-Location", "Cache-Status", "Server-Timing", "Planish-Warnings", "Content-Encoding", "Vary"];
const KEPT_HEADERS: &[&str] = &["Cache-Control", "Accept-Ranges"];
/// Problems that every address may answer.
const COMMON_PROBLEMS: &[ProblemKind] = &[
    problem::NOT_HTTP,
    problem::BAD_HOST,
    problem::HOST,
    problem::URI_TOO_LONG,
    problem::HEAD_TOO_LONG,
    problem::INTERNAL,
    problem::BUSY,
];
/// Problems of bodies, and of the jobs in them.
const BODY_PROBLEMS: &[ProblemKind] = &[
    problem::NOT_JSON,
    problem::NOT_CODED,
    problem::BROKEN_OFF,
    problem::SLOW,
    problem::BODY_TOO_LONG,
    problem::MEDIA_TYPE,
    problem::CODING,
    problem::INVALID,
    problem::TRANSFER_CODING,
];
/// Problems of jobs that are forecast.
const FORECAST_PROBLEMS: &[ProblemKind] = &[problem::TOO_LARGE, problem::TIMED_OUT];
/// Problems of jobs that are computed.
const COMPUTING_PROBLEMS: &[ProblemKind] = &[problem::INVALID, problem::GONE, problem::CANCELLED];

/// Adds to every operation what the handlers need not repeat.
pub(super) fn completed(mut document: Api) -> Api {
    document.servers = Some(vec![ServerBuilder::new().url("/").description(Some("This server")).build()]);
    // a key is optional, as servers may have none
    let key =
        SecurityScheme::Http(HttpBuilder::new().scheme(HttpAuthScheme::Bearer).bearer_format("planish_...").build());
    document.components.get_or_insert_default().add_security_scheme("key", key);
    document.security =
        Some(vec![SecurityRequirement::default(), SecurityRequirement::new("key", Vec::<String>::new())]);
    for (path, item) in &mut document.paths.paths {
        let methods =
            [(Method::GET, &mut item.get), (Method::POST, &mut item.post), (Method::DELETE, &mut item.delete)];
        for (method, operation) in methods {
            let Some(operation) = operation else { continue };
            complete(path, operation);
            let_in(&method, path, operation);
        }
        let is_bytes =
            ["/v1/artifacts/", "/v1/blobs/", "/kroki/", "/v1/r/"].iter().any(|start| path.starts_with(start));
        let is_bytes = is_bytes && !path.ends_with("/events");
        if is_bytes || path == "/v1/render" || path.ends_with("/archive.zip") {
            item.head = item.get.as_ref().map(head);
        }
    }
    document
}

/// Adds the problems of requests without a sufficient key, or in too great a number.
fn let_in(method: &Method, path: &str, operation: &mut Operation) {
    match needed(method, path) {
        Need::Nothing => operation.security = Some(Vec::new()),
        Need::Role(KeyRole::Render) => refuse(operation, &[problem::UNAUTHORIZED, problem::FORBIDDEN, problem::QUOTA]),
        Need::Role(_) => refuse(operation, &[problem::UNAUTHORIZED, problem::FORBIDDEN]),
        Need::Signature { works } => {
            operation.security = Some(Vec::new());
            refuse(operation, &[problem::BAD_LINK]);
            if works {
                refuse(operation, &[problem::QUOTA]);
            }
        }
    }
}

fn complete(path: &str, operation: &mut Operation) {
    refuse(operation, COMMON_PROBLEMS);
    if let Some(RefOr::T(body)) = &mut operation.request_body {
        body.required = Some(Required::True);
        let jobs = body.content.iter_mut().filter(|(media_type, _)| *media_type == "application/json");
        for (_, content) in jobs {
            if let RefOr::T(content) = content {
                content.examples = match path {
                    "/v1/analyses" => document_examples::analyses(),
                    "/v1/batches" => document_examples::batches(),
                    "/v1/compare" => document_examples::comparisons(),
                    "/v1/evaluate" => document_examples::evaluations(),
                    _ => document_examples::jobs(),
                };
            }
        }
        refuse(operation, BODY_PROBLEMS);
    }
    if path.contains('{') {
        refuse(operation, &[problem::NOT_FOUND]);
    }
    match path {
        "/v1/render"
        | "/kroki/{format}/{data}"
        | "/v1/r/{signature}/{expiry}/{job}"
        | "/v1/r/{signature}/{expiry}/{job}/{file}"
            if operation.request_body.is_none() =>
        {
            bytes(operation, "200", &[RESULT_HEADERS, KEPT_HEADERS].concat());
            headers(operation, "304", &["ETag", "Content-Location", "Cache-Status", "Cache-Control", "Vary"]);
            refuse(
                operation,
                &[problem::NOT_JSON, problem::BODY_TOO_LONG, problem::NOT_ACCEPTABLE, problem::UNFINISHED],
            );
            refuse(operation, FORECAST_PROBLEMS);
            refuse(operation, COMPUTING_PROBLEMS);
        }
        "/v1/render" => {
            files(operation);
            operation
                .parameters
                .get_or_insert_default()
                .extend(query_parameters::described().into_iter().map(RefOr::T));
            bytes(operation, "200", &[RESULT_HEADERS, &["Accept-Ranges"]].concat());
            headers(operation, "202", &["Location", "Retry-After", "Preference-Applied"]);
            headers(operation, "304", &["ETag", "Content-Location", "Cache-Status", "Vary"]);
            refuse(operation, FORECAST_PROBLEMS);
            refuse(operation, COMPUTING_PROBLEMS);
            refuse(operation, &[problem::NOT_ACCEPTABLE, problem::UNWRITTEN]);
        }
        "/v1/estimate" => refuse(operation, FORECAST_PROBLEMS),
        "/v1/compare" => {
            headers(operation, "200", &["Cache-Status"]);
            refuse(operation, FORECAST_PROBLEMS);
            refuse(operation, COMPUTING_PROBLEMS);
        }
        "/v1/analyses" | "/v1/evaluate" => {
            headers(operation, "200", RESULT_HEADERS);
            headers(operation, "304", &["ETag", "Content-Location", "Vary"]);
            let analysed: &[_] = &[problem::TIMED_OUT, problem::NOT_ACCEPTABLE];
            refuse(operation, if path == "/v1/evaluate" { FORECAST_PROBLEMS } else { analysed });
            refuse(operation, COMPUTING_PROBLEMS);
        }
        path if path.contains("/artifacts/") => {
            bytes(operation, "200", &[RESULT_HEADERS, KEPT_HEADERS].concat());
            bytes(operation, "206", &[RESULT_HEADERS, KEPT_HEADERS, &["Content-Range"]].concat());
            headers(operation, "304", &[RESULT_HEADERS, KEPT_HEADERS].concat());
            refuse(operation, FORECAST_PROBLEMS);
            refuse(operation, COMPUTING_PROBLEMS);
            refuse(operation, &[problem::RANGE]);
        }
        "/v1/jobs" | "/v1/batches" if operation.request_body.is_some() => {
            headers(operation, "200", &["Location", "Preference-Applied"]);
            headers(operation, "202", &["Location", "Retry-After", "Preference-Applied"]);
            refuse(operation, FORECAST_PROBLEMS);
            refuse(operation, &[problem::NOT_ACCEPTABLE, problem::UNWRITTEN]);
        }
        "/v1/jobs" | "/v1/batches" => refuse(operation, &[problem::INVALID]),
        path if path.ends_with("/archive.zip") => {
            headers(operation, "200", &["ETag", "Cache-Control"]);
            headers(operation, "304", &["ETag", "Cache-Control"]);
            refuse(operation, &[problem::UNFINISHED]);
        }
        "/v1/blobs" => {
            files(operation);
            headers(operation, "201", &["Location"]);
            refuse(operation, &[problem::UNWRITTEN]);
        }
        path if path.starts_with("/v1/blobs/") => {
            headers(operation, "200", &["ETag", "Cache-Control"]);
            headers(operation, "304", &["ETag", "Cache-Control"]);
        }
        path if path.starts_with("/v1/jobs/") || path.starts_with("/v1/batches/") => {
            headers(operation, "200", &["Cache-Control", "Retry-After"]);
        }
        "/readyz" => refuse(operation, &[problem::NOT_READY]),
        _ => {}
    }
}

/// Adds the media types of mesh files to a body: those of the readers, and one for files that show their format by
/// their first bytes.
fn files(operation: &mut Operation) {
    let Some(RefOr::T(body)) = &mut operation.request_body else { return };
    for media_type in READERS.iter().map(|reader| reader.media_type).chain(["application/octet-stream"]) {
        body.content.entry(media_type.to_owned()).or_insert_with(|| RefOr::T(content(output::Content::Binary)));
    }
}

/// Returns the operation as HEAD: the same headers, no content.
fn head(get: &Operation) -> Operation {
    let mut head = get.clone();
    head.operation_id = head.operation_id.map(|id| format!("{id}_head"));
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

/// Returns the answer with a status, if the handler describes one.
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

/// Describes an answer that carries an artifact: bytes of any format, with these headers.
fn bytes(operation: &mut Operation, status: &str, names: &[&str]) {
    headers(operation, status, names);
    let Some(response) = answer(operation, status) else { return };
    // generated clients take the first media type as the answer's type, and bytes fit every format
    let kinds = [output::Content::Binary, output::Content::Packed, output::Content::Text, output::Content::Json];
    for kind in kinds {
        for format in FORMATS.iter().filter(|format| format.facts().content == kind) {
            response.content.insert(format.media_type().to_owned(), RefOr::T(content(kind)));
        }
    }
}

/// Returns the schema of content: an object for JSON, a string for text. OpenAPI 3.1 has no schema for other bytes,
/// which generators know as format `binary`.
fn content(bytes: output::Content) -> Content {
    let of = |kind| ObjectBuilder::new().schema_type(SchemaType::new(kind));
    let schema = match bytes {
        output::Content::Json => of(Type::Object),
        output::Content::Text => of(Type::String),
        output::Content::Binary | output::Content::Packed => {
            of(Type::String).format(Some(SchemaFormat::KnownFormat(KnownFormat::Binary)))
        }
    };
    ContentBuilder::new().schema(Some(schema)).build()
}

fn refused() -> Content {
    ContentBuilder::new().schema(Some(Ref::from_schema_name("ProblemAnswer"))).build()
}

/// Adds problems to an operation; those with the same status share an entry.
fn refuse(operation: &mut Operation, kinds: &[ProblemKind]) {
    for kind in kinds {
        let status = kind.status.as_u16().to_string();
        let text = format!("{} (`{}`)", kind.title, kind.slug);
        let before = answer(operation, &status).map(|response| response.description.clone());
        let description = before.map_or(text.clone(), |before| format!("{before}; {text}"));
        let mut response =
            ResponseBuilder::new().description(description).content("application/problem+json", refused());
        if [problem::BUSY.slug, problem::QUOTA.slug].contains(&kind.slug) {
            response = response.header("Retry-After", header("Seconds after which to ask again"));
        }
        operation.responses.responses.insert(status, RefOr::T(response.build()));
    }
}
