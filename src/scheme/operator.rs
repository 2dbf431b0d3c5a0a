//! The operator trait: facts that are declared once, and a few methods.

use std::fmt;

use super::curve_rule::CurveRule;
use super::forecast::Census;
use super::mask_range::MaskRange;
use super::mesh_net::MeshNet;
use super::polygon_net::PolygonNet;
use super::settings::LetterSettings;
use super::step::{Step, StepValues};
use super::step_error::StepError;
use crate::math::parameter::Parameter;

/// An operator: connectivity and weights. Only operators that are not linear see coordinates, in an [`Action::Map`].
///
/// [`Action::Map`]: super::step::Action::Map
pub trait Operator: fmt::Debug + Send + Sync {
    /// Returns the facts of the operator.
    fn facts(&self) -> &'static Facts;
    /// Returns how the operator moves and counts the points of a polygon after `duals` half steps since the last
    /// upsampling, by default as the mask of the letter does; `None` if every point keeps its place in the sequence.
    fn mask_range(&self, settings: &LetterSettings, _duals: u32) -> Option<MaskRange> {
        settings.mask().map(|mask| MaskRange::of(settings.arity(), &mask))
    }
    /// Sets the values of a letter that depend on alpha.
    ///
    /// # Errors
    /// A sentence, if alpha does not allow it.
    fn at_alpha(&self, _settings: &mut LetterSettings, _alpha: f64) -> Result<(), String> {
        Ok(())
    }
    /// Returns the role of the operator in the steps of splines on meshes, with the weight `mu` of vertices on
    /// triangles and the kernel 1; its weights must be positive everywhere, and regular on boundaries and creases.
    ///
    /// # Errors
    /// The reason for which a cycle with this operator does not make splines, as the end of a sentence.
    fn spline(&self, _settings: &LetterSettings, _mu: f64) -> Result<SplineStep, &'static str> {
        Err("its steps are others")
    }
    /// Checks whether the operator can be applied to a mesh as it is given, as far as connectivity and tags decide.
    ///
    /// # Errors
    /// The reason, and the place.
    fn admits(&self, _net: &MeshNet) -> Result<(), StepError> {
        Ok(())
    }
    /// Returns the counts of a mesh after an operator that [rebuilds](Facts::rebuilds) it; for others, they do not
    /// change.
    fn census(&self, before: &Census) -> Census {
        *before
    }
    /// Applies the operator to a polygon.
    ///
    /// # Errors
    /// If the operator cannot be applied to this polygon.
    fn on_polygon(&self, _net: &PolygonNet, _values: &StepValues<'_>) -> Result<Step<PolygonNet>, StepError> {
        Err(StepError::new(self.facts().nets.not_polygons().unwrap_or_default()))
    }
    /// Applies the operator to a mesh.
    ///
    /// # Errors
    /// If the operator cannot be applied to this mesh.
    fn on_mesh(&self, _net: &MeshNet, _values: &StepValues<'_>) -> Result<Step<MeshNet>, StepError> {
        Err(StepError::new(self.facts().nets.not_meshes().unwrap_or_default()))
    }
}

/// The properties of an operator, as data.
#[derive(Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a question of its own, asked by its name")]
pub struct Facts {
    /// The letter in words, if the operator has one; presets may use operators without a letter.
    pub letter: Option<char>,
    /// The name in the catalogue and in keys.
    pub name: &'static str,
    /// What the operator does, with the formula.
    pub doc: &'static str,
    /// Author, year, page.
    pub source: &'static str,
    /// The kinds of nets to which the operator can be applied.
    pub nets: Nets,
    /// The rule on polygons away from their ends, if it is linear.
    pub curve: Option<CurveRule>,
    /// The effect on parameters that change along a plan.
    pub role: Role,
    /// The plan parameters that the operator uses.
    pub uses: &'static [&'static str],
    /// The parameters for which each of its letters has a value.
    pub parameters: &'static [Parameter],
    /// What becomes of the vertices and faces of a mesh.
    pub children: Children,
    /// The kinds of sharp edges and vertices that the operator supports.
    pub follows: Follows,
    /// The operator that equals this one applied twice, up to the order of points; on meshes, if they are closed.
    pub twice: Option<&'static dyn Operator>,
    /// Whether single points of a mesh may have their own kernel, compensation or push-back factor (from vertex
    /// parameters, latitude and longitude tags or the perturbation), provided that edges are halved and faces are
    /// quads.
    pub pointwise: bool,
    /// Whether the operator smooths meshes; linear interpolation, which keeps their edges, does not.
    pub smooths: bool,
    /// Whether the weights depend on alpha.
    pub needs_alpha: bool,
    /// Why the operator makes no sense before the first upsampling; `None` if it does.
    pub needs_upsampling: Option<&'static str>,
    /// Whether the operator is not linear, but turns tangents along with points of the plane.
    pub turns_tangents: bool,
    /// Whether the operator makes a connectivity of its own, whose faces lie across several old ones.
    pub rebuilds: bool,
    /// The number of steps between cuts of the boundary, for operators with a connectivity of their own.
    pub boundary_every: u32,
    /// Whether its rows on regular meshes of quads or triangles are symmetric sums, so that a point has the same bits
    /// wherever the walk around it begins.
    pub symmetric: bool,
    /// Whether, after a split into quads, the limit surface of regular nets is bicubic, and limits and tangents at
    /// extraordinary vertices are those of Catmull-Clark.
    pub bicubic: bool,
    /// The scheme of OpenSubdiv that the operator is together with an upsampling before it, or alone if it is that
    /// upsampling.
    pub standard: Option<Standard>,
    /// Whether its stencils reach one ring farther at extraordinary vertices than in regular nets.
    pub reaches_farther: bool,
}

