//! The reasons for which there is no limit.

use super::bounds::{
    MAX_DISC_VERTICES, MAX_DISCS, MAX_FOLLOWED_LEVELS, MAX_FOLLOWED_POINTS, MAX_INFLUENCE_RINGS, MAX_LEVEL_POINTS,
};
use crate::analysis::no_level::NoLevel;
use crate::refine::RefineError;
use crate::scheme::step_error::StepError;
use crate::watch::Stopped;

/// The reason for which there is no limit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unlimited {
    /// The computation was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// A later level cannot be computed.
    #[error("the limit needs later levels, of which one cannot be computed: {0}")]
    Later(String),
    /// No operator of the cycle refines.
    #[error("there is no limit surface where no operator of the plan's cycle refines")]
    NoUpsampling,
    /// A D leaves no faces near a vertex.
    #[error(
        "a vertex has no limit, as D leaves no faces near it, where all vertices lie on the boundary; widen the mesh \
         there, or close it"
    )]
    Lost,
    /// Faces take the place of vertices, so that no boundary vertex has a vertex as child.
    #[error("faces take the place of vertices here, so that no boundary vertex stays one")]
    NoVertex,
    /// The rules differ from their mirror image.
    #[error("the rules there are not their own mirror image, as the analysis takes them to be")]
    Lopsided,
    /// The iteration for eigenvalues does not converge.
    #[error("the eigenvalues of the local matrix were not found")]
    NoEigenvalues,
    /// A D separates the faces near a vertex, so that several vertices take the place of one face.
    #[error(
        "a vertex has no limit, as D parts the faces near it, where the mesh is one face wide; widen it there, or \
         refine once more"
    )]
    Separated,
    /// The scheme is not linear: new points are no weighted means of old ones.
    #[error("limits are known for linear schemes only")]
    NotLinear,
    /// The surroundings of all vertices of a perturbed plan have more than `MAX_FOLLOWED_POINTS` points together.
    #[error(
        "the vertices of a perturbed plan have more than {MAX_FOLLOWED_POINTS} points around them in all, with which \
             each is followed by itself, beyond which no limit is computed; ask for fewer levels"
    )]
    Followed,
    /// A perturbation keeps the points around a vertex from converging within `MAX_FOLLOWED_LEVELS` levels.
    #[error(
        "the perturbation keeps the points around a vertex apart for more than {MAX_FOLLOWED_LEVELS} levels, beyond \
             which no limit is computed; choose a smaller amplitude or decay"
    )]
    Wild,
    /// More than `MAX_DISCS` different discs have vertex parameters that differ.
    #[error(
        "vertices whose parameters differ from those around them have more than {MAX_DISCS} different surroundings, \
             each of which is followed by itself, beyond which no limit is computed; ask for fewer levels"
    )]
    Different,
    /// More than `MAX_INFLUENCE_RINGS` rings of faces influence a limit.
    #[error("the scheme reaches farther than {MAX_INFLUENCE_RINGS} rings of faces, beyond which no limit is computed")]
    Reach,
    /// A disc has more than `MAX_DISC_VERTICES` vertices.
    #[error(
        "a vertex has more than {MAX_DISC_VERTICES} others near it, beyond which no limit is computed; refine once more"
    )]
    Size,
    /// The operators of a level make more than `MAX_LEVEL_POINTS` points near a vertex.
    #[error(
        "a level of the plan makes more than {MAX_LEVEL_POINTS} points of those near a vertex, beyond which no limit \
         is computed; write a cycle with fewer or smaller upsamplings"
    )]
    Fine,
    /// The discs of a vertex and its children never repeat, or weights do not converge.
    #[error("the plan has no limit, as its levels do not settle")]
    Unsettled,
    /// Differences between neighbours do not shrink from level to level.
    #[error(
        "the plan has no continuous limit, as differences between neighbours do not shrink from level to level; choose \
         tamer parameters"
    )]
    Rough,
}

impl Unlimited {
    /// Returns whether the reason may be that a disc is too narrow.
    pub(super) fn may_be_of_the_disc(&self) -> bool {
        matches!(self, Self::Reach | Self::Later(_) | Self::Lost | Self::Separated)
    }
}

impl From<StepError> for Unlimited {
    fn from(error: StepError) -> Self {
        Self::Later(error.to_string())
    }
}

impl From<RefineError> for Unlimited {
    fn from(error: RefineError) -> Self {
        match error {
            RefineError::Stopped(stopped) => Self::Stopped(stopped),
            RefineError::Step { error, .. } => error.into(),
            other @ RefineError::NotFinite { .. } => Self::Later(other.to_string()),
        }
    }
}

impl From<Unlimited> for NoLevel {
    fn from(error: Unlimited) -> Self {
        if let Unlimited::Stopped(stopped) = error { Self::Stopped(stopped) } else { Self::Refused(error.to_string()) }
    }
}

/// The reason for which a mesh could not be refined to its limit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LimitError {
    /// The mesh could not be refined.
    #[error(transparent)]
    Refine(#[from] RefineError),
    /// There is no limit.
    #[error("{0}; ask for \"positions\": \"refined\"")]
    Unlimited(Unlimited),
}

impl From<Unlimited> for LimitError {
    fn from(error: Unlimited) -> Self {
        match error {
            Unlimited::Stopped(stopped) => Self::Refine(stopped.into()),
            error => Self::Unlimited(error),
        }
    }
}
