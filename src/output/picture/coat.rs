//! The colours of the surface in a picture: by a channel of its vertices, its texture coordinates, its groups or
//! materials.

use std::ops::Range;

use super::number_scale::NumberScale;
use super::options::{COLOR, Options, shown_as};
use super::skin;
use crate::fault::Fault;
use crate::math::parameter::{Parameter, ParameterKind, Value, Values};
use crate::output::color_maps::ColorMap;
use crate::output::colors::{linear, mark};
use crate::output::counts::{Counts, ShapeKind};
use crate::output::error::FormatError;
use crate::output::numbers::rounded;
use crate::output::scene::{FaceChunk, MeshSource, each_chunk, in_chunks, triangles};
use crate::raster::{Paint, Swatch, TriangleAppearance};
use crate::shape::attachments::{Attachments, COLOR_CHANNEL};
use crate::shape::labels::Labels;
use crate::shape::source::PlaceSource;
use crate::shape::topology::index;
use crate::watch::{Stopped, Watch};

/// The choice that refers to faces of the input.
const FACES_CHOICE: &str = "faces";

/// The attachment that colours follow.
pub(crate) const COLOR_BY: Parameter = Parameter::choice(
    "color_by",
    &["none", "channel", "uvs", "groups", "materials", FACES_CHOICE],
    "What the colours of a mesh follow: nothing but what its materials say of their looks, unless `color` is \
     given; a channel of its vertices, squares an eighth wide in its texture coordinates, the names of the groups \
     or materials of its faces, or the faces of the input that they came of.",
);

/// The channel that colours follow.
pub(crate) const CHANNEL: Parameter = Parameter::optional(
    "channel",
    ParameterKind::Name,
    "The channel that `color_by` \"channel\" shows; left out, \"color\". One of 3 or 4 numbers is a colour (sRGB \
     from 0 to 1), one of 1 number, or the `component` of others, has the colours of `color_map` over `range`.",
);

/// The component of a channel that colours follow.
pub(crate) const COMPONENT: Parameter = Parameter::optional(
    "component",
    ParameterKind::Integer { min: 0, max: 3 },
    "The component of the channel whose numbers are shown, the first being 0; left out, all of them as a colour.",
);

/// Number of squares per unit of a texture coordinate.
const SQUARES_A_UNIT: f64 = 8.0;
/// Share of white in the light colour of the squares.
const PALE_SHARE: f64 = 0.8;

/// Refuses colours by attachments that the shape does not have.
pub(crate) fn check(kind: ShapeKind, carried: &Attachments, options: &Values) -> Result<(), Fault> {
    let by = options.choice(COLOR_BY.name).unwrap_or("none");
    if kind != ShapeKind::Mesh && by != "none" {
        return Err(Fault::new("/color_by", "curves have one colour; leave it out"));
    }
    let says_channel = [CHANNEL, COMPONENT].iter().find(|option| *options.get(option.name) != Value::Absent);
    if let Some(option) = says_channel.filter(|_| by != "channel") {
        let detail = "a channel is shown where \"color_by\" is \"channel\"; say so";
        return Err(Fault::new(format!("/{}", option.name), detail));
    }
    let missing = match by {
        "channel" => return check_channel(carried, options),
        "uvs" => carried.uvs.is_none(),
        "groups" => carried.groups.is_empty(),
        "materials" => carried.materials.is_empty(),
        _ => false,
    };
    let what = if by == "uvs" { "texture coordinates" } else { by };
    if missing { Err(Fault::new("/color_by", format!("the mesh has no {what}; leave it out"))) } else { Ok(()) }
}

fn check_channel(carried: &Attachments, options: &Values) -> Result<(), Fault> {
    let name = options.name(CHANNEL.name).unwrap_or(COLOR_CHANNEL);
    let Some(channel) = carried.channels.iter().find(|channel| channel.name == name) else {
        let known: Vec<&str> = carried.channels.iter().map(|channel| channel.name.as_str()).collect();
        let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        return Err(Fault::new("/channel", format!("the mesh has no channel \"{name}\"; it has {known}")));
    };
    match component(options) {
        Some(component) if component >= channel.width => {
            let detail = format!("\"{name}\" has components 0 to {}; give one of them", channel.width - 1);
            Err(Fault::new("/component", detail))
        }
        None if channel.width == 2 => {
            let detail = format!("\"{name}\" has 2 numbers a vertex; give the \"component\" that is to be shown");
            Err(Fault::new("/channel", detail))
        }
        _ => Ok(()),
    }
}

