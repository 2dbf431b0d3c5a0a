//! Assembles the objects of the build of a 3MF model into one mesh, with the transforms of their items.

use std::collections::{BTreeMap, BTreeSet};

use super::model::{LookGroup, ModelObject, PlacedObject, ThreeMfModel, TriangleLook};
use crate::input::collect::MeshBuilder;
use crate::input::reader::{ReadLimits, ReadMesh};
use crate::input::room::{GROWN, MemoryBudget};
use crate::input::transform::Transform;
use crate::shape::attachments::{COLOR_CHANNEL, Channel, ChannelInput};
use crate::shape::check::FaceList;
use crate::shape::labels::FaceSet;
use crate::shape::looks::Look;
use crate::shape::seams::{Interpolation, SeamsInput};
use crate::shape::topology::index;

/// Bytes of memory of a vertex, of a triangle, of its material, of its colours, and of a set of faces, each kept in
/// lists that grow; the list of the faces of an object does not grow.
const BUILT_POSITION_BYTES: usize = GROWN * 24;
const BUILT_TRIANGLE_BYTES: usize = GROWN * 16 + 8;
const BUILT_MATERIAL_BYTES: usize = GROWN * 8;
const BUILT_COLORS_BYTES: usize = GROWN * 12;
const BUILT_SET_BYTES: usize = GROWN * size_of::<FaceSet>() + 192;
/// Bytes of memory of the colours of a vertex, and of the corner colours of a triangle.
const BUILT_VERTEX_BYTES: usize = 40 + 32;
const BUILT_CORNERS_BYTES: usize = GROWN * 16 + 12;
/// Bytes of memory of a colour, and of a group of colours.
const GROUP_COLOR_BYTES: usize = 32;
const COLOR_GROUP_BYTES: usize = 96;
/// Maximum depth to which objects may be nested as components.
const MAX_COMPONENT_DEPTH: usize = 16;
/// Maximum number of objects that are built, since an object may be a component of many others.
const MAX_BUILT: usize = 100_000;
/// The material name of faces without a material.
const DEFAULT_MATERIAL_NAME: &str = "default";

/// Assembles the mesh of all items of the build, or of all objects that are no component if the build is empty.
///
/// # Errors
/// An object does not exist or contains itself, or the mesh takes more than is allowed.
pub(super) fn built(mut model: ThreeMfModel, mut room: MemoryBudget, limits: &ReadLimits) -> Result<ReadMesh, String> {
    if let Some(id) = inside_itself(&model.objects) {
        return Err(format!("object {id} holds itself by its components; an object holds only others before it"));
    }
    let mut items = std::mem::take(&mut model.items);
    if items.is_empty() {
        let inside: BTreeSet<u64> =
            model.objects.values().flat_map(|object| object.components.iter().map(|part| part.object)).collect();
        let free = model.objects.keys().filter(|id| !inside.contains(id));
        items = free.map(|&object| PlacedObject { object, transform: Transform::IDENTITY }).collect();
    }
    let (starts, colors) = collect_colors(&model, &mut room)?;
    let mut building = Building {
        model: &model,
        mesh: MeshBuilder::new(limits),
        room,
        n_built: 0,
        groups: Vec::new(),
        materials: BTreeMap::new(),
        starts,
        colors,
        of_corners: Vec::new(),
        supports: 0,
        degenerate: 0,
    };
    for item in items {
        building.place(item, &Transform::IDENTITY, 0)?;
    }
    building.finish()
}

/// Returns an object to which its own components lead back, if there is one. Without a build no item would lead to it.
fn inside_itself(objects: &BTreeMap<u64, ModelObject>) -> Option<u64> {
    let mut done = BTreeSet::new();
    for (&outermost, _) in objects.iter().filter(|(_, object)| !object.components.is_empty()) {
        // The objects from the outermost inwards, each with the components that are still to be followed.
        let (mut path, mut open) = (Vec::new(), BTreeSet::new());
        let mut next = Some(outermost);
        loop {
            if let Some(id) = next.filter(|id| !done.contains(id)) {
                if !open.insert(id) {
                    return Some(id);
                }
                path.push((id, objects.get(&id).map_or(&[][..], |object| object.components.as_slice()).iter()));
            }
            let Some((id, components)) = path.last_mut() else { break };
            next = components.next().map(|part| part.object);
            if next.is_none() {
                done.insert(*id);
                open.remove(id);
                path.pop();
            }
        }
    }
    None
}

