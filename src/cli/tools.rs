//! The tools for clients of language models: functions from JSON arguments to texts and pictures.

use std::path::Path;

use serde_json::{Value, json};

use super::files::to_new_file;
use crate::fault::shortened;
use crate::http::validate::report;
use crate::job::limits::{Admitted, Limits, Refusal};
use crate::job::{Report, run};
use crate::output::Content;
use crate::watch::Watch;
use crate::wire::JobRequest;
use crate::wire::answer::EstimateAnswer;
use crate::wire::catalogue::presets;
use crate::wire::output::OutputRequest;
use crate::wire::read::{ReadError, read};

/// Maximum length of a text answer in bytes: some ten thousand words, which is a good part of what a model reads at
/// once. Half of it would send small meshes to files; twice of it would fill the context of the model with coordinates.
const MAX_ANSWER_TEXT: usize = 64 << 10;
/// Maximum size of a picture in bytes before base64; clients refuse messages of some megabytes. Half of it would refuse
/// pictures of 2,000 pixels a side; with twice of it some clients would refuse the message.
const MAX_PICTURE: usize = 4 << 20;
/// Maximum number of faces, and maximum memory of a job in bytes: they allow seconds of work, because a client waits
/// for its tools. Half of them would refuse level 9 of a cube; twice of them would let a call take a minute.
const MAX_TOOL_FACES: u64 = 2_000_000;
const MAX_TOOL_MEMORY: u64 = 2 << 30;
/// The four views: caption, azimuth and elevation in degrees.
const VIEWS: [(&str, f64, f64); 4] =
    [("above", 0.0, 90.0), ("front", 0.0, 0.0), ("side", 90.0, 0.0), ("corner", 35.0, 25.0)];

/// One item of the answer of a tool.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Answered {
    /// A text.
    Text(String),
    /// A picture as PNG.
    Picture(Vec<u8>),
}

/// The answer of a tool, or its error as a sentence.
type Said = Result<Vec<Answered>, String>;

/// A tool.
pub(super) struct ToolFacts {
    /// Name.
    pub(super) name: &'static str,
    /// Description for the model.
    pub(super) doc: &'static str,
    /// Returns the JSON schema of the arguments.
    pub(super) schema: fn() -> Value,
    /// Runs the tool with its arguments and the folder for files.
    call: fn(Value, Option<&Path>, &Watch) -> Said,
}

impl ToolFacts {
    /// Runs the tool, unless it does not know one of the arguments.
    pub(super) fn run(&self, arguments: Value, out: Option<&Path>, watch: &Watch) -> Said {
        let schema = (self.schema)();
        let known = &schema["properties"];
        let unknown = arguments.as_object().and_then(|given| given.keys().find(|name| known.get(name).is_none()));
        if let Some(unknown) = unknown {
            let known: Vec<&str> = known.as_object().into_iter().flatten().map(|(name, _)| name.as_str()).collect();
            let unknown = shortened(unknown);
            return Err(format!("there is no argument \"{unknown}\"; {} knows {}", self.name, known.join(", ")));
        }
        (self.call)(arguments, out, watch)
    }
}

/// All tools.
pub(super) const TOOLS: &[ToolFacts] = &[
    ToolFacts {
        name: "render",
        doc: "Refines the input of a job and answers with its one output: a png as a picture, svg, json, stats, obj \
              and other short texts as text, anything else as a file whose path is told.",
        schema: job_schema,
        call: |arguments, out, watch| render(&arguments["job"], out, watch),
    },
    ToolFacts {
        name: "views",
        doc: "Draws the refined shape of a job from above, the front, the side and a corner, in one picture.",
        schema: job_schema,
        call: |arguments, _, watch| views(&arguments["job"], watch),
    },
    ToolFacts {
        name: "validate",
        doc: "Tells all that is wrong with a job, with a JSON pointer to each place, and what its mesh is like.",
        schema: job_schema,
        call: |arguments, _, _| validate(&arguments["job"]),
    },
    ToolFacts {
        name: "estimate",
        doc: "Tells what a job would come to, without running it: counts a level, bytes, memory, time.",
        schema: job_schema,
        call: |arguments, _, watch| estimate(&arguments["job"], watch),
    },
    ToolFacts {
        name: "presets",
        doc: "Lists the subdivision schemes, or tells all of one: what it refines, its parameters, its source.",
        schema: || {
            json!({ "type": "object", "additionalProperties": false, "properties": {
            "name": { "type": "string", "description": "The name of a scheme; all are listed when left out." } } })
        },
        call: |arguments, _, _| match &arguments["name"] {
            Value::Null => list(None),
            Value::String(name) => list(Some(name)),
            _ => Err("name is no text; give the name of a scheme, or leave it out to list all".to_owned()),
        },
    },
];

fn job_schema() -> Value {
    json!({
        "type": "object",
        "required": ["job"],
        "additionalProperties": false,
        "properties": { "job": {
            "type": "object",
            "description": "A job: input (mesh with positions and faces, or polygon with points), plan (preset or \
                            word, with parameters), levels, and outputs with one format.",
        } },
    })
}

fn request(job: &Value) -> Result<JobRequest, String> {
    let text = job.to_string();
    let mut request: JobRequest = read(text.as_bytes()).map_err(|error| match error {
        ReadError::NotJson(detail) => detail.replace("the body", "the job"),
        ReadError::Unfit(faults) => listed(faults.iter()),
    })?;
    if request.describes() {
        request.source = Some(text.into());
    }
    Ok(request)
}