/// Returns the requested component.
fn component(options: &Values) -> Option<usize> {
    options.integer(COMPONENT.name).and_then(|n| usize::try_from(n).ok())
}

/// Returns the name of the channel whose numbers, one per vertex, the colours stand for, if they do.
pub(super) fn numbers_of<'a>(carried: &'a Attachments, options: &Values) -> Option<&'a str> {
    let name = options.name(CHANNEL.name).unwrap_or(COLOR_CHANNEL);
    let channel = carried.channels.iter().find(|channel| channel.name == name)?;
    let are_shown = options.choice(COLOR_BY.name) == Some("channel");
    (are_shown && (channel.width == 1 || component(options).is_some())).then_some(&channel.name)
}

/// Returns whether colours refer to faces of the input.
pub(crate) fn follows_faces(options: &Values) -> bool {
    options.choice(COLOR_BY.name) == Some(FACES_CHOICE)
}

/// Returns whether colours are those of materials.
fn follows_looks(carried: &Attachments, options: &Values) -> bool {
    options.choice(COLOR_BY.name).is_none_or(|by| by == "none")
        && options.color(COLOR.name).is_none()
        && skin::is_said(carried)
}

/// Returns the work of finding the colours, rows.
pub(crate) fn work(carried: &Attachments, options: &Values) -> u128 {
    if follows_looks(carried, options) { skin::work(carried) } else { 0 }
}

/// Returns the memory in bytes for the colours of `vertices` vertices, and of the triangles and texture coordinates in
/// `counts`.
pub(crate) fn memory(options: &Values, vertices: u128, counts: &Counts) -> u128 {
    let (triangles, uvs) = (counts.triangles(), counts.uvs);
    match options.choice(COLOR_BY.name) {
        _ if follows_looks(&counts.attachments, options) => {
            let places = uvs.saturating_mul(16).saturating_add(triangles.saturating_mul(12 + 4));
            places.saturating_add(skin::memory(&counts.attachments))
        }
        // a channel of four numbers, one component of it, and the colour
        Some("channel") => {
            let corners = if counts.seamed > 0 { triangles.saturating_mul(12) } else { 0 };
            vertices.max(counts.seamed).saturating_mul(32 + 8 + 12).saturating_add(corners)
        }
        Some("uvs") => uvs.saturating_mul(16).saturating_add(triangles.saturating_mul(12)),
        Some("groups" | "materials" | FACES_CHOICE) => triangles.saturating_mul(12),
        _ => 0,
    }
}

/// The colours of a surface.
#[derive(Debug)]
pub(super) enum Coat {
    /// One colour for the whole surface.
    Plain([u8; 4]),
    /// A colour per vertex, in linear light.
    Vertices(Vec<[f32; 3]>),
    /// Numbers of vertices, or of corners.
    Numbers {
        /// The places of the numbers in the table, from 0 to 1.
        shares: Vec<f32>,
        /// The indices of the numbers at the corners of each triangle, if they differ from its vertices.
        corners: Option<Vec<[u32; 3]>>,
        /// Colours in linear light.
        table: Vec<[f32; 3]>,
        /// The scale by which colours stand for numbers.
        scale: NumberScale,
    },
    /// A colour per triangle, in linear light.
    Triangles(Vec<[f32; 3]>),
    /// Colours of corners of triangles, in linear light.
    Corners {
        /// The colour of each place.
        colors: Vec<[f32; 3]>,
        /// The places at the corners of each triangle.
        corners: Vec<[u32; 3]>,
    },
    /// Squares in texture coordinates.
    Squares {
        /// Texture coordinates in sides of squares.
        places: Vec<[f64; 2]>,
        /// The places at the corners of each triangle.
        corners: Vec<[u32; 3]>,
        /// The light and the dark colour, in linear light.
        colors: [[f32; 3]; 2],
    },
    /// The images of materials.
    Covers {
        /// Texture coordinates.
        places: Vec<[f64; 2]>,
        /// The places at the corners of each triangle.
        corners: Vec<[u32; 3]>,
        /// The number of the material of each triangle.
        numbers: Vec<u32>,
        /// The swatch of each material, and at the end the one for faces without a material.
        swatches: Vec<Swatch>,
    },
}

