//! Parser of a 3MF model: its objects, materials, colours and build items.

use std::collections::BTreeMap;
use std::io::Read;

use super::xml::{Tag, XmlTags};
use crate::input::reader::ReadLimits;
use crate::input::room::{GROWN, MemoryBudget};
use crate::input::text::{count, number, quoted};
use crate::input::transform::Transform;
use crate::shape::coordinate_system::Unit;
use crate::shape::topology::index;

/// Bytes of memory of a vertex, of a triangle, of a change of looks, of a property, of a colour and of an object, each
/// kept in lists that grow.
const MODEL_POSITION_BYTES: usize = GROWN * 24;
const MODEL_TRIANGLE_BYTES: usize = GROWN * 12;
const MODEL_CHANGE_BYTES: usize = GROWN * size_of::<(u32, TriangleLook)>();
const MODEL_PROPERTY_BYTES: usize = GROWN * 64;
const MODEL_COLOR_BYTES: usize = GROWN * 4;
const MODEL_OBJECT_BYTES: usize = GROWN * (size_of::<ModelObject>() + 64);

/// A parsed model.
#[derive(Debug, Default)]
pub(super) struct ThreeMfModel {
    /// The unit of the coordinates after they are multiplied by `scale`.
    pub(super) unit: Unit,
    pub(super) scale: f64,
    pub(super) objects: BTreeMap<u64, ModelObject>,
    /// Groups of materials and colours, by id.
    pub(super) looks: BTreeMap<u64, LookGroup>,
    pub(super) items: Vec<PlacedObject>,
    pub(super) notes: BTreeMap<&'static str, usize>,
}

/// A group of materials or colours.
#[derive(Debug)]
pub(super) enum LookGroup {
    /// Names and colours of materials.
    Materials(Vec<(String, [f64; 4])>),
    /// Colours of corners as sRGB with alpha, 0 to 255.
    Colors(Vec<[u8; 4]>),
}

/// An object: a mesh, or a composition of other objects.
#[derive(Debug, Default)]
pub(super) struct ModelObject {
    pub(super) name: Option<String>,
    pub(super) is_support: bool,
    pub(super) positions: Vec<[f64; 3]>,
    /// The vertices of each triangle.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The looks of the triangles in runs: the first triangle of each run, and the look of the run. Triangles before
    /// the first run have none.
    pub(super) looks: Vec<(u32, TriangleLook)>,
    pub(super) components: Vec<PlacedObject>,
    /// The group and index of the look of triangles that name none.
    usual: Option<[u64; 2]>,
}

/// The look of a triangle: a group, and for each corner an index in the group.
pub(super) type TriangleLook = Option<(u32, [u32; 3])>;

/// An object with its transform.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedObject {
    pub(super) object: u64,
    pub(super) transform: Transform,
}

/// Reads a model.
///
/// # Errors
/// The document is not a valid model, or it takes more than is allowed.
pub(super) fn read<R: Read>(
    tags: &mut XmlTags<R>,
    room: &mut MemoryBudget,
    limits: &ReadLimits,
) -> Result<ThreeMfModel, String> {
    let mut reading = ThreemfReader {
        model: ThreeMfModel { scale: 1.0, ..ThreeMfModel::default() },
        object: None,
        group: None,
        changes: 0,
    };
    let mut counts = [0_u64; 2];
    let mut is_model = false;
    while let Some(tag) = tags.next()? {
        if tag.name == "model" && tag.opens {
            is_model = true;
        }
        if !is_model {
            return Err(format!("{} stands where a model should", quoted(&tag.name)));
        }
        match (tag.name.as_str(), tag.opens) {
            ("vertex", true) => {
                counts[0] += 1;
                at_most(counts[0], limits.max_vertices, "vertices")?;
                room.take(MODEL_POSITION_BYTES)?;
            }
            ("triangle", true) => {
                counts[1] += 1;
                at_most(counts[1], limits.max_faces, "triangles")?;
                room.take(MODEL_TRIANGLE_BYTES)?;
            }
            ("object", true) => room.take(MODEL_OBJECT_BYTES)?,
            ("color", true) => room.take(MODEL_COLOR_BYTES)?,
            (_, true) => room.take(if tag.closes { MODEL_PROPERTY_BYTES } else { 0 })?,
            _ => {}
        }
        reading.take(&tag)?;
        room.take(MODEL_CHANGE_BYTES * std::mem::take(&mut reading.changes))?;
    }
    if is_model { Ok(reading.model) } else { Err("the file holds no model".to_owned()) }
}

