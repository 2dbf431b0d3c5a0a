//! Descriptions: the text of a job within an artifact, from which the artifact can be made again.

use std::fmt::Write;
use std::sync::Arc;

use serde::Deserialize;
use serde_json::{Map, Value, json};

use crate::fault::Fault;
use crate::job::key::RESULTS_VERSION;
use crate::math::amounts::in_bytes;

/// Maximum length of a description in bytes. Programs that show a picture read it as a whole: half of it would refuse
/// meshes of some five thousand vertices, twice of it would let pictures be mostly text.
const MAX_DESCRIPTION_BYTES: usize = 1 << 20;
/// Maximum length in bytes of the request that is described, with blanks and other outputs. Half or twice of it would
/// read half or twice as much of a request that is refused afterwards.
const MAX_SOURCE: usize = 4 * MAX_DESCRIPTION_BYTES;

/// The description of a job within its artifact.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Description {
    /// The version of the results that made the artifact; other versions may make other bytes.
    pub results_version: u32,
    /// The job, with one output.
    pub job: Value,
}

/// Returns the description of a job with the text `source` for one output: the fields in alphabetical order, without
/// those that do not change the bytes (`spec`, the name of the output), and with this output only.
///
/// # Errors
/// A fault at `/describe` if the job is too long or its text is not known.
pub(super) fn description(source: Option<&str>, mut output: Map<String, Value>) -> Result<Arc<str>, Fault> {
    let fault = |detail: String| Fault::new("/describe", detail);
    let source = source.ok_or_else(|| {
        fault("the job has files beside its own that would have to be told as well; leave it out".to_owned())
    })?;
    if source.len() > MAX_SOURCE {
        return Err(too_long(source.len(), MAX_SOURCE));
    }
    let mut job: Map<String, Value> = serde_json::from_str(source).map_err(|error| fault(error.to_string()))?;
    job.remove("spec");
    output.remove("name");
    job.insert("outputs".to_owned(), json!([output]));
    let mut said = json!({ "results_version": RESULTS_VERSION, "job": job });
    said.sort_all_objects();
    let text = ascii(&said.to_string());
    if text.len() > MAX_DESCRIPTION_BYTES { Err(too_long(text.len(), MAX_DESCRIPTION_BYTES)) } else { Ok(text.into()) }
}

fn too_long(length: usize, most: usize) -> Fault {
    let [length, most] = [length as u128, most as u128].map(in_bytes);
    Fault::new("/describe", format!("the job has {length}, a description at most {most}; leave it out"))
}

/// Escapes all characters of a JSON text but printable ASCII.
fn ascii(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for c in json.chars() {
        if c.is_ascii() && c != '\u{7f}' {
            text.push(c);
        } else {
            let mut units = [0; 2];
            c.encode_utf16(&mut units).iter().for_each(|unit| {
                // writing to a `String` cannot fail
                let _ = write!(text, "\\u{unit:04x}");
            });
        }
    }
    text
}
