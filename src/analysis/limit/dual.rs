//! Finds the children of vertices, edges and faces under D in whole nets.

use std::sync::Arc;

use rayon::prelude::*;

use super::disc::Centre;
use super::error::Unlimited;
use crate::refine::{Points, advance};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::Children;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::check::{FaceList, Winding};
use crate::shape::topology::{NONE, Topology, index};
use crate::watch::Watch;

/// The topology of a net in the order of its construction.
#[derive(Debug)]
struct Constructed {
    topology: Arc<Topology>,
    /// For each vertex its number in the documented order.
    numbers: Vec<u32>,
}

/// A net and its dual.
#[derive(Debug)]
pub(super) struct DualNet<'a> {
    /// The net that D was applied to, in the documented order, which D follows.
    old: Arc<Topology>,
    /// The net that D was applied to in the order of its construction, if that is another one.
    constructed: Option<Constructed>,
    new: &'a Topology,
    /// For each vertex of `old` its face in the dual, or [`NONE`].
    faces: Vec<u32>,
}

impl<'a> DualNet<'a> {
    /// Creates the dual from the nets `before` and `after` a D.
    ///
    /// # Errors
    /// [`Unlimited::Lost`] if the net in the documented order is no valid mesh.
    pub(super) fn of(before: &MeshNet, after: &'a MeshNet) -> Result<Self, Unlimited> {
        let (old, constructed) = documented(before)?;
        let mut n_faces = 0;
        // inner vertices with at least three faces have faces in the dual, in the same order
        let face = |v: usize| {
            let inside = !old.is_isolated(v) && old.boundary_edges(v).is_none() && old.ring(v).nth(2).is_some();
            if !inside {
                return NONE;
            }
            n_faces += 1;
            n_faces - 1
        };
        let faces = (0..old.n_vertices()).map(face).collect();
        Ok(Self { old, constructed, new: &after.mesh.base, faces })
    }

    /// Returns the child of a vertex, edge or face of the net before D, which is in the order of construction.
    ///
    /// # Errors
    /// [`Unlimited::Lost`] if D leaves nothing of it, [`Unlimited::Separated`] if it leaves several equal parts.
    pub(super) fn child(&self, centre: Centre) -> Result<Centre, Unlimited> {
        let Some(Constructed { topology: constructed, numbers }) = &self.constructed else {
            return match centre {
                Centre::Vertex(v) => self.of_vertex(v),
                Centre::Edge(half_edge) => self.of_edge(half_edge),
                Centre::Face(f) => self.of_face(f as usize),
            };
        };
        let number = |v: u32| numbers[v as usize];
        match centre {
            Centre::Vertex(v) => self.of_vertex(number(v)),
            Centre::Edge(half_edge) => {
                let ends = [half_edge, constructed.next(half_edge)].map(|end| number(constructed.vertex(end)));
                self.of_edge(self.old.between(ends).ok_or(Unlimited::Lost)?)
            }
            Centre::Face(f) => {
                let mut face: Vec<u32> = constructed.face(f as usize).iter().map(|&v| number(v)).collect();
                face.sort_unstable();
                let same = |f: &usize| {
                    let mut other = self.old.face(*f).to_vec();
                    other.sort_unstable();
                    other == face
                };
                let mut around = self.old.ring(face[0] as usize).map(|half_edge| self.old.face_of(half_edge));
                self.of_face(around.find(same).ok_or(Unlimited::Lost)?)
            }
        }
    }

    /// Returns the child of a vertex: its face in the dual. A vertex without one has a path of dual vertices, and its
    /// child is the middle of the path: a vertex, or an edge.
    fn of_vertex(&self, v: u32) -> Result<Centre, Unlimited> {
        let (old, v) = (&self.old, v as usize);
        if self.faces[v] != NONE {
            return Ok(Centre::Face(self.faces[v]));
        }
        let ring: Vec<u32> = old.ring(v).collect();
        let half = ring.len() / 2;
        if old.boundary_edges(v).is_none() {
            let between = ring.iter().find_map(|&half_edge| self.between(half_edge));
            return between.ok_or(Unlimited::Lost);
        }
        if ring.len() % 2 == 1 {
            return self.of_face(old.face_of(ring[half]));
        }
        ring.get(half).and_then(|&half_edge| self.between(half_edge)).ok_or(Unlimited::Lost)
    }

    /// Returns the child of an edge: the dual edge between its two faces, or the vertex of its only face.
    fn of_edge(&self, half_edge: u32) -> Result<Centre, Unlimited> {
        match self.old.twin(half_edge) {
            NONE => self.of_face(self.old.face_of(half_edge)),
            twin => self.between(half_edge).or_else(|| self.between(twin)).ok_or(Unlimited::Lost),
        }
    }

