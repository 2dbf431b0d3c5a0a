//! The input of a job as clients write it.

use serde::Deserialize;
use utoipa::ToSchema;

use super::choice::choice;
use super::look::LookRequest;
use super::mesh::MeshRequest;
use super::object;
use super::polygon::{PolygonRequest, polygons};
use super::text::{MeshFile, MeshFileContent, TextRequest, within};
use super::weld::WeldRequest;
use crate::fault::{Fault, under};
use crate::input::{ReadLimits, Vertices};
use crate::job::{Input, InputEntry};
use crate::scheme::tags::Boundary;
use crate::shape::check::{NonManifold, Winding};
use crate::shape::coordinate_system::{CoordinateSystem, Unit, Up};
use crate::shape::looks::Look;
use crate::shape::mesh::{Mesh, MeshInput};

/// The input: exactly one of `mesh`, `text`, `blob`, `polygon` and `polygons`.
#[derive(Debug, Clone, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct InputRequest {
    /// A control mesh.
    #[serde(default, deserialize_with = "object::optional")]
    pub mesh: Option<MeshRequest>,
    /// A mesh file, written into the job.
    #[serde(default, deserialize_with = "object::optional")]
    pub text: Option<TextRequest>,
    /// A mesh file that was sent to /v1/blobs before, by its id there.
    #[schema(pattern = "^b3-[0-9a-f]{64}$")]
    pub blob: Option<String>,
    /// A control polygon.
    #[serde(default, deserialize_with = "object::optional")]
    pub polygon: Option<PolygonRequest>,
    /// Several control polygons, refined alike.
    #[serde(default, deserialize_with = "object::optional_list")]
    #[schema(min_items = 1, max_items = 4096)]
    pub polygons: Option<Vec<PolygonRequest>>,
    /// Unit of the coordinates: `m` (default), `mm`, `cm`, `in`; left out, what a file of `3mf` or `usda` says.
    pub unit: Option<UnitRequest>,
    /// The axis that points up: `y` (default) or `z`; left out, what a file of `3mf` or `usda` says.
    pub up: Option<UpRequest>,
    /// What to do with faces whose winding disagrees with their neighbours': `refuse` (default) or `repair`.
    pub orient: Option<OrientRequest>,
    /// Merge vertices of a mesh that are at most so far apart, in model units; 0 merges equal positions. When it is
    /// left out, files of formats that double vertices (`gltf`, `glb`) are welded at equal positions where there is a
    /// plan; `false` keeps their vertices apart, and the facets of `stl`, whose equal corners are joined else.
    pub weld: Option<WeldRequest>,
    /// What to do with faces that are no manifold, as where an edge has three: `refuse` (default where there is a plan)
    /// or `split`, which cuts the mesh into manifold pieces; without a plan that is what is drawn and converted. Where
    /// welding that nobody asked for makes such edges, as where bodies touch, the default is `split`.
    pub non_manifold: Option<NonManifoldRequest>,
    /// Join pairs of triangles of a mesh into quads, where there is one way to do it.
    #[serde(default)]
    pub pair_quads: bool,
    /// How faces look that have no material of their own, and those of materials of which nothing but the name is
    /// said.
    #[serde(default, deserialize_with = "object::optional")]
    pub material: Option<LookRequest>,
    /// A mesh file that was not written into the job.
    #[serde(skip)]
    pub file: Option<MeshFile>,
    /// Whether the job has no input.
    #[serde(skip)]
    pub is_missing: bool,
}

choice! {
    /// What to do with inconsistent winding.
    pub enum OrientRequest means Winding {
        /// Refuse the mesh.
        Refuse = "refuse",
        /// Turn faces to agree with the lowest of their component.
        Repair = "repair",
    }
}

choice! {
    /// What to do with faces that are no manifold.
    pub enum NonManifoldRequest means NonManifold {
        /// Refuse the mesh.
        Refuse = "refuse",
        /// Cut it into manifold pieces.
        Split = "split",
    }
}

choice! {
    /// Unit of the coordinates.
    pub enum UnitRequest means Unit {
        /// Metres.
        Metre = "m",
        /// Millimetres.
        Millimetre = "mm",
        /// Centimetres.
        Centimetre = "cm",
        /// Inches.
        Inch = "in",
    }
}

choice! {
    /// The axis that points up.
    pub enum UpRequest means Up {
        /// The second, as in glTF.
        Y = "y",
        /// The third.
        Z = "z",
    }
}

/// The purpose of an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// The input is refined by a plan.
    Refine,
    /// The input is converted or drawn as it is.
    Keep,
}

