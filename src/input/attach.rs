//! Conversion of the contents of a file to the input of a mesh: names without blanks, each face in at most one group,
//! and channels that the mesh can hold.

use std::collections::BTreeMap;

use super::reader::{CornerUvs, ReadMesh};
use super::text::quoted;
use crate::shape::attachments::{AttachmentsInput, ChannelInput, MAX_CHANNELS, MAX_TOTAL_WIDTH, check_channel};
use crate::shape::check::{FaceList, Winding};
use crate::shape::labels::FaceSet;
use crate::shape::labels::{MAX_LABEL_NAME, MAX_LABELS};
use crate::shape::mesh::MeshInput;
use crate::shape::seams::{SeamsInput, UvsInput};

impl ReadMesh {
    /// Converts the contents to the input of a mesh; data that a mesh cannot hold are reported in its notes.
    pub fn into_input(self, winding: Winding) -> MeshInput {
        let Self { positions, faces, corners, creases, holes, mut notes, .. } = self;
        let uvs = self.uvs.map(|uvs| of_corners(uvs, &faces));
        let channels = channels(self.channels, positions.len(), &mut notes);
        let (groups, _) = sets(self.groups, faces.len(), "group", &mut notes);
        let (materials, given) = sets(self.materials, faces.len(), "material", &mut notes);
        let looks = given.into_iter().map(|i| self.looks.get(i).cloned().unwrap_or_default()).collect();
        let attachments = AttachmentsInput { channels, groups, materials, looks, uvs };
        MeshInput { positions, faces, corners, creases, holes, winding, attachments, notes, ..MeshInput::default() }
    }
}

/// Converts the texture coordinates to one list per face.
fn of_corners(uvs: CornerUvs, faces: &FaceList) -> UvsInput {
    let mut seams = SeamsInput { interpolation: uvs.interpolation, ..SeamsInput::default() };
    let mut corners = uvs.corners.into_iter();
    for f in 0..faces.len() {
        seams.faces.push(corners.by_ref().take(faces.face(f).len()));
    }
    UvsInput { values: uvs.values, seams }
}

/// Returns the channels that a mesh can hold, in order.
fn channels(given: Vec<ChannelInput>, n_vertices: usize, notes: &mut Vec<String>) -> Vec<ChannelInput> {
    let mut kept: Vec<ChannelInput> = Vec::with_capacity(given.len());
    for channel in given {
        let width: usize = kept.iter().map(|channel| channel.width).sum::<usize>() + channel.width;
        if kept.len() == MAX_CHANNELS || width > MAX_TOTAL_WIDTH {
            notes.push(format!("the numbers {} of vertices are left out: there are too many", quoted(&channel.name)));
        } else if let Some(detail) = check_channel(&channel, &kept, n_vertices) {
            notes.push(format!("the numbers {} of vertices are left out: {detail}", quoted(&channel.name)));
        } else {
            kept.push(channel);
        }
    }
    kept
}

/// Returns disjoint sets of faces with names that all formats can hold, and for each its index among the given sets;
/// sets with equal names are merged, with the index of the first.
fn sets(given: Vec<FaceSet>, n_faces: usize, what: &str, notes: &mut Vec<String>) -> (Vec<FaceSet>, Vec<usize>) {
    let mut taken = vec![false; n_faces];
    let mut numbers: BTreeMap<String, usize> = BTreeMap::new();
    let mut kept: Vec<FaceSet> = Vec::new();
    let mut places = Vec::new();
    let (mut shared, mut beyond) = (0_usize, 0_usize);
    for (i, set) in given.into_iter().enumerate() {
        let name = plain(&set.name);
        let mut faces = set.faces;
        let n = faces.len();
        faces.retain(|&f| {
            let slot = usize::try_from(f).ok().and_then(|f| taken.get_mut(f));
            slot.is_some_and(|taken| !std::mem::replace(taken, true))
        });
        shared += n - faces.len();
        if faces.is_empty() {
            continue;
        }
        if let Some(&number) = numbers.get(&name) {
            kept[number].faces.extend(faces);
        } else if kept.len() == MAX_LABELS {
            beyond += 1;
        } else {
            numbers.insert(name.clone(), kept.len());
            kept.push(FaceSet { name, faces });
            places.push(i);
        }
    }
    if shared > 0 {
        notes.push(format!("faces in more than one {what} are kept in the first: {shared}"));
    }
    if beyond > 0 {
        notes.push(format!("{what}s are left out, as a mesh has at most {MAX_LABELS}: {beyond}"));
    }
    (kept, places)
}

/// Replaces by `_` the characters that names cannot hold, and shortens the name.
fn plain(name: &str) -> String {
    let letter = |c: char| if c.is_whitespace() || c.is_control() || c == '#' { '_' } else { c };
    let mut plain: String = name.chars().map(letter).collect();
    while plain.len() > MAX_LABEL_NAME {
        plain.pop();
    }
    if plain.is_empty() { "unnamed".to_owned() } else { plain }
}
