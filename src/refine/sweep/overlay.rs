//! What is special about the corners and sides of patches: stars, whose points overwrite those that the loops compute
//! as if the grid were regular, and lines.

use std::ops::Range;

use super::aligned::AlignedBuffer;
use super::grid::GridSize;
use super::lattice::{CornerFrame, cell, reach, sector};
use super::planes::PLANES;
use super::star::StarShape;
use super::surface::PatchSurface;
use crate::shape::tile::Tile;
use crate::shape::topology::NONE;

/// The faces of a star that a patch reads, counter-clockwise from the patch itself, which comes first.
const TURNS: [isize; 3] = [0, -1, 1];

/// The place of a point of a star: its plane, and its cell relative to that of the star's vertex.
type StarPlace = (usize, [isize; 2]);

/// The places of the points of stars in the refined grids of patches.
#[derive(Debug)]
pub(super) struct Overlay {
    /// For each corner of a patch the places in the faces of [`TURNS`].
    corners: Vec<[FacePlaces; TURNS.len()]>,
}

/// The places of the points of a face around a corner.
#[derive(Debug)]
struct FacePlaces {
    /// Those of its [`sector`], in order.
    inside: Vec<StarPlace>,
    /// Those on the edge to the next face, from the corner on.
    on_edge: Vec<StarPlace>,
}

/// A side of a patch.
#[derive(Debug, Clone, Copy)]
pub(super) struct SpecialSide {
    /// The index of the line on which it lies.
    pub(super) line: Option<usize>,
    /// The star around its first corner.
    pub(super) star: Option<CornerStar>,
}

/// The star around a corner of a patch.
#[derive(Debug, Clone, Copy)]
pub(super) struct CornerStar {
    shape: StarShape,
    /// The index of its first point after the first round.
    first: usize,
    /// The faces of [`TURNS`] in the ring of the vertex; `None` beyond a boundary.
    faces: [Option<usize>; TURNS.len()],
}

/// The sides of consecutive patches.
#[derive(Debug, Default)]
pub(super) struct SpecialSides {
    /// The first of the patches.
    first_patch: usize,
    /// Number of sides of a patch.
    n: usize,
    sides: Vec<SpecialSide>,
}

impl Overlay {
    /// Creates the places for grids with `halo` cells beyond the sides of a patch.
    pub(super) fn new(tile: Tile, halo: usize) -> Self {
        let reach = reach(tile, halo);
        let places = |at: usize, turn: isize| {
            let frame = CornerFrame::new(tile, 0, at, turn);
            let place = |place: [usize; 2]| cell(frame.place(place.map(usize::cast_signed)));
            let inside = sector(tile, reach).map(place).collect();
            FacePlaces { inside, on_edge: (1..=reach).map(|b| place([0, b])).collect() }
        };
        Self { corners: (0..tile.sides() as usize).map(|at| TURNS.map(|turn| places(at, turn))).collect() }
    }

    /// Returns the number of bytes that the places occupy.
    pub(super) fn bytes(&self) -> usize {
        let faces = self.corners.as_flattened();
        let places: usize = faces.iter().map(|face| face.inside.capacity() + face.on_edge.capacity()).sum();
        size_of_val(faces) + places * size_of::<StarPlace>()
    }

    /// Overwrites the points around a corner by those of its star after a round. The corner is that of `side`, at the
    /// cell `corner` of a grid of this size. If only the patch `itself` counts, those in the halo stay.
    pub(super) fn put<const W: usize>(
        &self,
        planes: &mut [AlignedBuffer; PLANES],
        (size, corner): (GridSize, [isize; 2]),
        (side, star): (usize, CornerStar),
        points: &[[f64; W]],
        itself: bool,
    ) {
        let (from, shape) = (size.at(corner), star.shape);
        let mut put = |&(plane, cell): &StarPlace, point: &[f64; W]| {
            let at = from.wrapping_add_signed(size.distance(cell));
            planes[plane][at..at + W].copy_from_slice(point);
        };
        put(&(0, [0, 0]), &points[0]);
        let faces = star.faces.into_iter().zip(&self.corners[side]);
        for (face, places) in faces.take(if itself { 1 } else { TURNS.len() }) {
            let Some(face) = face else { continue };
            let inside = &points[shape.point(face, [1, 0])..];
            places.inside.iter().zip(inside).for_each(|(place, point)| put(place, point));
            // the points on the edge towards the next face
            (1..).zip(&places.on_edge).for_each(|(b, place)| put(place, &points[shape.point(face, [0, b])]));
        }
    }
}

impl CornerStar {
    /// Returns the points of the star after a round, given those of all stars, round after round.
    pub(super) fn points<const W: usize>(self, round: usize, stars: &[[f64; W]]) -> &[[f64; W]] {
        let n = self.shape.len();
        &stars[self.first + round * n..][..n]
    }
}

impl SpecialSides {
    /// Looks at consecutive patches; `star_of` gives the index of the first point of the star around each vertex, or
    /// [`NONE`].
    pub(super) fn find(&mut self, surface: &PatchSurface, patches: Range<usize>, halo: usize, star_of: &[u32]) {
        (self.first_patch, self.n) = (patches.start, surface.tile.sides() as usize);
        self.sides.clear();
        for half_edge in patches.flat_map(|patch| surface.patches.half_edges(patch)) {
            let v = surface.patches.vertex(half_edge) as usize;
            let star = surface.kind_of(v).filter(|_| star_of[v] != NONE).map(|kind| {
                let shape = surface.shape(kind, halo);
                let own = surface.patches.ring(v).position(|ring| ring == half_edge).unwrap_or(0);
                let faces = [Some(own), shape.neighbour(own, false), shape.neighbour(own, true)];
                CornerStar { shape, first: star_of[v] as usize, faces }
            });
            self.sides.push(SpecialSide { line: surface.line(half_edge), star });
        }
    }

    /// Returns the sides of a patch.
    pub(super) fn of(&self, patch: usize) -> &[SpecialSide] {
        let first = (patch - self.first_patch) * self.n;
        self.sides.get(first..first + self.n).unwrap_or_default()
    }
}