struct Building<'a> {
    model: &'a ThreeMfModel,
    mesh: MeshBuilder,
    room: MemoryBudget,
    n_built: usize,
    groups: Vec<FaceSet>,
    /// The faces of each material, by group and index in the group.
    materials: BTreeMap<(u32, u32), Vec<u64>>,
    /// The index in `colors` of the first colour of each group, by the id of the group.
    starts: BTreeMap<u32, u32>,
    /// The colours of all groups.
    colors: Vec<[f64; 4]>,
    /// The index in `colors` of each corner's colour, or `u32::MAX` if the corner has none; empty if no corner has a
    /// colour.
    of_corners: Vec<u32>,
    supports: usize,
    degenerate: usize,
}

/// For each group of colours the index of its first one, and the colours of all groups.
type GroupColors = (BTreeMap<u32, u32>, Vec<[f64; 4]>);

/// Collects the colours of all groups, and for each group the index of its first colour.
fn collect_colors(model: &ThreeMfModel, room: &mut MemoryBudget) -> Result<GroupColors, String> {
    let (mut starts, mut colors) = (BTreeMap::new(), Vec::new());
    for (&id, group) in &model.looks {
        if let (Ok(id), LookGroup::Colors(all)) = (u32::try_from(id), group) {
            room.take(COLOR_GROUP_BYTES + GROWN * GROUP_COLOR_BYTES * all.len())?;
            starts.insert(id, index(colors.len()));
            colors.extend(all.iter().map(|color| color.map(|byte| f64::from(byte) / 255.0)));
        }
    }
    Ok((starts, colors))
}

impl Building<'_> {
    fn place(&mut self, item: PlacedObject, outer: &Transform, depth: usize) -> Result<(), String> {
        let PlacedObject { object: id, transform } = item;
        let model = self.model;
        let object = model.objects.get(&id).ok_or_else(|| format!("there is no object {id}, which is to be built"))?;
        self.n_built += 1;
        if depth > MAX_COMPONENT_DEPTH {
            return Err(format!("object {id} lies deeper in others than {MAX_COMPONENT_DEPTH}; nest them less deep"));
        }
        if self.n_built > MAX_BUILT {
            return Err(format!("more than {MAX_BUILT} objects are built; send a smaller model"));
        }
        if object.is_support {
            self.supports += 1;
            return Ok(());
        }
        let transform = outer.after(&transform);
        if !object.triangles.is_empty() {
            self.mesh(id, object, &transform)?;
        }
        object.components.iter().try_for_each(|&part| self.place(part, &transform, depth + 1))
    }

    fn mesh(&mut self, id: u64, object: &ModelObject, transform: &Transform) -> Result<(), String> {
        let has = |wanted: fn(&LookGroup) -> bool| self.model.looks.values().any(wanted);
        let materials = if has(|group| matches!(group, LookGroup::Materials(_))) { BUILT_MATERIAL_BYTES } else { 0 };
        let colors = if has(|group| matches!(group, LookGroup::Colors(_))) { BUILT_COLORS_BYTES } else { 0 };
        let triangle = BUILT_TRIANGLE_BYTES + materials + colors;
        self.room.take(
            BUILT_SET_BYTES + object.positions.len() * BUILT_POSITION_BYTES + object.triangles.len() * triangle,
        )?;
        let start = index(self.mesh.mesh.positions.len());
        let first_face = self.mesh.mesh.faces.len() as u64;
        let stays = *transform == Transform::IDENTITY;
        for &position in &object.positions {
            let at = if stays { position } else { transform.point(position) };
            if at.iter().any(|x| !x.is_finite()) {
                return Err(format!("object {id} is put beyond the largest number there is"));
            }
            self.mesh.vertex(at)?;
        }
        let is_mirrored = transform.is_mirror();
        let mut changes = object.looks.iter().peekable();
        let mut look = None;
        for (i, corners) in (0..).zip(&object.triangles) {
            if let Some(&(_, changed)) = changes.next_if(|(from, _)| *from == i) {
                look = changed;
            }
            let &[a, b, c] = corners;
            if a == b || b == c || c == a {
                self.degenerate += 1;
                continue;
            }
            let order = if is_mirrored { [0, 2, 1] } else { [0, 1, 2] };
            self.mesh.face(&order.map(|k| start + corners[k]))?;
            self.look(look, order)?;
        }
        let faces = (first_face..self.mesh.mesh.faces.len() as u64).collect();
        let name = object.name.clone().unwrap_or_else(|| format!("object-{id}"));
        self.groups.push(FaceSet { name, faces });
        Ok(())
    }

    /// Assigns a material or corner colours to the last face.
    fn look(&mut self, look: TriangleLook, order: [usize; 3]) -> Result<(), String> {
        let face = self.mesh.mesh.faces.len() as u64 - 1;
        let Some((group, properties)) = look else {
            self.uncolored();
            return Ok(());
        };
        let missing = |n: u32| format!("there is no property {n} in the group {group}");
        match self.model.looks.get(&u64::from(group)) {
            Some(LookGroup::Materials(all)) => {
                let (name, _) = all.get(properties[0] as usize).ok_or_else(|| missing(properties[0]))?;
                if name != DEFAULT_MATERIAL_NAME {
                    self.materials.entry((group, properties[0])).or_default().push(face);
                }
                self.uncolored();
            }
            Some(LookGroup::Colors(all)) => {
                let before = self.mesh.mesh.faces.n_half_edges() - 3;
                self.of_corners.resize(before, u32::MAX);
                let start = self.starts.get(&group).copied().unwrap_or_default();
                for k in order {
                    all.get(properties[k] as usize).ok_or_else(|| missing(properties[k]))?;
                    self.of_corners.push(start + properties[k]);
                }
            }
            // textures and mixtures are reported in a note
            None => self.uncolored(),
        }
        Ok(())
    }

    /// Marks the corners of the last face as uncoloured if earlier corners have colours.
    fn uncolored(&mut self) {
        if !self.of_corners.is_empty() {
            self.of_corners.resize(self.mesh.mesh.faces.n_half_edges(), u32::MAX);
        }
    }

    fn finish(self) -> Result<ReadMesh, String> {
        let Self { model, mesh, mut room, groups, materials, colors, of_corners, supports, degenerate, .. } = self;
        let mut mesh = mesh.mesh;
        mesh.channels = channel(&mesh, &colors, of_corners, &mut room)?.into_iter().collect();
        mesh.groups = if groups.len() > 1 { groups } else { Vec::new() };
        for ((group, number), faces) in materials {
            if let Some(LookGroup::Materials(all)) = model.looks.get(&u64::from(group)) {
                let (name, color) = &all[number as usize];
                mesh.materials.push(FaceSet { name: name.clone(), faces });
                mesh.looks.push(Look { color: Some(*color), ..Look::default() });
            }
        }
        let notes = model.notes.iter().map(|(what, n)| (*what, *n));
        let own = [("supports are left out", supports), ("triangles with two equal corners are left out", degenerate)];
        let notes = notes.chain(own).filter(|(_, n)| *n > 0);
        mesh.notes = notes.map(|(what, n)| format!("{what}: {n}")).collect();
        Ok(mesh)
    }
}

