//! A refined mesh as a source for the writers, in the documented order.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use crate::scheme::mesh_net::MeshNet;
use crate::scheme::sharpness::Sharpness;
use crate::shape::attachments::Attachments;
use crate::shape::order::Order;
use crate::shape::source::{FaceChunk, MeshSource, Origin};
use crate::shape::topology::{Topology, index};

/// A refined mesh: positions in the order of construction, and the way from there to the documented order.
#[derive(Debug)]
pub struct RefinedMesh {
    points: Vec<f64>,
    /// Normals of the limit, if there are any, in the same order.
    normals: Option<Vec<[f64; 3]>>,
    base: Arc<Topology>,
    /// `None` when the mesh was not split since its base: then the orders agree.
    order: Option<Order>,
    shown: Shown,
    attachments: Arc<Attachments>,
    /// The numbers of each channel, in the order of construction.
    channels: Vec<Vec<f64>>,
    /// Edges that are still sharp, numbered in the order of construction.
    sharpness: Option<Arc<Sharpness>>,
    /// Pieces of each edge of the base: those of edge `e` have the numbers `e x pieces ..` in its direction.
    pieces: usize,
}

/// The faces that are shown: runs of consecutive ones.
#[derive(Debug)]
struct Shown {
    /// For each run its first number among the shown faces and its first face.
    runs: Vec<(usize, usize)>,
    n: usize,
    n_corners: usize,
}

impl RefinedMesh {
    /// The mesh of a net with its points in the order of construction, `n x 3`.
    pub fn new(net: &MeshNet, points: Vec<f64>) -> Self {
        let order = net.order();
        let shown = Shown::new(&net.base, order.as_ref(), &net.holes);
        let pieces = net.pieces.iter().map(|&pieces| pieces as usize).product();
        Self {
            points,
            normals: None,
            base: net.base.clone(),
            order,
            shown,
            attachments: Arc::default(),
            channels: Vec::new(),
            sharpness: net.sharpness.clone(),
            pieces,
        }
    }

    /// The same mesh with what it carries: for each channel its numbers in the order of construction.
    #[must_use]
    pub fn carrying(self, attachments: Arc<Attachments>, channels: Vec<Vec<f64>>) -> Self {
        Self { attachments, channels, ..self }
    }

    /// Some rows of an array in the order of construction, in the documented one.
    fn ordered(&self, rows: &[[f64; 3]], range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        match &self.order {
            None => {
                out.clear();
                out.extend_from_slice(&rows[range]);
            }
            Some(order) => range
                .into_par_iter()
                .with_min_len(4096)
                .map(|v| rows[order.constructed(v) as usize])
                .collect_into_vec(out),
        }
    }

    /// The same mesh with unit normals in the order of construction, if there are any.
    #[must_use]
    pub(super) fn with_normals(self, normals: Option<Vec<[f64; 3]>>) -> Self {
        Self { normals, ..self }
    }

    /// Positions of all vertices in the documented order, model units.
    pub fn all_positions(&self) -> Vec<[f64; 3]> {
        let mut positions = Vec::new();
        self.positions(0..self.n_vertices(), &mut positions);
        positions
    }
}

impl Shown {
    fn new(base: &Topology, order: Option<&Order>, holes: &[u32]) -> Self {
        let all = order.map_or(base.n_faces(), Order::n_faces);
        let first = |f: usize| if f == base.n_faces() { all } else { order.map_or(f, |order| order.first_face(f)) };
        let corners = |f: usize| base.face(f).len();
        let mut runs = Vec::new();
        let (mut n, mut n_corners, mut from) = (0, 0, 0);
        let hidden = holes.iter().map(|&f| f as usize).chain([base.n_faces()]);
        for hole in hidden {
            if hole > from {
                runs.push((n, first(from)));
                n += first(hole) - first(from);
                n_corners += (from..hole).map(corners).sum::<usize>();
            }
            from = hole + 1;
        }
        let n_corners = order.map_or(n_corners, |order| order.face_size() * n);
        Self { runs, n, n_corners }
    }