/// Asks for a picture of a job without outputs.
fn show(request: &mut JobRequest) {
    if request.outputs.is_empty() {
        request.outputs = vec![OutputRequest::of_format("png")];
    }
}

fn listed(lines: impl Iterator<Item = impl ToString>) -> String {
    lines.map(|line| line.to_string()).collect::<Vec<_>>().join("\n")
}

fn admitted(request: JobRequest, watch: &Watch) -> Result<Admitted, String> {
    let limits = Limits { max_faces: MAX_TOOL_FACES, max_job_bytes: MAX_TOOL_MEMORY, ..Limits::default() };
    let job = request.resolve_within(&limits.reading()).map_err(|faults| listed(faults.iter()))?;
    limits.admit_under(job, watch).map_err(|refusal| match refusal {
        Refusal::Impossible(faults) => listed(faults.iter()),
        Refusal::TooLarge { detail, .. } => detail,
        Refusal::Stopped => "it was stopped".to_owned(),
    })
}

/// Makes the bytes of the only output of a job, with the report on them.
fn made(admitted: &Admitted, watch: &Watch) -> Result<(Vec<u8>, Report), String> {
    let (output, mut bytes) = (&admitted.job().outputs[0], Vec::new());
    let report = run(admitted, output, &mut bytes, watch).map_err(|error| error.to_string())?;
    Ok((bytes, report))
}

fn render(job: &Value, out: Option<&Path>, watch: &Watch) -> Said {
    let mut request = request(job)?;
    show(&mut request);
    let n = request.outputs.len();
    if n > 1 {
        return Err(format!("{n} outputs; a call answers with one, ask for the others by themselves"));
    }
    let admitted = admitted(request, watch)?;
    if admitted.job().detail_keys().next().is_some() {
        return Err("levels of detail are several files; leave \"lod\" out".to_owned());
    }
    let (bytes, report) = made(&admitted, watch)?;
    let format = admitted.job().outputs[0].format;
    let is_text = matches!(format.facts().content, Content::Json | Content::Text) && bytes.len() <= MAX_ANSWER_TEXT;
    let mut answers = match (format.name(), String::from_utf8(bytes)) {
        ("png", Err(bytes)) if bytes.as_bytes().len() <= MAX_PICTURE => vec![Answered::Picture(bytes.into_bytes())],
        (_, Ok(text)) if is_text => vec![Answered::Text(text)],
        (_, bytes) => {
            let bytes = bytes.map_or_else(std::string::FromUtf8Error::into_bytes, String::into_bytes);
            let name = format!("{}.{}", admitted.job().keys()[0], format.extension());
            let folder = out.ok_or_else(|| {
                format!(
                    "the {} has {} bytes and cannot be shown; start planish mcp with --out",
                    format.name(),
                    bytes.len()
                )
            })?;
            let path = folder.join(name);
            let put = |out: &mut dyn std::io::Write| out.write_all(&bytes).map_err(super::error::CliError::files);
            to_new_file(&path, put).map_err(|error| error.to_string())?;
            vec![Answered::Text(format!("{} ({} bytes)", path.display(), bytes.len()))]
        }
    };
    answers.extend(report.warnings.into_iter().map(Answered::Text));
    Ok(answers)
}

fn views(job: &Value, watch: &Watch) -> Said {
    let mut bare = job.clone();
    if let Some(job) = bare.as_object_mut() {
        job.remove("outputs");
    }
    let panel = |(caption, azimuth, elevation): (&str, f64, f64)| {
        let mut job = bare.clone();
        let camera = json!({ "azimuth_deg": azimuth, "elevation_deg": elevation, "projection": "orthographic" });
        job["outputs"] = json!([{ "format": "png", "width": 400, "height": 400, "camera": camera }]);
        json!({ "job": job, "caption": caption })
    };
    if !job.is_object() {
        return Err("the argument \"job\" is missing: an object with \"input\", \"plan\" and \"levels\"".to_owned());
    }
    let panels: Vec<Value> = VIEWS.into_iter().map(panel).collect();
    let figure =
        json!({ "figure": { "columns": 2, "panels": panels }, "outputs": [{ "format": "png", "width": 900 }] });
    let (bytes, report) = made(&admitted(request(&figure)?, watch)?, watch)?;
    Ok(std::iter::once(Answered::Picture(bytes)).chain(report.warnings.into_iter().map(Answered::Text)).collect())
}

fn validate(job: &Value) -> Said {
    let mut request = request(job)?;
    let purpose = request.stated_purpose();
    show(&mut request);
    let limits = Limits::default();
    json_answer(&report(request.examine(purpose, &limits.reading()).bounded(&limits, &Watch::new())))
}

fn estimate(job: &Value, watch: &Watch) -> Said {
    let mut request = request(job)?;
    show(&mut request);
    let admitted = admitted(request, watch)?;
    json_answer(&EstimateAnswer::new(admitted.job(), admitted.estimate()))
}

fn list(name: Option<&str>) -> Said {
    let all = presets();
    match name {
        None => Ok(vec![Answered::Text(listed(
            all.iter().map(|preset| format!("{} ({}): {}", preset.name, preset.refines.join(", "), preset.doc)),
        ))]),
        Some(name) => match all.iter().find(|preset| preset.name == name) {
            Some(preset) => json_answer(preset),
            None => Err(format!("there is no preset \"{name}\"; there are {}", {
                let names: Vec<&str> = all.iter().map(|preset| preset.name).collect();
                names.join(", ")
            })),
        },
    }
}

fn json_answer(value: &impl serde::Serialize) -> Said {
    Ok(vec![Answered::Text(serde_json::to_string(value).map_err(|error| error.to_string())?)])
}