/// Creates the colour channel: one colour per vertex if all corners at each vertex have the same colour, otherwise one
/// per corner. Corners without a colour are white.
fn channel(
    mesh: &ReadMesh,
    colors: &[[f64; 4]],
    mut of_corners: Vec<u32>,
    room: &mut MemoryBudget,
) -> Result<Option<ChannelInput>, String> {
    if of_corners.is_empty() {
        return Ok(None);
    }
    room.take(BUILT_VERTEX_BYTES * mesh.positions.len())?;
    of_corners.resize(mesh.faces.n_half_edges(), u32::MAX);
    let color = |number: u32| colors.get(number as usize).copied().unwrap_or([1.0; 4]);
    let width = if colors.iter().all(|color| color[3] >= 1.0) { 3 } else { 4 };
    let mut of_vertices: Vec<Option<[f64; 4]>> = vec![None; mesh.positions.len()];
    let mut agree = true;
    for (&v, &number) in mesh.faces.vertices().iter().zip(&of_corners) {
        let known = *of_vertices[v as usize].get_or_insert(color(number));
        agree &= known.map(f64::to_bits) == color(number).map(f64::to_bits);
    }
    if agree {
        let values =
            of_vertices.into_iter().flat_map(|color| color.unwrap_or([1.0; 4]).into_iter().take(width)).collect();
        return Ok(Some(Channel { name: COLOR_CHANNEL.to_owned(), width, values, seams: None }));
    }
    drop(of_vertices);
    room.take(BUILT_CORNERS_BYTES * mesh.faces.len())?;
    let white = index(colors.len());
    let values = colors.iter().chain([&[1.0; 4]]).flat_map(|color| &color[..width]).copied().collect();
    let numbers: Vec<u32> = of_corners.iter().map(|&number| number.min(white)).collect();
    let faces: FaceList = numbers.chunks_exact(3).map(<[u32]>::to_vec).collect();
    let seams = SeamsInput { faces, interpolation: Interpolation::None };
    Ok(Some(Channel { name: COLOR_CHANNEL.to_owned(), width, values, seams: Some(seams) }))
}
