//! The result of applying one operator to a net: the next net and the action on its points.

use std::fmt;
use std::sync::Arc;

use super::local::Sources;
use super::rules::LatitudeRule;
use super::settings::LetterSettings;
use crate::math::expression::Expression;
use crate::math::planar::Vector2;
use crate::math::rows::RowSource;
use crate::shape::topology::NONE;
use crate::watch::{Stopped, Watch};

/// The values with which an operator is applied at one place of a plan.
#[derive(Debug, Clone, Copy)]
pub struct StepValues<'a> {
    /// The values of the letter's parameters.
    pub settings: &'a LetterSettings,
    /// The alpha that entered the last upsampling, in radians.
    pub alpha: f64,
    /// Value of the kernel for this average.
    pub kernel: f64,
    /// Weight of a vertex in averages of triangles.
    pub mu: f64,
    /// Value of the compensation function.
    pub compensation: f64,
    /// The push-back factor, an expression in the valence.
    pub delta: &'a Expression,
    /// Whether this is the first average since the last upsampling.
    pub first: bool,
    /// The rule for odd points of latitude lines.
    pub latitude_rule: LatitudeRule,
    /// The functions from which upsamplings compute the values of single points; `None` if all have those of the plan.
    pub sources: Option<Sources<'a>>,
}

/// One step of a refinement.
#[derive(Debug)]
pub struct Step<Net> {
    /// The net after the step.
    pub net: Net,
    /// The action on its points.
    pub action: Action,
}

/// The action of a step on the points of a net.
#[derive(Debug)]
pub enum Action {
    /// `points <- rows x points`.
    Blend(Box<dyn RowSource>),
    /// The points become the anchor, then are blended by `points <- rows x points`.
    BlendFromAnchor(Box<dyn RowSource>),
    /// `points <- points + rows x (anchor - children)`; `children[i]` is the child of anchor point `i`.
    PushBack {
        /// One row for each point, over the points of the anchor.
        rows: Box<dyn RowSource>,
        /// The child of each anchor point; [`NONE`] where a net was cut out of a closed mesh and D lost the point at
        /// the cut, so that the difference is unknown.
        children: Arc<[u32]>,
    },
    /// A nonlinear step maps points and tangents.
    Map(Box<dyn PointMap>),
    /// Several actions, one after another.
    Sequence(Vec<Action>),
}

/// The kind of a term of a new point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TermKind {
    /// A point before the step.
    Point(u32),
    /// A point of the anchor.
    Anchor(u32),
    /// A point that was lost where the net was cut out of a closed mesh, so that its position is unknown.
    Lost,
}

/// The operand of an action: the points of a net, or rows of weights that stand for them.
pub trait Operand {
    /// The error of an action that cannot be applied.
    type Error;

    /// Sets `points <- rows x points`; if `anchor` is set, the points before become the anchor.
    ///
    /// # Errors
    /// The errors of the operand.
    fn blend(&mut self, rows: &dyn RowSource, anchor: bool) -> Result<(), Self::Error>;

    /// Sets `points <- points + rows x (anchor - children)`, see [`Action::PushBack`].
    ///
    /// # Errors
    /// The errors of the operand.
    fn push_back(&mut self, rows: &dyn RowSource, children: &[u32]) -> Result<(), Self::Error>;

    /// Maps points and tangents by a nonlinear step.
    ///
    /// # Errors
    /// The errors of the operand; in particular if it has no coordinates.
    fn map(&mut self, map: &dyn PointMap) -> Result<(), Self::Error>;
}

impl Action {
    /// Applies the action: an operand says what blends, push-backs and maps mean for it. [`Action::weights`] says the
    /// same of single rows, for those who read weights.
    ///
    /// # Errors
    /// The errors of the operand.
    pub fn apply<T: Operand>(&self, operand: &mut T) -> Result<(), T::Error> {
        match self {
            Self::Blend(rows) => operand.blend(&**rows, false),
            Self::BlendFromAnchor(rows) => operand.blend(&**rows, true),
            Self::PushBack { rows, children } => operand.push_back(&**rows, children),
            Self::Map(map) => operand.map(&**map),
            Self::Sequence(actions) => actions.iter().try_for_each(|action| action.apply(operand)),
        }
    }

    /// Returns the rows of a blend, or `None` for other actions.
    pub fn rows(&self) -> Option<&dyn RowSource> {
        match self {
            Self::Blend(rows) | Self::BlendFromAnchor(rows) => Some(&**rows),
            _ => None,
        }
    }

    /// Returns the rows of a blend or a push-back; `None` if there is not exactly one table.
    pub fn table(&self) -> Option<&dyn RowSource> {
        match self {
            Self::PushBack { rows, .. } => Some(&**rows),
            _ => self.rows(),
        }
    }

    /// Returns whether the points before the step become the anchor.
    pub fn sets_anchor(&self) -> bool {
        matches!(self, Self::BlendFromAnchor(_))
    }

    /// Calls `each` with the terms of point `point` and their weights in a linear step, given the point's row: the sum
    /// that [`Points::act`](crate::refine::Points::act) computes for all points at once.
    pub fn weights(&self, point: u32, (indices, weights): (&[u32], &[f64]), mut each: impl FnMut(TermKind, f64)) {
        let entries = indices.iter().zip(weights);
        let Self::PushBack { children, .. } = self else {
            return entries.for_each(|(&index, &weight)| each(TermKind::Point(index), weight));
        };
        each(TermKind::Point(point), 1.0);
        for (&index, &weight) in entries {
            each(TermKind::Anchor(index), weight);
            let child = children[index as usize];
            each(if child == NONE { TermKind::Lost } else { TermKind::Point(child) }, -weight);
        }
    }
}

/// A nonlinear step on points of the plane and their tangents, the only kind of step that sees coordinates.
pub trait PointMap: fmt::Debug + Send + Sync {
    /// Returns the next points and their unit tangents; there is one tangent per point.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    fn apply(
        &self,
        points: &[Vector2],
        tangents: &[Vector2],
        watch: &Watch,
    ) -> Result<(Vec<Vector2>, Vec<Vector2>), Stopped>;
}