impl Coat {
    /// Returns the colours of a mesh; by default one colour, `plain`.
    pub(super) fn of(
        mesh: &dyn MeshSource,
        options: &Options<'_>,
        plain: [u8; 4],
        watch: &Watch,
    ) -> Result<Self, FormatError> {
        let carried = mesh.attachments();
        if follows_looks(carried, options.values) {
            return by_looks(mesh, plain, watch);
        }
        Ok(match options.values.choice(COLOR_BY.name) {
            Some("channel") => {
                let name = options.values.name(CHANNEL.name).unwrap_or(COLOR_CHANNEL);
                let channel = carried.channels.iter().position(|channel| channel.name == name);
                channel.map_or(Ok(Self::Plain(plain)), |channel| by_channel(mesh, channel, options.values, watch))?
            }
            Some("uvs") => by_uvs(mesh, plain, watch)?,
            Some("groups") => by_labels(mesh, &carried.groups, plain, watch)?,
            Some("materials") => by_labels(mesh, &carried.materials, plain, watch)?,
            Some(FACES_CHOICE) => Self::Triangles(by_origin(mesh, |face| mark(face as usize), watch)?),
            _ => Self::Plain(plain),
        })
    }

    /// Returns the coat that shows numbers of vertices as colours.
    pub(super) fn numbers(numbers: &[f64], corners: Option<Vec<[u32; 3]>>, scale: NumberScale) -> Self {
        let shares = numbers.iter().map(|&x| scale.share(x)).collect();
        Self::Numbers { shares, corners, table: scale.map.table(), scale }
    }

    /// Returns the surface for the rasteriser.
    pub(super) fn surface(&self) -> TriangleAppearance<'_> {
        match self {
            Self::Plain(color) => TriangleAppearance::Lit(*color),
            _ => self.paint().map_or(TriangleAppearance::Unseen, TriangleAppearance::Painted),
        }
    }

    /// Returns the paint for the rasteriser, if there is more than one colour.
    pub(super) fn paint(&self) -> Option<Paint<'_>> {
        Some(match self {
            Self::Plain(_) => return None,
            Self::Vertices(colors) => Paint::Vertices(colors),
            Self::Numbers { shares, corners, table, .. } => Paint::Scale { shares, corners: corners.as_deref(), table },
            Self::Corners { colors, corners } => Paint::Corners { colors, corners },
            Self::Triangles(colors) => Paint::Triangles(colors),
            Self::Squares { places, corners, colors } => Paint::Squares { places, corners, colors: *colors },
            Self::Covers { places, corners, numbers, swatches } => Paint::Covers { places, corners, numbers, swatches },
        })
    }
}

fn by_channel(mesh: &dyn MeshSource, channel: usize, options: &Values, watch: &Watch) -> Result<Coat, Stopped> {
    let width = mesh.attachments().channels[channel].width;
    let places = mesh.channel_places(channel);
    let values = match &places {
        Some(places) => values(places.n_places(), width, |range, out| places.values(range, out), watch)?,
        None => values(mesh.n_vertices(), width, |range, out| mesh.channel(channel, range, out), watch)?,
    };
    let corners = places.map(|places| corners(mesh, places.as_ref(), watch)).transpose()?;
    let component = component(options).or((width == 1).then_some(0));
    if let Some(component) = component.filter(|component| *component < width) {
        let numbers: Vec<f64> = values.into_iter().skip(component).step_by(width).collect();
        let scale = NumberScale::new(&numbers, options, ColorMap::EVEN, |extent| extent);
        return Ok(Coat::numbers(&numbers, corners, scale));
    }
    let color = |row: &[f64]| std::array::from_fn(|k| rounded(linear(k, row[k])));
    let colors = values.chunks_exact(width).map(color).collect();
    Ok(match corners {
        Some(corners) => Coat::Corners { colors, corners },
        None => Coat::Vertices(colors),
    })
}

