//! The order in which values of refined vertices are kept, and the way from there to the documented one.

use std::ops::Range;

use rayon::prelude::*;

use crate::scheme::mesh_net::MeshNet;
use crate::shape::order::Order;

/// Vertices that one thread takes at a time at least.
const CHUNK: usize = 4096;

/// How the values of the vertices of a mesh are kept.
#[derive(Debug)]
pub(super) struct VertexOrder {
    /// The documented order; `None` when the mesh was not split since its base: then there is only one order.
    documented: Option<Order>,
    /// Whether values are kept in the order of construction.
    constructed: bool,
}

impl VertexOrder {
    /// Values in the order in which steps construct the vertices of a net.
    pub(super) fn constructed(net: &MeshNet) -> Self {
        let documented = net.mesh.order();
        Self { constructed: documented.is_some(), documented }
    }

    /// Values in the documented order already, so that nothing has to be gathered.
    pub(super) fn documented(net: &MeshNet) -> Self {
        Self { documented: net.mesh.order(), constructed: false }
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
        match self.way() {
            None => {
                out.clear();
                out.extend_from_slice(&all[range]);
            }
            Some(order) => {
                let vertices = range.into_par_iter().with_min_len(CHUNK);
                vertices.map(|v| all[order.constructed(v) as usize]).collect_into_vec(out);
            }
        }
    }

    /// Gathers values of any `width` in the documented order.
    pub(super) fn values(&self, all: &[f64], width: usize, range: Range<usize>, out: &mut Vec<f64>) {
        out.clear();
        let Some(order) = self.way() else {
            out.extend_from_slice(&all[width * range.start..width * range.end]);
            return;
        };
        out.resize(width * range.len(), 0.0);
        let rows = out.par_chunks_exact_mut(width).with_min_len(CHUNK);
        rows.zip(range).for_each(|(row, v)| {
            let at = order.constructed(v) as usize * width;
            row.copy_from_slice(&all[at..at + width]);
        });
    }
}
