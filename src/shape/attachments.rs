//! What a mesh carries besides its shape: channels on its vertices or corners, groups and materials of faces, and
//! texture coordinates.

use std::sync::Arc;

use super::connect::CheckedTopology;
use super::labels::{FaceSet, Labels};
use super::looks::Look;
use super::seams::{Seams, SeamsInput, Uvs, UvsInput, joint};
use super::topology::Topology;
use crate::fault::{Fault, token, under};

/// Maximum number of channels of a mesh.
pub const MAX_CHANNELS: usize = 64;

/// Maximum number of values per vertex in one channel.
pub const MAX_WIDTH: usize = 4;

/// Maximum number of values per vertex in all channels together.
pub const MAX_TOTAL_WIDTH: usize = 128;

/// Maximum length of a channel's name, in bytes.
const MAX_CHANNEL_NAME: usize = 48;

/// The channel that file formats treat as the colour of a vertex: sRGB from 0 to 1, with or without alpha.
pub const COLOR_CHANNEL: &str = "color";

/// Names of PLY properties that have another meaning.
const PLY_PROPERTIES: &[&str] =
    &["x", "y", "z", "nx", "ny", "nz", "s", "t", "red", "green", "blue", "alpha", "origin", "origin_dimension"];

/// The glTF attribute that holds origins, `_ORIGIN`, reserved at any width.
pub(crate) const ORIGIN: &str = "origin";

/// Values on vertices, or on face corners, that are refined like positions.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel<S = Seams> {
    /// The name: a letter, then letters, digits and underscores.
    pub name: String,
    /// Number of values per vertex, 1 to 4.
    pub width: usize,
    /// The values, `n x width`: vertex after vertex, or place after place if the channel has seams.
    pub values: Vec<f64>,
    /// The corners at which the values stand, if there is not one row per vertex.
    pub seams: Option<S>,
}

/// A channel as a client gives it, unchecked.
pub type ChannelInput = Channel<SeamsInput>;

/// Values at places: texture coordinates, or a channel with seams.
#[derive(Debug, Clone, Copy)]
pub struct Places<'a> {
    /// Number of values per place.
    pub width: usize,
    /// `n_places x width`.
    pub values: &'a [f64],
    /// The places at which the values stand.
    pub seams: &'a Seams,
}

impl<S> Channel<S> {
    /// A channel with one row of values per vertex, `n_vertices x width`.
    pub fn of_vertices(name: &str, width: usize, values: Vec<f64>) -> Self {
        Self { name: name.to_owned(), width, values, seams: None }
    }

    /// Returns whether the channel is the colour of the vertices.
    pub fn is_color(&self) -> bool {
        self.name == COLOR_CHANNEL
    }

    /// Returns one name per value: the channel's name, followed by `_0`, `_1`, ... if there are several values.
    pub fn number_names(&self) -> Vec<String> {
        if self.width == 1 {
            return vec![self.name.clone()];
        }
        (0..self.width).map(|k| format!("{}_{k}", self.name)).collect()
    }
}

/// What a client gives with a mesh, unchecked.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AttachmentsInput {
    /// Channels.
    pub channels: Vec<ChannelInput>,
    /// Groups of faces.
    pub groups: Vec<FaceSet>,
    /// Materials of faces.
    pub materials: Vec<FaceSet>,
    /// The appearance of the first of these materials.
    pub looks: Vec<Look>,
    /// Texture coordinates.
    pub uvs: Option<UvsInput>,
}

/// What a mesh carries besides its shape, checked.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Attachments {
    /// Channels by ascending name.
    pub channels: Vec<Channel>,
    /// Groups of faces.
    pub groups: Labels,
    /// Materials of faces.
    pub materials: Labels,
    /// The appearance of each material; empty if none is given.
    pub looks: Vec<Look>,
    /// Texture coordinates.
    pub uvs: Option<Uvs>,
    /// The topology with one vertex per place of all seams together; `None` if nothing has seams.
    pub unfolded: Option<Arc<Topology>>,
}

/// The attachments of a mesh that carries nothing.
static NO_ATTACHMENTS: Attachments = Attachments {
    channels: Vec::new(),
    groups: Labels::NONE,
    materials: Labels::NONE,
    looks: Vec::new(),
    uvs: None,
    unfolded: None,
};

