//! Answers: what the service says besides artifacts.

use serde::Serialize;
use utoipa::ToSchema;

use crate::analysis::circles::Outlook;
use crate::fault::{Fault, cut};
use crate::job::Job;
use crate::job::Resolved;
use crate::job::limits::Estimate;
use crate::output::Size;

/// Most characters of a pointer: eight names that are too long to be right; nothing stands that deep.
const MOST_POINTER: usize = 1000;
/// Most characters of the sentence about a fault: the longest list all presets or options there are, in half of them.
const MOST_DETAIL: usize = 2000;

/// A problem (RFC 9457).
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ProblemAnswer {
    /// Where the kind of problem is explained.
    #[serde(rename = "type")]
    pub kind: String,
    /// The kind of problem.
    pub title: String,
    /// The HTTP status.
    pub status: u16,
    /// What happened here and what to do.
    pub detail: String,
    /// Every fault found, with a JSON pointer to its place.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<FaultAnswer>,
    /// Finds this answer in the service's log.
    pub trace_id: String,
}

/// One fault of a request.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct FaultAnswer {
    /// JSON pointer into the request; where the query says the job, a question mark and the name of the parameter.
    pub pointer: String,
    /// What is wrong there and what would be right.
    pub detail: String,
}

impl From<Fault> for FaultAnswer {
    fn from(fault: Fault) -> Self {
        let Fault { pointer, detail, .. } = fault;
        Self { pointer: cut(&pointer, MOST_POINTER).into_owned(), detail: cut(&detail, MOST_DETAIL).into_owned() }
    }
}

/// How a job stands.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct JobAnswer {
    /// Id of the job.
    pub id: String,
    /// Where it stands.
    #[schema(pattern = "^(queued|running|done|failed|cancelled)$")]
    pub state: &'static str,
    /// Share of the work done, from 0 to 1.
    pub progress: f64,
    /// How often it was queued.
    pub attempts: u32,
    /// Time spent so far, or in all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub timings_ms: Option<TimingsAnswer>,
    /// Counts and predicted cost.
    pub cost: CostAnswer,
    /// The outputs of the job.
    pub outputs: Vec<OutputAnswer>,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// What the client should know about the result.
    pub warnings: Vec<String>,
    /// What a tolerance led to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reached: Option<ReachedAnswer>,
}

/// The level that a tolerance or `"auto"` led to.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct ReachedAnswer {
    /// The level.
    pub level: u32,
    /// The result is at most this far from the limit, model units, where a tolerance was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound: Option<f64>,
}

impl From<Resolved> for ReachedAnswer {
    fn from(reached: Resolved) -> Self {
        Self { level: reached.level, bound: reached.bound }
    }
}

/// Time by stage, milliseconds.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct TimingsAnswer {
    /// Waiting for a turn.
    pub queue: f64,
    /// Refining.
    pub refine: f64,
    /// Drawing.
    pub render: f64,
    /// Writing bytes.
    pub encode: f64,
}

/// Predicted cost.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct CostAnswer {
    /// Points or vertices of the result.
    pub vertices: u64,
    /// Faces of the result.
    pub faces: u64,
    /// Memory while it runs, bytes.
    pub memory_bytes: u64,
    /// Time on one core, milliseconds.
    pub time_ms: u64,
}

/// One output of a job.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct OutputAnswer {
    /// The name of the output.
    pub name: String,
    /// The format of the output.
    pub format: &'static str,
    /// The key of the output: id of the artifact and strong ETag.
    pub key: String,
    /// Where its bytes are, or will be.
    pub href: String,
}

/// What a job will come to.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct EstimateAnswer {
    /// Id of the job.
    pub id: String,
    /// Counts after the prefix (0) and after each level.
    pub levels: Vec<LevelAnswer>,
    /// Key and size of each output.
    pub outputs: Vec<OutputEstimate>,
    /// Predicted time on one core, milliseconds.
    pub time_ms: u64,
    /// Predicted memory, bytes.
    pub memory_bytes: u64,
    /// How it is refined: `sweep`, patch by patch, or `rows`, by rows of whole nets. The bytes do not depend on it.
    pub path: &'static str,
    /// What a tolerance led to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reached: Option<ReachedAnswer>,
}

/// Exact counts of one level.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct LevelAnswer {
    /// The level.
    pub level: u64,
    /// Points or vertices.
    pub vertices: u64,
    /// Edges.
    pub edges: u64,
    /// Faces.
    pub faces: u64,
}

/// Key and size of one output.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct OutputEstimate {
    /// The name of the output.
    pub name: String,
    /// The format of the output.
    pub format: &'static str,
    /// The key of the output.
    pub key: String,
    /// The size of the output.
    pub bytes: SizeAnswer,
}

