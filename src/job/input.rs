//! The input of a job.

use crate::fault::Fault;
use crate::output::ShapeKind;
use crate::scheme::plan::{AlphaOf, Carried, Plan, PlanInput, Subject};
use crate::scheme::tags::Boundary;
use crate::shape::attachments::Attachments;
use crate::shape::attributes::Attributes;
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::mesh::Mesh;
use crate::shape::polygon::Polygon;

/// The input of a job.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a job has one input")]
pub enum Input {
    /// Polygons that are refined alike.
    Polygons(Vec<Polygon>),
    /// A mesh.
    Mesh(Mesh),
}

impl Input {
    /// Returns whether the input is a mesh, and whether it is open (has ends or a boundary).
    pub fn kind(&self) -> (bool, bool) {
        match self {
            Self::Polygons(polygons) => (false, polygons.iter().any(|polygon| !polygon.closed)),
            Self::Mesh(mesh) => (true, mesh.topology.n_boundary() > 0),
        }
    }

    /// Returns the number of points or vertices.
    pub fn n_points(&self) -> usize {
        match self {
            Self::Polygons(polygons) => polygons.iter().map(Polygon::len).sum(),
            Self::Mesh(mesh) => mesh.topology.n_vertices(),
        }
    }

    /// Returns the kind of the result, for formats.
    pub fn shape_kind(&self) -> ShapeKind {
        match self {
            Self::Polygons(polygons) => {
                ShapeKind::Curves { dimension: polygons.iter().map(Polygon::result_dimension).max().unwrap_or(1) }
            }
            Self::Mesh(_) => ShapeKind::Mesh,
        }
    }

    /// Returns the attachments of a mesh; polygons have none.
    pub fn attachments(&self) -> &Attachments {
        self.mesh().map_or(Attachments::none(), |mesh| &mesh.attachments)
    }

    /// Resolves a plan for the input.
    ///
    /// # Errors
    /// Every fault of the plan, with pointers below it.
    pub fn plan(&self, plan: &PlanInput) -> Result<Plan, Vec<Fault>> {
        Plan::resolve(plan, self.subject(plan))
    }

    /// Returns the mesh, if the input is one.
    pub fn mesh(&self) -> Option<&Mesh> {
        if let Self::Mesh(mesh) = self { Some(mesh) } else { None }
    }

    /// Returns whether single points have parameters of their own.
    pub fn has_own_parameters(&self) -> bool {
        match self {
            Self::Polygons(polygons) => polygons.iter().any(|polygon| polygon.attributes.is_some()),
            Self::Mesh(mesh) => mesh.attributes.is_some(),
        }
    }

    /// Returns the properties of the input that matter to a plan.
    pub(super) fn subject(&self, input: &PlanInput) -> Subject {
        let (is_mesh, is_open) = self.kind();
        let mesh = self.mesh();
        let attached = match mesh {
            Some(mesh) if mesh.attachments.uvs.is_some() => Some("uvs"),
            Some(mesh) if mesh.attachments.unfolded.is_some() => Some("channels of corners"),
            Some(mesh) if mesh.attachments.tells_faces_apart() => Some("groups and materials"),
            _ => None,
        };
        let tags = match self {
            Self::Polygons(polygons) if polygons.iter().any(|p| !p.corners.is_empty()) => Some("corners"),
            Self::Polygons(polygons) => {
                polygons.iter().any(|p| p.attributes.is_some()).then_some("parameters of points")
            }
            Self::Mesh(mesh) if !mesh.corners.is_empty() || !mesh.semi_sharp_corners.is_empty() => Some("corners"),
            Self::Mesh(mesh) if !mesh.creases.is_empty() => Some("creases"),
            Self::Mesh(mesh) if !mesh.holes.is_empty() => Some("holes"),
            Self::Mesh(_) if is_open && input.boundary == Boundary::None => {
                Some("the holes that boundary \"none\" makes")
            }
            Self::Mesh(mesh) if mesh.directions.is_some() => Some("latitude and longitude tags"),
            Self::Mesh(mesh) if mesh.attributes.is_some() => Some("parameters of vertices"),
            Self::Mesh(_) => attached,
        };
        let semi_sharp_edge = |mesh: &Mesh| mesh.creases.iter().any(|&(_, sharpness)| sharpness < INFINITE_SHARPNESS);
        let semi_sharp = match mesh {
            Some(mesh) if !mesh.semi_sharp_corners.is_empty() => Some("corners"),
            Some(mesh) if semi_sharp_edge(mesh) => Some("creases"),
            _ => None,
        };
        let other_face = mesh.and_then(|mesh| {
            let face = mesh.topology.first_other_than_triangle()?;
            Some((face, mesh.topology.face(face).len()))
        });
        let carried = mesh.and_then(|mesh| match &mesh.directions {
            Some(directions) if directions.any_latitude() => Some(Carried::Latitude),
            Some(_) => Some(Carried::Longitude),
            None => mesh.attributes.is_some().then_some(Carried::Parameters),
        });
        let carry_alpha = |kept: &Option<Attributes>| kept.as_ref().is_some_and(|kept| kept.alpha.is_some());
        let carried_by_all = match self {
            Self::Polygons(polygons) => polygons.iter().all(|polygon| carry_alpha(&polygon.attributes)),
            Self::Mesh(mesh) => carry_alpha(&mesh.attributes),
        };
        let alpha = if carried_by_all { AlphaOf::Points } else { AlphaOf::Plan };
        let creased = mesh.is_some_and(|mesh| !mesh.creases.is_empty());
        Subject { is_mesh, is_open, tags, attached, creased, carried, semi_sharp, alpha, other_face }
    }
}
