//! What an operator is: facts, declared once and read by everybody, and the little that it does.

use std::fmt;

use super::curve_rule::CurveRule;
use super::forecast::Census;
use super::mesh_net::MeshNet;
use super::polygon_net::PolygonNet;
use super::settings::Settings;
use super::step::{Step, Values};
use super::step_error::StepError;
use super::window::Window;
use crate::math::parameter::Parameter;

/// An operator: weights and connectivity; coordinates are seen only by those that are not linear, in an
/// [`Action::Map`].
///
/// [`Action::Map`]: super::step::Action::Map
pub trait Operator: fmt::Debug + Send + Sync {
    /// What holds of it everywhere.
    fn facts(&self) -> &'static Facts;
    /// How it moves and counts the points of a polygon after `duals` half steps since the last upsampling; `None` when
    /// every point stays one.
    fn window(&self, _settings: &Settings, _duals: u32) -> Option<Window> {
        None
    }
    /// Sets what follows alpha among the values of a letter.
    ///
    /// # Errors
    /// A sentence, where alpha does not allow it.
    fn at_alpha(&self, _settings: &mut Settings, _alpha: f64) -> Result<(), String> {
        Ok(())
    }
    /// What it is among the steps of splines on meshes, with the weight `mu` of vertices on triangles and the kernel 1;
    /// its weights are to be positive everywhere, and regular on boundaries and creases.
    ///
    /// # Errors
    /// What keeps a cycle with this operator from making splines, as the end of a sentence.
    fn spline(&self, _settings: &Settings, _mu: f64) -> Result<SplineStep, &'static str> {
        Err("its steps are others")
    }
    /// Whether it can be applied to a mesh as it is given, as far as that depends on its connectivity and tags.
    ///
    /// # Errors
    /// Why not, and where.
    fn admits(&self, _net: &MeshNet) -> Result<(), StepError> {
        Ok(())
    }
    /// The counts of a mesh after it, for operators that [rebuild](Facts::rebuilds) it; others leave them as they are.
    fn census(&self, before: &Census) -> Census {
        *before
    }
    /// The step on a polygon.
    ///
    /// # Errors
    /// When the operator cannot be applied here.
    fn on_polygon(&self, _net: &PolygonNet, _values: &Values<'_>) -> Result<Step<PolygonNet>, StepError> {
        Err(StepError::new(self.facts().nets.not_polygons().unwrap_or_default()))
    }
    /// The step on a mesh.
    ///
    /// # Errors
    /// When the operator cannot be applied here.
    fn on_mesh(&self, _net: &MeshNet, _values: &Values<'_>) -> Result<Step<MeshNet>, StepError> {
        Err(StepError::new(self.facts().nets.not_meshes().unwrap_or_default()))
    }
}

/// What holds of an operator everywhere.
#[derive(Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a question of its own, asked by its name")]
pub struct Facts {
    /// Its letter in words; presets may use operators that have none.
    pub letter: Option<char>,
    /// Its name in the catalogue and in keys.
    pub name: &'static str,
    /// What it does, with the formula.
    pub doc: &'static str,
    /// Author, year, page.
    pub source: &'static str,
    /// To which nets it can be applied.
    pub nets: Nets,
    /// What it does to polygons between their ends, where that is linear.
    pub curve: Option<CurveRule>,
    /// What it means for the parameters that change along a plan.
    pub role: Role,
    /// The plan parameters that it uses.
    pub uses: &'static [&'static str],
    /// The parameters that each of its letters has a value of.
    pub parameters: &'static [Parameter],
    /// What becomes of the vertices and faces of a mesh.
    pub children: Children,
    /// Which sharp edges and vertices of meshes it follows.
    pub follows: Follows,
    /// The operator that two of it in a row are, up to the order of points; on meshes where they are closed.
    pub twice: Option<&'static dyn Operator>,
    /// Whether single points of a mesh may have their own kernel, compensation or push-back factor, be it from vertex
    /// parameters, latitude and longitude tags or the perturbation, as long as edges are halved and faces are quads.
    pub pointwise: bool,
    /// Whether meshes become smooth by it: not by linear interpolation, which keeps their edges.
    pub smooths: bool,
    /// Whether its weights follow alpha.
    pub needs_alpha: bool,
    /// Why it makes no sense before the first upsampling, if it makes none.
    pub needs_upsampling: Option<&'static str>,
    /// Whether it is not linear but turns tangents along with points of the plane.
    pub turns_tangents: bool,
    /// Whether it makes a connectivity of its own, whose faces lie across several old ones.
    pub rebuilds: bool,
    /// Boundaries are cut in every so many-th step, where it makes a connectivity of its own.
    pub boundary_every: u32,
    /// Whether on regular meshes of quads or triangles its rows are symmetric sums, so that a point has the same bits
    /// wherever the walk around it begins.
    pub symmetric: bool,
    /// Whether after a split of faces into quads the limit surface of regular nets is bicubic, and vertices of other
    /// valences have the limits and tangents of Catmull and Clark's scheme.
    pub bicubic: bool,
    /// The scheme of OpenSubdiv that it makes with one upsampling before it, or alone where it is that upsampling.
    pub standard: Option<Standard>,
    /// Whether its rules reach a ring farther beside extraordinary vertices than in regular nets.
    pub reaches_farther: bool,
}