/// A number of bytes.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SizeAnswer {
    /// Exactly this many.
    Exact(u64),
    /// At most this many.
    AtMost(u64),
}

/// What is known of a mesh.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ValidateAnswer {
    /// Whether it can be refined.
    pub valid: bool,
    /// Faults that forbid it.
    pub errors: Vec<FaultAnswer>,
    /// What was repaired or is worth knowing.
    pub warnings: Vec<String>,
    /// What the mesh is like, when it is valid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub report: Option<MeshReport>,
}

/// What a valid mesh is like.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct MeshReport {
    /// Vertices.
    pub vertices: usize,
    /// Edges.
    pub edges: usize,
    /// Faces.
    pub faces: usize,
    /// Connected components, isolated vertices not counted.
    pub components: usize,
    /// V - E + F, isolated vertices not counted.
    pub euler_characteristic: i64,
    /// Whether it is a 2-manifold (with boundary); true for every mesh that is accepted.
    pub manifold: bool,
    /// Whether there is no boundary.
    pub closed: bool,
    /// Boundary loops as vertex indices.
    pub boundary_loops: Vec<Vec<u32>>,
    /// How many vertices have each valence.
    #[schema(schema_with = super::schema::histogram)]
    pub valences: std::collections::BTreeMap<usize, usize>,
    /// Interior edges that are sharp.
    pub creases: usize,
    /// Vertices that are sharp by themselves.
    pub corners: usize,
    /// How many faces have each size.
    #[schema(schema_with = super::schema::histogram)]
    pub face_sizes: std::collections::BTreeMap<usize, usize>,
    /// Vertices that no face has.
    pub isolated_vertices: Vec<u32>,
    /// What becomes of each latitude line.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub latitude_lines: Vec<LatitudeLineAnswer>,
    /// Faces without area.
    pub degenerate_faces: Vec<u32>,
    /// Pairs of vertices at the same place.
    #[schema(schema_with = super::schema::pairs)]
    pub coincident_vertices: Vec<[u32; 2]>,
}

/// What becomes of a latitude line under the plan of the question (push-back with delta 1 when it names none).
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct LatitudeLineAnswer {
    /// The vertices of the line, in order.
    pub vertices: Vec<u32>,
    /// Whether it is closed.
    pub closed: bool,
    /// Whether it is a circle in the limit.
    pub exact: bool,
    /// Radius of that circle, model units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_radius: Option<f64>,
    /// By how much the rings that it comes from miss regular polygons, model units: it is a circle to about that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub irregularity: Option<f64>,
    /// Why it is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl From<Outlook> for LatitudeLineAnswer {
    fn from(outlook: Outlook) -> Self {
        let Outlook { line, circle } = outlook;
        Self {
            vertices: line.vertices,
            closed: line.closed,
            exact: circle.is_ok(),
            limit_radius: circle.as_ref().ok().map(|circle| circle.radius),
            irregularity: circle.as_ref().ok().map(|circle| circle.irregularity),
            reason: circle.err(),
        }
    }
}

/// A count for JSON: what is beyond 2^64 - 1 is written as that.
pub fn count(n: u128) -> u64 {
    u64::try_from(n).unwrap_or(u64::MAX)
}

impl From<Size> for SizeAnswer {
    fn from(size: Size) -> Self {
        match size {
            Size::Exact(n) => Self::Exact(count(n)),
            Size::AtMost(n) => Self::AtMost(count(n)),
        }
    }
}

impl EstimateAnswer {
    /// The estimate of a job.
    pub fn new(job: &Job, estimate: &Estimate) -> Self {
        let level = |(level, c): (usize, &crate::scheme::forecast::Count)| LevelAnswer {
            level: level as u64,
            vertices: count(c.vertices),
            edges: count(c.edges),
            faces: count(c.faces),
        };
        let output = |(output, (key, size)): (&crate::job::Output, &(crate::job::key::Key, Size))| OutputEstimate {
            name: output.name.clone(),
            format: output.format.name(),
            key: key.to_string(),
            bytes: (*size).into(),
        };
        Self {
            id: job.id().to_string(),
            levels: estimate.forecast.levels.iter().enumerate().map(level).collect(),
            outputs: job.outputs.iter().zip(&estimate.outputs).map(output).collect(),
            time_ms: count(estimate.time_ms),
            memory_bytes: count(estimate.memory_bytes),
            path: if job.is_swept() { "sweep" } else { "rows" },
            reached: job.reached.map(ReachedAnswer::from),
        }
    }
}

impl CostAnswer {
    /// The cost of an estimate.
    pub fn new(estimate: &Estimate) -> Self {
        let last = estimate.forecast.levels.last().copied().unwrap_or_default();
        Self {
            vertices: count(last.vertices),
            faces: count(last.faces),
            memory_bytes: count(estimate.memory_bytes),
            time_ms: count(estimate.time_ms),
        }
    }
}
