//! Distances of points from the triangles of a mesh.

use rayon::prelude::*;

use super::scene::{Curve, MeshSource, ROWS_PER_CHUNK, each_face, triangles};
use crate::math::functions::sqrt;
use crate::math::vector::{Vector, length, minus, square_from_triangle};
use crate::watch::{Stopped, Watch};

/// Maximum number of triangles of a leaf. Half of it doubles the nodes of the tree; twice of it measures up to 8
/// triangles where a box would do. Distances are the same.
const TRIANGLES_PER_LEAF: usize = 4;

/// Bytes of memory per triangle of the mesh: its corners (72), its place in the order (4), and its share of the nodes,
/// of which there are at most as many (56).
pub(super) const TREE_TRIANGLE_BYTES: u128 = 72 + 4 + 56;

/// The triangles of a mesh in a tree of boxes.
#[derive(Debug)]
pub(super) struct Triangles {
    /// The corners of the triangles, leaf after leaf.
    corners: Vec<[Vector; 3]>,
    nodes: Vec<TriangleNode>,
}

/// A box around triangles `from..to`. The node of the first half of them is the next node, the node of the second half
/// is `second`, which is 0 for a leaf.
#[derive(Debug)]
struct TriangleNode {
    low: Vector,
    high: Vector,
    from: u32,
    to: u32,
    second: u32,
}

impl Triangles {
    /// Builds the tree of a mesh, whose faces are cut as for every picture.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub(super) fn of(mesh: &dyn MeshSource, positions: &[Vector], watch: &Watch) -> Result<Self, Stopped> {
        let mut corners = Vec::with_capacity(mesh.n_half_edges().saturating_sub(2 * mesh.n_faces()));
        each_face(mesh, watch, |face| {
            corners.extend(triangles(face).map(|face| face.map(|v| positions[v as usize])));
        })?;
        Self::new(corners, watch)
    }

    /// Builds the tree of the segments of curves with at most three coordinates; each segment is a triangle with two
    /// equal corners.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub(super) fn of_curves(curves: &[Curve], watch: &Watch) -> Result<Self, Stopped> {
        let mut corners = Vec::new();
        for curve in curves {
            let point = |i: usize| {
                let row = &curve.points[(i % curve.len()) * curve.dimension..][..curve.dimension];
                std::array::from_fn(|k| row.get(k).copied().unwrap_or(0.0))
            };
            let n = if curve.closed { curve.len() } else { curve.len().saturating_sub(1) };
            corners.extend((0..n).map(|i| [point(i), point(i + 1), point(i + 1)]));
        }
        Self::new(corners, watch)
    }

    fn new(mut corners: Vec<[Vector; 3]>, watch: &Watch) -> Result<Self, Stopped> {
        let mut nodes = Vec::new();
        if !corners.is_empty() {
            grow(&mut nodes, &mut corners, 0, watch)?;
        }
        Ok(Self { corners, nodes })
    }

    /// Returns the corners of all triangles, in the order of the tree.
    pub(super) fn corners(&self) -> &[[Vector; 3]] {
        &self.corners
    }

    /// Returns the length of the diagonal of the box around all triangles, model units; 0 without triangles.
    pub(super) fn diagonal(&self) -> f64 {
        self.nodes.first().map_or(0.0, |all| length(minus(all.high, all.low)))
    }

    /// Returns the squared distance of a point from the nearest triangle, and replaces `near` by the number of that
    /// triangle. The search starts with triangle `near`. There must be a triangle.
    pub(super) fn nearest(&self, point: Vector, near: &mut usize, waiting: &mut Vec<(f64, u32)>) -> f64 {
        let mut best = square_from_triangle(point, self.corners[*near]);
        waiting.clear();
        waiting.push((0.0, 0));
        while let Some((square, number)) = waiting.pop() {
            let node = &self.nodes[number as usize];
            if square >= best {
                continue;
            }
            if node.second == 0 {
                for i in node.from as usize..node.to as usize {
                    let square = square_from_triangle(point, self.corners[i]);
                    if square < best {
                        (best, *near) = (square, i);
                    }
                }
                continue;
            }
            let mut halves = [number + 1, node.second].map(|half| (self.nodes[half as usize].square(point), half));
            if halves[0].0 < halves[1].0 {
                halves.swap(0, 1);
            }
            // the nearer half is visited first
            waiting.extend(halves);
        }
        best
    }

    /// Returns the distance of each point, model units; infinite if the mesh has no triangles.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub(super) fn distances(&self, points: &[Vector], watch: &Watch) -> Result<Vec<f64>, Stopped> {
        let mut distances = vec![f64::INFINITY; points.len()];
        let part = ROWS_PER_CHUNK / 16;
        distances.par_chunks_mut(part).zip(points.par_chunks(part)).try_for_each(|(distances, points)| {
            let (mut near, mut waiting) = (0, Vec::new());
            for (distance, &point) in distances.iter_mut().zip(points) {
                // a point equally far from all triangles is tested against each of them
                watch.check()?;
                *distance = self.distance(point, &mut near, &mut waiting);
            }
            Ok(())
        })?;
        Ok(distances)
    }

    /// Returns the distance of a point; the search starts with triangle `near`, which the nearest one replaces.
    fn distance(&self, point: Vector, near: &mut usize, waiting: &mut Vec<(f64, u32)>) -> f64 {
        if self.corners.is_empty() { f64::INFINITY } else { sqrt(self.nearest(point, near, waiting)) }
    }
}

