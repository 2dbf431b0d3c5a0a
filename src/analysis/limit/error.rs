//! The reasons for which there is no limit.

use super::bounds::{
    MAX_DISC_VERTICES, MAX_DISCES, MAX_FOLLOWED_LEVELS, MAX_FOLLOWED_POINTS, MAX_LEVEL_POINTS, MAX_RINGS,
};
use crate::analysis::no_level::NoLevel;
use crate::refine::RefineError;
use crate::scheme::step_error::StepError;
use crate::watch::Stopped;

/// The reason for which there is no limit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unlimited {
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// A later level cannot be computed.
    #[error("the limit needs later levels, of which one cannot be computed: {0}")]
    Later(String),
    /// Nothing in the cycle refines.
    #[error("there is no limit surface where no operator of the plan's cycle refines")]
    NoUpsampling,
    /// A D that leaves nothing of a vertex.
    #[error(
        "a vertex has no limit, as D leaves no faces near it, where all vertices lie on the boundary; widen the mesh \
         there, or close it"
    )]
    Lost,
    /// A boundary of faces that take the place of vertices.
    #[error("faces take the place of vertices here, so that no boundary vertex stays one")]
    NoVertex,
    /// Rules that differ from their mirror image.
    #[error("the rules there are not their own mirror image, as the analysis takes them to be")]
    Lopsided,
    /// Steps towards eigenvalues that go on and on.
    #[error("the eigenvalues of the local matrix were not found")]
    NoEigenvalues,
    /// A D that leaves several things of a vertex.
    #[error(
        "a vertex has no limit, as D parts the faces near it, where the mesh is one face wide; widen it there, or \
         refine once more"
    )]
    Separated,
    /// New points are no weighted means of old ones.
    #[error("limits are known for linear schemes only")]
    NotLinear,
    /// More perturbed points than are followed.
    #[error(
        "the vertices of a perturbed plan have more than {} points around them in all, with which each is followed by \
             itself, beyond which no limit is computed; ask for fewer levels",
        MAX_FOLLOWED_POINTS
    )]
    Followed,
    /// Perturbations that do not fade.
    #[error(
        "the perturbation keeps the points around a vertex apart for more than {} levels, beyond which no limit is \
             computed; choose a smaller amplitude or decay",
        MAX_FOLLOWED_LEVELS
    )]
    Wild,
    /// More vertices with different parameters than are followed.
    #[error(
        "the parameters around more than {} vertices differ, each of which is followed by itself, beyond which no \
             limit is computed; ask for fewer levels",
        MAX_DISCES
    )]
    Different,
    /// More rings than are followed.
    #[error("the scheme reaches farther than {} rings of faces, beyond which no limit is computed", MAX_RINGS)]
    Reach,
    /// A disc beyond the bound.
    #[error(
        "a vertex has more than {} others near it, beyond which no limit is computed; refine once more",
        MAX_DISC_VERTICES
    )]
    Size,
    /// More points than are followed.
    #[error(
        "a level of the plan makes more than {} points of those near a vertex, beyond which no limit is computed; \
         write a cycle with fewer or smaller upsamplings",
        MAX_LEVEL_POINTS
    )]
    Fine,
    /// Neighbourhoods that never look alike, or weights that never settle.
    #[error("the plan has no limit, as its levels do not settle")]
    Unsettled,
    /// Differences that do not shrink.
    #[error(
        "the plan has no continuous limit, as differences between neighbours do not shrink from level to level; choose \
         tamer parameters"
    )]
    Rough,
}

impl Unlimited {
    /// Whether a wider disc may have what this one lacks.
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
    /// It could not be refined.
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
