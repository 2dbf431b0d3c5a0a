//! A control mesh under a scheme that OpenSubdiv has, in the terms of USD.

use super::tokens;
use crate::output::control_source::ControlSource;
use crate::scheme::operator::Standard;
use crate::scheme::plan::Plan;
use crate::scheme::rules::TriangleRule;
use crate::scheme::sharpness::Creasing;
use crate::scheme::tags::Boundary;
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::mesh::Mesh;
use crate::shape::seams::{Interpolation, Seams};

/// A control mesh under a scheme that OpenSubdiv has.
#[derive(Debug)]
pub(super) struct UsdaCage<'a> {
    mesh: &'a Mesh,
    plan: &'a Plan,
    standard: Standard,
}

impl<'a> UsdaCage<'a> {
    /// Returns the cage of a plan, if the plan is a scheme of OpenSubdiv with all its rules.
    pub(super) fn of(mesh: &'a Mesh, plan: &'a Plan) -> Option<Self> {
        let standard = plan.standard()?;
        let semi_sharp = |&(_, sharpness): &(u32, f64)| sharpness < INFINITE_SHARPNESS;
        // USD cannot express another rule by which sharpness decreases
        let creases_alike = plan.rules.creasing == Creasing::default() || !mesh.creases.iter().any(semi_sharp);
        creases_alike.then_some(Self { mesh, plan, standard })
    }

    /// Returns the token of `subdivisionScheme`.
    pub(super) fn scheme(&self) -> &'static str {
        match self.standard {
            Standard::CatmullClark => "catmullClark",
            Standard::Loop => "loop",
            Standard::Bilinear => "bilinear",
        }
    }

    /// Returns the tokens of the rules that matter to this mesh, with the names of their attributes.
    pub(super) fn rules(&self) -> Vec<(&'static str, &'static str)> {
        let mut rules = Vec::new();
        let topology = &self.mesh.topology;
        // the rule makes no difference to a closed mesh, whose bytes are then the same under all of them
        let boundary = if topology.n_boundary() > 0 { self.plan.boundary } else { Boundary::default() };
        rules.push(("interpolateBoundary", tokens::boundary(boundary)));
        let has_triangle = || (0..topology.n_faces()).any(|f| topology.face(f).len() == 3);
        if self.plan.rules.triangles == TriangleRule::Smooth && has_triangle() {
            rules.push(("triangleSubdivisionRule", "smooth"));
        }
        if let Some(uvs) = &self.mesh.attachments.uvs {
            rules.push(("faceVaryingLinearInterpolation", tokens::interpolation(uvs.seams.interpolation(topology))));
        }
        rules
    }

    /// Returns the names of channels of corners that are interpolated otherwise than texture coordinates: USD has one
    /// rule for all values of corners.
    pub(super) fn otherwise(&self) -> Vec<&str> {
        let carried = &self.mesh.attachments;
        let word = |seams: &Seams| seams.interpolation(&self.mesh.topology);
        let of_uvs = carried.uvs.as_ref().map_or(Interpolation::CornersPlus1, |uvs| word(&uvs.seams));
        let differs = |seams: &Option<Seams>| seams.as_ref().is_some_and(|seams| word(seams) != of_uvs);
        carried.channels.iter().filter(|channel| differs(&channel.seams)).map(|channel| channel.name.as_str()).collect()
    }

    /// Returns the mesh, hidden faces included.
    pub(super) fn source(&self) -> ControlSource<'a> {
        ControlSource(self.mesh)
    }
}
