//! Operators: one file each; the registry is the only place that lists them.

mod around;
mod average;
mod box_average;
mod butterfly;
mod catmull_clark;
mod circle;
mod cosines;
mod doo_sabin;
mod dual;
mod incenter;
mod kobbelt_edges;
mod kobbelt_faces;
mod latitude;
mod local_average;
mod loop_smoothing;
mod masked;
mod push_back;
mod ring_average;
mod root_three;
mod upsample;

use std::fmt;

pub use butterfly::ButterflyEdges;
pub use catmull_clark::CatmullClark;
pub use circle::Circle;
pub use doo_sabin::DooSabin;
pub(super) use dual::dual;
pub use incenter::Incenter;
pub use kobbelt_edges::KobbeltEdges;
pub use kobbelt_faces::KobbeltFaces;
pub use latitude::LatitudeRule;
pub use loop_smoothing::LoopSmoothing;
pub use masked::Masked;
pub use push_back::CIRCULAR_PUSH_BACK;
pub(super) use push_back::seen_valence;
pub use root_three::RootThree;

use super::census::Census;
use super::mesh_net::MeshNet;
use super::polygon_net::PolygonNet;
use super::step::{Step, StepError, Values};
use super::window::Window;
use super::word::Letter;

/// Every operator, in the order of the documentation.
pub const OPERATORS: &[&dyn Operator] = &[
    &upsample::Upsample,
    &dual::Dual,
    &average::Average,
    &box_average::BoxAverage,
    &push_back::PUSH_BACK,
    &masked::Masked,
    &circle::Circle,
    &push_back::CIRCULAR_PUSH_BACK,
    &incenter::Incenter,
    &catmull_clark::CatmullClark,
    &loop_smoothing::LoopSmoothing,
    &doo_sabin::DooSabin,
    &kobbelt_edges::KobbeltEdges,
    &kobbelt_faces::KobbeltFaces,
    &butterfly::ButterflyEdges,
    &root_three::RootThree,
];

/// Arities of U.
pub const ARITIES: Arities = Arities { least: 2, most: 8 };

/// A range of arities.
#[derive(Debug, Clone, Copy)]
pub struct Arities {
    /// Smallest.
    pub least: u32,
    /// Largest.
    pub most: u32,
}

impl Arities {
    /// Whether `arity` is one of them.
    pub fn contains(self, arity: u32) -> bool {
        (self.least..=self.most).contains(&arity)
    }
}

impl fmt::Display for Arities {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.least == self.most { write!(f, "{}", self.least) } else { write!(f, "{} to {}", self.least, self.most) }
    }
}

/// The operator of a letter.
pub fn lettered(letter: char) -> Option<&'static dyn Operator> {
    OPERATORS.iter().copied().find(|op| op.letter() == Some(letter))
}

/// The operator of a name.
pub fn named(name: &str) -> Option<&'static dyn Operator> {
    OPERATORS.iter().copied().find(|op| op.name() == name)
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
pub enum Heirs {
    /// They stay what they are.
    Same,
    /// The mesh gets finer; vertices stay vertices and keep their numbers.
    Vertices,
    /// Vertices become faces and faces vertices.
    Dual,
    /// The mesh gets finer; vertices become faces, faces stay faces, and new vertices stand in the corners of old faces,
    /// in their order.
    Faces,
}

impl Heirs {
    /// Whether the mesh gets finer.
    pub fn refine(self) -> bool {
        matches!(self, Self::Vertices | Self::Faces)
    }
}

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

/// An operator: weights and connectivity; coordinates are seen only by those that are not linear, in an [`Action::Map`].
///
/// [`Action::Map`]: super::step::Action::Map
pub trait Operator: fmt::Debug + Send + Sync {
    /// Its letter in words; presets may use operators that have none.
    fn letter(&self) -> Option<char> {
        None
    }
    /// Its name in the catalogue and in keys.
    fn name(&self) -> &'static str;
    /// What it does, with the formula.
    fn doc(&self) -> &'static str;
    /// Author, year, page.
    fn source(&self) -> &'static str;
    /// What it means for the parameters.
    fn role(&self) -> Role;
    /// The plan parameters it uses.
    fn uses(&self) -> &'static [&'static str] {
        &[]
    }
    /// How it moves and counts the points of a polygon after `duals` half steps since the last upsampling; `None` when
    /// every point stays one.
    fn window(&self, _letter: &Letter, _duals: u32) -> Option<Window> {
        None
    }
    /// Whether its weights follow alpha.
    fn needs_alpha(&self) -> bool {
        false
    }
    /// Sets what follows alpha in its letter.
    ///
    /// # Errors
    /// A sentence, where alpha does not allow it.
    fn at_alpha(&self, _letter: &mut Letter, _alpha: f64) -> Result<(), String> {
        Ok(())
    }
    /// Whether it is not linear but turns tangents along with points of the plane.
    fn turns_tangents(&self) -> bool {
        false
    }
    /// Whether it makes sense only after an upsampling.
    fn needs_upsampling(&self) -> bool {
        false
    }
    /// Whether it moves the points of a polygon by half a step.
    fn shifts(&self, letter: &Letter) -> bool {
        self.window(letter, 0).is_some_and(|window| window.arity == 1 && (window.first + window.last) % 2 != 0)
    }
    /// What becomes of the vertices and faces of a mesh.
    fn heirs(&self) -> Heirs {
        if self.role() == Role::Upsample { Heirs::Vertices } else { Heirs::Same }
    }
    /// What it is among the steps of splines on meshes, with the weight `mu` of vertices on triangles and the kernel 1;
    /// its weights are to be positive everywhere, and regular on boundaries and creases. `None` for other operators.
    fn spline(&self, _letter: &Letter, _mu: f64) -> Option<SplineStep> {
        None
    }
    /// Which sharp edges and vertices of meshes it follows.
    fn follows(&self) -> Follows {
        Follows::Corners
    }
    /// Whether it makes a connectivity of its own, whose faces lie across several old ones.
    fn rebuilds(&self) -> bool {
        false
    }
    /// Whether its rules reach a ring farther beside irregular vertices than in regular nets.
    fn reaches_farther(&self) -> bool {
        false
    }
    /// Whether it can be applied to a mesh as it is given, as far as that depends on its connectivity and tags.
    ///
    /// # Errors
    /// Why not, and where.
    fn admits(&self, _net: &MeshNet) -> Result<(), StepError> {
        Ok(())
    }
    /// The counts of a mesh after it; `None` unless it [rebuilds](Self::rebuilds) it.
    fn census(&self, _before: &Census) -> Option<Census> {
        None
    }
    /// The step on a polygon.
    ///
    /// # Errors
    /// When the operator cannot be applied here.
    fn on_polygon(&self, net: &PolygonNet, values: &Values<'_>) -> Result<Step<PolygonNet>, StepError>;
    /// The step on a mesh.
    ///
    /// # Errors
    /// When the operator cannot be applied here.
    fn on_mesh(&self, net: &MeshNet, values: &Values<'_>) -> Result<Step<MeshNet>, StepError>;
}
