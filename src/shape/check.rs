//! Checks of a face list, and the topology of one that passes.

use rayon::prelude::*;

use super::indices::MAX_REPORTED;
use super::topology::{Faces, NONE, Topology, index};
use crate::fault::Fault;
use crate::math::sharing::is_small;

/// A face list: face `f` has the vertices `vertices[starts[f]..starts[f + 1]]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FaceList {
    starts: Vec<u32>,
    vertices: Vec<u32>,
}

impl Default for FaceList {
    fn default() -> Self {
        Self { starts: vec![0], vertices: Vec::new() }
    }
}

impl<F: IntoIterator<Item = u32>> FromIterator<F> for FaceList {
    fn from_iter<I: IntoIterator<Item = F>>(faces: I) -> Self {
        let mut list = Self::default();
        faces.into_iter().for_each(|face| list.push(face));
        list
    }
}

impl FaceList {
    /// Appends a face.
    pub fn push(&mut self, vertices: impl IntoIterator<Item = u32>) {
        self.vertices.extend(vertices);
        self.starts.push(index(self.vertices.len()));
    }

    /// Appends the faces of another list.
    pub fn append(&mut self, other: &Self) {
        let before = self.starts[self.len()];
        self.starts.extend(other.starts[1..].iter().map(|start| before + start));
        self.vertices.extend_from_slice(&other.vertices);
    }

    /// Number of faces.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there is no face.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of half-edges: the sum of the sizes of all faces.
    pub fn n_half_edges(&self) -> usize {
        self.vertices.len()
    }

    /// The vertices of face `f`.
    pub fn face(&self, f: usize) -> &[u32] {
        &self.vertices[self.starts[f] as usize..self.starts[f + 1] as usize]
    }

    /// The vertices of all faces, face after face.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    pub(super) fn reverse(&mut self, f: usize) {
        self.vertices[self.starts[f] as usize..self.starts[f + 1] as usize].reverse();
    }
}

/// What to do with faces whose winding disagrees with their neighbours'.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Winding {
    /// They are a fault.
    #[default]
    Refuse,
    /// They are turned to agree with the lowest face of their component.
    Repair,
}

/// A topology with what was changed to get it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Checked {
    /// The topology of the faces.
    pub topology: Topology,
    /// For each vertex appended by splitting fans apart: the vertex it was split from.
    pub split_from: Vec<u32>,
    /// Faces that were turned.
    pub turned: Vec<u32>,
}

impl Topology {
    /// Builds the topology of `faces` over `n_vertices` vertices.
    ///
    /// Edges are numbered by first appearance when the faces are scanned in order, corner by corner. A vertex that
    /// joins several fans of faces is split into one vertex a fan; the fan of the lowest corner keeps the number.
    ///
    /// # Errors
    /// Every fault with a pointer `/faces/...`: faces of fewer than three vertices, repeated or missing vertices, edges
    /// with three faces or more, components that cannot be oriented or are wound inconsistently.
    pub fn of_faces(n_vertices: usize, mut faces: FaceList, winding: Winding) -> Result<Checked, Vec<Fault>> {
        check_faces(n_vertices, &faces)?;
        let mut sides = sides(n_vertices, &faces);
        check_edges(&faces, &sides)?;
        let turned = orient(&mut faces, &sides, winding)?;
        if !turned.is_empty() {
            sides = self::sides(n_vertices, &faces);
        }
        let mut topology = connect(n_vertices, faces, &sides);
        let split_from = topology.part_fans();
        Ok(Checked { topology, split_from, turned })
    }

    /// The topology of some of its faces, in this order, and for each vertex there the one that it is here; ascending,
    /// but for those that are added where fans are split apart.
    ///
    /// # Errors
    /// None are known, as a part of an oriented manifold is one.
    pub fn part(&self, faces: &[u32]) -> Result<(Self, Vec<u32>), Vec<Fault>> {
        let mut vertices: Vec<u32> = faces.iter().flat_map(|&f| self.face(f as usize)).copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let number = |v: &u32| vertices.binary_search(v).map_or(NONE, index);
        let faces = faces.iter().map(|&f| self.face(f as usize).iter().map(number)).collect();
        let Checked { topology, split_from, .. } = Self::of_faces(vertices.len(), faces, Winding::Refuse)?;
        let copies: Vec<u32> = split_from.iter().map(|&v| vertices[v as usize]).collect();
        vertices.extend(copies);
        Ok((topology, vertices))
    }

    /// Finds each vertex's first corner; splits vertices with several fans. Returns the origins of the added vertices.
    fn part_fans(&mut self) -> Vec<u32> {
        let mut seen = vec![false; self.n_half_edges()];
        let mut split_from = Vec::new();
        for half_edge in 0..index(self.n_half_edges()) {
            if seen[half_edge as usize] {
                continue;
            }
            let start = self.fan_start(half_edge);
            let fan: Vec<u32> = super::topology::Ring::from(self, start).collect();
            for &c in &fan {
                seen[c as usize] = true;
            }
            let vertex = self.vertex(half_edge);
            if self.outgoing[vertex as usize] == NONE {
                self.outgoing[vertex as usize] = start;
            } else {
                let added = index(self.n_vertices);
                self.n_vertices += 1;
                self.outgoing.push(start);
                split_from.push(vertex);
                for c in fan {
                    self.vertices[c as usize] = added;
                }
            }
        }
        split_from
    }

