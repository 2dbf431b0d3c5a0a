//! Answers of the service other than artifacts.

use serde::Serialize;
use utoipa::ToSchema;

use crate::analysis::circles::Outlook;
use crate::fault::{Fault, cut};
use crate::job::Job;
use crate::job::ResolvedLevel;
use crate::job::limits::Estimate;
use crate::output::Size;

/// Maximum number of characters of a JSON pointer in an answer: seven names of the 128 characters at which names are
/// cut, deeper than any place of a request.
const MAX_POINTER: usize = 1000;
/// Maximum number of characters of the sentence about a fault. The longest sentences list all presets or options, and
/// take half as many.
const MAX_FAULT_DETAIL: usize = 2000;

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
        Self { pointer: cut(&pointer, MAX_POINTER).into_owned(), detail: cut(&detail, MAX_FAULT_DETAIL).into_owned() }
    }
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

impl From<ResolvedLevel> for ReachedAnswer {
    fn from(reached: ResolvedLevel) -> Self {
        Self { level: reached.level, bound: reached.bound }
    }
}

/// A file that was sent.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct BlobAnswer {
    /// What names it in jobs: `b3-` and the BLAKE3 of its bytes.
    pub id: String,
    /// Its length.
    pub bytes: u64,
    /// The format that it is read as: that of a reader, or `json`.
    pub format: String,
    /// Where it is.
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

/// Converts a count for JSON; counts beyond 2^64 - 1 become 2^64 - 1.
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
    /// Creates the estimate of a job.
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
