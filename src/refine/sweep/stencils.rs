//! Stencils of values at refined points over the points around them, read off small nets.

use super::lattice::is_within;
use super::line::SharpSide;
use super::program::Sweep;
use super::sample::Sample;
use super::star::{StarKind, StarMesh, StarShape};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::Plan;
use crate::shape::tile::Tile;
use crate::shape::topology::index;

/// A stencil of the value at a point: each sector around the point has functionals, and each functional is a weighted
/// sum of points.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stencil<P> {
    /// For each sector and functional the points and their weights.
    pub(crate) sectors: Vec<Vec<Vec<(P, f64)>>>,
    /// The points that follow the point in its faces, with the sectors of these faces.
    pub(crate) sides: Vec<(P, usize)>,
}

/// The largest number of weights of the stencils near the stars of a sweep: 50 MB for a position and two tangents. They
/// grow with the square of the number of faces around a vertex, so that half of it sends vertices of seven tenths of
/// the faces to whole nets, and twice of it takes those of 1.4 times the faces.
const MOST_STAR_WEIGHTS: usize = 1 << 20;

/// How far the value at a point depends on the net around it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct StencilReach {
    /// Number of rings of points with weights.
    pub(crate) points: usize,
    /// Number of rings of faces whose arrangement decides the weights.
    pub(crate) faces: usize,
}

/// The stencils of the points on a line, for each axis along which it may run.
type AlongAxes = Vec<Stencil<[isize; 2]>>;

/// The stencils of the points of a refined net.
#[derive(Debug)]
pub(crate) struct Stencils {
    /// Number of rings of points that stencils reach.
    pub(super) reach: usize,
    /// Number of rings around a vertex where the grid is not regular, beyond the vertex itself, whose points have
    /// stencils of their own.
    pub(super) near: usize,
    /// The stencil where the grid is regular, over places relative to the point.
    pub(super) regular: Stencil<[isize; 2]>,
    /// For each line the stencils along each axis, or `None` where the line is smooth by then.
    pub(super) lines: Vec<Option<AlongAxes>>,
    /// For each kind of star the stencils of the points of the star with `near` cells around its vertex, over the
    /// points of the star with `near + reach` cells.
    pub(super) stars: Vec<Vec<Stencil<usize>>>,
}

impl<P> Stencil<P> {
    /// Renames the points of the stencil; returns `None` if a point with nonzero weight has no new name.
    fn named<Q>(self, name: impl Fn(P) -> Option<Q>) -> Option<Stencil<Q>> {
        let weights = |all: Vec<(P, f64)>| {
            let taking_part = all.into_iter().filter(|(_, weight)| *weight != 0.0);
            taking_part.map(|(point, weight)| Some((name(point)?, weight))).collect::<Option<Vec<_>>>()
        };
        let sector = |all: Vec<Vec<(P, f64)>>| all.into_iter().map(weights).collect::<Option<Vec<_>>>();
        let sectors = self.sectors.into_iter().map(sector).collect::<Option<_>>()?;
        let sides =
            self.sides.into_iter().map(|(point, sector)| Some((name(point)?, sector))).collect::<Option<_>>()?;
        Some(Stencil { sectors, sides })
    }
}

