//! Bounds the distance of the limit of a net's faces from the faces.

use rayon::prelude::*;

use super::bend::{Bend, Box3, around, bends, spread};
use super::budget::Budget;
use super::hull::Hulls;
use super::level::Level;
use super::sheet::{Sheet, normal};
use super::spline::Spline;
use crate::analysis::no_level::NoLevel;
use crate::math::vector::{Vector, length, minus, plus, times};

/// A vector at length 1; zero for zero.
fn at_unit_length(x: Vector) -> Vector {
    let size = length(x);
    if size > 0.0 { times(1.0 / size, x) } else { [0.0; 3] }
}

/// Points of hulls that are looked at in the time of a row of a table, about 100 ns.
/// It only says how much of the budget a point takes: with twice of it searches may do twice as much.
const POINTS_A_ROW: u64 = 4;

/// What is known of the vertices near one.
#[derive(Clone, Copy)]
struct Near {
    bend: Bend,
    points: Box3,
    normals: Box3,
}

impl Near {
    fn or(self, other: Self) -> Self {
        Self {
            bend: self.bend.or(other.bend),
            points: around(self.points, other.points),
            normals: around(self.normals, other.normals),
        }
    }
}

/// The distances of the limit from the faces of a net.
pub(super) struct Remainders<'a> {
    level: &'a Level,
    spline: &'a Spline,
    /// For each vertex what the limit of the faces around it depends on.
    near: Vec<Near>,
    /// What is near each face with a ring of faces more.
    beside: Vec<Near>,
    hulls: Hulls<'a>,
    /// Once it is over, nothing more is looked into.
    budget: &'a Budget,
}

impl<'a> Remainders<'a> {
    /// Bounds the remainders of a level.
    ///
    /// # Errors
    /// [`NoLevel`].
    pub(super) fn of(level: &'a Level, spline: &'a Spline, budget: &'a Budget) -> Result<Self, NoLevel> {
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
            Near { bend, points: [points[v]; 2], normals }
        };
        let single = bends.into_iter().enumerate().map(single).collect();
        let near = spread(topology, single, spline.reach, Near::or);
        budget.check()?;
        let beside = spread(topology, near.clone(), 1, Near::or);
        budget.advance((topology.n_faces() * (spline.reach + 4)) as u64);
        Ok(Self { level, spline, near, beside, hulls: Hulls::of(level, spline.reach), budget })
    }

    fn joined(&self, values: &[Near], face: u32) -> Option<Near> {
        self.level.topology.face(face as usize).iter().map(|&v| values[v as usize]).reduce(Near::or)
    }

    /// By second differences alone; infinite where the net is not regular.
    pub(super) fn bend(&self, face: u32) -> f64 {
        if self.spline.reach == 0 {
            return 0.0;
        }
        self.joined(&self.near, face).map_or(0.0, |near| self.spline.factor * near.bend.most)
    }

    /// By second differences, or by the box around the points that the limit depends on. A point of the limit is as far
    /// from its place on the face.
    pub(super) fn plain(&self, face: u32) -> f64 {
        if self.spline.reach == 0 {
            return 0.0;
        }
        let hull = self.joined(&self.near, face).map_or(0.0, |near| length(minus(near.points[1], near.points[0])));
        self.bend(face).min(hull)
    }

    /// For each of these faces the distance of its limit from the faces up to `Spline::rings` around it, and of the
    /// face from the limit of those; as soon as it is known to be `little`, it is not looked into. Faces belong to the
    /// surface that `belongs` says.
    ///
    /// # Errors
    /// [`NoLevel`].
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

    /// The distance of the limit from the face and those around it, and of the face from the limit, where points move
    /// along their sheet; `None` where that is not known. Faces belong to the sheet that `belongs` says.
    ///
    /// Second differences d of vertices with the normals m move points by `n d <= |m d| + |n - m| |d|` along the normal
    /// n of the sheet.
    fn on_sheet(&self, face: u32, belongs: impl Fn(usize) -> bool) -> Option<f64> {
        let near = self.joined(&self.beside, face).filter(|near| near.bend.most.is_finite())?;
        let level = self.level;
        let sheet = Sheet::around(&level.topology, level.points.now.as_chunks().0, face as usize, belongs)?;
        let [low, high] = near.normals;
        let along = self.spline.factor * near.bend.most;
        let rise = self.spline.factor * (near.bend.rise + length(minus(high, low)) * near.bend.most);
        (along < sheet.exit()).then(|| rise + sheet.slope() * along)
    }
}
