//! GET /v1/render and GET /kroki/{format}/{data}: jobs in addresses, for images in pages and model loaders, which
//! cannot send POST.

use std::io::Read;
use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::{Path, RawQuery, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, Uri, header};
use axum::response::Response;
use base64::Engine;
use base64::alphabet::URL_SAFE;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use flate2::read::ZlibDecoder;

use super::address::MAX_LINK_BYTES;
use super::app::{App, SharedApp};
use super::body::Sent;
use super::client::Client;
use super::problem::{self, Problem};
use super::render::{ResultRequest, rendered};
use super::{memo, streaming};
use crate::fault::{Fault, shortened};
use crate::output::{self, FORMATS};
use crate::wire::query::refuse_parameters;

/// Maximum length of a job in an address, inflated, in bytes, which is a promise of the interface. Half of it refuses
/// meshes that still fit into an address; twice of it lets an address hold twice as much uncharged memory.
pub(crate) const MAX_JOB_BYTES: usize = 64 << 10;
/// Maximum time for which caches may store the result of an address. The job determines the result, but a new version
/// of planish may change it: with a day, pages see that the next day, and repeated requests until then cost nothing;
/// half or twice of it changes only that time.
const CACHE_CONTROL: &str = "public, max-age=86400";
/// Base64url, with or without padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &URL_SAFE,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Renders the job that stands in the address, and answers with the bytes, as POST does with the same job.
///
/// `job` is base64url (RFC 4648, 5) of the job's JSON, as it is or compressed by zlib: at most 8 KiB of address and
/// 64 KiB of JSON. A result that is not there in time is answered 503, and is kept for whoever asks again.
#[utoipa::path(
    get, path = "/v1/render", tag = "jobs",
    params(
        ("job" = String, Query, description = "The job as JSON, perhaps compressed by zlib, in base64url",
            example = "eyJpbnB1dCI6eyJwb2x5Z29uIjp7InBvaW50cyI6W1swLDBdLFsxLDBdLFsxLDFdXSwiY2xvc2VkIjp0cnVlfX0sIn\
                BsYW4iOnsicHJlc2V0IjoiY2hhaWtpbiJ9LCJsZXZlbHMiOjIsIm91dHB1dHMiOlt7ImZvcm1hdCI6InN2ZyJ9XX0"),
        ("keep" = Option<bool>, Query,
            description = "`true` keeps the result even where it has more than `keep_at_most_bytes`"),
        ("If-None-Match" = Option<String>, Header, description = "ETags of results that the client has"),
    ),
    responses(
        (status = 200, description = "The bytes of the result, in the format that `outputs` or `Accept` asks for"),
        (status = 304, description = "The client has it already (`If-None-Match`)"),
    )
)]
pub(super) async fn link(
    State(app): State<SharedApp>,
    client: Client,
    headers: HeaderMap,
    uri: Uri,
    RawQuery(query): RawQuery,
) -> Result<Response, Problem> {
    let at = "?job";
    let query = query.unwrap_or_default();
    let given = form_urlencoded::parse(query.as_bytes()).find(|(name, _)| name == "job").map(|(_, job)| job);
    let job = given.ok_or_else(|| {
        let detail = "the address says no job; give its JSON in base64url, as it is or compressed by zlib, or POST it";
        Problem::invalid(vec![Fault::new(at, detail)])
    })?;
    refuse_parameters(&query, &["job", "keep"]).map_err(Problem::invalid)?;
    let wanted = wanted_by((&client, &headers), &uri, &job, at)?;
    let keep = streaming::asks_to_keep(Some(&query))?;
    respond(&app, &client, &headers, ResultRequest { keep, ..wanted }).await
}