impl Sweep {
    /// Returns the stencils of the points where the sweep ends. `find` returns the stencil of a vertex of a small net
    /// that is uniform for one ring more than `reach.faces` around the vertex. Returns `None` if `find` does, if a
    /// stencil reaches farther than `reach.points`, if patches are too small for it, if it looks farther than the next
    /// points on triangles or beside a line, or if stars would have more than [`MOST_STAR_WEIGHTS`].
    pub(crate) fn stencils<E>(
        &self,
        plan: &Plan,
        reach: StencilReach,
        find: impl Fn(&MeshNet, u32) -> Result<Option<Stencil<u32>>, E>,
    ) -> Result<Option<Stencils>, E> {
        let tile = self.tile();
        // where only the next points have weights, sharp edges alone make points beside a vertex special
        let near = if reach.points == 1 { 0 } else { reach.faces.saturating_sub(1) };
        let n = self.patch_pieces();
        if 2 * near >= n || near + reach.points > n || (reach.points > 1 && tile == Tile::Triangle) {
            return Ok(None);
        }
        let on_grid = |line: Option<(SharpSide, usize)>| {
            let sample = Sample::new(tile, line, reach.faces + 1);
            let most = reach.points.cast_signed();
            let name = |v: u32| Some(sample.off_middle(v)).filter(|place| place.iter().all(|x| x.abs() <= most));
            let found = find(&sample.net(plan), sample.middle());
            found.map(|found| found.and_then(|stencil| stencil.named(name)))
        };
        let weights = |kind: &StarKind| {
            let points = |reach: usize| StarShape { tile, faces: kind.faces, closed: kind.closed, reach }.len();
            points(near).saturating_mul(points(near + reach.points))
        };
        if near > 0 && self.surface.kinds.iter().map(weights).fold(0, usize::saturating_add) > MOST_STAR_WEIGHTS {
            return Ok(None);
        }
        let Some(lines) = self.line_stencils(reach, on_grid)? else { return Ok(None) };
        let Some(regular) = on_grid(None)? else { return Ok(None) };
        let mut stars = Vec::new();
        for kind in &self.surface.kinds {
            let Some(of_kind) = self.star_stencils(&kind.after(self.n_rounds()), plan, (reach, near), &find)? else {
                return Ok(None);
            };
            stars.push(of_kind);
        }
        Ok(Some(Stencils { reach: reach.points, near, regular, lines, stars }))
    }

    /// Returns the stencils along the lines that are still sharp; `None` if one is missing.
    fn line_stencils<E>(
        &self,
        reach: StencilReach,
        on_grid: impl Fn(Option<(SharpSide, usize)>) -> Result<Option<Stencil<[isize; 2]>>, E>,
    ) -> Result<Option<Vec<Option<AlongAxes>>>, E> {
        let axes = if self.tile() == Tile::Quad { 2 } else { 3 };
        let mut lines = Vec::new();
        for line in &self.surface.lines {
            let line = line.filter(|line| *line != SharpSide::Boundary || self.surface.base.n_boundary() > 0);
            let Some(line) = line.and_then(|line| line.after(self.n_rounds())) else {
                lines.push(None);
                continue;
            };
            if reach.points > 1 {
                return Ok(None);
            }
            let along: Option<Vec<_>> = (0..axes).map(|axis| on_grid(Some((line, axis)))).collect::<Result<_, E>>()?;
            let Some(along) = along else { return Ok(None) };
            lines.push(Some(along));
        }
        Ok(Some(lines))
    }

    /// Returns the stencils of the points of a star with `near` cells around its vertex; `None` if one is missing.
    fn star_stencils<E>(
        &self,
        kind: &StarKind,
        plan: &Plan,
        (reach, near): (StencilReach, usize),
        find: &impl Fn(&MeshNet, u32) -> Result<Option<Stencil<u32>>, E>,
    ) -> Result<Option<Vec<Stencil<usize>>>, E> {
        let tile = self.tile();
        let Some(disc) = StarMesh::new(kind, tile, near + reach.faces + 1) else { return Ok(None) };
        let shape = |reach: usize| StarShape { tile, faces: kind.faces, closed: kind.closed, reach };
        let wide = shape(near + reach.points);
        let places: Vec<(usize, [usize; 2])> = disc.shape().points().collect();
        let name = |v: u32| {
            let (face, place) = places[v as usize];
            let is_near = is_within(tile, wide.reach.cast_signed(), 0, place.map(usize::cast_signed));
            is_near.then(|| wide.point(face, place))
        };
        let net = disc.net(kind, plan);
        let mut found = Vec::new();
        for (face, place) in shape(near).points() {
            let v = index(disc.shape().point(face, place));
            let Some(stencil) = find(&net, v)?.and_then(|stencil| stencil.named(name)) else { return Ok(None) };
            found.push(stencil);
        }
        Ok(Some(found))
    }
}
