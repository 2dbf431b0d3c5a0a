//! The lines of a mesh: its silhouettes, boundary, creases, isolines and the edges of faces.

use rayon::prelude::*;

use crate::math::parameter::Values;
use crate::output::error::FormatError;
use crate::output::hard_edges::HardEdges;
use crate::output::picture::lines::pieces;
use crate::output::scene::{MeshSource, Scene, each_face, triangles};
use crate::raster::ProjectedPoint;
use crate::shape::topology::NONE;
use crate::watch::Watch;

/// The class of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Class {
    /// Between a triangle that shows its outside and one that shows its inside.
    Silhouette,
    /// The boundary of the mesh.
    Boundary,
    /// Sharp, or between faces that meet at a large angle.
    Crease,
    /// A piece of an edge of the input.
    Isoline,
    /// An edge of a face.
    Wireframe,
}

/// All classes; a line is drawn as the first class it belongs to that is shown.
pub(super) const CLASSES: [Class; 5] =
    [Class::Silhouette, Class::Boundary, Class::Crease, Class::Isoline, Class::Wireframe];

impl Class {
    /// Returns the name of the class in requests.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Silhouette => "silhouettes",
            Self::Boundary => "boundary",
            Self::Crease => "creases",
            Self::Isoline => "isolines",
            Self::Wireframe => "wireframe",
        }
    }
}

/// A line from vertex to vertex.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DrawnEdge {
    pub(super) ends: [u32; 2],
    /// Whether the line belongs to each class, in the order of [`CLASSES`].
    is: [bool; 5],
    /// The first two triangles that have the line as a side; [`NONE`] if there is no second one.
    pub(super) beside: [u32; 2],
}

impl DrawnEdge {
    /// Returns the class as which the line is drawn, if `shows` tells which classes are shown.
    pub(super) fn drawn_as(&self, shows: impl Fn(&str) -> bool) -> Option<Class> {
        CLASSES.into_iter().find(|class| self.is[*class as usize] && shows(class.name()))
    }
}

/// The triangles of a mesh, and its lines.
pub(super) struct SceneEdges {
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) all: Vec<DrawnEdge>,
    /// The edges on whose two sides normals differ, apart from sharp ones.
    pub(super) hard: HardEdges,
}

/// A side of a triangle: its ends, the lower first, and the triangle.
type TriangleSide = [u32; 3];

impl SceneEdges {
    /// Finds the lines of a mesh whose vertices have these `positions` and are `seen` in the picture. Vertices at one
    /// position are merged into the first of them, so that neither poles nor files without neighbours have boundaries
    /// inside.
    pub(super) fn of(
        scene: &Scene<'_>,
        mesh: &dyn MeshSource,
        (positions, seen): (&[[f64; 3]], &[ProjectedPoint]),
        options: &Values,
        watch: &Watch,
    ) -> Result<Self, FormatError> {
        let first = firsts(positions);
        let (cut, faces) = cut(mesh, &first, watch)?;
        let named = |ends: Vec<[u32; 2]>| {
            let mut ends: Vec<[u32; 2]> =
                ends.into_iter().map(|ends| ordered(ends.map(|v| first[v as usize]))).collect();
            ends.par_sort_unstable();
            ends
        };
        let hard = HardEdges::of(scene.shape, options, watch)?;
        let creases = named(hard.and(mesh.sharp_edges()));
        let isolines = named(pieces(mesh, 0..mesh.input_cells()[1], watch)?);
        let outward: Vec<bool> = cut.iter().map(|triangle| shows_outside(triangle.map(|v| seen[v as usize]))).collect();
        let sides =
            (0..).zip(&cut).flat_map(|(t, [a, b, c])| [[a, b], [b, c], [c, a]].map(|[a, b]| [*a.min(b), *a.max(b), t]));
        let mut sides: Vec<TriangleSide> = sides.collect();
        sides.par_sort_unstable();
        let edge = |sides: &[TriangleSide]| {
            let ends = [sides[0][0], sides[0][1]];
            let beside = [sides[0][2], sides.get(1).map_or(NONE, |side| side[2])];
            let inner = sides.len() == 2 && faces[beside[0] as usize] == faces[beside[1] as usize];
            let turns = sides.iter().any(|side| outward[side[2] as usize] != outward[beside[0] as usize]);
            let sharp = sides.len() > 2 || creases.binary_search(&ends).is_ok();
            let is = [turns, sides.len() == 1, sharp, isolines.binary_search(&ends).is_ok(), !inner];
            DrawnEdge { ends, is, beside }
        };
        let all = sides.chunk_by(|a, b| a[..2] == b[..2]).map(edge).filter(|edge| edge.is.contains(&true)).collect();
        Ok(Self { triangles: cut, all, hard })
    }
}

fn ordered([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Returns whether a triangle turns counter-clockwise in the picture, where y points downwards.
fn shows_outside([a, b, c]: [ProjectedPoint; 3]) -> bool {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) < 0.0
}

/// Returns for each vertex the first vertex at the same position.
fn firsts(positions: &[[f64; 3]]) -> Vec<u32> {
    // adding 0 turns -0 into 0
    let key = |v: u32| positions[v as usize].map(|x| (x + 0.0).to_bits());
    let mut order: Vec<u32> = (0..).take(positions.len()).collect();
    order.par_sort_unstable_by_key(|&v| (key(v), v));
    let mut first = vec![0; positions.len()];
    for same in order.chunk_by(|a, b| key(*a) == key(*b)) {
        same.iter().for_each(|v| first[*v as usize] = same[0]);
    }
    first
}

/// Returns the triangles of all faces with three distinct corners, and the face of each.
fn cut(mesh: &dyn MeshSource, first: &[u32], watch: &Watch) -> Result<(Vec<[u32; 3]>, Vec<u32>), FormatError> {
    let (mut all, mut faces) = (Vec::new(), Vec::new());
    let mut number = 0;
    each_face(mesh, watch, |face| {
        for triangle in triangles(face).map(|triangle| triangle.map(|v| first[v as usize])) {
            let [a, b, c] = triangle;
            if a != b && b != c && c != a {
                all.push(triangle);
                faces.push(number);
            }
        }
        number += 1;
    })?;
    Ok((all, faces))
}