impl Facts {
    /// Returns whether its letters have a value of this parameter.
    pub fn has(&self, parameter: &Parameter) -> bool {
        self.parameters.iter().any(|declared| declared.name == parameter.name)
    }

    /// The facts of an operator without special properties; name, documentation and source must still be given.
    pub const USUAL: Self = Self {
        letter: None,
        name: "",
        doc: "",
        source: "",
        nets: Nets::Both,
        curve: None,
        role: Role::Smooth,
        uses: &[],
        parameters: &[],
        children: Children::Same,
        follows: Follows::Corners,
        twice: None,
        pointwise: false,
        smooths: true,
        needs_alpha: false,
        needs_upsampling: None,
        turns_tangents: false,
        rebuilds: false,
        boundary_every: 1,
        symmetric: false,
        bicubic: false,
        standard: None,
        reaches_farther: false,
    };
}

/// A scheme that OpenSubdiv provides, so that other programs can refine control meshes by it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standard {
    /// Catmull-Clark subdivision, for faces of any size.
    CatmullClark,
    /// Loop subdivision, for triangles.
    Loop,
    /// Bilinear interpolation.
    Bilinear,
}

/// The kinds of nets to which an operator can be applied, with the reason for excluding others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Nets {
    /// Polygons and meshes.
    Both,
    /// Polygons only, with the reason for excluding meshes.
    Polygons(&'static str),
    /// Meshes only, with the reason for excluding polygons.
    Meshes(&'static str),
}

impl Nets {
    /// Returns why the operator cannot be applied to polygons, or `None` if it can.
    pub fn not_polygons(self) -> Option<&'static str> {
        if let Self::Meshes(why) = self { Some(why) } else { None }
    }

    /// Returns why the operator cannot be applied to meshes, or `None` if it can.
    pub fn not_meshes(self) -> Option<&'static str> {
        if let Self::Polygons(why) = self { Some(why) } else { None }
    }
}

/// The effect of an operator on parameters that change along a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Divides alpha at the next upsampling, and lets the next average use the kernel.
    Upsample,
    /// Uses the kernel if it is the first average since an upsampling.
    Average,
    /// Uses the compensation and delta.
    PushBack,
    /// Uses no parameter that changes.
    Smooth,
}

/// What becomes of the vertices and faces of a mesh in one step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Children {
    /// Vertices and faces stay the same.
    Same,
    /// The mesh is refined; vertices have vertices as children and keep their indices.
    Vertices,
    /// Vertices become faces, and faces become vertices.
    Dual,
    /// The mesh is refined; vertices become faces, faces have faces as children, and the new vertices lie in the
    /// corners of old faces, in their order.
    Faces,
}

impl Children {
    /// Returns whether the step refines the mesh.
    pub fn refine(self) -> bool {
        matches!(self, Self::Vertices | Self::Faces)
    }
}

/// The schemes whose steps make splines, for messages.
pub const SPLINES: &str = "Catmull-Clark, Loop and words over U, C and D that make splines";

/// The schemes whose regular pieces are bicubic, for messages.
pub const BICUBIC: &str = "Catmull-Clark (preset \"catmull-clark\")";

/// The role of an operator among the steps that make splines of regular nets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SplineStep {
    /// Inserts points halfway between old ones.
    Upsample,
    /// A mean over neighbours in all directions, with weights (1, 2, 1)/4 in each of two, or 1/4 and six times 1/8.
    Mean,
    /// Half of such a mean: the mean over the corners of a face.
    HalfMean,
}

/// The kinds of sharp edges and vertices that an operator supports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Follows {
    /// Infinitely sharp vertices only.
    Corners,
    /// Infinitely sharp vertices and edges.
    Creases,
    /// Any sharpness.
    SemiSharp,
}
