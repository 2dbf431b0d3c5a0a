//! The memory of an input that was read.

use std::mem::size_of;

use super::complete::Job;
use super::input::Input;
use crate::scheme::forecast;
use crate::scheme::plan::{MAX_PLAN_LEVELS, Plan, Scheduled};
use crate::shape::attachments::{Attachments, Channel};
use crate::shape::attributes::Attributes;
use crate::shape::labels::Labels;
use crate::shape::looks::images;
use crate::shape::mesh::Mesh;
use crate::shape::polygon::Polygon;
use crate::shape::repairs::Repair;
use crate::shape::seams::Seams;
use crate::shape::textures::Image;
use crate::shape::topology::Topology;

/// Bytes per corner of a topology: its vertex, in a list that may have twice the capacity, its edge, the two half-edges
/// of that edge as if no edges were shared, and its face, if faces differ in size.
const SIZED_CORNER_BYTES: usize = 2 * size_of::<u32>() + size_of::<u32>() + size_of::<[u32; 2]>();
/// Bytes of the index of a face or vertex, in a list that may have twice the capacity.
const INDEX_BYTES: usize = 2 * size_of::<u32>();

/// Bytes that any forecast takes: its lists of levels, and those of the outputs.
const FORECAST_BYTES: u64 = 1 << 20;

/// Returns the memory in bytes of the steps of a plan at the highest level.
pub(super) fn of_most_steps(plan: &Plan) -> u64 {
    let letters = plan.word.prefix.len() + plan.word.cycle.len() * MAX_PLAN_LEVELS as usize;
    (letters * size_of::<Scheduled>()) as u64
}

impl Job {
    /// Returns the memory in bytes of the input and the steps.
    pub(super) fn bytes(&self) -> u64 {
        let frames = self.films.iter().flat_map(|film| &film.frames);
        let frames = frames.map(|frame| (size_of_val(frame.steps()) + size_of::<Self>()) as u64).sum::<u64>();
        let panels = self.panels().iter().map(|panel| panel.bytes() + size_of::<Self>() as u64).sum::<u64>() + frames;
        let other = self.other.as_ref().map_or(0, |other| other.bytes());
        self.input.bytes() + size_of_val(self.steps()) as u64 + panels + other
    }

    /// Returns an upper bound of the memory in bytes of the job's forecast: lists over the parts of the input, and the
    /// part of the net that it follows.
    pub fn forecast_bytes(&self) -> u64 {
        let others = self.panels().iter().chain(self.other.as_deref());
        let of_others = others.map(Self::forecast_bytes).fold(0, u64::saturating_add);
        let followed = match &*self.input {
            Input::Polygons(_) => 0,
            Input::Mesh(mesh) => forecast::forecast_bytes(&self.plan.word, mesh.topology.n_half_edges()),
        };
        let own = FORECAST_BYTES.saturating_add(self.input.bytes());
        own.saturating_add(u64::try_from(followed).unwrap_or(u64::MAX)).saturating_add(of_others)
    }
}

impl Input {
    /// Returns the memory in bytes of the input: rounded up a little, never down.
    pub fn bytes(&self) -> u64 {
        let bytes = match self {
            Self::Polygons(polygons) => {
                list(polygons) + polygons.iter().map(|one| size_of::<Polygon>() + of_polygon(one)).sum::<usize>()
            }
            Self::Mesh(mesh) => size_of::<Mesh>() + of_mesh(mesh),
        };
        bytes as u64
    }
}

/// Returns the bytes of a list's capacity.
fn list<T>(list: &Vec<T>) -> usize {
    list.capacity() * size_of::<T>()
}

fn of_polygon(polygon: &Polygon) -> usize {
    let Polygon { points, dimension: _, closed: _, corners, rational: _, tangents, pinned, attributes } = polygon;
    let tangents = tangents.as_ref().map_or(0, list);
    list(points) + list(corners) + list(pinned) + tangents + attributes.as_ref().map_or(0, of_attributes)
}

fn of_attributes(attributes: &Attributes) -> usize {
    let Attributes { alpha, kernel, compensation, delta } = attributes;
    [alpha, kernel, compensation, delta].into_iter().flatten().map(list).sum()
}

fn of_mesh(mesh: &Mesh) -> usize {
    let Mesh {
        positions,
        frames,
        topology,
        corners,
        semi_sharp_corners,
        creases,
        holes,
        attributes,
        directions,
        attachments,
        split_from,
        repairs,
    } = mesh;
    let tags = list(corners) + list(semi_sharp_corners) + list(creases) + list(holes);
    // one byte per edge
    let directions = directions.as_ref().map_or(0, |_| topology.n_edges());
    let repairs = list(repairs) + repairs.iter().map(of_repair).sum::<usize>();
    let attributes = attributes.as_ref().map_or(0, of_attributes);
    let carried = size_of::<Attachments>() + of_attachments(attachments);
    let parts = size_of_val::<[u32]>(split_from);
    let frames: usize = frames.iter().map(|frame| size_of::<Vec<f64>>() + list(frame)).sum();
    list(positions) + frames + of_topology(topology) + tags + directions + repairs + attributes + carried + parts
}

fn of_repair(repair: &Repair) -> usize {
    match repair {
        Repair::Read(note) => note.capacity(),
        Repair::Welded { merged: _, pairs } => list(pairs),
        Repair::LostParameters(lost) => list(lost),
        Repair::LeftOut(faces) | Repair::Turned(faces) | Repair::Repeating(faces) => list(&faces.first),
        Repair::Crowded(edges) | Repair::Opposed(edges) | Repair::Doubled(edges) => list(&edges.first),
        Repair::Split { added: _, first } => list(first),
        Repair::Paired { pairs: _, left: _ } => 0,
    }
}

fn of_topology(topology: &Topology) -> usize {
    let (corners, faces) = (topology.n_half_edges(), topology.n_faces());
    let is_mixed = !topology.is_quads() && topology.first_other_than_triangle().is_some();
    let of_faces = if is_mixed { faces * INDEX_BYTES + corners * size_of::<u32>() } else { 0 };
    size_of::<Topology>() + corners * SIZED_CORNER_BYTES + of_faces + topology.n_vertices() * INDEX_BYTES
}

fn of_attachments(attachments: &Attachments) -> usize {
    let Attachments { channels, groups, materials, looks, uvs, unfolded } = attachments;
    let of_channel = |channel: &Channel| {
        list(&channel.values) + channel.name.capacity() + channel.seams.as_ref().map_or(0, of_seams)
    };
    let numbers: usize = channels.iter().map(of_channel).sum();
    let uvs = uvs.as_ref().map_or(0, |uvs| list(&uvs.values) + of_seams(&uvs.seams));
    // a single attribute with seams has the places of all
    let is_shared = attachments.places().count() < 2;
    let unfolded = unfolded.as_ref().filter(|_| !is_shared).map_or(0, |unfolded| of_topology(unfolded));
    let looks = list(looks) + images(looks).iter().map(|image| size_of::<Image>() + image.bytes().len()).sum::<usize>();
    list(channels) + numbers + of_labels(groups) + of_labels(materials) + looks + uvs + unfolded
}

fn of_seams(Seams { topology, corners, pairs, linear: _ }: &Seams) -> usize {
    of_topology(topology) + list(corners) + list(pairs)
}

fn of_labels(Labels { names, of_faces }: &Labels) -> usize {
    list(names) + names.iter().map(String::capacity).sum::<usize>() + list(of_faces)
}
