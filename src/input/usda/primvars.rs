//! Primvars of all meshes: texture coordinates, colours and other values of vertices and corners.

use std::collections::BTreeMap;

use super::polygons::{MeshRanges, below, is_subdivided};
use super::tree::{Prim, UsdaProperty, UsdaValue, metadata_value};
use crate::input::colors::encoded;
use crate::input::reader::{CornerUvs, ReadMesh};
use crate::input::room::{GROWN, MemoryBudget};
use crate::input::text::quoted;
use crate::shape::attachments::{COLOR_CHANNEL, Channel, ChannelInput};
use crate::shape::check::FaceList;
use crate::shape::seams::{Interpolation, SeamsInput};
use crate::shape::topology::index;

/// The namespace of primvars.
const PRIMVAR_PREFIX: &str = "primvars:";
/// Bytes of a primvar with its name, and perhaps with a note.
const PRIMVAR_BYTES: usize = GROWN * (size_of::<PrimvarRows>() + 24) + 256;
/// Bytes of the colour of a vertex or corner: its index, and, if all colours are distinct, its map entry and the
/// colour.
const COLOR_BYTES: usize = 4 + 48 + GROWN * 32;
/// Marks a vertex or corner without a row.
const NO_ROW: u32 = u32::MAX;
const UV_PRIMVAR: &str = "st";
const COLOR_PRIMVAR: &str = "displayColor";
const OPACITY_PRIMVAR: &str = "displayOpacity";

/// The primvars read so far, by name.
#[derive(Debug, Default)]
pub(super) struct Primvars(BTreeMap<String, PrimvarRows>);

/// Rows of values, with the rows of vertices and corners.
#[derive(Debug, Default)]
struct PrimvarRows {
    width: usize,
    values: Vec<f64>,
    /// The row of each vertex, or [`NO_ROW`].
    of_vertices: Vec<u32>,
    /// The row of each corner, or [`NO_ROW`].
    of_corners: Vec<u32>,
    /// Whether some values belong to corners, so that the corners at a vertex may differ.
    has_seams: bool,
    /// Where corner values are interpolated linearly.
    interpolation: Interpolation,
}

/// Returns the number of components of a type; `None` for types without numbers.
fn width(kind: &str) -> Option<usize> {
    const STEMS: [&str; 10] =
        ["float", "double", "half", "int", "uint", "color", "vector", "normal", "point", "texCoord"];
    let stem = STEMS.iter().find_map(|stem| kind.strip_prefix(stem))?;
    match stem.as_bytes() {
        [] => Some(1),
        [digit @ b'2'..=b'4', rest @ ..] if rest.len() < 2 => Some(usize::from(digit - b'0')),
        _ => None,
    }
}

impl Primvars {
    /// Adds the primvars of a mesh whose faces were added. Invalid primvars are left out with a note.
    ///
    /// # Errors
    /// The primvars take more than is allowed.
    pub(super) fn take(
        &mut self,
        prim: &Prim<'_>,
        part: &MeshRanges,
        room: &mut MemoryBudget,
        mesh: &mut ReadMesh,
    ) -> Result<(), String> {
        let is_uv = |property: &&UsdaProperty<'_>| {
            property.kind.starts_with("texCoord2") && property.name.starts_with(PRIMVAR_PREFIX)
        };
        let uv = prim.property("primvars:st").filter(is_uv).or_else(|| prim.properties.iter().find(is_uv));
        for property in &prim.properties {
            let Some(name) = property.name.strip_prefix(PRIMVAR_PREFIX) else { continue };
            if name == "normals" || name.contains('.') || name.ends_with(":indices") {
                continue;
            }
            let is_uv = uv.is_some_and(|uv| std::ptr::eq(uv, property));
            let name = if is_uv { UV_PRIMVAR } else { name.strip_prefix("channel:").unwrap_or(name) };
            let is_known = is_uv || [COLOR_PRIMVAR, OPACITY_PRIMVAR].contains(&name);
            room.take(PRIMVAR_BYTES + name.len())?;
            let rows = self.0.entry(name.to_owned()).or_default();
            if let Err(detail) = rows.take(prim, property, is_known, (part, &mesh.faces), room)? {
                mesh.notes.push(format!("the primvar {} is left out: {detail}", quoted(property.name)));
            }
        }
        Ok(())
    }

    /// Moves the primvars that all meshes have into the mesh, and colours if any mesh has them.
    ///
    /// # Errors
    /// The primvars take more than is allowed.
    pub(super) fn finish(mut self, room: &mut MemoryBudget, mesh: &mut ReadMesh) -> Result<(), String> {
        let ends = [mesh.positions.len(), mesh.faces.n_half_edges()];
        for name in [UV_PRIMVAR, COLOR_PRIMVAR, OPACITY_PRIMVAR] {
            if let Some(rows) = self.0.get_mut(name) {
                rows.fill(ends, room)?;
            }
        }
        room.take(if self.0.contains_key(COLOR_PRIMVAR) { (ends[0] + ends[1]) * COLOR_BYTES } else { 0 })?;
        let opacity = self.0.remove(OPACITY_PRIMVAR).filter(|rows| rows.width == 1 && !rows.values.is_empty());
        if let Some(colors) = self.0.remove(COLOR_PRIMVAR).filter(|rows| rows.width == 3 && !rows.values.is_empty()) {
            mesh.channels.push(colored(&colors, opacity.as_ref()).channel(COLOR_CHANNEL, &mesh.faces));
        }
        for (name, rows) in self.0 {
            if rows.values.is_empty() {
                continue; // already reported in a note
            }
            if rows.ends() != ends || rows.is_missing() {
                mesh.notes.push(format!("the primvar {} is left out, as not every mesh has it", quoted(&name)));
            } else if name == UV_PRIMVAR && rows.width == 2 {
                let values = rows.values.as_chunks().0.to_vec();
                mesh.uvs = Some(CornerUvs { values, corners: rows.of_corners, interpolation: rows.interpolation });
            } else {
                let name = if name == COLOR_CHANNEL { "Color" } else { &name };
                mesh.channels.push(rows.channel(name, &mesh.faces));
            }
        }
        Ok(())
    }
}