/// A checked input.
#[derive(Debug, Clone)]
pub struct ResolvedInput {
    /// The shape to be refined.
    pub input: Input,
    /// The field of the request that holds the input.
    pub entry: InputEntry,
    /// The boundary rule that the mesh file states, if any.
    pub boundary: Option<Boundary>,
    /// The unit and the up axis of the coordinates: from the request, else from the mesh file.
    pub coordinate_system: CoordinateSystem,
}

impl InputRequest {
    /// Creates the input of a job without one.
    pub(super) fn missing() -> Self {
        Self { is_missing: true, ..Self::default() }
    }

    /// Returns the unit and the up axis that the request states, else the defaults.
    pub fn coordinate_system(&self) -> CoordinateSystem {
        CoordinateSystem {
            unit: self.unit.map(Into::into).unwrap_or_default(),
            up: self.up.map(Into::into).unwrap_or_default(),
        }
    }

    /// Whether exactly one kind of input is given.
    pub(super) fn is_one(&self) -> bool {
        let is_file = self.blob.is_some() || self.file.is_some();
        let given =
            [self.mesh.is_some(), self.text.is_some(), is_file, self.polygon.is_some(), self.polygons.is_some()];
        given.iter().filter(|given| **given).count() == 1
    }

    /// Checks the input, with the defaults for its purpose; `limits` bound the size of mesh files.
    ///
    /// # Errors
    /// All faults, with pointers below the input.
    pub fn resolve(mut self, purpose: Purpose, limits: &ReadLimits) -> Result<ResolvedInput, Vec<Fault>> {
        if self.is_missing {
            return Err(vec![Fault::new("", "\"input\" is missing, and has to be given")]);
        }
        if !self.is_one() {
            let detail = "give exactly one of \"mesh\", \"text\", \"blob\", \"polygon\" and \"polygons\"";
            return Err(vec![Fault::new("", detail)]);
        }
        if self.blob.is_some() && self.file.is_none() {
            let detail = "uploads are read by the service that has them, in /v1/render, /v1/jobs and /v1/estimate; \
                          here give the file itself, as \"text\"";
            return Err(vec![Fault::new("/blob", detail)]);
        }
        let coordinate_system = self.coordinate_system();
        let (text, file) = (self.text.take(), self.file.take());
        if let Some(mesh) = self.mesh.take() {
            let under = |found| under("/mesh", found);
            self.keeps_vertices(&mesh)?;
            let input = self.covered(mesh.input(self.winding()).map_err(under)?)?;
            let input = Input::Mesh(self.mesh(input, purpose)?.map_err(under)?);
            return Ok(ResolvedInput { input, entry: InputEntry::Mesh, boundary: None, coordinate_system });
        }
        let (place, entry) =
            if self.blob.is_some() { ("/blob", InputEntry::Blob) } else { ("/text", InputEntry::Text) };
        // no pointer into a file that was uploaded earlier is a pointer into the request
        let in_text = |found: Vec<Fault>| match entry {
            InputEntry::Blob => found.into_iter().map(|fault| Fault::new(place, fault.detail)).collect(),
            _ => under(place, found),
        };
        if let Some(file) = text.map(TextRequest::file).transpose().map_err(|fault| in_text(vec![fault]))?.or(file) {
            let MeshFileContent { mesh, boundary, lines, vertices, stated_system: (unit, up) } =
                file.read(self.winding(), limits).map_err(in_text)?;
            let is_split = vertices == Vertices::Joined && self.weld == Some(WeldRequest::Never);
            let mesh = self.covered(if is_split { mesh.with_split_corners() } else { mesh })?;
            let is_usual = self.weld.is_none() && purpose == Purpose::Refine;
            let may_cut = self.non_manifold != Some(NonManifoldRequest::Refuse);
            // clients did not request the edges of more than two faces that default welding makes
            let mesh = match vertices {
                Vertices::Doubled if is_usual && may_cut => mesh.joined().map_err(|fault| vec![fault])?,
                Vertices::Doubled if is_usual => mesh.welded(0.0).map_err(|fault| vec![fault])?,
                Vertices::Joined if is_usual && may_cut => mesh.split_where_crowded(),
                _ => mesh,
            };
            // repairs remove or join faces, so that line numbers no longer match them
            let keeps_faces =
                self.distance().is_none() && !self.pair_quads && !(is_usual && vertices == Vertices::Doubled);
            let lines = if keeps_faces { lines } else { Vec::new() };
            let is_joined = is_usual && vertices != Vertices::Shared;
            let of_joined = |found: Vec<Fault>| -> Vec<Fault> {
                if is_joined { found.into_iter().map(told_of_weld).collect() } else { found }
            };
            let mesh = self.mesh(mesh, purpose)?.map_err(|found| in_text(within(of_joined(found), &lines)))?;
            let unit = self.unit.map(Into::into).or(unit).unwrap_or_default();
            let up = self.up.map(Into::into).or(up).unwrap_or_default();
            return Ok(ResolvedInput {
                input: Input::Mesh(mesh),
                entry,
                boundary,
                coordinate_system: CoordinateSystem { unit, up },
            });
        }
        self.has_no_mesh()?;
        let (found, entry) = if let Some(polygon) = self.polygon {
            (vec![polygon.resolve().map_err(|found| under("/polygon", found))?], InputEntry::Polygon)
        } else {
            let all = polygons(self.polygons.unwrap_or_default());
            (all.map_err(|found| under("/polygons", found))?, InputEntry::Polygons)
        };
        Ok(ResolvedInput { input: Input::Polygons(found), entry, boundary: None, coordinate_system })
    }

