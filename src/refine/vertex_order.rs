//! The order in which values of refined vertices are stored, and the map from there to the documented order.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use crate::scheme::mesh_net::MeshNet;
use crate::shape::order::Order;

/// Number of vertices that one thread takes at a time. Each is looked up and copied, so that half of it costs more
/// switching and more searches for the start of a range; twice of it leaves threads idle at smaller ranges.
const ORDERED_PER_TASK: usize = 4096;

fn bytes(net: &MeshNet) -> usize {
    let (base, parent) = (&net.mesh.base, net.mesh.parent.as_ref());
    let parent = parent.filter(|parent| !Arc::ptr_eq(parent, base)).map_or(0, |parent| parent.bytes());
    parent + 2 * size_of::<u32>() * base.n_faces()
}

/// The order in which the values of a mesh's vertices are stored.
#[derive(Debug)]
pub(super) struct VertexOrder {
    /// The documented order; `None` when the mesh was not split since its base, so that both orders are the same.
    documented: Option<Order>,
    /// Whether values are stored in the order of construction.
    constructed: bool,
    /// Size of the topology before the last split, and of the most that the order stores for each base face.
    bytes: usize,
}

impl VertexOrder {
    /// The order of values stored as steps construct the vertices of a net.
    pub(super) fn constructed(net: &MeshNet) -> Self {
        let documented = net.mesh.order();
        Self { constructed: documented.is_some(), documented, bytes: bytes(net) }
    }

    /// The order of values stored in the documented order already, so that nothing has to be reordered.
    pub(super) fn documented(net: &MeshNet) -> Self {
        Self { documented: net.mesh.order(), constructed: false, bytes: bytes(net) }
    }

    /// Returns the number of bytes that the order occupies besides the base.
    pub(super) fn bytes(&self) -> usize {
        self.bytes
    }

    /// Returns whether values are stored in the documented order.
    pub(super) fn is_documented(&self) -> bool {
        !self.constructed
    }

    /// Returns the documented order of vertices and faces; `None` when it is that of the base.
    pub(super) fn order(&self) -> Option<&Order> {
        self.documented.as_ref()
    }

    /// Returns the map to the stored order, if that differs from the documented order.
    fn way(&self) -> Option<&Order> {
        self.documented.as_ref().filter(|_| self.constructed)
    }

    /// Returns where the values of the vertex with index `v` in the documented order are stored.
    pub(super) fn place(&self, v: usize) -> usize {
        self.way().map_or(v, |order| order.constructed(v) as usize)
    }

    /// Writes the points of the vertices in `range`, indexed in the documented order, to `out`.
    pub(super) fn points<const W: usize>(&self, all: &[[f64; W]], range: Range<usize>, out: &mut Vec<[f64; W]>) {
        let Some(order) = self.way() else {
            out.clear();
            out.extend_from_slice(&all[range]);
            return;
        };
        out.resize(range.len(), [0.0; W]);
        out.par_chunks_mut(ORDERED_PER_TASK).enumerate().for_each(|(i, rows)| {
            let start = range.start + i * ORDERED_PER_TASK;
            let (range, mut rows) = (start..start + rows.len(), rows.iter_mut());
            order.each_constructed(range, |at| rows.next().into_iter().for_each(|row| *row = all[at as usize]));
        });
    }

    /// Returns the values of all vertices, `width` each, in the documented order.
    pub(super) fn ordered(&self, all: Vec<f64>, width: usize) -> Vec<f64> {
        if self.is_documented() {
            return all;
        }
        let mut ordered = Vec::new();
        self.values(&all, width, 0..all.len() / width, &mut ordered);
        ordered
    }

    /// Writes the values of the vertices in `range`, `width` each, to `out` in the documented order.
    pub(super) fn values(&self, all: &[f64], width: usize, range: Range<usize>, out: &mut Vec<f64>) {
        let Some(order) = self.way() else {
            out.clear();
            out.extend_from_slice(&all[width * range.start..width * range.end]);
            return;
        };
        out.resize(width * range.len(), 0.0);
        out.par_chunks_mut(width * ORDERED_PER_TASK).enumerate().for_each(|(i, rows)| {
            let start = range.start + i * ORDERED_PER_TASK;
            let (range, mut rows) = (start..start + rows.len() / width, rows.chunks_exact_mut(width));
            order.each_constructed(range, |at| {
                let at = at as usize * width;
                rows.next().into_iter().for_each(|row| row.copy_from_slice(&all[at..at + width]));
            });
        });
    }
}