/// Returns where corner values are interpolated linearly: everywhere on polygons.
fn interpolation(prim: &Prim<'_>) -> Interpolation {
    match prim.word("faceVaryingLinearInterpolation") {
        _ if !is_subdivided(prim) => Interpolation::All,
        Some("none") => Interpolation::None,
        Some("cornersOnly") => Interpolation::CornersOnly,
        Some("cornersPlus2") => Interpolation::CornersPlus2,
        Some("boundaries") => Interpolation::Boundaries,
        Some("all") => Interpolation::All,
        _ => Interpolation::CornersPlus1,
    }
}

/// Converts colours to sRGB with their opacity; missing colours are white.
fn colored(colors: &PrimvarRows, opacity: Option<&PrimvarRows>) -> PrimvarRows {
    let has_seams = colors.has_seams || opacity.is_some_and(|rows| rows.has_seams);
    let width = if opacity.is_some() { 4 } else { 3 };
    let mut all = PrimvarRows { width, has_seams, interpolation: colors.interpolation, ..PrimvarRows::default() };
    let mut numbers = BTreeMap::new();
    let mut row = |at: u32, opacity_at: u32| {
        *numbers.entry((at, opacity_at)).or_insert_with(|| {
            let color = colors.row(at).unwrap_or(&[1.0; 3]);
            all.values.extend(color.iter().map(|x| encoded(x.clamp(0.0, 1.0))));
            all.values.extend(opacity.map(|rows| rows.row(opacity_at).map_or(1.0, |row| row[0].clamp(0.0, 1.0))));
            index(all.values.len() / width - 1)
        })
    };
    let at = |i: usize, list: fn(&PrimvarRows) -> &[u32]| opacity.map_or(NO_ROW, |rows| list(rows)[i]);
    let of_corners: fn(&PrimvarRows) -> &[u32] = |rows| &rows.of_corners;
    let of_vertices: fn(&PrimvarRows) -> &[u32] = |rows| &rows.of_vertices;
    let list = |list: fn(&PrimvarRows) -> &[u32]| {
        list(colors).iter().enumerate().map(move |(i, &number)| (number, at(i, list)))
    };
    if has_seams {
        all.of_corners = list(of_corners).map(|(a, b)| row(a, b)).collect();
    } else {
        all.of_vertices = list(of_vertices).map(|(a, b)| row(a, b)).collect();
    }
    all
}

