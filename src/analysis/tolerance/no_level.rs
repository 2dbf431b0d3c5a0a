//! Why no level can be given for a tolerance, and the limits of the search that it tells.

use crate::analysis::limit::Unlimited;
use crate::refine::RefineError;
use crate::scheme::operator::SPLINES;
use crate::watch::Stopped;

/// Most levels that are looked at.
/// Level 16 has 2^32 times as many faces as the input, more than are numbered. Half of it refuses tolerances that are
/// met from level 9 on only.
pub(super) const MAX_LEVEL: u32 = 16;
/// Most faces of a net that are looked at.
/// As a level multiplies faces by 4, half and twice of it shift what is refused by half a level, and halve and double
/// the memory of a search.
pub(super) const MAX_FACES: usize = 1 << 18;
/// The least tolerance, over the greatest coordinate: below it, rounding is not negligible.
/// It is a hundred times what is added for rounding. Half of it leaves fifty times; twice of it refuses what could be
/// kept.
pub(super) const LEAST: f64 = 1e-12;
/// Most units of work of a search, of about 100 ns each: 3.5 minutes, ten times what those take that look at all the
/// levels and faces they may.
pub const MAX_WORK: u64 = 1 << 31;

/// Why no level can be given for a tolerance.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoLevel {
    /// Numbers that differ from vertex to vertex.
    #[error("with {0} no distance to the limit is known in advance; give \"levels\" as a number")]
    Perturbed(&'static str),
    /// A step that is not linear.
    #[error(
        "the scheme is not linear, so that no distance to the limit is known in advance; give \"levels\" as a number"
    )]
    NotLinear,
    /// A dual scheme on an open mesh.
    #[error(
        "a dual scheme loses the boundary, which the limit is not near to; close the mesh, or give \"levels\" as a \
         number"
    )]
    LostBoundary,
    /// Single D in some places.
    #[error(
        "distances are bounded where each U of the cycle is followed by C and pairs of D, or each by one D more, \
         which comes last; use C instead, or give \"levels\" as a number"
    )]
    Dual,
    /// A kernel other than 1.
    #[error(
        "the kernel is {0} at some level; distances are bounded for splines, whose kernel is 1 at all levels: leave \
         it out, or give \"levels\" as a number"
    )]
    Kernel(f64),
    /// Another scheme.
    #[error("distances are bounded for {SPLINES}, which this plan does not as {0}; give \"levels\" as a number")]
    NoSpline(&'static str),
    /// Rounding is larger.
    #[error(
        "{tolerance} is below what rounding leaves of coordinates of {size}; ask for at least {least}",
        least = size * LEAST
    )]
    TooFine {
        /// What was asked for.
        tolerance: f64,
        /// Greatest coordinate.
        size: f64,
    },
    /// Too large a net.
    #[error(
        "level {level} has {faces} faces near which distances are not bounded in advance; up to {MAX_FACES} are \
         looked at: ask for a coarser tolerance, or give \"levels\" as a number"
    )]
    TooLarge {
        /// Its level.
        level: u32,
        /// Its faces.
        faces: usize,
    },
    /// Not within any number of levels.
    #[error("no level up to {MAX_LEVEL} is known to be within {0} of the limit; ask for a coarser tolerance")]
    Never(f64),
    /// Too long a search.
    #[error(
        "the search for a level this close to the limit has taken more than {MAX_WORK} steps, which is the most that \
         is done; ask for a coarser tolerance, or give \"levels\" as a number"
    )]
    TooLong,
    /// A level cannot be computed.
    #[error("{0}")]
    Level(String),
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl NoLevel {
    /// Whether the search only ended because it was asked to.
    pub fn stopped(&self) -> Option<Stopped> {
        if let Self::Stopped(stopped) = self { Some(*stopped) } else { None }
    }
}

impl From<RefineError> for NoLevel {
    fn from(error: RefineError) -> Self {
        if let RefineError::Stopped(stopped) = error { Self::Stopped(stopped) } else { Self::Level(error.to_string()) }
    }
}

impl From<Unlimited> for NoLevel {
    fn from(error: Unlimited) -> Self {
        if let Unlimited::Stopped(stopped) = error { Self::Stopped(stopped) } else { Self::Level(error.to_string()) }
    }
}
