//! Application-specific data of vertices and triangles: custom attributes, and the groups that primitives name.

use std::collections::BTreeMap;
use std::ops::Range;

use gltf::json::Index;
use gltf::json::accessor::Accessor;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked::{self, Valid};
use serde_json::Value;

use super::accessor::AccessorRows;
use super::buffers::GltfDocument;
use crate::input::reader::ReadMesh;
use crate::input::room::{GROWN, MemoryBudget};
use crate::input::text::{MAX_NOTED_NAMES, first_names, quoted};
use crate::shape::attachments::{COLOR_CHANNEL, ChannelInput, ORIGIN};
use crate::shape::labels::FaceSet;

/// Returns the channel name of an application-specific attribute: `_HEAT` becomes `heat`. glTF permits upper case only,
/// so the name is made lower case, unless it would then be that of the colour.
pub(super) fn name(semantic: &Checked<Semantic>) -> Option<String> {
    let Valid(Semantic::Extras(name)) = semantic else { return None };
    let small = name.to_ascii_lowercase();
    let kept = if small == COLOR_CHANNEL { name.clone() } else { small };
    // origins do not become a channel
    (kept != ORIGIN).then_some(kept)
}

/// Names of attributes that are not read, with the number of primitives that have them.
#[derive(Debug, Default)]
pub(super) struct UnreadAttributes {
    found: BTreeMap<String, usize>,
}

impl UnreadAttributes {
    /// Counts the attributes of a primitive that are not read.
    pub(super) fn take(&mut self, primitive: &Primitive) {
        for name in primitive.attributes.keys().filter_map(unread) {
            *self.found.entry(name).or_default() += 1;
        }
    }

    /// Adds a note that names the attributes.
    pub(super) fn finish(self, mesh: &mut ReadMesh) {
        if !self.found.is_empty() {
            let names = self.found.into_iter().map(|(name, primitives)| format!("{name} ({primitives})"));
            mesh.notes.push(format!("attributes of primitives are left out: {}", first_names(names)));
        }
    }
}

/// Returns the name of an attribute that is not read; normals are computed anew, and application-specific attributes
/// become channels.
fn unread(semantic: &Checked<Semantic>) -> Option<String> {
    match semantic {
        Valid(
            Semantic::Positions
            | Semantic::Normals
            | Semantic::TexCoords(0)
            | Semantic::Colors(0)
            | Semantic::Extras(_),
        ) => None,
        Valid(Semantic::Tangents) => Some("TANGENT".to_owned()),
        Valid(Semantic::TexCoords(set)) => Some(format!("TEXCOORD_{set}")),
        Valid(Semantic::Colors(set)) => Some(format!("COLOR_{set}")),
        Valid(Semantic::Joints(set)) => Some(format!("JOINTS_{set}")),
        Valid(Semantic::Weights(set)) => Some(format!("WEIGHTS_{set}")),
        Checked::Invalid => Some("one that glTF does not know".to_owned()),
    }
}

/// Returns the group that a primitive names among its extras: `"extras": {"group": "top"}`.
pub(super) fn group(primitive: &Primitive) -> Option<String> {
    let extras: Value = serde_json::from_str(primitive.extras.as_ref()?.get()).ok()?;
    Some(extras.get("group")?.as_str()?.to_owned())
}

/// Values of vertices by attribute name, as long as all vertices have them.
#[derive(Debug, Default)]
pub(super) struct Channels {
    found: BTreeMap<String, AccessorRows>,
}

impl Channels {
    /// Adds the attributes of `n` vertices, whose first index is `start`. Attributes that exceed the room are left out,
    /// because a mesh does not depend on them, and accessors may share their bytes.
    pub(super) fn take(
        &mut self,
        document: &GltfDocument<'_>,
        attributes: &[(String, Index<Accessor>)],
        (start, n): (usize, usize),
        room: &mut MemoryBudget,
    ) {
        for (name, accessor) in attributes {
            let known = self.found.entry(name.clone()).or_default();
            if known.values.len() != start * known.width {
                continue;
            }
            if document.accessor(*accessor).is_ok_and(|accessor| accessor.count.0 != n as u64) {
                continue;
            }
            let Ok(rows) = document.rows(*accessor, room) else { continue };
            let bytes = rows.bytes();
            let fits = start == 0 || rows.width == known.width;
            if fits && rows.values.iter().all(|x| x.is_finite()) && room.take(GROWN * bytes).is_ok() {
                known.width = rows.width;
                known.values.extend(&rows.values);
            }
            room.give(bytes);
        }
    }

    /// Moves the channels that all vertices have into the mesh, and notes the others.
    pub(super) fn finish(self, mesh: &mut ReadMesh) {
        let n = mesh.positions.len();
        let mut others = Vec::new();
        for (name, AccessorRows { width, values }) in self.found {
            if width > 0 && values.len() == n * width {
                mesh.channels.push(ChannelInput::of_vertices(&name, width, values));
            } else {
                others.push(quoted(&name));
            }
        }
        if !others.is_empty() {
            let (n, first) = (others.len(), others[..others.len().min(MAX_NOTED_NAMES)].join(", "));
            mesh.notes.push(format!("{n} attributes are left out, as not every vertex has them: {first}"));
        }
    }
}

/// Groups of faces: those that primitives name, otherwise the nodes.
#[derive(Debug, Default)]
pub(super) struct Groups {
    named: Vec<FaceSet>,
    /// Indices into `named` by name.
    numbers: BTreeMap<String, usize>,
    /// Faces of the current node that are in a named group.
    taken: Vec<Range<u64>>,
    /// Faces of each node that are in no named group.
    nodes: Vec<FaceSet>,
}

impl Groups {
    /// Adds faces to the group that a primitive names.
    pub(super) fn add_faces(&mut self, name: String, faces: Range<u64>) {
        let number = *self.numbers.entry(name.clone()).or_insert(self.named.len());
        if number == self.named.len() {
            self.named.push(FaceSet { name, faces: Vec::new() });
        }
        self.named[number].faces.extend(faces.clone());
        self.taken.push(faces);
    }

    /// Ends a node, whose faces without a named group form a group of its own.
    pub(super) fn node(&mut self, name: String, faces: Range<usize>) {
        let mut free = Vec::new();
        let mut next = faces.start as u64;
        for range in self.taken.drain(..) {
            free.extend(next..range.start);
            next = range.end;
        }
        free.extend(next..faces.end as u64);
        if !free.is_empty() {
            self.nodes.push(FaceSet { name, faces: free });
        }
    }

    /// Returns the groups. A single node group is dropped because it distinguishes nothing.
    pub(super) fn finish(self) -> Vec<FaceSet> {
        let nodes = if self.nodes.len() > 1 { self.nodes } else { Vec::new() };
        self.named.into_iter().chain(nodes).collect()
    }
}