    /// The number that face `face` has among the shown ones, or that of the first shown one after it.
    fn number(&self, face: usize) -> usize {
        let run = self.runs.partition_point(|(_, first)| *first <= face);
        let end = self.runs.get(run).map_or(self.n, |(number, _)| *number);
        let number = run.checked_sub(1).map_or(0, |run| self.runs[run].0 + face - self.runs[run].1);
        number.min(end)
    }

    fn face(&self, shown: usize) -> usize {
        let run = self.runs.partition_point(|(first, _)| *first <= shown) - 1;
        let (first_shown, first) = self.runs[run];
        first + shown - first_shown
    }
}

impl MeshSource for RefinedMesh {
    fn n_vertices(&self) -> usize {
        self.points.len() / 3
    }

    fn n_faces(&self) -> usize {
        self.shown.n
    }

    fn n_corners(&self) -> usize {
        self.shown.n_corners
    }

    fn positions(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        self.ordered(self.points.as_chunks::<3>().0, range, out);
    }

    fn normals(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) -> bool {
        self.normals.as_ref().map(|normals| self.ordered(normals, range, out)).is_some()
    }

    fn sharp_edges(&self) -> Vec<[u32; 2]> {
        let ends = |&(e, _): &(u32, f64)| {
            let (edge, piece) = (e as usize / self.pieces, e as usize % self.pieces);
            let [start, end] = self.base.ends(edge);
            [piece, piece + 1].map(|at| match at {
                0 => start,
                at if at == self.pieces => end,
                at => index(self.base.n_vertices() + edge * (self.pieces - 1) + at - 1),
            })
        };
        self.sharpness.iter().flat_map(|sharpness| sharpness.edges()).map(ends).collect()
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        out.clear();
        match &self.order {
            None => range.for_each(|f| out.push(self.base.face(self.shown.face(f)))),
            Some(order) => {
                let size = order.face_size();
                out.sizes.resize(range.len(), index(size));
                out.vertices.resize(size * range.len(), 0);
                let faces = out.vertices.par_chunks_exact_mut(size);
                let start = range.start;
                faces.with_min_len(4096).enumerate().for_each(|(i, face)| {
                    order.face(self.shown.face(start + i), face);
                });
            }
        }
    }

    fn attachments(&self) -> &Attachments {
        &self.attachments
    }

    fn channel(&self, channel: usize, range: Range<usize>, out: &mut Vec<f64>) {
        out.clear();
        let (values, width) = (&self.channels[channel], self.attachments.channels[channel].width);
        let Some(order) = &self.order else {
            out.extend_from_slice(&values[width * range.start..width * range.end]);
            return;
        };
        out.resize(width * range.len(), 0.0);
        let rows = out.par_chunks_exact_mut(width).with_min_len(4096);
        rows.zip(range).for_each(|(row, v)| {
            let at = order.constructed(v) as usize * width;
            row.copy_from_slice(&values[at..at + width]);
        });
    }

    fn input_cells(&self) -> [usize; 3] {
        [self.base.n_vertices(), self.base.n_edges(), self.base.n_faces()]
    }

    fn face_origin(&self, face: usize) -> u32 {
        let face = self.shown.face(face);
        index(self.order.as_ref().map_or(face, |order| order.base_face(face)))
    }

    fn faces_of(&self, face: usize) -> Range<usize> {
        let first = |f: usize| match &self.order {
            None => f,
            Some(order) if f == self.base.n_faces() => order.n_faces(),
            Some(order) => order.first_face(f),
        };
        self.shown.number(first(face))..self.shown.number(first(face + 1))
    }

    fn vertex_origin(&self, vertex: usize) -> Origin {
        match &self.order {
            None => Origin { dimension: 0, cell: index(vertex) },
            Some(order) => order.origin(vertex),
        }
    }
}
