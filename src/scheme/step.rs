//! What one operator does to one net: the net that follows and the weights that lead to it.

use std::fmt;
use std::sync::Arc;

use super::local::{MAX_COMPENSATION, Sources};
use super::rules::LatitudeRule;
use super::settings::Settings;
use crate::math::expression::{Expression, ExpressionError};
use crate::math::planar::Vector;
use crate::math::rows::RowSource;
use crate::shape::creases::INFINITE_SHARPNESS;
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
        /// For each anchor point its child; [`NONE`](crate::shape::topology::NONE) where a net was cut out of a closed mesh and D lost it at the cut, so
        /// that the difference is not known.
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

impl Action {
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

    /// The weights with which a linear step with a table makes point number `point`, given the row of the point there: what
    /// [`Points::act`](crate::refine::Points::act) computes for all points at once.
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

/// Why an operator cannot be applied.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StepError {
    /// Push-back without an upsampling before it.
    #[error("P needs a U before it: it pushes back towards what entered the last U")]
    NoAnchor,
    /// A window average without an upsampling that gives its width.
    #[error("A needs a U before it: it averages as many points as the arity of the last U")]
    NoArity,
    /// A value of a single point that does not exist.
    #[error("{0}; choose other values")]
    Local(String),
    /// A kernel of a single point with which no average exists.
    #[error(
        "the {name} of point {point}{} is {value}, where no average exists, as its weights add up to 0; it is any number \
         but -1", origin(*.point, .from)
    )]
    NoAverage {
        /// Which kernel.
        name: &'static str,
        /// The point, in the net that entered the last U or, beyond its points, that came of it.
        point: usize,
        /// Its kernel.
        value: f64,
        /// The points of the input that make it, ascending, where they are known.
        from: Vec<u32>,
    },
    /// A compensation of a single point beyond [`MAX_COMPENSATION`].
    #[error("{}", large_compensation(*.point, *.value, *.alpha, .from))]
    LargeCompensation {
        /// The point, in the net that came of the last U.
        point: usize,
        /// Its compensation.
        value: f64,
        /// Its alpha, where the compensation is a function of that.
        alpha: Option<f64>,
        /// The points of the input between which it lies, ascending, where they are known.
        from: Vec<u32>,
    },
    /// Tags that a scheme of its own mask cannot carry.
    #[error("this scheme is a mask, which knows no {0}; leave them out or use a word over U, C and P")]
    MaskTags(&'static str),
    /// Push-back in a dual net.
    #[error("P needs an even number of D since the last U; here it is {0}")]
    OddDuals(u32),
    /// Push-back after points were lost.
    #[error("P needs a child of every point that entered the last U; here some were lost to {0}")]
    LostPoints(&'static str),
    /// What a scheme has no use for.
    #[error("this scheme knows no {0}; leave them out or use a word over U, C and P")]
    Useless(&'static str),
    /// What only upsamplings that halve edges and make quads have a use for.
    #[error(
        "{what} act in words over U, C and P with arity 2 and split quad; here stands {found}: change it or leave them out"
    )]
    NotHalves {
        /// What.
        what: &'static str,
        /// The upsampling, or its split.
        found: String,
    },
    /// Too few points would remain.
    #[error("natural ends leave {0} points; at least 2 must remain: give more points or use clamped ends")]
    TooFewPoints(usize),
    /// D where something cannot follow.
    #[error("D cannot carry {0}, nor can A of an even arity: leave them out or use C, which is two D at once")]
    DualTags(&'static str),
    /// Sharp edges where they are not known.
    #[error("this scheme knows no creases; leave them out, or use catmull-clark, push-back or a word over U, C and P")]
    Creases,
    /// Sharpness between smooth and infinitely sharp where it is not known.
    #[error(
        "{0} of a sharpness between 0 and {INFINITE_SHARPNESS} belong to catmull-clark and loop; here an edge or vertex is smooth \
         (0) or infinitely sharp ({INFINITE_SHARPNESS} or more)"
    )]
    SemiSharp(&'static str),
    /// A mesh without interior vertices has no dual.
    #[error("D needs a vertex all of whose faces meet in a full ring; this mesh has none")]
    NoInterior,
    /// The dual is no manifold, as when two faces share several edges.
    #[error("D is not possible here, as the dual is no manifold ({0}); apply a U first")]
    DualNotManifold(String),
    /// A scheme of its own connectivity where something cannot follow.
    #[error("{0} cannot carry {1}, as its faces lie across several old ones; leave them out")]
    OwnTags(&'static str, &'static str),
    /// A corner that has no vertex in the dual.
    #[error(
        "vertex {0} is tagged as a corner; doo-sabin, which makes faces of vertices, keeps corners only on the boundary \
         where one face meets them: leave the tag out"
    )]
    DualCorner(usize),
    /// A vertex all around which there are two faces only.
    #[error(
        "all around vertex {vertex} there are only two faces; {scheme} needs at least three there: remove the vertex or \
         split the faces"
    )]
    TwoFaces {
        /// The scheme.
        scheme: &'static str,
        /// The vertex.
        vertex: usize,
    },
    /// A face of more vertices than there may be.
    #[error("face {face} has {size} vertices; {scheme} takes at most {most}: split the face")]
    LargeFace {
        /// The scheme.
        scheme: &'static str,
        /// The face.
        face: usize,
        /// Its vertices.
        size: usize,
        /// The bound.
        most: usize,
    },
    /// A vertex of more faces than there may be.
    #[error("vertex {vertex} has {n} faces; {scheme} takes at most {most} around a vertex: split the vertex")]
    LargeRing {
        /// The scheme.
        scheme: &'static str,
        /// The vertex.
        vertex: usize,
        /// Its faces.
        n: usize,
        /// The bound.
        most: usize,
    },
    /// A face that cannot be split into triangles.
    #[error(
        "face {face} has {size} vertices, and only triangles are split into triangles; send a mesh of triangles, or use \
         a scheme for any faces, such as catmull-clark or a word with \"split\": \"quad\""
    )]
    NotTriangles {
        /// The first such face.
        face: usize,
        /// Its number of vertices.
        size: usize,
    },
    /// The operator acts on the other kind of net only.
    #[error("{0}")]
    WrongNet(&'static str),
    /// The push-back factor has no value at some valence.
    #[error("delta: {error} (valence {valence})")]
    Delta {
        /// Where it failed.
        valence: usize,
        /// Why.
        error: ExpressionError,
    },
}

/// The sentence of a compensation beyond its bound.
fn large_compensation(point: usize, value: f64, alpha: Option<f64>, from: &[u32]) -> String {
    let (why, remedy) = match alpha {
        Some(alpha) => (format!(" (alpha = {alpha}), a pole of the function"), "choose another alpha there"),
        None => (String::new(), "choose smaller ones"),
    };
    format!(
        "the compensation of point {point}{} is {value}{why}; at most {MAX_COMPENSATION} in size is allowed: {remedy}",
        origin(point, from)
    )
}

/// What a sentence says of the points of the input that make a point: the first of them where they are many.
fn origin(point: usize, from: &[u32]) -> String {
    const MOST: usize = 8;
    let named = from.iter().take(MOST).map(u32::to_string).collect::<Vec<_>>().join(", ");
    match from {
        [] => String::new(),
        &[own] if own as usize == point => String::new(),
        [_] => format!(" (point {named} of the input)"),
        _ if from.len() > MOST => format!(" (between the points {named}, ... of the input)"),
        _ => format!(" (between the points {named} of the input)"),
    }
}