impl TriangleNode {
    /// Returns the squared distance of a point from the box.
    fn square(&self, point: Vector) -> f64 {
        let off = |k: usize| (self.low[k] - point[k]).max(point[k] - self.high[k]).max(0.0);
        (0..3).map(|k| off(k) * off(k)).sum()
    }
}

/// Adds the node of triangles, the first of which has the number `start`, and the nodes below it.
fn grow(
    nodes: &mut Vec<TriangleNode>,
    corners: &mut [[Vector; 3]],
    start: usize,
    watch: &Watch,
) -> Result<(), Stopped> {
    watch.check()?;
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in corners.iter().flatten() {
        (low, high) = ([0, 1, 2].map(|k| low[k].min(point[k])), [0, 1, 2].map(|k| high[k].max(point[k])));
    }
    let number = |n: usize| u32::try_from(n).expect("fewer than 2^32 triangles");
    let (here, n) = (nodes.len(), corners.len());
    nodes.push(TriangleNode { low, high, from: number(start), to: number(start + n), second: 0 });
    if n > TRIANGLES_PER_LEAF {
        let longest = (1..3).fold(0, |k, other| if high[other] - low[other] > high[k] - low[k] { other } else { k });
        let middle = |triangle: &[Vector; 3]| triangle.iter().map(|p| p[longest] / 3.0).sum::<f64>();
        let half = n / 2;
        corners.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
        let (first, second) = corners.split_at_mut(half);
        grow(nodes, first, start, watch)?;
        nodes[here].second = number(nodes.len());
        grow(nodes, second, start + half, watch)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners spread over a cube, always the same ones.
    fn scattered(n: u32) -> Vec<[Vector; 3]> {
        let mut state = 1_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state) / f64::from(u32::MAX)
        };
        (0..n).map(|_| std::array::from_fn(|_| std::array::from_fn(|_| next()))).collect()
    }

    #[test]
    fn the_tree_finds_the_least_of_all_distances() {
        let all = scattered(200);
        let mut corners = all.clone();
        let mut nodes = Vec::new();
        grow(&mut nodes, &mut corners, 0, &Watch::new()).expect("nobody stops it");
        let tree = Triangles { corners, nodes };
        let points: Vec<Vector> = scattered(100).into_iter().flatten().map(|p| p.map(|x| 3.0 * x - 1.0)).collect();
        let found = tree.distances(&points, &Watch::new()).expect("nobody stops it");
        for (point, found) in points.iter().zip(found) {
            let least = all.iter().map(|&t| square_from_triangle(*point, t)).fold(f64::INFINITY, f64::min);
            assert_eq!(found.to_bits(), sqrt(least).to_bits());
        }
        let nothing = Triangles { corners: Vec::new(), nodes: Vec::new() };
        let found = nothing.distances(&points[..1], &Watch::new()).expect("nobody stops it");
        assert!(found[0].is_infinite());
    }
}