impl Facts {
    /// Whether letters have a value of a parameter.
    pub fn has(&self, parameter: &Parameter) -> bool {
        self.parameters.iter().any(|declared| declared.name == parameter.name)
    }

    /// What holds of an operator that says nothing else; its name, documentation and source are still to be given.
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

/// A scheme that OpenSubdiv has, so that other programs refine cages by it themselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standard {
    /// Catmull and Clark's, on faces of any size.
    CatmullClark,
    /// Loop's, on triangles.
    Loop,
    /// Bilinear interpolation.
    Bilinear,
}

/// To which nets an operator can be applied, and why not to others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Nets {
    /// Polygons and meshes.
    Both,
    /// Polygons; why no meshes.
    Polygons(&'static str),
    /// Meshes; why no polygons.
    Meshes(&'static str),
}

impl Nets {
    /// Why it cannot be applied to polygons, if it cannot.
    pub fn not_polygons(self) -> Option<&'static str> {
        if let Self::Meshes(why) = self { Some(why) } else { None }
    }

    /// Why it cannot be applied to meshes, if it cannot.
    pub fn not_meshes(self) -> Option<&'static str> {
        if let Self::Polygons(why) = self { Some(why) } else { None }
    }
}

/// What an operator means for the parameters that change along a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Divides alpha at the next of its kind, and lets the next average use the kernel.
    Upsample,
    /// Uses the kernel when it is the first since an upsampling.
    Average,
    /// Uses the compensation and delta.
    PushBack,
    /// Uses no parameter that changes.
    Smooth,
}

/// What becomes of the vertices and faces of a mesh in one step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Children {
    /// They stay what they are.
    Same,
    /// The mesh gets finer; vertices stay vertices and keep their numbers.
    Vertices,
    /// Vertices become faces and faces vertices.
    Dual,
    /// The mesh gets finer; vertices become faces, faces stay faces, and new vertices stand in the corners of old
    /// faces, in their order.
    Faces,
}

impl Children {
    /// Whether the mesh gets finer.
    pub fn refine(self) -> bool {
        matches!(self, Self::Vertices | Self::Faces)
    }
}

/// The schemes whose steps make splines, for sentences.
pub const SPLINES: &str = "Catmull-Clark, Loop and words over U, C and D that make splines";

/// The schemes whose regular pieces are bicubic, for sentences.
pub const BICUBIC: &str = "Catmull-Clark (preset \"catmull-clark\")";

/// What an operator is among the steps that make splines of regular nets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SplineStep {
    /// Points halfway between old ones.
    Upsample,
    /// A mean over neighbours in all directions, with the weights (1, 2, 1)/4 in each of two, or 1/4 and six times 1/8.
    Mean,
    /// Half of it: a mean over the corners of a face.
    HalfMean,
}

/// Which sharp edges and vertices an operator follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Follows {
    /// Vertices that are infinitely sharp.
    Corners,
    /// Edges that are infinitely sharp, too.
    Creases,
    /// Any sharpness.
    SemiSharp,
}