    /// The first corner, counter-clockwise, of the fan that holds `half_edge`: at the boundary, or `half_edge` itself.
    fn fan_start(&self, half_edge: u32) -> u32 {
        let mut at = half_edge;
        loop {
            let twin = self.twin(at);
            if twin == NONE {
                return at;
            }
            at = self.next(twin);
            if at == half_edge {
                return half_edge;
            }
        }
    }
}

/// Turns faces so that neighbours run along their edges in opposite directions. Returns those that were turned.
///
/// # Errors
/// As [`Topology::of_faces`].
pub fn oriented(n_vertices: usize, faces: &mut FaceList, winding: Winding) -> Result<Vec<u32>, Vec<Fault>> {
    check_faces(n_vertices, faces)?;
    let sides = sides(n_vertices, faces);
    check_edges(faces, &sides)?;
    orient(faces, &sides, winding)
}

/// Reports the first of some faults, and how many there are. The others are not kept: their sentences would be longer
/// than what they speak of.
fn report(mut faults: impl Iterator<Item = Fault>) -> Result<(), Vec<Fault>> {
    let first: Vec<Fault> = faults.by_ref().take(MAX_REPORTED).collect();
    let more = faults.count();
    let mut faults = first;
    if faults.is_empty() {
        return Ok(());
    }
    if more > 0 {
        faults.push(Fault::new("/faces", format!("and {more} more faults like these")));
    }
    Err(faults)
}

fn check_faces(n_vertices: usize, faces: &FaceList) -> Result<(), Vec<Fault>> {
    let check = |f: usize| -> Option<Fault> {
        let face = faces.face(f);
        let place = || format!("/faces/{f}");
        if face.len() < 3 {
            return Some(Fault::new(place(), format!("a face of {} vertices; a face has at least 3", face.len())));
        }
        if let Some(j) = face.iter().position(|&v| v as usize >= n_vertices) {
            let detail = format!("there is no vertex {}; the mesh has {n_vertices}, counted from 0", face[j]);
            return Some(Fault::new(format!("{}/{j}", place()), detail));
        }
        let mut sorted = face.to_vec();
        sorted.sort_unstable();
        let repeated = sorted.windows(2).find(|pair| pair[0] == pair[1])?;
        Some(Fault::new(
            place(),
            format!("vertex {} occurs twice; a face visits each of its vertices once", repeated[0]),
        ))
    };
    let all = 0..index(faces.len());
    let is_wrong = |f: &u32| check(*f as usize).is_some();
    let wrong: Vec<u32> = if is_small(faces.len()) {
        all.filter(is_wrong).collect()
    } else {
        all.into_par_iter().filter(is_wrong).collect()
    };
    report(wrong.into_iter().filter_map(|f| check(f as usize)))
}

/// One side of an edge: the edge as (lower vertex, higher vertex), then the corner.
type Side = ((u32, u32), u32);

/// All sides, those of one edge next to each other, by ascending corner: sorted into the lower vertices, then at each.
fn sides(n_vertices: usize, faces: &FaceList) -> Vec<Side> {
    let all = || {
        (0..faces.len()).flat_map(|f| {
            let face = faces.face(f);
            (0..face.len()).map(move |j| {
                let (a, b) = (face[j], face[(j + 1) % face.len()]);
                ((a.min(b), a.max(b)), faces.starts[f] + index(j))
            })
        })
    };
    let mut places = vec![0; n_vertices + 1];
    all().for_each(|side| places[side.0.0 as usize + 1] += 1);
    (0..n_vertices).for_each(|v| places[v + 1] += places[v]);
    let mut sides = vec![((0, 0), 0); faces.n_half_edges()];
    for side in all() {
        let place = &mut places[side.0.0 as usize];
        sides[*place] = side;
        *place += 1;
    }
    let same_vertex = |a: &Side, b: &Side| a.0.0 == b.0.0;
    if is_small(sides.len()) {
        sides.chunk_by_mut(same_vertex).for_each(<[Side]>::sort_unstable);
    } else {
        sides.par_chunk_by_mut(same_vertex).for_each(<[Side]>::sort_unstable);
    }
    sides
}

fn groups(sides: &[Side]) -> impl Iterator<Item = &[Side]> {
    sides.chunk_by(|a, b| a.0 == b.0)
}

fn face_of(faces: &FaceList, half_edge: u32) -> usize {
    faces.starts.partition_point(|&start| start <= half_edge) - 1
}

