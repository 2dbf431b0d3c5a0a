//! Stencils of values at refined points over the points next to them, read off small nets.

use super::lattice::sector;
use super::line::SharpSide;
use super::program::Sweep;
use super::sample::Sample;
use super::star::{StarMesh, StarShape};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::Plan;
use crate::shape::tile::Tile;

/// A stencil of the value at a point: each sector around the point has functionals, and each functional is a weighted
/// sum of points.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stencil<P> {
    /// For each sector and functional the points and their weights.
    pub(crate) sectors: Vec<Vec<Vec<(P, f64)>>>,
    /// The points that follow the point in its faces, with the sectors of these faces.
    pub(crate) sides: Vec<(P, usize)>,
}

/// The stencils of the points of a refined net.
#[derive(Debug)]
pub(crate) struct Stencils {
    /// The stencil where the grid is regular, over places relative to the point.
    pub(super) regular: Stencil<[isize; 2]>,
    /// For each line the stencils along each axis, or `None` where the line is smooth by then.
    pub(super) lines: Vec<Option<Vec<Stencil<[isize; 2]>>>>,
    /// For each kind of star the stencil of its vertex, over the points of a star that is one cell wide.
    pub(super) stars: Vec<Stencil<usize>>,
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
    /// that is uniform for `rings` rings around the vertex. Returns `None` if `find` does, or if a stencil reaches
    /// beyond the points next to its own.
    pub(crate) fn stencils<E>(
        &self,
        plan: &Plan,
        rings: usize,
        find: impl Fn(&MeshNet, u32) -> Result<Option<Stencil<u32>>, E>,
    ) -> Result<Option<Stencils>, E> {
        let (tile, rounds) = (self.tile(), self.n_rounds());
        let on_grid = |line: Option<(SharpSide, usize)>| {
            let sample = Sample::new(tile, line, rings + 1);
            let near = |v: u32| Some(sample.off_middle(v)).filter(|place| place.iter().all(|x| x.abs() <= 1));
            let found = find(&sample.net(plan), sample.middle());
            found.map(|found| found.and_then(|stencil| stencil.named(near)))
        };
        let Some(regular) = on_grid(None)? else { return Ok(None) };
        let axes = if tile == Tile::Quad { 2 } else { 3 };
        let mut lines = Vec::new();
        for line in &self.surface.lines {
            let line = line.filter(|line| *line != SharpSide::Boundary || self.surface.base.n_boundary() > 0);
            let Some(line) = line.and_then(|line| line.after(rounds)) else {
                lines.push(None);
                continue;
            };
            let along: Option<Vec<_>> = (0..axes).map(|axis| on_grid(Some((line, axis)))).collect::<Result<_, E>>()?;
            let Some(along) = along else { return Ok(None) };
            lines.push(Some(along));
        }
        let mut stars = Vec::new();
        for kind in &self.surface.kinds {
            let kind = kind.after(rounds);
            let Some(disc) = StarMesh::new(&kind, tile, rings + 1) else { return Ok(None) };
            let near = StarShape { tile, faces: kind.faces, closed: kind.closed, reach: 1 };
            let places: Vec<(usize, [usize; 2])> = disc.shape().points().collect();
            let is_near =
                |place: [usize; 2]| place == [0, 0] || place == [0, 1] || sector(tile, 1).any(|at| at == place);
            let name = |v: u32| {
                let (face, place) = places[v as usize];
                is_near(place).then(|| near.point(face, place))
            };
            let Some(stencil) = find(&disc.net(&kind, plan), 0)?.and_then(|stencil| stencil.named(name)) else {
                return Ok(None);
            };
            stars.push(stencil);
        }
        Ok(Some(Stencils { regular, lines, stars }))
    }
}
