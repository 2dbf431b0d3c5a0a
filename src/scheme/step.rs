//! What one operator does to one net: the net that follows and the weights that lead to it.

use std::fmt;
use std::sync::Arc;

use super::local::Sources;
use super::rules::LatitudeRule;
use super::settings::Settings;
use crate::math::expression::Expression;
use crate::math::planar::Vector;
use crate::math::rows::RowSource;
use crate::shape::topology::NONE;
use crate::watch::{Stopped, Watch};

/// The numbers an operator works with at one place of a plan.
#[derive(Debug, Clone, Copy)]
pub struct Values<'a> {
    /// The values of the parameters of its letter.
    pub settings: &'a Settings,
    /// Parameter spacing that entered the last upsampling, radians.
    pub alpha: f64,
    /// Value of the kernel for this average.
    pub kernel: f64,
    /// Weight of a vertex in averages of triangles.
    pub mu: f64,
    /// Value of the compensation function.
    pub compensation: f64,
    /// Push-back factor, an expression in the valence.
    pub delta: &'a Expression,
    /// Whether it is the first average since the last upsampling.
    pub first: bool,
    /// What odd points of latitude lines follow.
    pub latitude_rule: LatitudeRule,
    /// From what upsamplings compute values of single points; `None` when all have the plan's.
    pub sources: Option<Sources<'a>>,
}

/// One step of a refinement.
#[derive(Debug)]
pub struct Step<Net> {
    /// The net after the step.
    pub net: Net,
    /// How its points come about.
    pub action: Action,
}

/// How the points of a step come about.
#[derive(Debug)]
pub enum Action {
    /// `points <- rows x points`.
    Blend(Box<dyn RowSource>),
    /// The points are remembered as the anchor, then blended.
    BlendFromAnchor(Box<dyn RowSource>),
    /// `points <- points + rows x (anchor - children)`; `children[i]` is the point that came of anchor point `i`.
    PushBack {
        /// One row for each point, over the anchor's points.
        rows: Box<dyn RowSource>,
        /// For each anchor point its child; [`NONE`] where a net was cut out of a closed
        /// mesh and D lost it at the cut, so that the difference is not known.
        children: Arc<[u32]>,
    },
    /// Points and tangents are turned into the next ones, by a step that is not linear.
    Map(Box<dyn PointMap>),
    /// One after another.
    Sequence(Vec<Action>),
}

/// What a new point is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// A point before the step.
    Point(u32),
    /// A point of the anchor.
    Anchor(u32),
    /// A point that a net lost where it was cut out of a closed mesh: nothing is known of it.
    Lost,
}

/// What an action is applied to: the points of a net, or rows of weights in their place.
pub trait Operand {
    /// Why an action cannot be applied.
    type Error;

    /// `points <- rows x points`; with `anchor` the points before become the anchor.
    ///
    /// # Errors
    /// Those of the operand.
    fn blend(&mut self, rows: &dyn RowSource, anchor: bool) -> Result<(), Self::Error>;

    /// `points <- points + rows x (anchor - children)`, see [`Action::PushBack`].
    ///
    /// # Errors
    /// Those of the operand.
    fn push_back(&mut self, rows: &dyn RowSource, children: &[u32]) -> Result<(), Self::Error>;

    /// Turns points and tangents into the next ones.
    ///
    /// # Errors
    /// Those of the operand, among them that it has no coordinates.
    fn map(&mut self, map: &dyn PointMap) -> Result<(), Self::Error>;
}

impl Action {
    /// Applies the action: the one place that tells what its variants mean.
    ///
    /// # Errors
    /// Those of the operand.
    pub fn apply<T: Operand>(&self, operand: &mut T) -> Result<(), T::Error> {
        match self {
            Self::Blend(rows) => operand.blend(&**rows, false),
            Self::BlendFromAnchor(rows) => operand.blend(&**rows, true),
            Self::PushBack { rows, children } => operand.push_back(&**rows, children),
            Self::Map(map) => operand.map(&**map),
            Self::Sequence(actions) => actions.iter().try_for_each(|action| action.apply(operand)),
        }
    }

    /// The rows of a blend.
    pub fn rows(&self) -> Option<&dyn RowSource> {
        match self {
            Self::Blend(rows) | Self::BlendFromAnchor(rows) => Some(&**rows),
            _ => None,
        }
    }

    /// The rows of a linear step, whatever they are applied to; `None` where there is none or more than one table.
    pub fn table(&self) -> Option<&dyn RowSource> {
        match self {
            Self::PushBack { rows, .. } => Some(&**rows),
            _ => self.rows(),
        }
    }

    /// Whether the points before the step become the anchor.
    pub fn sets_anchor(&self) -> bool {
        matches!(self, Self::BlendFromAnchor(_))
    }

    /// The weights with which a linear step with a table makes point number `point`, given the row of the point there:
    /// what [`Points::act`](crate::refine::Points::act) computes for all points at once.
    pub fn weights(&self, point: u32, (indices, weights): (&[u32], &[f64]), mut each: impl FnMut(Source, f64)) {
        let entries = indices.iter().zip(weights);
        let Self::PushBack { children, .. } = self else {
            return entries.for_each(|(&index, &weight)| each(Source::Point(index), weight));
        };
        each(Source::Point(point), 1.0);
        for (&index, &weight) in entries {
            each(Source::Anchor(index), weight);
            let child = children[index as usize];
            each(if child == NONE { Source::Lost } else { Source::Point(child) }, -weight);
        }
    }
}

/// A step that is not linear: the one kind that sees coordinates, those of points in the plane and of their tangents.
pub trait PointMap: fmt::Debug + Send + Sync {
    /// The next points and their unit tangents, from points and unit tangents, one for each.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    fn apply(
        &self,
        points: &[Vector],
        tangents: &[Vector],
        watch: &Watch,
    ) -> Result<(Vec<Vector>, Vec<Vector>), Stopped>;
}