/// Renders a job as Kroki's clients ask for it: the format in the address, and behind it the job without `outputs`,
/// compressed by zlib, in base64url.
#[utoipa::path(
    get, path = "/kroki/{format}/{data}", tag = "jobs",
    params(
        ("format" = String, Path, description = "The name of a format, see /v1/formats", example = "svg"),
        ("data" = String, Path, description = "The job without `outputs`, as `job` of GET /v1/render",
            example = "eyJpbnB1dCI6eyJwb2x5Z29uIjp7InBvaW50cyI6W1swLDBdLFsxLDBdLFsxLDFdXSwiY2xvc2VkIjp0cnVlfX0sIn\
                BsYW4iOnsicHJlc2V0IjoiY2hhaWtpbiJ9LCJsZXZlbHMiOjJ9"),
        ("If-None-Match" = Option<String>, Header, description = "ETags of results that the client has"),
    ),
    responses(
        (status = 200, description = "The bytes of the result"),
        (status = 304, description = "The client has it already (`If-None-Match`)"),
    )
)]
pub(super) async fn kroki(
    State(app): State<SharedApp>,
    client: Client,
    headers: HeaderMap,
    uri: Uri,
    path: Result<Path<(String, String)>, axum::extract::rejection::PathRejection>,
) -> Result<Response, Problem> {
    let unknown = |detail: String| Problem::new(problem::NOT_FOUND, detail);
    let Path((name, data)) = path.map_err(|_| unknown("the address is no text in UTF-8".to_owned()))?;
    let format = output::named(&name).ok_or_else(|| {
        let known: Vec<&str> = FORMATS.iter().map(|format| format.name()).collect();
        unknown(format!("there is no format \"{}\"; known are {}", shortened(&name), known.join(", ")))
    })?;
    let wanted = wanted_by((&client, &headers), &uri, &data, "")?;
    let sent = wanted.sent.drawn(format);
    respond(&app, &client, &headers, ResultRequest { sent, ..wanted }).await
}

/// Decodes the job of an address; `at` is its place in the request, for faults.
fn wanted_by(
    (client, headers): (&Client, &HeaderMap),
    address: &Uri,
    job: &str,
    at: &str,
) -> Result<ResultRequest, Problem> {
    check_length(address)?;
    let sent = Sent::job(decoded(job, at)?);
    let identity = memo::link_identity(client.tenant(), headers, &address.to_string());
    Ok(ResultRequest { sent, identity: Some(identity), keep: false })
}

/// Refuses an address that is longer than [`MAX_LINK_BYTES`].
pub(super) fn check_length(address: &Uri) -> Result<(), Problem> {
    let length = address.path_and_query().map_or(0, |both| both.as_str().len());
    if length > MAX_LINK_BYTES {
        let detail = format!("the address has {length} bytes, at most {MAX_LINK_BYTES} are read; POST the job");
        return Err(Problem::new(problem::URI_TOO_LONG, detail));
    }
    Ok(())
}

/// Decodes the JSON of a job in an address.
fn decoded(job: &str, at: &str) -> Result<Bytes, Problem> {
    let wrong = |detail: String| Problem::invalid(vec![Fault::new(at, detail)]);
    let is_json = |bytes: &[u8]| bytes.trim_ascii_start().starts_with(b"{");
    if is_json(job.as_bytes()) {
        return Ok(Bytes::copy_from_slice(job.as_bytes()));
    }
    let bytes = BASE64.decode(job).map_err(|error| wrong(format!("it is no base64url: {error}")))?;
    if is_json(&bytes) {
        return Ok(bytes.into());
    }
    inflated(ZlibDecoder::new(&bytes[..]), |error| wrong(format!("it is neither JSON nor compressed by zlib: {error}")))
}

/// Inflates the JSON of a job in an address, up to [`MAX_JOB_BYTES`].
pub(super) fn inflated(inflating: impl Read, wrong: impl FnOnce(std::io::Error) -> Problem) -> Result<Bytes, Problem> {
    let mut json = Vec::new();
    inflating.take(MAX_JOB_BYTES as u64 + 1).read_to_end(&mut json).map_err(wrong)?;
    if json.len() > MAX_JOB_BYTES {
        let detail = format!("the job in the address has more than {MAX_JOB_BYTES} bytes; POST it");
        return Err(Problem::new(problem::BODY_TOO_LONG, detail));
    }
    Ok(json.into())
}

/// Answers with the result or a refusal, and with no other status of success that could be taken for the result.
pub(super) async fn respond(
    app: &Arc<App>,
    client: &Client,
    headers: &HeaderMap,
    wanted: ResultRequest,
) -> Result<Response, Problem> {
    let mut response = rendered(app, client, headers, wanted).await?;
    match response.status() {
        StatusCode::ACCEPTED => Err(Problem::unfinished()),
        StatusCode::OK | StatusCode::NOT_MODIFIED => {
            response.headers_mut().insert(header::CACHE_CONTROL, HeaderValue::from_static(CACHE_CONTROL));
            Ok(response)
        }
        _ => Ok(response),
    }
}
