//! The model after projection, clipping and sorting into tiles, ready to be drawn tile by tile.

use rayon::prelude::*;

use super::bins::{BinnedItem, Bins, TileGrid};
use super::camera::{Camera, unit};
use super::clip;
use super::culling::{BlockFates, TriangleFate};
use super::finish::Finisher;
use super::line::StrokeLayer;
use super::model::{Model, ShadingNormals, TriangleAppearance};
use super::paint::Paint;
use super::project::{BEHIND, FAR_OUT, Vertex, vertices, vertices_of};
use super::shade::Lamps;
use super::triangle_block::{BLOCK_TRIANGLES, TriangleBlock};
use crate::kept::Kept;
use crate::math::vector::{Vector, cross, minus};
use crate::watch::{Stopped, Watch};

/// A piece of a clipped triangle.
#[derive(Debug, Clone, Copy)]
struct ClippedPiece {
    corners: [Vertex; 3],
    /// For each corner, its barycentric coordinates in the whole triangle.
    shares: [[f64; 3]; 3],
    whole: u32,
}

/// Everything that is drawn, sorted by tile.
#[derive(Debug)]
pub(super) struct BinnedModel<'a> {
    model: &'a Model<'a>,
    pub(super) camera: &'a Camera,
    pub(super) grid: TileGrid,
    vertices: Kept<Vertex>,
    pieces: Vec<ClippedPiece>,
    /// For each run, the front-facing triangles and the back-facing ones.
    runs: Vec<[Bins; 2]>,
    pub(super) layers: Vec<StrokeLayer>,
    /// The lamps; `None` if the surface is not visible.
    pub(super) lamps: Option<Lamps>,
    /// The paint; `None` if the surface has a single colour.
    pub(super) paint: Option<Paint<'a>>,
    /// The finish; `None` if the surface is lit.
    pub(super) finisher: Option<Finisher>,
}

/// Triangles between two questions whether to stop. Half of it asks when nobody stopped yet; twice of it may take a
/// hundredth of a second if all cover the tile.
pub(super) const LISTED_TRIANGLES: usize = 4096;

/// The visible triangles of one run.
struct TriangleRun {
    /// The front-facing triangles, and the back-facing ones.
    found: [Vec<BinnedItem>; 2],
    pieces: Vec<ClippedPiece>,
}

impl TriangleRun {
    /// Lists a triangle, if it is seen, in the tiles that it touches.
    #[inline]
    fn admit(&mut self, id: u32, fate: TriangleFate) {
        if let TriangleFate::Seen { is_back, rect, nearest } = fate {
            let [front, back] = &mut self.found;
            if is_back { back.push((id, rect, nearest)) } else { front.push((id, rect, nearest)) }
        }
    }
}

impl<'a> BinnedModel<'a> {
    pub(super) fn new(
        model: &'a Model<'a>,
        camera: &'a Camera,
        grid: TileGrid,
        watch: &Watch,
    ) -> Result<Self, Stopped> {
        let vertices = if model.triangles.is_empty() { Kept::default() } else { vertices(camera, model.positions) };
        watch.check()?;
        let layers = model
            .strokes
            .iter()
            .map(|strokes| StrokeLayer::new(camera, grid, strokes, watch))
            .collect::<Result<Vec<_>, Stopped>>()?;
        let (lamps, paint, finish) = match model.surface {
            TriangleAppearance::Lit(color) => (Some(Lamps::new(camera, color)), None, None),
            TriangleAppearance::Painted(paint) => (Some(Lamps::new(camera, [0; 4])), Some(paint), None),
            TriangleAppearance::Finished { color, paint, finish } => {
                (Some(Lamps::new(camera, color)), paint, Some(finish))
            }
            TriangleAppearance::Unseen => (None, None, None),
        };
        let finisher = finish.map(|finish| Finisher::new(finish, camera));
        let (pieces, runs) = (Vec::new(), Vec::new());
        let mut binned = Self { model, camera, grid, vertices, pieces, runs, layers, lamps, paint, finisher };
        binned.sort(watch)?;
        Ok(binned)
    }

    /// Culls, clips and bins the triangles, in runs whose boundaries depend on the number of triangles only.
    fn sort(&mut self, watch: &Watch) -> Result<(), Stopped> {
        let triangles = self.model.triangles;
        let run = triangles.len().div_ceil(64).max(8192);
        let runs: Vec<([Bins; 2], Vec<ClippedPiece>)> = triangles
            .par_chunks(run)
            .enumerate()
            .map(|(i, list)| {
                watch.check()?;
                let found = [(); 2].map(|()| Vec::with_capacity(list.len()));
                let mut run_of = TriangleRun { found, pieces: Vec::new() };
                let mut block = TriangleBlock::default();
                for (first, list) in (i * run..).step_by(BLOCK_TRIANGLES).zip(list.chunks(BLOCK_TRIANGLES)) {
                    let first = u32::try_from(first).expect("fewer than 2^32 triangles");
                    block.n = 0;
                    (first..).zip(list).for_each(|(id, triangle)| block.push(self.placed(triangle), id));
                    let fates = BlockFates::of(self.grid, &block);
                    for (k, id) in (first..).enumerate().take(list.len()) {
                        match fates.at(k) {
                            TriangleFate::Cut => self.admit_pieces(id, list[k], &mut run_of),
                            fate => run_of.admit(id, fate),
                        }
                    }
                }
                Ok((run_of.found.map(|found| Bins::sort(self.grid, &found)), run_of.pieces))
            })
            .collect::<Result<_, Stopped>>()?;
        let first = u32::try_from(triangles.len()).expect("fewer than 2^32 triangles");
        for (mut bins, pieces) in runs {
            let shift = u32::try_from(self.pieces.len()).expect("fewer than 2^32 pieces");
            if shift > 0 {
                bins.iter_mut().for_each(|bins| bins.shift_from(first, shift));
            }
            self.pieces.extend(pieces);
            self.runs.push(bins);
        }
        Ok(())
    }