    fn winding(&self) -> Winding {
        self.orient.map(Into::into).unwrap_or_default()
    }

    /// Returns the distance within which vertices are merged, if given.
    fn distance(&self) -> Option<f64> {
        if let Some(WeldRequest::Within(distance)) = self.weld { Some(distance) } else { None }
    }

    /// Gives the job's material, if any, to the faces that have none.
    fn covered(&mut self, mut mesh: MeshInput) -> Result<MeshInput, Vec<Fault>> {
        let Some(material) = self.material.take() else { return Ok(mesh) };
        let in_material = |found| under("/material", found);
        let look: Look = material.look(&mut Vec::new()).map_err(|fault| in_material(vec![fault]))?;
        if !mesh.attachments.cover(&look, mesh.faces.len()).map_err(in_material)? {
            mesh.notes
                .push("every face has a material of its own, so that that of the job is shown nowhere".to_owned());
        }
        Ok(mesh)
    }

    /// Repairs and checks a mesh. The outer error holds the faults of the repairs, the inner one those of the mesh.
    fn mesh(&self, mut input: MeshInput, purpose: Purpose) -> Result<Result<Mesh, Vec<Fault>>, Vec<Fault>> {
        if let Some(non_manifold) = self.non_manifold {
            input.non_manifold = non_manifold.into();
        } else if purpose == Purpose::Keep {
            input.non_manifold = NonManifold::Split;
        }
        if let Some(distance) = self.distance() {
            input = input.welded(distance).map_err(|fault| vec![fault])?;
        }
        let mesh = Mesh::new(if self.pair_quads { input.paired() } else { input });
        Ok(mesh.map(|mut mesh| {
            let doubled = if purpose == Purpose::Refine { mesh.doubled_boundary() } else { None };
            mesh.repairs.extend(doubled);
            mesh
        }))
    }

    /// Refuses repairs that compare positions of vertices if the mesh has frames, and so several positions per vertex.
    fn keeps_vertices(&self, mesh: &MeshRequest) -> Result<(), Vec<Fault>> {
        let given = [("weld", self.distance().is_some()), ("pair_quads", self.pair_quads)];
        let fault = |(name, _)| {
            let detail = format!("\"{name}\" goes by positions, and frames have several each; leave it out");
            Fault::new(format!("/{name}"), detail)
        };
        let found = given.into_iter().filter(|&(_, given)| given && !mesh.frames.is_empty());
        let faults: Vec<Fault> = found.map(fault).collect();
        if faults.is_empty() { Ok(()) } else { Err(faults) }
    }

    /// Refuses fields that only meshes have.
    fn has_no_mesh(&self) -> Result<(), Vec<Fault>> {
        let given = [
            ("/orient", self.orient.is_some(), "polygons have no winding; leave it out"),
            ("/weld", self.weld.is_some(), "only meshes are welded; leave it out"),
            ("/non_manifold", self.non_manifold.is_some(), "only meshes have edges with several faces; leave it out"),
            ("/material", self.material.is_some(), "only meshes have materials; leave it out"),
            ("/pair_quads", self.pair_quads, "only meshes have triangles; leave it out"),
        ];
        let found = given.into_iter().filter(|(_, is_given, _)| *is_given);
        let faults: Vec<Fault> = found.map(|(place, _, detail)| Fault::new(place, detail)).collect();
        if faults.is_empty() { Ok(()) } else { Err(faults) }
    }
}

/// Adds the remedy `"weld": false` to a fault about edges with too many faces, which default welding may have made.
fn told_of_weld(mut fault: Fault) -> Fault {
    if fault.detail.contains("at most 2 are allowed") {
        fault.detail.push_str(", and \"weld\": false joins no vertices");
    }
    fault
}
