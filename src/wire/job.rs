//! The job as clients write it.

use serde::Deserialize;
use utoipa::ToSchema;

use super::literal::WireFields;
use super::output::{OutputRequest, outputs};
use super::{object, schema};
use crate::fault::{Fault, under};
use crate::job::{Input, Job};
use crate::output::ShapeKind;
use crate::scheme::mesh_net::Boundary;
use crate::scheme::plan::PlanInput;
use crate::scheme::polygon_net::Ends;
use crate::shape::attributes::Attributes;
use crate::shape::check::{FaceList, Winding};
use crate::shape::mesh::{Mesh, MeshInput};
use crate::shape::polygon::Polygon;

/// Most polygons of one job.
pub(crate) const MAX_POLYGONS: usize = 4096;

/// A job: what is refined, how, how often, and what is answered.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct JobRequest {
    /// Version of this notation; 1 when left out.
    #[schema(minimum = 1, maximum = 1, default = 1)]
    pub spec: Option<u64>,
    /// What is refined: exactly one kind of input.
    #[serde(deserialize_with = "object::one")]
    pub input: InputRequest,
    /// How it is refined; may be left out together with `levels`, to convert or draw the input as it is.
    #[serde(default, deserialize_with = "object::optional")]
    pub plan: Option<PlanRequest>,
    /// How often the plan's cycle is applied; has to be given where there is a plan.
    #[schema(minimum = 0, maximum = 64)]
    pub levels: Option<u64>,
    /// What is answered, 1 to 64 results; without any, /v1/render goes by `Accept`.
    #[serde(default)]
    #[schema(max_items = 64)]
    pub outputs: Vec<OutputRequest>,
}

/// The input: exactly one of `mesh`, `polygon` and `polygons`.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct InputRequest {
    /// A control mesh.
    #[serde(default, deserialize_with = "object::optional")]
    pub mesh: Option<MeshRequest>,
    /// A control polygon.
    #[serde(default, deserialize_with = "object::optional")]
    pub polygon: Option<PolygonRequest>,
    /// Several control polygons, refined alike.
    #[serde(default, deserialize_with = "object::optional_list")]
    #[schema(min_items = 1, max_items = 4096)]
    pub polygons: Option<Vec<PolygonRequest>>,
    /// What to do with faces whose winding disagrees with their neighbours': `refuse` (default) or `repair`.
    pub orient: Option<OrientRequest>,
}

/// A control mesh.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshRequest {
    /// Vertex positions, `n x 3`, model units.
    #[schema(schema_with = schema::positions)]
    pub positions: Vec<[f64; 3]>,
    /// Faces as lists of vertex indices, counted from 0, counter-clockwise seen from outside.
    #[schema(schema_with = schema::faces)]
    pub faces: Vec<Vec<u64>>,
    /// Vertices that keep their place.
    #[serde(default, deserialize_with = "object::list")]
    pub corners: Vec<CornerRequest>,
    /// Faces that are refined but not shown.
    #[serde(default)]
    pub holes: Vec<u64>,
}

/// A corner of a mesh.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CornerRequest {
    /// The vertex.
    pub vertex: u64,
    /// 0 is smooth, 10 or more infinitely sharp.
    pub sharpness: f64,
}

/// A control polygon.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PolygonRequest {
    /// Points, all of the same 1 to 4 coordinates.
    #[schema(schema_with = schema::points)]
    pub points: Vec<Vec<f64>>,
    /// Whether the last point is joined to the first.
    #[serde(default)]
    pub closed: bool,
    /// Indices of points that keep their place.
    #[serde(default)]
    pub corners: Vec<u64>,
    /// Whether points are homogeneous: the last coordinate is a weight, by which the others are divided after refining.
    #[serde(default)]
    pub rational: bool,
    /// Parameters that points carry: each a list of one number a point.
    pub parameters: Option<PointParameters>,
}