impl Attachments {
    /// Returns the attachments of a mesh that carries nothing.
    pub fn none() -> &'static Self {
        &NO_ATTACHMENTS
    }

    /// Returns whether the mesh carries nothing.
    pub fn is_empty(&self) -> bool {
        self == Self::none()
    }

    /// Returns whether faces have groups or materials.
    pub fn names_faces(&self) -> bool {
        !self.groups.is_empty() || !self.materials.is_empty()
    }

    /// Returns whether faces differ in their groups or materials.
    pub fn tells_faces_apart(&self) -> bool {
        self.groups.differ() || self.materials.differ()
    }

    /// Returns the colour channel of the vertices, if there is one, with its index.
    pub fn color(&self) -> Option<(usize, &Channel)> {
        self.channels.iter().enumerate().find(|(_, channel)| channel.is_color())
    }

    /// Returns everything that has seams: texture coordinates, then channels.
    pub fn places(&self) -> impl Iterator<Item = Places<'_>> + Clone {
        let uvs = self.uvs.iter().map(|Uvs { values, seams }| Places { width: 2, values, seams });
        uvs.chain(self.channels.iter().filter_map(|Channel { width, values, seams, .. }| {
            Some(Places { width: *width, values, seams: seams.as_ref()? })
        }))
    }

    /// Returns the appearance of a material, with the defaults for whatever is not given.
    pub fn look(&self, material: Option<usize>) -> Look {
        material.and_then(|material| self.looks.get(material)).cloned().unwrap_or_default()
    }

    /// Returns the number of values per vertex in all channels.
    pub fn width(&self) -> usize {
        self.channels.iter().map(|channel| channel.width).sum()
    }

    /// Checks the attachments of a mesh that was given with `n_vertices` vertices.
    ///
    /// # Errors
    /// Every fault found, with a pointer below the mesh.
    pub fn new(
        input: AttachmentsInput,
        n_vertices: usize,
        checked @ CheckedTopology { topology, split_from: _, reversed }: &CheckedTopology,
    ) -> Result<Self, Vec<Fault>> {
        let AttachmentsInput { channels, groups, materials, mut looks, uvs } = input;
        let n_faces = topology.n_faces();
        let mut faults = check_channels(&channels, n_vertices);
        let found = looks.iter().enumerate().flat_map(|(i, look)| under(&format!("/{i}"), look.check(uvs.is_some())));
        faults.extend(under("/materials", found.take(20).collect()));
        let mut labels = |sets: Vec<FaceSet>, place: &str| {
            Labels::new(sets, n_faces).map_err(|found| faults.extend(under(place, found))).unwrap_or_default()
        };
        let (groups, materials) = (labels(groups, "/groups"), labels(materials, "/materials"));
        let uvs = uvs.map(|UvsInput { values, seams }| {
            let (seams, values) = Seams::new(&seams, (2, values.as_flattened()), topology, reversed)?;
            Ok(Uvs { values, seams })
        });
        let uvs = uvs.transpose().map_err(|found| under("/uvs", found));
        faults.extend(uvs.as_ref().err().into_iter().flatten().cloned());
        let (true, Ok(uvs)) = (faults.is_empty(), uvs) else { return Err(faults) };
        let checked = |channel| of_parts(channel, checked);
        let mut channels = channels.into_iter().map(checked).collect::<Result<Vec<_>, _>>()?;
        channels.sort_by(|a, b| a.name.cmp(&b.name));
        looks.resize(if looks.iter().all(Look::is_silent) { 0 } else { materials.names.len() }, Look::default());
        let mut all = Self { channels, groups, materials, looks, uvs, unfolded: None };
        let sets: Vec<&Seams> = all.places().map(|places| places.seams).collect();
        all.unfolded = if sets.is_empty() { None } else { Some(joint(&sets, topology)?) };
        Ok(all)
    }
}

