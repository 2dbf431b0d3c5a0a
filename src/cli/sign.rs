//! `planish sign`: signed links, which open one thing without a key.

use std::io::Write;
use std::path::PathBuf;

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use flate2::Compression;
use flate2::write::DeflateEncoder;

use super::error::CliError;
use super::inputs::InputSource;
use super::key::{lifetime, now_s};
use super::say::answer;
use crate::config::keys::{Link, MODEL, Token};
use crate::fault::{Fault, shortened};
use crate::http::address::MAX_LINK_BYTES;
use crate::http::links::MAX_JOB_BYTES;
use crate::job::key::Key;
use crate::output::{FORMATS, named};
use crate::wire::JobRequest;
use crate::wire::read::{ReadError, read};

/// What the address is to open.
#[derive(Debug, clap::Args)]
pub(crate) struct SignOptions {
    /// A job with one output (- reads it from standard input).
    #[arg(required_unless_present_any = ["events", "batch_events", "artifact"],
        conflicts_with_all = ["events", "batch_events", "artifact"])]
    job: Option<PathBuf>,
    /// The id of a job whose events the address tells.
    #[arg(long, value_name = "JOB ID", conflicts_with_all = ["batch_events", "artifact"])]
    events: Option<String>,
    /// The id of a batch whose events the address tells.
    #[arg(long, value_name = "BATCH ID", conflicts_with = "artifact")]
    batch_events: Option<String>,
    /// The name of a result, 64 hexadecimal digits and an extension.
    #[arg(long, value_name = "ID.EXTENSION")]
    artifact: Option<String>,
    /// The format, where the job names none.
    #[arg(long)]
    format: Option<String>,
    /// How long the address opens it, like 30min or 7d.
    #[arg(long, value_name = "TIME", default_value = "1h", value_parser = lifetime)]
    expires_in: u64,
    /// The service, where the address should be a whole one, like `https://planish.example.org`.
    #[arg(long, default_value = "")]
    url: String,
    /// The key that signs, of the role render for jobs.
    #[arg(long, env = "PLANISH_KEY", hide_env_values = true)]
    key: String,
}

impl SignOptions {
    /// Prints the address.
    pub(super) fn sign(self) -> Result<(), CliError> {
        let not_a_key = || CliError::usage("the key is none; give what `planish key add` has printed, as PLANISH_KEY");
        let token = Token::parse(&self.key).ok_or_else(not_a_key)?;
        let id = |text: &str| Key::parse(text).ok_or_else(|| CliError::usage(no_id(text)));
        let rest = match (&self.events, &self.batch_events, &self.artifact, &self.job) {
            (Some(job), ..) => format!("jobs/{}/events", id(job)?),
            (_, Some(batch), ..) => format!("batches/{}/events", id(batch)?),
            (_, _, Some(file), _) => {
                let (key, extension) = file.split_once('.').unwrap_or((file, ""));
                check_extension(extension)?;
                format!("artifacts/{}.{extension}", id(key)?)
            }
            (.., Some(job)) => {
                let source = InputSource::of(job);
                let json = source.read().map_err(|error| CliError::files(format!("{source}: {error}")))?;
                of_job(&json, self.format.as_deref())?
            }
            (None, None, None, None) => return Err(CliError::usage("name a job")),
        };
        let path = Link::sign(token.id(), &token.link_secret(), now_s().saturating_add(self.expires_in), &rest);
        if path.len() > MAX_LINK_BYTES {
            let detail = format!(
                "the address would have {} bytes, and services read {MAX_LINK_BYTES}; send the mesh to /v1/blobs \
                 and name it as input.blob, or have the job done and sign its --artifact",
                path.len()
            );
            return Err(CliError::too_large(detail));
        }
        answer(format!("{}{path}\n", self.url.trim_end_matches('/')).as_bytes())
    }
}

fn no_id(text: &str) -> String {
    format!("\"{}\" is no id, which is 64 hexadecimal digits", shortened(text))
}

fn check_extension(extension: &str) -> Result<(), CliError> {
    let is_known = FORMATS.iter().any(|format| format.extension() == extension);
    let wrong = || format!("\"{}\" is no extension; `planish formats` lists them", shortened(extension));
    if is_known { Ok(()) } else { Err(CliError::usage(wrong())) }
}

/// Encodes a job, with the extension of its format, as part of an address.
fn of_job(json: &[u8], format: Option<&str>) -> Result<String, CliError> {
    if json.len() > MAX_JOB_BYTES {
        let detail = format!("the job has {} bytes, and an address holds {MAX_JOB_BYTES}", json.len());
        return Err(CliError::too_large(format!("{detail}; send the mesh to /v1/blobs and name it as input.blob")));
    }
    let refused = |detail: String| CliError::faults([Fault::new("/outputs", detail)]);
    let request: JobRequest = read(json).map_err(|error| match error {
        ReadError::NotJson(detail) => CliError::refused(detail),
        ReadError::Unfit(faults) => CliError::faults(faults),
    })?;
    let own = match request.outputs.as_slice() {
        [] => format,
        [output] => output.format().or(format),
        _ => return Err(refused("an address has one output; leave the others out".to_owned())),
    };
    let name = own.ok_or_else(|| refused("the job names no format; give one with --format".to_owned()))?;
    let unknown = || refused(format!("there is no format \"{}\"; `planish formats` lists them", shortened(name)));
    let extension = named(name).ok_or_else(unknown)?.extension();
    let mut deflated = DeflateEncoder::new(Vec::new(), Compression::best());
    let deflated = deflated.write_all(json).and_then(|()| deflated.finish()).map_err(CliError::other)?;
    let written = URL_SAFE_NO_PAD.encode(deflated);
    // A loader resolves the buffers of a model relative to its address.
    let refers = request.outputs.iter().any(|output| output.gives("lod"));
    Ok(if refers { format!("{written}/{MODEL}") } else { format!("{written}.{extension}") })
}
