//! Bounds the remainders of a net: the distances between its faces and their limits.

use rayon::prelude::*;

use super::bend::{Bend, Box3, around, bends, spread};
use super::budget::Budget;
use super::hull::Hulls;
use super::level::ComparedNet;
use super::sheet::{ProjectedSheet, normal};
use super::spline::Spline;
use crate::analysis::no_level::NoLevel;
use crate::math::vector::{Vector, length, minus, plus, times};

/// Returns a vector scaled to length 1; zero stays zero.
fn at_unit_length(x: Vector) -> Vector {
    let size = length(x);
    if size > 0.0 { times(1.0 / size, x) } else { [0.0; 3] }
}

/// Number of points of hulls that are projected in the time of one unit of work, a table row, about 100 ns.
/// It only determines the share of the budget that a point takes: with twice of it searches may do twice as much.
const POINTS_A_ROW: u64 = 4;

/// Bounds over some vertices: of their second differences, their points, and their normals and those of their faces.
#[derive(Clone, Copy)]
struct NeighbourhoodBounds {
    bend: Bend,
    points: Box3,
    normals: Box3,
}

impl NeighbourhoodBounds {
    fn or(self, other: Self) -> Self {
        Self {
            bend: self.bend.or(other.bend),
            points: around(self.points, other.points),
            normals: around(self.normals, other.normals),
        }
    }
}

/// Bounds of the distances between the faces of a net and their limits.
pub(super) struct Remainders<'a> {
    level: &'a ComparedNet,
    spline: &'a Spline,
    /// For each vertex the bounds over the vertices within `spline.reach` rings. Joined over the corners of a face,
    /// they cover all vertices that its limit depends on.
    near: Vec<NeighbourhoodBounds>,
    /// For each vertex the bounds over the vertices within one ring more, `spline.reach + 1`.
    beside: Vec<NeighbourhoodBounds>,
    hulls: Hulls<'a>,
    /// The budget; once it is over, bounds are no longer improved.
    budget: &'a Budget,
}

impl<'a> Remainders<'a> {
    /// Prepares the bounds of a level.
    ///
    /// # Errors
    /// [`NoLevel`] if the budget is over.
    pub(super) fn of(level: &'a ComparedNet, spline: &'a Spline, budget: &'a Budget) -> Result<Self, NoLevel> {
        budget.check()?;
        let (topology, points) = (&level.topology, level.points.now.as_chunks::<3>().0);
        let area = |f: usize| topology.half_edges(f).map(|at| normal(topology, points, at)).fold([0.0; 3], plus);
        let areas: Vec<Vector> = (0..topology.n_faces()).into_par_iter().with_min_len(1024).map(area).collect();
        let around_vertex = |v: usize| topology.ring(v).map(|half_edge| areas[topology.face_of(half_edge)]);
        let of_vertex = |v: usize| at_unit_length(around_vertex(v).fold([0.0; 3], plus));
        let all = (0..topology.n_vertices()).into_par_iter().with_min_len(1024);
        let normals: Vec<Vector> = all.map(of_vertex).collect();
        budget.check()?;
        let bends = bends(&level.net, topology, spline.tile, points, &normals);
        budget.check()?;
        let single = |(v, bend): (usize, Bend)| {
            let normals = around_vertex(v).map(at_unit_length).map(|n| [n, n]).fold([normals[v]; 2], around);
            NeighbourhoodBounds { bend, points: [points[v]; 2], normals }
        };
        let single = bends.into_iter().enumerate().map(single).collect();
        let near = spread(topology, single, spline.reach, NeighbourhoodBounds::or);
        budget.check()?;
        let beside = spread(topology, near.clone(), 1, NeighbourhoodBounds::or);
        budget.advance((topology.n_faces() * (spline.reach + 4)) as u64);
        Ok(Self { level, spline, near, beside, hulls: Hulls::of(level, spline.reach), budget })
    }

