//! Evaluates places by descending from the input faces to bicubic pieces.

use rayon::prelude::*;

use super::isolated::{Query, halved, isolated};
use super::jet::Jet;
use super::place::{Place, squares};
use crate::scheme::plan::Plan;
use crate::shape::mesh::Mesh;
use crate::shape::topology::index;
use crate::solid::edges::Edges;
use crate::solid::error::SolidError;
use crate::solid::level::{Level, Refiner};
use crate::watch::Watch;

/// Number of levels after which every face is bicubic or has a single extraordinary vertex: ten for the largest finite
/// sharpness, one for faces that are not quads, and one to separate vertices.
const SEPARATING_LEVELS: u32 = 12;

/// A face of a level, with the places in it.
#[derive(Debug)]
struct LevelFace {
    face: u32,
    /// The ratio of its parameters to those of the input face.
    scale: f64,
    queries: Vec<Query>,
}

/// A face to be split, with the places in each of its parts, whose parameters run `scale` times as fast as those of the
/// input face.
#[derive(Debug)]
struct SplitFace {
    face: u32,
    scale: f64,
    queries: Vec<Vec<Query>>,
}

impl LevelFace {
    /// Splits the cell of a quad.
    fn split(self) -> SplitFace {
        let mut queries = vec![Vec::new(); 4];
        for (part, query) in self.queries.into_iter().map(halved) {
            queries[part].push(query);
        }
        SplitFace { face: self.face, scale: 2.0 * self.scale, queries }
    }
}

/// The outcome of a cell.
enum CellOutcome {
    Found(Vec<(u32, Jet)>),
    Split(LevelFace),
}

/// Returns the limit surface of a mesh at some places, in order, under a plan whose regular pieces are bicubic.
///
/// A place in a bicubic piece is evaluated in that piece. Faces at other vertices are split as far as their places
/// require: rings of bicubic pieces surround the vertex, each half as large in u and v as the one before.
///
/// # Errors
/// If the watch says stop, a place is not on the mesh, or a coordinate is no longer finite.
pub fn evaluate(mesh: &Mesh, plan: &Plan, places: &[Place], watch: &Watch) -> Result<Vec<Jet>, SolidError> {
    if let Some((_, detail)) = places.iter().find_map(|place| place.fault(&mesh.topology)) {
        return Err(SolidError::at("", detail));
    }
    let refiner = Refiner::new(plan, watch)?;
    let (mut level, mut edges) = Level::of(mesh, plan);
    let mut found: Vec<Option<Jet>> = vec![None; places.len()];
    let (mut cells, others) = first(mesh, places);
    // faces that are not quads have their squares on the next level
    let mut joining = Some(others);
    for _ in 0..=SEPARATING_LEVELS {
        watch.check()?;
        let outcomes: Vec<_> = cells.into_par_iter().map(|cell| level.looked_at(cell, &refiner)).collect();
        let mut split = Vec::new();
        for outcome in outcomes {
            match outcome? {
                CellOutcome::Found(jets) => jets.into_iter().for_each(|(i, jet)| found[i as usize] = Some(jet)),
                CellOutcome::Split(cell) => split.push(cell),
            }
        }
        let others = joining.take().unwrap_or_default();
        if split.is_empty() && others.is_empty() {
            break;
        }
        (level, cells) = level.divided(split, others, &refiner, &mut edges)?;
    }
    let lost = || SolidError::at("", "a place was lost between faces; this is a fault of planish, please report it");
    found.into_iter().collect::<Option<Vec<_>>>().ok_or_else(lost)
}

/// Returns the faces that contain places, ascending: quads with their places, and for each other face those of its
/// squares.
fn first(mesh: &Mesh, places: &[Place]) -> (Vec<LevelFace>, Vec<SplitFace>) {
    let mut order: Vec<u32> = (0..index(places.len())).collect();
    order.sort_by_key(|&i| places[i as usize].face);
    let (mut quads, mut others) = (Vec::new(), Vec::new());
    for run in order.chunk_by(|&a, &b| places[a as usize].face == places[b as usize].face) {
        let face = places[run[0] as usize].face;
        let mut of_squares = vec![Vec::new(); squares(&mesh.topology, face) as usize];
        for &number in run {
            let Place { corner, uv, .. } = places[number as usize];
            of_squares[corner as usize].push(Query { number, uv });
        }
        if of_squares.len() == 1 {
            quads.push(LevelFace { face, scale: 1.0, queries: of_squares.swap_remove(0) });
        } else {
            others.push(SplitFace { face, scale: 1.0, queries: of_squares });
        }
    }
    (quads, others)
}

impl Level {
    /// Evaluates a face that is bicubic or has a single extraordinary vertex.
    fn looked_at(&self, cell: LevelFace, refiner: &Refiner<'_>) -> Result<CellOutcome, SolidError> {
        if self.is_leaf(cell.face) {
            let net = self.net(self.topology.half_edges(cell.face as usize).start);
            let value = |query: &Query| (query.number, Jet::of(&net, cell.scale, query.uv));
            return Ok(CellOutcome::Found(cell.queries.iter().map(value).collect()));
        }
        match self.lone_extraordinary(cell.face) {
            Some(half_edge) => isolated(self, half_edge, cell.scale, cell.queries, refiner).map(CellOutcome::Found),
            None => Ok(CellOutcome::Split(cell)),
        }
    }

    /// Returns the next level of some quads and some other faces, with its cells.
    fn divided(
        &self,
        quads: Vec<LevelFace>,
        others: Vec<SplitFace>,
        refiner: &Refiner<'_>,
        edges: &mut Edges,
    ) -> Result<(Self, Vec<LevelFace>), SolidError> {
        let mut split: Vec<SplitFace> = quads.into_iter().map(LevelFace::split).chain(others).collect();
        split.sort_by_key(|parts| parts.face);
        let faces: Vec<u32> = split.iter().map(|parts| parts.face).collect();
        let next = self.refined(&faces, refiner, edges)?;
        // the wanted faces are the children of these faces, in order
        let wanted = (0..index(next.topology.n_faces())).filter(|&f| next.wanted[f as usize]);
        let parts =
            split.into_iter().flat_map(|SplitFace { scale, queries, .. }| queries.into_iter().map(move |q| (scale, q)));
        let cells = wanted.zip(parts).map(|(face, (scale, queries))| LevelFace { face, scale, queries });
        let cells = cells.filter(|cell| !cell.queries.is_empty()).collect();
        Ok((next, cells))
    }
}