/// Transfers a channel to the checked mesh, whose vertices may have been split.
fn of_parts(
    channel: ChannelInput,
    CheckedTopology { topology, split_from, reversed }: &CheckedTopology,
) -> Result<Channel, Vec<Fault>> {
    let Channel { name, width, mut values, seams } = channel;
    if let Some(seams) = seams {
        let found = Seams::new(&seams, (width, &values), topology, reversed);
        let (seams, values) = found.map_err(|found| under(&format!("/channels/{}", token(&name)), found))?;
        return Ok(Channel { name, width, values, seams: Some(seams) });
    }
    values.iter_mut().for_each(|x| *x += 0.0);
    for &from in split_from {
        let start = from as usize * width;
        values.extend_from_within(start..start + width);
    }
    Ok(Channel { name, width, values, seams: None })
}

fn check_channels(channels: &[ChannelInput], n: usize) -> Vec<Fault> {
    let mut faults = Vec::new();
    let total: usize = channels.iter().map(|channel| channel.width).sum();
    if channels.len() > MAX_CHANNELS || total > MAX_TOTAL_WIDTH {
        let found = format!("{} channels with {total} numbers a vertex", channels.len());
        let detail = format!("{found}; at most {MAX_CHANNELS} channels with {MAX_TOTAL_WIDTH} numbers are allowed");
        return vec![Fault::new("/channels", detail)];
    }
    for (i, channel) in channels.iter().enumerate() {
        let place = format!("/channels/{}", token(&channel.name));
        if let Some(detail) = check_channel(channel, &channels[..i], n) {
            faults.push(Fault::new(place, detail));
        } else if let (None, Some(k)) = (&channel.seams, channel.values.iter().position(|x| !x.is_finite())) {
            let detail = format!("{} is not a finite number", channel.values[k]);
            faults.push(Fault::new(format!("{place}/{}", k / channel.width), detail));
        }
    }
    faults
}

/// Returns why a channel cannot follow the channels `before` on a mesh of `n` vertices, or `None` if it can.
pub fn check_channel(channel: &ChannelInput, before: &[ChannelInput], n: usize) -> Option<String> {
    check_name(&channel.name)
        .or_else(|| check_clash(channel, before))
        .or_else(|| check_width(channel))
        .or_else(|| check_length(channel, n))
}

fn check_name(name: &str) -> Option<String> {
    let starts = name.starts_with(|c: char| c.is_ascii_alphabetic());
    let sound = starts && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') && name.len() <= MAX_CHANNEL_NAME;
    let rule = format!("a letter, then letters, digits and underscores, {MAX_CHANNEL_NAME} at most");
    (!sound).then(|| format!("\"{}\" is no name of a channel; it is {rule}", crate::fault::shortened(name)))
}

fn check_clash(channel: &ChannelInput, before: &[ChannelInput]) -> Option<String> {
    let names = channel.number_names();
    let own = Some(&channel.name).filter(|name| name.eq_ignore_ascii_case(ORIGIN));
    let taken = names.iter().find(|name| PLY_PROPERTIES.contains(&name.to_ascii_lowercase().as_str())).or(own);
    if let Some(taken) = taken {
        return Some(format!("\"{taken}\" means something else in files; choose another name"));
    }
    let same = |a: &String, b: &String| a.eq_ignore_ascii_case(b);
    let clash = before.iter().find(|other| {
        let others = other.number_names();
        same(&other.name, &channel.name) || others.iter().any(|a| names.iter().any(|b| same(a, b)))
    })?;
    Some(format!("it cannot be told from the channel \"{}\" in files; choose another name", clash.name))
}

fn check_width(channel: &ChannelInput) -> Option<String> {
    let width = channel.width;
    if channel.is_color() && !(3..=4).contains(&width) {
        return Some(format!("{width} numbers a vertex; a color has 3 or 4: red, green, blue, alpha from 0 to 1"));
    }
    let sound = (1..=MAX_WIDTH).contains(&width);
    (!sound).then(|| format!("{width} numbers a vertex; a channel has 1 to {MAX_WIDTH}"))
}

fn check_length(channel: &ChannelInput, n: usize) -> Option<String> {
    let rows = channel.values.len() / channel.width;
    let sound = channel.values.len() == n * channel.width || channel.seams.is_some();
    (!sound).then(|| format!("{rows} entries for {n} vertices; give one a vertex"))
}