fn at_most(n: u64, most: u64, what: &str) -> Result<(), String> {
    if n <= most { Ok(()) } else { Err(format!("{n} {what} or more; {most} are allowed; send a smaller model")) }
}

struct ThreemfReader {
    model: ThreeMfModel,
    /// The object that is being read, with its id.
    object: Option<(u64, ModelObject)>,
    /// The group of looks that is being read, with its id.
    group: Option<(u64, LookGroup)>,
    /// The number of changes of looks since memory was last booked for them.
    changes: usize,
}

impl ThreemfReader {
    fn take(&mut self, tag: &Tag) -> Result<(), String> {
        if tag.opens {
            self.open(tag)?;
        }
        if tag.closes {
            self.close(&tag.name)?;
        }
        Ok(())
    }

    fn open(&mut self, tag: &Tag) -> Result<(), String> {
        match (tag.name.as_str(), &mut self.object, &mut self.group) {
            ("model", ..) => self.begin(tag)?,
            ("object", ..) => self.object = Some((whole(tag, "id")?, object(tag)?)),
            ("basematerials", ..) => self.group = Some((whole(tag, "id")?, LookGroup::Materials(Vec::new()))),
            ("colorgroup", ..) => self.group = Some((whole(tag, "id")?, LookGroup::Colors(Vec::new()))),
            ("base", _, Some((_, LookGroup::Materials(all)))) => {
                let color = color(tag, "displaycolor")?.map(|byte| f64::from(byte) / 255.0);
                all.push((tag.get("name").unwrap_or_default().to_owned(), color));
            }
            ("color", _, Some((_, LookGroup::Colors(all)))) => all.push(color(tag, "color")?),
            ("vertex", Some((_, object)), _) => {
                let scale = self.model.scale;
                let at = |name| coordinate(tag, name).map(|x| x * scale);
                object.positions.push([at("x")?, at("y")?, at("z")?]);
            }
            ("triangle", Some((_, object)), _) => {
                let (corners, look) = triangle(tag, object)?;
                if look != object.looks.last().and_then(|&(_, last)| last) {
                    object.looks.push((index(object.triangles.len()), look));
                    self.changes += 1;
                }
                object.triangles.push(corners);
            }
            ("component", Some((_, object)), _) => object.components.push(placed(tag, self.model.scale)?),
            ("item", ..) => self.model.items.push(placed(tag, self.model.scale)?),
            ("texture2d", ..) => self.note("textures are left out"),
            ("compositematerials" | "multiproperties", ..) => self.note("mixed materials are left out"),
            ("beamlattice", ..) => self.note("lattices of beams are left out"),
            _ => {}
        }
        Ok(())
    }

    fn note(&mut self, what: &'static str) {
        *self.model.notes.entry(what).or_insert(0) += 1;
    }