    /// Returns the dual edge between the two faces beside an inner edge, as a half-edge of the dual face of the vertex
    /// where the given half-edge ends; `None` if that vertex has no face in the dual.
    fn between(&self, half_edge: u32) -> Option<Centre> {
        let old = &self.old;
        let end = old.next(half_edge);
        let face = self.faces[old.vertex(end) as usize];
        if face == NONE {
            return None;
        }
        // counter-clockwise around that vertex, the face of the twin follows the face of the half-edge
        let place = self.place(old.vertex(end), old.face_of(half_edge))?;
        Some(Centre::Edge(self.new.half_edges(face as usize).start + place))
    }

    /// Returns the position of a face in the cycle of the faces around an inner vertex, which begins with the face of
    /// the lowest number.
    fn place(&self, v: u32, face: usize) -> Option<u32> {
        let cycle: Vec<usize> = self.old.ring(v as usize).map(|half_edge| self.old.face_of(half_edge)).collect();
        let lowest = (0..cycle.len()).min_by_key(|&i| cycle[i])?;
        let at = cycle.iter().position(|&other| other == face)?;
        Some(index((at + cycle.len() - lowest) % cycle.len()))
    }

    /// Returns the child of a face: its vertex in the dual. Where dual faces of its inner vertices do not share edges,
    /// there may be several such vertices; then it is the one with the most faces.
    ///
    /// # Errors
    /// [`Unlimited::Lost`] if there is none, [`Unlimited::Separated`] if several have the most faces.
    fn of_face(&self, f: usize) -> Result<Centre, Unlimited> {
        let mut found: Vec<(u32, usize)> = Vec::new();
        for &v in self.old.face(f) {
            let face = self.faces[v as usize];
            let Some(place) = self.place(v, f).filter(|_| face != NONE) else { continue };
            let vertex = self.new.vertex(self.new.half_edges(face as usize).start + place);
            match found.iter_mut().find(|(known, _)| *known == vertex) {
                Some((_, n)) => *n += 1,
                None => found.push((vertex, 1)),
            }
        }
        let most = found.iter().map(|&(_, n)| n).max().ok_or(Unlimited::Lost)?;
        let mut largest = found.iter().filter(|&&(_, n)| n == most);
        match (largest.next(), largest.next()) {
            (Some(&(vertex, _)), None) => Ok(Centre::Vertex(vertex)),
            _ => Err(Unlimited::Separated),
        }
    }
}

/// Returns the topology of a net in the documented order, and in the order of construction if that is another one.
fn documented(net: &MeshNet) -> Result<(Arc<Topology>, Option<Constructed>), Unlimited> {
    let topology = net.mesh.topology();
    let Some(order) = net.mesh.order() else { return Ok((topology, None)) };
    let (mut faces, mut face) = (FaceList::default(), vec![0; order.face_size()]);
    for f in 0..order.n_faces() {
        order.face(f, &mut face);
        faces.push(face.iter().copied());
    }
    let n = order.n_vertices();
    let old = Topology::of_faces(n, faces, Winding::Refuse).map_err(|_| Unlimited::Lost)?.topology;
    let mut numbers = vec![0; n];
    (0..n).for_each(|v| numbers[order.constructed(v) as usize] = index(v));
    Ok((Arc::new(old), Some(Constructed { topology, numbers })))
}

/// A net and its points after the steps that come before the next upsampling.
pub(super) struct Unrefined {
    /// The net.
    pub(super) net: MeshNet,
    /// The points of the net, channel by channel.
    pub(super) points: Vec<Points>,
    /// For each vertex of the net before the first D its child, or `None` if it has no faces; `None` if no step was a
    /// D, so that vertices are their own children.
    pub(super) centres: Option<Vec<Option<Centre>>>,
}

impl Unrefined {
    /// Applies steps that do not refine.
    ///
    /// # Errors
    /// [`Unlimited`] if a step cannot be applied or a D leaves a vertex with faces no child.
    pub(super) fn by(
        net: &MeshNet,
        points: &[Points],
        plan: &Plan,
        steps: &[Scheduled],
        watch: &Watch,
    ) -> Result<Self, Unlimited> {
        let mut unrefined = Self { net: net.clone(), points: points.to_vec(), centres: None };
        for step in steps {
            let before = unrefined.net.clone();
            advance(&mut unrefined.net, &mut unrefined.points, plan, [step], watch)?;
            if step.letter.facts().children == Children::Dual {
                let centres = unrefined.centres.take().unwrap_or_else(|| vertices(&before));
                let dual = DualNet::of(&before, &unrefined.net)?;
                let child = |centre: Option<Centre>| centre.map(|centre| dual.child(centre)).transpose();
                unrefined.centres =
                    Some(centres.into_par_iter().with_min_len(1024).map(child).collect::<Result<_, _>>()?);
            }
        }
        Ok(unrefined)
    }
}

/// Returns each vertex of a net as its own child; `None` for vertices without faces.
fn vertices(net: &MeshNet) -> Vec<Option<Centre>> {
    let topology = net.mesh.topology();
    let vertex = |v: usize| (!topology.is_isolated(v)).then(|| Centre::Vertex(index(v)));
    (0..topology.n_vertices()).map(vertex).collect()
}