impl PrimvarRows {
    /// Adds the rows of a mesh, or returns why they are invalid.
    fn take(
        &mut self,
        prim: &Prim<'_>,
        property: &UsdaProperty<'_>,
        is_known: bool,
        (part, faces): (&MeshRanges, &FaceList),
        room: &mut MemoryBudget,
    ) -> Result<Result<(), String>, String> {
        let UsdaProperty { kind, name, value, metadata } = property;
        let Some(width) = width(kind) else { return Ok(Err(format!("its type is {kind}"))) };
        if self.width != 0 && self.width != width {
            return Ok(Err("another mesh has it with another type".to_owned()));
        }
        let lies = metadata_value(metadata, "interpolation").and_then(UsdaValue::word).unwrap_or("constant");
        let n = match lies {
            "vertex" | "varying" => part.n_vertices,
            "faceVarying" => part.corners.len(),
            "constant" if is_known => 1,
            "uniform" if is_known => part.n_faces,
            _ => return Ok(Err(format!("its interpolation is {lies}"))),
        };
        let indices = prim.value(&format!("{name}:indices")).map(|value| &value.numbers);
        let starts = [part.first_vertex, part.first_corner];
        if is_known {
            self.fill(starts, room)?;
        } else if self.ends() != starts {
            return Ok(Err("not every mesh has it, or it has it twice".to_owned()));
        }
        let (base, n_rows) = (self.values.len() / width, value.numbers.len() / width);
        let given = indices.map_or(n_rows, Vec::len);
        let fits = value.numbers.len().is_multiple_of(width) && base + n_rows < NO_ROW as usize;
        if given != n || !fits || value.numbers.iter().any(|x| !x.is_finite()) {
            return Ok(Err(format!("it has {given} values, which are to be {n} of finite numbers")));
        }
        let bytes = value.numbers.len() * 8 + (part.n_vertices + part.corners.len() + n) * 4;
        room.take(GROWN * bytes)?;
        let base = index(base);
        let row = |i: usize| indices.map_or(Ok(index(i)), |all| below(all[i], n_rows, name));
        let rows: Result<Vec<u32>, String> = (0..n).map(|i| row(i).map(|row| base + row)).collect();
        let rows = match rows {
            Ok(rows) => rows,
            Err(detail) => return Ok(Err(detail)),
        };
        self.width = width;
        self.values.extend(&value.numbers);
        let vertices = &faces.vertices()[part.first_corner..];
        let of_vertex = |v: &u32| rows[*v as usize - part.first_vertex];
        let (of_vertices, of_corners): (Vec<u32>, Vec<u32>) = match lies {
            "constant" => (vec![rows[0]; part.n_vertices], vec![rows[0]; part.corners.len()]),
            "uniform" => {
                let of_face = |f: usize| std::iter::repeat_n(rows[f], faces.face(part.first_face + f).len());
                (vec![NO_ROW; part.n_vertices], (0..part.n_faces).flat_map(of_face).collect())
            }
            "faceVarying" => {
                let of_corners = part.corners.iter().map(|&corner| rows[corner as usize]);
                (vec![NO_ROW; part.n_vertices], of_corners.collect())
            }
            _ => (rows.clone(), vertices.iter().map(of_vertex).collect()),
        };
        self.of_vertices.extend(of_vertices);
        self.of_corners.extend(of_corners);
        if !matches!(lies, "vertex" | "constant") {
            self.interpolation = if lies == "varying" { Interpolation::All } else { interpolation(prim) };
            self.has_seams = true;
        }
        Ok(Ok(()))
    }

    /// Returns the numbers of vertices and corners so far.
    fn ends(&self) -> [usize; 2] {
        [self.of_vertices.len(), self.of_corners.len()]
    }

    /// Extends the rows to these numbers of vertices and corners; the new ones are [`NO_ROW`].
    fn fill(&mut self, ends: [usize; 2], room: &mut MemoryBudget) -> Result<(), String> {
        let [vertices, corners] = self.ends();
        room.take(GROWN * 4 * (ends[0].saturating_sub(vertices) + ends[1].saturating_sub(corners)))?;
        self.of_vertices.resize(ends[0], NO_ROW);
        self.of_corners.resize(ends[1], NO_ROW);
        Ok(())
    }

    fn row(&self, number: u32) -> Option<&[f64]> {
        self.values.chunks_exact(self.width).nth(number as usize)
    }

    /// Whether a vertex or corner has no row.
    fn is_missing(&self) -> bool {
        let list = if self.has_seams { &self.of_corners } else { &self.of_vertices };
        list.contains(&NO_ROW)
    }

    /// Converts the rows to a channel.
    fn channel(self, name: &str, faces: &FaceList) -> ChannelInput {
        let Self { width, values, of_vertices, of_corners, has_seams, interpolation } = self;
        let name = name.to_owned();
        if !has_seams {
            let rows = of_vertices.iter().flat_map(|&row| &values[row as usize * width..][..width]);
            return Channel { name, width, values: rows.copied().collect(), seams: None };
        }
        let mut corners = of_corners.into_iter();
        let mut places = FaceList::default();
        (0..faces.len()).for_each(|f| places.push(corners.by_ref().take(faces.face(f).len())));
        Channel { name, width, values, seams: Some(SeamsInput { faces: places, interpolation }) }
    }
}