    fn close(&mut self, name: &str) -> Result<(), String> {
        let again = |id: u64| format!("two resources have the id {id}; each has one of its own");
        match name {
            "object" => {
                if let Some((id, object)) = self.object.take()
                    && self.model.objects.insert(id, object).is_some()
                {
                    return Err(again(id));
                }
            }
            "basematerials" | "colorgroup" => {
                if let Some((id, group)) = self.group.take()
                    && self.model.looks.insert(id, group).is_some()
                {
                    return Err(again(id));
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Reads the unit from the root tag, and refuses models that require an extension which is not supported.
    fn begin(&mut self, tag: &Tag) -> Result<(), String> {
        const READ_NAMESPACES: [&str; 3] = ["/material/", "/production/", "/trianglesets/"];
        (self.model.unit, self.model.scale) = match tag.get("unit").unwrap_or("millimeter") {
            "micron" => (Unit::Millimetre, 0.001),
            "millimeter" => (Unit::Millimetre, 1.0),
            "centimeter" => (Unit::Centimetre, 1.0),
            "meter" => (Unit::Metre, 1.0),
            "inch" => (Unit::Inch, 1.0),
            "foot" => (Unit::Inch, 12.0),
            other => return Err(format!("there is no unit {}", quoted(other))),
        };
        for prefix in tag.get("requiredextensions").unwrap_or_default().split_ascii_whitespace() {
            let space = tag.get(prefix).unwrap_or_default();
            if !READ_NAMESPACES.iter().any(|known| space.contains(known)) {
                return Err(format!(
                    "the model makes no sense without the extension {} {}, which is not read; save it as plain meshes",
                    quoted(prefix),
                    quoted(space)
                ));
            }
        }
        Ok(())
    }
}

fn object(tag: &Tag) -> Result<ModelObject, String> {
    let usual = tag.get("pid").map(|_| Ok::<_, String>([whole(tag, "pid")?, optional(tag, "pindex")?.unwrap_or(0)]));
    Ok(ModelObject {
        name: tag.get("name").filter(|name| !name.is_empty()).map(str::to_owned),
        is_support: matches!(tag.get("type"), Some("support" | "solidsupport")),
        usual: usual.transpose()?,
        ..ModelObject::default()
    })
}

/// Reads the vertices and the look of a triangle.
fn triangle(tag: &Tag, object: &ModelObject) -> Result<([u32; 3], TriangleLook), String> {
    let n = object.positions.len() as u64;
    let corner = |name: &str| {
        let v = whole(tag, name)?;
        let missing = || format!("there is no vertex {v}; the object has {n}, counted from 0");
        u32::try_from(v).ok().filter(|_| v < n).ok_or_else(missing)
    };
    let corners = [corner("v1")?, corner("v2")?, corner("v3")?];
    let usual = object.usual.unwrap_or_default();
    let group = optional(tag, "pid")?.or(object.usual.map(|[pid, _]| pid));
    let first = optional(tag, "p1")?;
    let look = group.map(|group| {
        let first = first.unwrap_or(usual[1]);
        let other = |name: &str| Ok::<_, String>(optional(tag, name)?.unwrap_or(first));
        let small = |n: u64| u32::try_from(n).map_err(|_| format!("there is no property {n}"));
        Ok::<_, String>((small(group)?, [small(first)?, small(other("p2")?)?, small(other("p3")?)?]))
    });
    Ok((corners, look.transpose()?))
}

fn placed(tag: &Tag, scale: f64) -> Result<PlacedObject, String> {
    if let Some(path) = tag.get("path") {
        return Err(format!("an object stands in another file, {}, which is not read; save all in one", quoted(path)));
    }
    let mut transform = Transform::IDENTITY;
    if let Some(text) = tag.get("transform") {
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        if words.len() != 12 {
            return Err(format!("a transform has {} numbers; it needs 12", words.len()));
        }
        for (slot, word) in transform.0.as_flattened_mut().iter_mut().zip(words) {
            *slot = number(word)?;
        }
        transform.0[3].iter_mut().for_each(|x| *x *= scale);
    }
    Ok(PlacedObject { object: whole(tag, "objectid")?, transform })
}

fn coordinate(tag: &Tag, name: &str) -> Result<f64, String> {
    number(tag.get(name).ok_or_else(|| missing(tag, name))?.trim())
}

fn whole(tag: &Tag, name: &str) -> Result<u64, String> {
    optional(tag, name)?.ok_or_else(|| missing(tag, name))
}

fn optional(tag: &Tag, name: &str) -> Result<Option<u64>, String> {
    tag.get(name).map(|text| count(text.trim())).transpose()
}

fn missing(tag: &Tag, name: &str) -> String {
    format!("{} has no {name}", quoted(&tag.name))
}

/// Parses a colour, `#RRGGBB` or `#RRGGBBAA`, as sRGB with alpha from 0 to 255.
fn color(tag: &Tag, name: &str) -> Result<[u8; 4], String> {
    let text = tag.get(name).ok_or_else(|| missing(tag, name))?.trim();
    let wrong = || format!("{} is no color, which is #RRGGBB or #RRGGBBAA", quoted(text));
    let digits = text.strip_prefix('#').filter(|digits| digits.is_ascii()).ok_or_else(wrong)?;
    let mut found = [255; 4];
    if digits.len() != 6 && digits.len() != 8 {
        return Err(wrong());
    }
    for (slot, at) in found.iter_mut().zip((0..digits.len()).step_by(2)) {
        *slot = u8::from_str_radix(&digits[at..at + 2], 16).map_err(|_| wrong())?;
    }
    Ok(found)
}