/// Parameters that points carry; each beats the plan's.
#[derive(Debug, Clone, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PointParameters {
    /// Parameter spacing, radians.
    pub alpha: Option<Vec<f64>>,
    /// Kernel.
    pub kernel: Option<Vec<f64>>,
    /// Compensation.
    pub compensation: Option<Vec<f64>>,
    /// Push-back factor.
    pub delta: Option<Vec<f64>>,
}

/// What to do with inconsistent winding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OrientRequest {
    /// Refuse the mesh.
    Refuse,
    /// Turn faces to agree with the lowest of their component.
    Repair,
}

/// How the input is refined: a preset or a word.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanRequest {
    /// Name of a preset, see `/v1/presets`.
    pub preset: Option<String>,
    /// A word over operators, see `/v1/operators`.
    pub word: Option<String>,
    /// Parameters of the preset, or of the word: numbers, constant expressions, expressions.
    #[serde(default)]
    #[schema(value_type = Object)]
    pub parameters: WireFields,
    /// Boundary rule of meshes; `edge-and-corner` when left out.
    pub boundary: Option<BoundaryRequest>,
    /// End rule of open polygons; `clamped` when left out.
    pub ends: Option<EndsRequest>,
    /// Seed of random perturbation; without effect on plans that have none.
    pub seed: Option<u64>,
}

/// Boundary rule of meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BoundaryRequest {
    /// Boundary curves by the curve rule; vertices with one face keep their place.
    EdgeAndCorner,
    /// Boundary curves by the curve rule.
    EdgeOnly,
    /// As `edge-only`, and faces that touch the boundary are not shown.
    None,
}

/// End rule of open polygons.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum EndsRequest {
    /// The curve starts and ends at the end points.
    Clamped,
    /// Only points whose whole stencil exists.
    Natural,
}

impl JobRequest {
    /// What kind of result it has, as far as that can be told before it is checked.
    pub fn shape_kind(&self) -> ShapeKind {
        let first = self.input.polygon.iter().chain(self.input.polygons.iter().flatten()).next();
        match first {
            Some(polygon) if self.input.mesh.is_none() => {
                let dimension = polygon.points.first().map_or(1, Vec::len);
                ShapeKind::Curves { dimension: dimension.saturating_sub(usize::from(polygon.rational)).max(1) }
            }
            _ => ShapeKind::Mesh,
        }
    }

    /// Checks the request as a whole.
    ///
    /// # Errors
    /// All faults found in input and outputs, or, where these are right, in the plan.
    pub fn resolve(self) -> Result<Job, Vec<Fault>> {
        let mut faults = Vec::new();
        if self.spec.is_some_and(|spec| spec != 1) {
            faults.push(Fault::new("/spec", format!("{} is unknown; this server speaks 1", self.spec.unwrap_or(0))));
        }
        let input = keep(self.input.resolve().map_err(|found| under("/input", found)), &mut faults);
        let outputs = keep(outputs(&self.outputs), &mut faults);
        let plan = self.plan.map(PlanRequest::resolve);
        let Some(input) = input else { return Err(faults) };
        // a plan is looked at even where the outputs are wrong, so that all faults come together
        match Job::new(input, plan.as_ref(), self.levels, outputs.unwrap_or_default()) {
            Ok(job) if faults.is_empty() => Ok(job),
            Ok(_) => Err(faults),
            Err(found) => Err(faults.into_iter().chain(found).collect()),
        }
    }
}

fn keep<T>(result: Result<T, Vec<Fault>>, faults: &mut Vec<Fault>) -> Option<T> {
    result.map_err(|found| faults.extend(found)).ok()
}