fn check_edges(faces: &FaceList, sides: &[Side]) -> Result<(), Vec<Fault>> {
    let crowded = groups(sides).filter(|group| group.len() > 2).map(|group| {
        let ((a, b), half_edge) = group[2];
        let all: Vec<String> = group.iter().take(8).map(|side| face_of(faces, side.1).to_string()).collect();
        let detail = format!("edge ({a}, {b}) has {} faces ({}); at most 2 are allowed", group.len(), all.join(", "));
        Fault::new(format!("/faces/{}", face_of(faces, half_edge)), detail)
    });
    report(crowded)
}

/// Turns faces so that neighbours agree, or reports why they do not. Returns the faces turned.
fn orient(faces: &mut FaceList, sides: &[Side], winding: Winding) -> Result<Vec<u32>, Vec<Fault>> {
    let forward = |faces: &FaceList, side: &Side| faces.vertices[side.1 as usize] == side.0.0;
    let disagree = |group: &[Side]| group.len() == 2 && forward(faces, &group[0]) == forward(faces, &group[1]);
    let wrong: Vec<&[Side]> = groups(sides).filter(|group| disagree(group)).collect();
    if wrong.is_empty() {
        return Ok(Vec::new());
    }
    let turned = turns(faces, sides)?;
    if winding == Winding::Refuse {
        let faults = wrong.iter().map(|group| {
            let ((a, b), half_edge) = group[1];
            let (f, g) = (face_of(faces, group[0].1), face_of(faces, half_edge));
            let detail = format!(
                "faces {f} and {g} run along edge ({a}, {b}) in the same direction; turn one of them, or set \
                 \"orient\": \"repair\""
            );
            Fault::new(format!("/faces/{g}"), detail)
        });
        report(faults)?;
    }
    for &f in &turned {
        faces.reverse(f as usize);
    }
    Ok(turned)
}

/// A neighbouring face, whether it runs along the common edge in the same direction, and that edge.
type Neighbour = (usize, bool, (u32, u32));

/// The faces to turn so that all agree with the lowest face of their component, by a search over neighbours.
fn turns(faces: &FaceList, sides: &[Side]) -> Result<Vec<u32>, Vec<Fault>> {
    let mut neighbours: Vec<Vec<Neighbour>> = vec![Vec::new(); faces.len()];
    for group in groups(sides).filter(|group| group.len() == 2) {
        let [f, g] = [face_of(faces, group[0].1), face_of(faces, group[1].1)];
        let same = faces.vertices[group[0].1 as usize] == faces.vertices[group[1].1 as usize];
        neighbours[f].push((g, same, group[0].0));
        neighbours[g].push((f, same, group[0].0));
    }
    let mut turn: Vec<Option<bool>> = vec![None; faces.len()];
    for first in 0..faces.len() {
        if turn[first].is_some() {
            continue;
        }
        turn[first] = Some(false);
        let mut waiting = vec![first];
        while let Some(f) = waiting.pop() {
            for &(g, same, (a, b)) in &neighbours[f] {
                let wanted = turn[f].map(|turned| turned != same);
                if turn[g].is_none() {
                    turn[g] = wanted;
                    waiting.push(g);
                } else if turn[g] != wanted {
                    let detail = format!(
                        "the faces cannot be oriented: around edge ({a}, {b}) they form a one-sided strip; cut the \
                         mesh along it"
                    );
                    return Err(vec![Fault::new(format!("/faces/{g}"), detail)]);
                }
            }
        }
    }
    Ok((0..index(faces.len())).filter(|&f| turn[f as usize] == Some(true)).collect())
}

/// The topology of checked faces, but for [`Topology::part_fans`].
fn connect(n_vertices: usize, faces: FaceList, sides: &[Side]) -> Topology {
    let n_half_edges = faces.vertices.len();
    let mut opposite = vec![NONE; n_half_edges];
    for group in groups(sides).filter(|group| group.len() == 2) {
        opposite[group[0].1 as usize] = group[1].1;
        opposite[group[1].1 as usize] = group[0].1;
    }
    let mut edge_of = vec![NONE; n_half_edges];
    let mut halves = Vec::with_capacity(sides.len());
    for half_edge in 0..n_half_edges {
        let other = opposite[half_edge];
        if other == NONE || (other as usize) > half_edge {
            edge_of[half_edge] = index(halves.len());
            halves.push([index(half_edge), other]);
        } else {
            edge_of[half_edge] = edge_of[other as usize];
        }
    }
    let all = |size: u32| faces.starts.windows(2).all(|pair| pair[1] - pair[0] == size);
    let (quads, triangles) = (all(4), all(3));
    let FaceList { starts, vertices } = faces;
    let layout = if quads {
        Faces::Quads
    } else if triangles {
        Faces::Triangles
    } else {
        let owner = starts.windows(2).enumerate();
        let owner = owner.flat_map(|(f, pair)| std::iter::repeat_n(index(f), (pair[1] - pair[0]) as usize)).collect();
        Faces::Mixed { starts, owner }
    };
    let outgoing = vec![NONE; n_vertices];
    Topology { n_vertices, faces: layout, vertices, edge_of, halves, outgoing }
}
