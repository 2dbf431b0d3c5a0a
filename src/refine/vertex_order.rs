//! The order in which values of refined vertices are kept, and the way from there to the documented one.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use crate::scheme::mesh_net::MeshNet;
use crate::shape::order::Order;

/// Vertices that one thread takes at a time at least.
const CHUNK: usize = 4096;

fn bytes(net: &MeshNet) -> usize {
    let (base, parent) = (&net.mesh.base, net.mesh.parent.as_ref());
    let parent = parent.filter(|parent| !Arc::ptr_eq(parent, base)).map_or(0, |parent| parent.bytes());
    parent + 2 * size_of::<u32>() * base.n_faces()
}

/// How the values of the vertices of a mesh are kept.
#[derive(Debug)]
pub(super) struct VertexOrder {
    /// The documented order; `None` when the mesh was not split since its base: then there is only one order.
    documented: Option<Order>,
    /// Whether values are kept in the order of construction.
    constructed: bool,
    /// Bytes of the topology before the last split, and of what the order knows of each face of the base.
    bytes: usize,
}

impl VertexOrder {
    /// Values in the order in which steps construct the vertices of a net.
    pub(super) fn constructed(net: &MeshNet) -> Self {
        let documented = net.mesh.order();
        Self { constructed: documented.is_some(), documented, bytes: bytes(net) }
    }

    /// Values in the documented order already, so that nothing has to be gathered.
    pub(super) fn documented(net: &MeshNet) -> Self {
        Self { documented: net.mesh.order(), constructed: false, bytes: bytes(net) }
    }

    /// Bytes that it holds besides the base.
    pub(super) fn bytes(&self) -> usize {
        self.bytes
    }

    /// Whether values are kept in the documented order.
    pub(super) fn is_documented(&self) -> bool {
        !self.constructed
    }

    /// The documented order of vertices and faces; `None` when it is that of the base.
    pub(super) fn order(&self) -> Option<&Order> {
        self.documented.as_ref()
    }

    /// The way to where values are kept, where that is not their place in the documented order.
    fn way(&self) -> Option<&Order> {
        self.documented.as_ref().filter(|_| self.constructed)
    }

    /// Where the values of a vertex are kept that has the number `v` in the documented order.
    pub(super) fn place(&self, v: usize) -> usize {
        self.way().map_or(v, |order| order.constructed(v) as usize)
    }

    /// The points of the vertices in `range`, numbered in the documented order.
    pub(super) fn points<const W: usize>(&self, all: &[[f64; W]], range: Range<usize>, out: &mut Vec<[f64; W]>) {
        let Some(order) = self.way() else {
            out.clear();
            out.extend_from_slice(&all[range]);
            return;
        };
        out.resize(range.len(), [0.0; W]);
        out.par_chunks_mut(CHUNK).enumerate().for_each(|(i, rows)| {
            let start = range.start + i * CHUNK;
            let (range, mut rows) = (start..start + rows.len(), rows.iter_mut());
            order.each_constructed(range, |at| rows.next().into_iter().for_each(|row| *row = all[at as usize]));
        });
    }

    /// Gathers values of any `width` in the documented order.
    pub(super) fn values(&self, all: &[f64], width: usize, range: Range<usize>, out: &mut Vec<f64>) {
        let Some(order) = self.way() else {
            out.clear();
            out.extend_from_slice(&all[width * range.start..width * range.end]);
            return;
        };
        out.resize(width * range.len(), 0.0);
        out.par_chunks_mut(width * CHUNK).enumerate().for_each(|(i, rows)| {
            let start = range.start + i * CHUNK;
            let (range, mut rows) = (start..start + rows.len() / width, rows.chunks_exact_mut(width));
            order.each_constructed(range, |at| {
                let at = at as usize * width;
                rows.next().into_iter().for_each(|row| row.copy_from_slice(&all[at..at + width]));
            });
        });
    }
}