impl InputRequest {
    /// Checks the input.
    ///
    /// # Errors
    /// All faults, with pointers below the input.
    pub fn resolve(self) -> Result<Input, Vec<Fault>> {
        let given = [self.mesh.is_some(), self.polygon.is_some(), self.polygons.is_some()];
        if given.iter().filter(|given| **given).count() != 1 {
            let detail = "give exactly one of \"mesh\", \"polygon\" and \"polygons\"";
            return Err(vec![Fault::new("", detail)]);
        }
        if let Some(mesh) = self.mesh {
            return mesh.resolve(self.orient).map(Input::Mesh).map_err(|found| under("/mesh", found));
        }
        if self.orient.is_some() {
            return Err(vec![Fault::new("/orient", "polygons have no winding; leave it out")]);
        }
        if let Some(polygon) = self.polygon {
            let polygon = polygon.resolve().map_err(|found| under("/polygon", found))?;
            return Ok(Input::Polygons(vec![polygon]));
        }
        polygons(self.polygons.unwrap_or_default()).map(Input::Polygons).map_err(|found| under("/polygons", found))
    }
}

fn polygons(requests: Vec<PolygonRequest>) -> Result<Vec<Polygon>, Vec<Fault>> {
    if requests.is_empty() || requests.len() > MAX_POLYGONS {
        let detail = format!("{} polygons; 1 to {MAX_POLYGONS} are allowed", requests.len());
        return Err(vec![Fault::new("", detail)]);
    }
    let mut faults = Vec::new();
    let mut found = Vec::with_capacity(requests.len());
    for (i, request) in requests.into_iter().enumerate() {
        match request.resolve() {
            Ok(polygon) => found.push(polygon),
            Err(wrong) => faults.extend(under(&format!("/{i}"), wrong)),
        }
    }
    if faults.is_empty() { Ok(found) } else { Err(faults) }
}

impl PolygonRequest {
    fn resolve(self) -> Result<Polygon, Vec<Fault>> {
        let polygon = Polygon::new(&self.points, self.closed, &self.corners)?;
        let polygon = if self.rational { polygon.rational()? } else { polygon };
        match self.parameters {
            None => Ok(polygon),
            Some(PointParameters { alpha, kernel, compensation, delta }) => {
                polygon.carrying(Attributes { alpha, kernel, compensation, delta })
            }
        }
    }
}

impl MeshRequest {
    /// Checks the mesh.
    ///
    /// # Errors
    /// All faults, with pointers below the mesh.
    pub fn resolve(self, orient: Option<OrientRequest>) -> Result<Mesh, Vec<Fault>> {
        let mut faces = FaceList::default();
        for face in &self.faces {
            // an index beyond 32 bits is beyond every mesh, too
            faces.push(face.iter().map(|&v| u32::try_from(v).unwrap_or(u32::MAX)));
        }
        let beyond = |(f, face): (usize, &Vec<u64>)| {
            let j = face.iter().position(|&v| v >= u64::from(u32::MAX))?;
            let detail =
                format!("there is no vertex {}; the mesh has {}, counted from 0", face[j], self.positions.len());
            Some(Fault::new(format!("/faces/{f}/{j}"), detail))
        };
        let beyond: Vec<Fault> = self.faces.iter().enumerate().filter_map(beyond).take(20).collect();
        if !beyond.is_empty() {
            return Err(beyond);
        }
        let winding = if orient == Some(OrientRequest::Repair) { Winding::Repair } else { Winding::Refuse };
        let corners = self.corners.iter().map(|corner| (corner.vertex, corner.sharpness)).collect();
        Mesh::new(MeshInput { positions: self.positions, faces, corners, holes: self.holes, winding })
    }
}

impl PlanRequest {
    /// The plan as it is to be resolved for its input.
    pub fn resolve(self) -> PlanInput {
        PlanInput {
            preset: self.preset,
            word: self.word,
            parameters: self.parameters.0,
            boundary: match self.boundary {
                None | Some(BoundaryRequest::EdgeAndCorner) => Boundary::EdgeAndCorner,
                Some(BoundaryRequest::EdgeOnly) => Boundary::EdgeOnly,
                Some(BoundaryRequest::None) => Boundary::None,
            },
            ends: match self.ends {
                None | Some(EndsRequest::Clamped) => Ends::Clamped,
                Some(EndsRequest::Natural) => Ends::Natural,
            },
            seed: self.seed.unwrap_or(0),
        }
    }
}