    fn admit_pieces(&self, id: u32, triangle: [u32; 3], run: &mut TriangleRun) {
        let seen = triangle.map(|v| self.camera.view(self.model.positions[v as usize]));
        let polygon = clip::polygon(self.camera, seen);
        let corners: Vec<Vertex> = polygon.iter().flat_map(|corner| vertices_of(self.camera, [corner.seen])).collect();
        if corners.iter().any(|v| v.sides & (BEHIND | FAR_OUT) != 0) {
            return;
        }
        for k in 2..corners.len() {
            let piece = [0, k - 1, k];
            // no piece is culled by its sides: what lies beside the picture may still mark an edge at its border
            let corners = piece.map(|i| Vertex { sides: 0, ..corners[i] });
            let local = self.model.triangles.len() + run.pieces.len();
            let local = u32::try_from(local).expect("fewer than 2^32 pieces");
            let mut block = TriangleBlock::default();
            block.push([&corners[0], &corners[1], &corners[2]], local);
            let fate = BlockFates::of(self.grid, &block).at(0);
            if let TriangleFate::Seen { .. } = fate {
                run.admit(local, fate);
                run.pieces.push(ClippedPiece { corners, shares: piece.map(|i| polygon[i].shares), whole: id });
            }
        }
    }

    /// Returns whether a triangle may touch a tile.
    pub(super) fn touches(&self, tile: usize) -> bool {
        self.runs.iter().flatten().any(|bins| bins.tile(tile).next().is_some())
    }

    /// Returns the front-facing or the back-facing triangles that may touch a tile, without some that are farther than
    /// `depth`, in lists of at most [`LISTED_TRIANGLES`].
    pub(super) fn tile(&self, tile: usize, is_back: bool, depth: f32) -> impl Iterator<Item = &[u32]> + '_ {
        let lists = self.runs.iter().flat_map(move |bins| bins[usize::from(is_back)].tile_from(tile, depth));
        lists.flat_map(|list| list.chunks(LISTED_TRIANGLES))
    }

    #[inline]
    fn placed(&self, [a, b, c]: &[u32; 3]) -> [&Vertex; 3] {
        [&self.vertices[*a as usize], &self.vertices[*b as usize], &self.vertices[*c as usize]]
    }

    fn piece(&self, id: u32) -> Option<&ClippedPiece> {
        (id as usize).checked_sub(self.model.triangles.len()).map(|i| &self.pieces[i])
    }

    /// Returns the corners of triangle `id` in the picture.
    #[inline]
    pub(super) fn corners(&self, id: u32) -> [&Vertex; 3] {
        match self.model.triangles.get(id as usize) {
            Some(triangle) => self.placed(triangle),
            None => self.pieces[id as usize - self.model.triangles.len()].corners.each_ref(),
        }
    }

    /// Returns the corners of triangle `id` in the picture and the normals there as they stand in the model; `None` if
    /// it is a piece, or if normals are not those of vertices.
    #[inline]
    pub(super) fn shaded_corners(&self, id: u32) -> Option<([&Vertex; 3], [&Vector; 3])> {
        let triangle = self.model.triangles.get(id as usize)?;
        let ShadingNormals::Vertices(normals) = self.model.normals else { return None };
        Some((self.placed(triangle), triangle.map(|v| &normals[v as usize])))
    }

    /// Returns the normals at the three corners of triangle `id`.
    pub(super) fn normals(&self, id: u32) -> [[f64; 3]; 3] {
        let whole = self.whole(id);
        let triangle = self.model.triangles[whole];
        let mut normals = match self.model.normals {
            ShadingNormals::Vertices(list) => {
                [list[triangle[0] as usize], list[triangle[1] as usize], list[triangle[2] as usize]]
            }
            ShadingNormals::Triangles(list) => [list[whole]; 3],
            ShadingNormals::Planes => [[0.0; 3]; 3],
        };
        let undefined = |n: &[f64; 3]| n.iter().all(|c| c.abs() <= 0.0);
        if normals.iter().any(undefined) {
            let [a, b, c] = triangle.map(|v| self.model.positions[v as usize]);
            let plane = unit(cross(minus(b, a), minus(c, a))).unwrap_or(self.camera.forward.map(|x| -x));
            normals.iter_mut().filter(|n| undefined(n)).for_each(|n| *n = plane);
        }
        shared(self.piece(id), normals)
    }

    /// Returns the triangle of the model that triangle `id` is, or is a piece of.
    pub(super) fn whole(&self, id: u32) -> usize {
        self.piece(id).map_or(id, |piece| piece.whole) as usize
    }

    /// Returns the paint values at the three corners of triangle `id`.
    pub(super) fn painted(&self, paint: &Paint<'_>, id: u32) -> [[f64; 3]; 3] {
        let whole = self.whole(id);
        shared(self.piece(id), paint.corners(whole, self.model.triangles[whole]))
    }
}

/// Returns the values at the corners of a piece, interpolated from those of its whole triangle.
fn shared(piece: Option<&ClippedPiece>, whole: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    match piece {
        None => whole,
        Some(piece) => piece
            .shares
            .map(|share| [0, 1, 2].map(|k| share[0] * whole[0][k] + share[1] * whole[1][k] + share[2] * whole[2][k])),
    }
}
