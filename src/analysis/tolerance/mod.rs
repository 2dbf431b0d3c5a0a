//! The level at which a mesh is within a tolerance of its limit surface.
//!
//! Where a net is regular, averages move vertices by multiples of second differences, which a level divides by 4
//! ([`spline`], [`bend`]); elsewhere the limit lies in the hull of the points around ([`mod@bound`]). Further levels are
//! measured until what is left is small, at last only around faces where it is not ([`level`]). Where points move along
//! the surface, they do not leave it ([`sheet`]).
//!
//! Derivation and sources: `docs/tolerance.md`; Dyn and Levin, Acta Numerica 11 (2002), section 3; Cheng, Chen and Yong,
//! LNCS 4035 (2006), 404-416; Lane and Riesenfeld, IEEE PAMI 2 (1980), 35-46.

mod bend;
mod bound;
mod budget;
mod cut;
mod hull;
mod level;
mod nearest;
mod rest;
mod sheet;
mod spline;

use super::curve::Reached;
use super::limit::Unlimited;
use super::limit::{self, LimitRequest};
use crate::refine::{Points, RefineError, act_on, mesh_net};
use crate::scheme::operator::SPLINES;
use crate::scheme::plan::Plan;
use crate::shape::mesh::Mesh;
use crate::shape::tile::Tile;
use crate::watch::{Stopped, Watch};
use bound::{FOLLOWED_FACES, bound};
use budget::Budget;
pub use budget::MAX_WORK;
use cut::{cut, twist};
use level::Level;
use rest::Rests;
use spline::Spline;

/// Most levels that are looked at.
const MAX_LEVEL: u32 = 16;
/// Most faces of a net that are looked at.
const MAX_FACES: usize = 1 << 18;
/// What a search takes for each face of the net that is looked at, bytes: measured with a cube one corner of which is a
/// million times as far as the others, which takes 550 MiB at [`MAX_FACES`].
const BYTES_A_FACE: u64 = 3 << 10;
/// The least tolerance, over the greatest coordinate: below it, rounding is not negligible.
const LEAST: f64 = 1e-12;
/// What rounding adds to a bound, over the greatest coordinate.
const ROUNDING: f64 = 1e-14;