    /// Returns the bounds over the corners of a face.
    fn joined(&self, values: &[NeighbourhoodBounds], face: u32) -> Option<NeighbourhoodBounds> {
        self.level.topology.face(face as usize).iter().map(|&v| values[v as usize]).reduce(NeighbourhoodBounds::or)
    }

    /// Returns the bound from second differences alone; infinite where the net is not regular. It holds point by point,
    /// like [`plain`](Self::plain).
    pub(super) fn bend(&self, face: u32) -> f64 {
        if self.spline.reach == 0 {
            return 0.0;
        }
        self.joined(&self.near, face).map_or(0.0, |near| self.spline.factor * near.bend.most)
    }

    /// Returns the lesser bound from second differences and from the box around the points that the limit depends on.
    /// It holds point by point: for each point of the limit and the point of the face with the same parameters.
    pub(super) fn plain(&self, face: u32) -> f64 {
        if self.spline.reach == 0 {
            return 0.0;
        }
        let hull = self.joined(&self.near, face).map_or(0.0, |near| length(minus(near.points[1], near.points[0])));
        self.bend(face).min(hull)
    }

    /// Returns for each of some faces an upper bound of the distance of its limit from the faces up to
    /// [`Spline::rings`] around it, and of the face from the limit of those. Bounds up to `little` are not improved.
    /// `belongs` tells which faces belong to the surface.
    ///
    /// # Errors
    /// [`NoLevel`] if the budget is over.
    pub(super) fn distances(
        &self,
        faces: &[u32],
        little: f64,
        belongs: impl Fn(usize) -> bool + Sync,
    ) -> Result<Vec<f64>, NoLevel> {
        self.budget.check()?;
        let first = |&face: &u32| {
            let plain = self.plain(face);
            let looked_into = plain > little && !self.budget.is_over();
            let sheet = if looked_into { self.on_sheet(face, &belongs) } else { Some(plain) };
            (plain, sheet)
        };
        let known: Vec<(f64, Option<f64>)> = faces.par_iter().with_min_len(64).map(first).collect();
        let unknown = known.iter().filter(|(_, sheet)| sheet.is_none()).count();
        let hulls = self.hulls.affordable(unknown);
        self.budget.advance(faces.len() as u64 + hulls.map_or(0, |hulls| hulls.work(unknown) as u64) / POINTS_A_ROW);
        let last = |(&face, (plain, sheet)): (&u32, (f64, Option<f64>))| {
            let hulls = || hulls.filter(|_| !self.budget.is_over());
            let hull = || hulls()?.height(face as usize, &belongs);
            sheet.or_else(hull).unwrap_or(plain).min(plain)
        };
        let distances = faces.par_iter().zip(known).with_min_len(64).map(last).collect();
        self.budget.check()?;
        Ok(distances)
    }

    /// Returns an upper bound of the distance of the limit of a face from the face and those around it, and of the face
    /// from the limit of these, where points move within the sheet of the face; `None` if it has no sheet or points may
    /// leave it. `belongs` tells which faces belong to the surface.
    ///
    /// Points move by at most `factor` times the second differences. A second difference d at a vertex with the normal
    /// m has a component `n d <= |m d| + |n - m| |d|` along the normal n of the sheet.
    fn on_sheet(&self, face: u32, belongs: impl Fn(usize) -> bool) -> Option<f64> {
        let near = self.joined(&self.beside, face).filter(|near| near.bend.most.is_finite())?;
        let level = self.level;
        let sheet = ProjectedSheet::around(&level.topology, level.points.now.as_chunks().0, face as usize, belongs)?;
        let [low, high] = near.normals;
        let along = self.spline.factor * near.bend.most;
        let rise = self.spline.factor * (near.bend.rise + length(minus(high, low)) * near.bend.most);
        (along < sheet.exit()).then(|| rise + sheet.slope() * along)
    }
}