/// Reads all `n x width` values with `some`, which gives them in ranges.
fn values(
    n: usize,
    width: usize,
    some: impl Fn(Range<usize>, &mut Vec<f64>),
    watch: &Watch,
) -> Result<Vec<f64>, Stopped> {
    let mut values = Vec::with_capacity(width * n);
    let mut chunk = Vec::new();
    in_chunks(n, |range| {
        watch.check()?;
        some(range, &mut chunk);
        values.extend_from_slice(&chunk);
        Ok(())
    })?;
    Ok(values)
}

fn by_uvs(mesh: &dyn MeshSource, plain: [u8; 4], watch: &Watch) -> Result<Coat, Stopped> {
    let Some((mut places, corners)) = places(mesh, watch)? else { return Ok(Coat::Plain(plain)) };
    places.iter_mut().flatten().for_each(|x| *x *= SQUARES_A_UNIT);
    let dark = shown_as(plain);
    let light = dark.map(|x| rounded(f64::from(x) + PALE_SHARE * (1.0 - f64::from(x))));
    Ok(Coat::Squares { places, corners, colors: [light, dark] })
}

/// Texture coordinates, and the indices of those at the corners of each triangle.
type TriangleUvs = (Vec<[f64; 2]>, Vec<[u32; 3]>);

/// Returns the texture coordinates of a mesh, if it has any.
fn places(mesh: &dyn MeshSource, watch: &Watch) -> Result<Option<TriangleUvs>, Stopped> {
    let Some(source) = mesh.uvs() else { return Ok(None) };
    let places = values(source.n_places(), 2, |range, out| source.values(range, out), watch)?;
    Ok(Some((places.as_chunks().0.to_vec(), corners(mesh, source.as_ref(), watch)?)))
}

/// Returns the places at the corners of each triangle.
fn corners(mesh: &dyn MeshSource, source: &dyn PlaceSource, watch: &Watch) -> Result<Vec<[u32; 3]>, Stopped> {
    let mut corners = Vec::with_capacity(mesh.n_half_edges().saturating_sub(2 * mesh.n_faces()));
    let mut faces = FaceChunk::default();
    in_chunks(mesh.n_faces(), |range| {
        watch.check()?;
        source.faces(range, &mut faces);
        corners.extend(faces.iter().flat_map(triangles));
        Ok(())
    })?;
    Ok(corners)
}

/// Returns the coat of the looks of materials.
fn by_looks(mesh: &dyn MeshSource, plain: [u8; 4], watch: &Watch) -> Result<Coat, FormatError> {
    let carried = mesh.attachments();
    let swatches = skin::swatches(carried, shown_as(plain), watch)?;
    let none = swatches.len() - 1;
    let number = |face| carried.materials.number(face).unwrap_or(none);
    let places = if skin::has_images(carried) { places(mesh, watch)? } else { None };
    if !skin::is_rich(&swatches) {
        return Ok(Coat::Triangles(by_origin(mesh, |face| swatches[number(face)].color, watch)?));
    }
    let (places, corners) = places.unwrap_or_default();
    Ok(Coat::Covers { places, corners, numbers: by_origin(mesh, |face| index(number(face)), watch)?, swatches })
}

fn by_labels(mesh: &dyn MeshSource, labels: &Labels, plain: [u8; 4], watch: &Watch) -> Result<Coat, Stopped> {
    let plain = shown_as(plain);
    let marks: Vec<[f32; 3]> = (0..labels.names.len()).map(mark).collect();
    let color = |face| labels.number(face).map_or(plain, |label| marks[label]);
    Ok(Coat::Triangles(by_origin(mesh, color, watch)?))
}

/// Returns for each triangle the value of the input face from which it was refined.
fn by_origin<T: Copy>(mesh: &dyn MeshSource, color: impl Fn(u32) -> T, watch: &Watch) -> Result<Vec<T>, Stopped> {
    let mut colors = Vec::with_capacity(mesh.n_half_edges().saturating_sub(2 * mesh.n_faces()));
    each_chunk(mesh, watch, |range, faces| {
        let mut known = None;
        for (f, face) in range.zip(faces.iter()) {
            let origin = mesh.face_origin(f);
            // consecutive faces are mostly of one origin
            let same = known.filter(|(of, _)| *of == origin);
            let (_, color) = *known.insert(same.unwrap_or_else(|| (origin, color(origin))));
            colors.extend(std::iter::repeat_n(color, face.len().saturating_sub(2)));
        }
    })?;
    Ok(colors)
}