/// Where the vertices of an output are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Placed {
    /// Where the levels put them.
    Refined,
    /// At their limits.
    Limit,
}

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
        "a dual scheme loses the boundary, which the limit is not near to; close the mesh, or give \"levels\" as a number"
    )]
    LostBoundary,
    /// Single D in some places.
    #[error(
        "distances are bounded where each U of the cycle is followed by C and pairs of D, or each by one D more, which comes \
         last; use C instead, or give \"levels\" as a number"
    )]
    Dual,
    /// A kernel other than 1.
    #[error(
        "the kernel is {0} at some level; distances are bounded for splines, whose kernel is 1 at all levels: leave it out, or \
         give \"levels\" as a number"
    )]
    Kernel(f64),
    /// Another scheme.
    #[error("distances are bounded for {SPLINES}, which this plan does not as {0}; give \"levels\" as a number")]
    NoSpline(&'static str),
    /// Rounding is larger.
    #[error("{tolerance} is below what rounding leaves of coordinates of {size}; ask for at least {least}", least = size * LEAST)]
    TooFine {
        /// What was asked for.
        tolerance: f64,
        /// Greatest coordinate.
        size: f64,
    },
    /// Too large a net.
    #[error(
        "level {level} has {faces} faces near which distances are not bounded in advance; up to {MAX_FACES} are looked at: \
         ask for a coarser tolerance, or give \"levels\" as a number"
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
        "the search for a level this close to the limit has taken more than {MAX_WORK} steps, which is the most that is done; \
         ask for a coarser tolerance, or give \"levels\" as a number"
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

/// Whether a level could be searched for, as far as that can be told at once.
///
/// # Errors
/// [`NoLevel`].
pub fn check(mesh: &Mesh, plan: &Plan, tolerance: f64) -> Result<(), NoLevel> {
    Spline::of(plan, mesh)?;
    check_size(mesh, tolerance).map(|_| ())
}

/// The greatest coordinate.
fn check_size(mesh: &Mesh, tolerance: f64) -> Result<f64, NoLevel> {
    let size = mesh.positions.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    if tolerance < LEAST * size { Err(NoLevel::TooFine { tolerance, size }) } else { Ok(size) }
}

/// Bytes that a search takes at most.
pub fn search_bytes(mesh: &Mesh) -> u64 {
    let faces = mesh.topology.n_half_edges().max(mesh.topology.n_faces()).max(MAX_FACES);
    BYTES_A_FACE.saturating_mul(faces as u64)
}

/// The first level at which a mesh is known to be within `tolerance` of its limit surface, with its vertices at each of
/// these places.
///
/// # Errors
/// [`NoLevel`], also when `watch` says stop.
pub fn reach(mesh: &Mesh, plan: &Plan, placed: &[Placed], tolerance: f64, watch: &Watch) -> Result<Reached, NoLevel> {
    let spline = Spline::of(plan, mesh)?;
    let size = check_size(mesh, tolerance)?;
    let budget = &Budget::of(watch, MAX_WORK);
    let points = vec![Points::new(mesh.positions.clone(), 3)];
    let (net, mut points) = act_on(mesh_net(mesh, plan), points, &spline.plan, &spline.prefix, watch)?;
    let mut walk = Walk { level: Level::new(net, points.remove(0)), left: 0.0 };
    for level in 0..=MAX_LEVEL {
        if walk.is_ready(&spline) {
            let mut most = 0.0;
            for &placed in placed {
                most = walk.bound(&spline, placed, tolerance, ROUNDING * size, budget)?.max(most);
            }
            let bound = most + ROUNDING * size;
            if bound <= tolerance {
                return Ok(Reached { level, bound });
            }
        }
        budget.check()?;
        walk.leave(&spline, tolerance, budget)?;
        let faces = walk.level.faces_after(spline.rounds.len() + usize::from(spline.halved));
        if faces > MAX_FACES {
            return Err(NoLevel::TooLarge { level: level + 1, faces });
        }
        walk.on(&spline, watch)?;
    }
    Err(NoLevel::Never(tolerance))
}

/// The level that is looked at, and what is known of faces that are followed no longer.
struct Walk {
    level: Level,
    /// How far they are from their limit, at most; a quarter of it a round later.
    left: f64,
}

impl Walk {
    /// Whether all faces are those that the scheme splits regularly.
    fn is_ready(&self, spline: &Spline) -> bool {
        let sides = if spline.tile == Tile::Quad { 4 } else { 3 };
        let topology = &self.level.topology;
        spline.halved || self.level.live.iter().all(|&f| topology.face(f as usize).len() == sides)
    }

    /// How far the output is from the limit at most, with its vertices there; infinite where it is soon seen to be above the
    /// tolerance.
    fn bound(
        &self,
        spline: &Spline,
        placed: Placed,
        tolerance: f64,
        rounding: f64,
        budget: &Budget,
    ) -> Result<f64, NoLevel> {
        let (places, times) = match placed {
            Placed::Refined => (self.level.points.now.clone(), 1.0),
            Placed::Limit => (self.limits(spline, &budget.watch)?, 2.0),
        };
        let left = times * self.left;
        if self.level.live.is_empty() {
            return Ok(left);
        }
        let base = self.level.compared(places);
        if spline.halved {
            let upsampling = spline.rounds[0].first().expect("a round begins with an upsampling");
            let split = base.upsampled(&spline.plan, upsampling, &budget.watch)?;
            let cut = cut(&base);
            return Ok(bound(&split, spline, tolerance - cut, rounding, budget)? + cut);
        }
        Ok(bound(&base, spline, tolerance, rounding, budget)?.max(left))
    }

    /// The limits of the vertices.
    fn limits(&self, spline: &Spline, watch: &Watch) -> Result<Vec<f64>, NoLevel> {
        if self.level.live.is_empty() {
            return Ok(self.level.points.now.clone());
        }
        let plan = &spline.plan;
        let steps = plan.schedule(limit::AHEAD).map_err(|fault| NoLevel::Level(fault.detail))?;
        let asked = LimitRequest { positions: true, normals: false };
        let points = [self.level.points.clone()];
        let found = limit::limits(plan, &self.level.net, &points, &steps[spline.prefix.len()..], asked, watch)?;
        Ok(found.points.and_then(|mut points| points.pop()).unwrap_or_default())
    }

    /// Leaves faces behind whose distance second differences bound, where there are too many to go on with all: first
    /// those that are within half the tolerance.
    fn leave(&mut self, spline: &Spline, tolerance: f64, budget: &Budget) -> Result<(), NoLevel> {
        let fits = |level: &Level| level.faces_after(1) <= FOLLOWED_FACES;
        if fits(&self.level) || spline.halved {
            return Ok(());
        }
        let level = &self.level;
        let points = level.points.now.as_chunks::<3>().0;
        let twists: Vec<f64> = (0..level.topology.n_vertices())
            .map(|v| {
                let around = level.topology.ring(v).map(|corner| level.topology.face_of(corner));
                around.map(|f| twist(&level.topology, f, points)).fold(0.0, f64::max)
            })
            .collect();
        let twists = bend::spread(&level.topology, twists, spline.reach, f64::max);
        let rests = Rests::of(level, spline, budget)?;
        let of_face = |&f: &u32| {
            let twist = level.topology.face(f as usize).iter().map(|&v| twists[v as usize]).fold(0.0, f64::max);
            (f, rests.bend(f) + twist)
        };
        let known: Vec<(u32, f64)> = level.live.iter().map(of_face).collect();
        let part = |most: f64| {
            let (left, kept): (Vec<_>, Vec<_>) = known.iter().partition(|&&(_, distance)| distance <= most);
            let left = left.iter().map(|&(_, distance)| distance).fold(self.left, f64::max);
            let kept: Vec<u32> = kept.iter().map(|&(f, _)| f).collect();
            Self { level: level.focused(&kept, spline.margin()), left }
        };
        let some = part(tolerance / 2.0);
        *self = if fits(&some.level) { some } else { part(f64::MAX) };
        Ok(())
    }

    /// One level further.
    fn on(&mut self, spline: &Spline, watch: &Watch) -> Result<(), NoLevel> {
        for round in &spline.rounds {
            if spline.halved {
                let points = vec![self.level.points.clone()];
                let (net, mut points) = act_on(self.level.net.clone(), points, &spline.plan, round, watch)?;
                self.level = Level::new(net, points.remove(0));
                continue;
            }
            if !self.level.live.is_empty() {
                self.level = self.level.next(&spline.plan, round, watch)?;
            }
            self.left /= 4.0;
        }
        Ok(())
    }
}
