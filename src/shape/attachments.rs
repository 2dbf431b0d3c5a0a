//! What a mesh carries besides its shape: channels of numbers on its vertices, and names on its faces.

use super::connect::Checked;
use super::labels::{FaceSet, Labels};
use super::looks::Look;
use super::uvs::{Uvs, UvsInput};
use crate::fault::{Fault, token, under};

/// Most channels of a mesh.
pub const MAX_CHANNELS: usize = 64;

/// Most numbers that a vertex carries in one channel.
pub const MAX_WIDTH: usize = 4;

/// Most numbers that a vertex carries in all channels together.
pub const MAX_TOTAL_WIDTH: usize = 128;

/// Longest name of a channel, bytes.
const MAX_NAME: usize = 48;

/// The channel that formats know as the colour of a vertex: sRGB, 0 to 1, with or without alpha.
pub const COLOR: &str = "color";

/// Names of PLY properties that stand for something else.
const TAKEN: &[&str] =
    &["x", "y", "z", "nx", "ny", "nz", "s", "t", "red", "green", "blue", "alpha", "origin", "origin_dimension"];

/// The attribute of glTF that tells origins, `_ORIGIN`, of whatever width.
const ORIGIN: &str = "origin";

/// Numbers on vertices that are refined like positions.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// The name: a letter, then letters, digits and underscores.
    pub name: String,
    /// Numbers a vertex, 1 to 4.
    pub width: usize,
    /// `n_vertices x width`, vertex after vertex.
    pub values: Vec<f64>,
}

impl Channel {
    /// Whether it is the colour of the vertices.
    pub fn is_color(&self) -> bool {
        self.name == COLOR
    }

    /// One name for each of its numbers: its own, or its own with `_0`, `_1`, ... behind it where there are several.
    pub fn number_names(&self) -> Vec<String> {
        if self.width == 1 {
            return vec![self.name.clone()];
        }
        (0..self.width).map(|k| format!("{}_{k}", self.name)).collect()
    }
}

/// What a client gives along with a mesh, unchecked.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AttachmentsInput {
    /// Channels.
    pub channels: Vec<Channel>,
    /// Groups of faces.
    pub groups: Vec<FaceSet>,
    /// Materials of faces.
    pub materials: Vec<FaceSet>,
    /// How the first of these materials look.
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
    /// How each material looks; empty where nothing is said of any.
    pub looks: Vec<Look>,
    /// Texture coordinates.
    pub uvs: Option<Uvs>,
}

/// Nothing at all.
static NONE: Attachments =
    Attachments { channels: Vec::new(), groups: Labels::NONE, materials: Labels::NONE, looks: Vec::new(), uvs: None };

impl Attachments {
    /// Nothing at all.
    pub fn none() -> &'static Self {
        &NONE
    }

    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self == Self::none()
    }

    /// Whether faces have names.
    pub fn names_faces(&self) -> bool {
        !self.groups.is_empty() || !self.materials.is_empty()
    }

    /// The colour of the vertices, if there is one, and its number among the channels.
    pub fn color(&self) -> Option<(usize, &Channel)> {
        self.channels.iter().enumerate().find(|(_, channel)| channel.is_color())
    }

    /// How the faces of a material look, as far as that is said.
    pub fn look(&self, material: Option<usize>) -> Look {
        material.and_then(|material| self.looks.get(material)).cloned().unwrap_or_default()
    }

    /// Numbers that a vertex carries in all channels.
    pub fn width(&self) -> usize {
        self.channels.iter().map(|channel| channel.width).sum()
    }

    /// Checks what comes with a mesh that was given with `n_vertices` vertices.
    ///
    /// # Errors
    /// Every fault found, with a pointer below the mesh.
    pub fn new(
        input: AttachmentsInput,
        n_vertices: usize,
        Checked { topology, split_from, turned }: &Checked,
    ) -> Result<Self, Vec<Fault>> {
        let AttachmentsInput { mut channels, groups, materials, mut looks, uvs } = input;
        let n_faces = topology.n_faces();
        let mut faults = check_channels(&channels, n_vertices);
        let found = looks.iter().enumerate().flat_map(|(i, look)| under(&format!("/{i}"), look.check(uvs.is_some())));
        faults.extend(under("/materials", found.take(20).collect()));
        let mut labels = |sets: Vec<FaceSet>, place: &str| {
            Labels::new(sets, n_faces).map_err(|found| faults.extend(under(place, found))).unwrap_or_default()
        };
        let (groups, materials) = (labels(groups, "/groups"), labels(materials, "/materials"));
        let uvs = uvs.map(|uvs| Uvs::new(&uvs, topology, turned).map_err(|found| under("/uvs", found))).transpose();
        faults.extend(uvs.as_ref().err().into_iter().flatten().cloned());
        let (true, Ok(uvs)) = (faults.is_empty(), uvs) else { return Err(faults) };
        for channel in &mut channels {
            channel.values.iter_mut().for_each(|x| *x += 0.0);
            for &from in split_from {
                let start = from as usize * channel.width;
                channel.values.extend_from_within(start..start + channel.width);
            }
        }
        channels.sort_by(|a, b| a.name.cmp(&b.name));
        looks.resize(if looks.iter().all(Look::is_silent) { 0 } else { materials.names.len() }, Look::default());
        Ok(Self { channels, groups, materials, looks, uvs })
    }
}

fn check_channels(channels: &[Channel], n: usize) -> Vec<Fault> {
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
        } else if let Some(k) = channel.values.iter().position(|x| !x.is_finite()) {
            let detail = format!("{} is not a finite number", channel.values[k]);
            faults.push(Fault::new(format!("{place}/{}", k / channel.width), detail));
        }
    }
    faults
}

/// Why a channel cannot stand behind others on a mesh of `n` vertices, if so.
pub fn check_channel(channel: &Channel, before: &[Channel], n: usize) -> Option<String> {
    check_name(&channel.name)
        .or_else(|| check_clash(channel, before))
        .or_else(|| check_width(channel))
        .or_else(|| check_length(channel, n))
}

fn check_name(name: &str) -> Option<String> {
    let starts = name.starts_with(|c: char| c.is_ascii_alphabetic());
    let sound = starts && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') && name.len() <= MAX_NAME;
    let rule = format!("a letter, then letters, digits and underscores, {MAX_NAME} at most");
    (!sound).then(|| format!("\"{}\" is no name of a channel; it is {rule}", crate::fault::shortened(name)))
}

fn check_clash(channel: &Channel, before: &[Channel]) -> Option<String> {
    let names = channel.number_names();
    let own = Some(&channel.name).filter(|name| name.eq_ignore_ascii_case(ORIGIN));
    let taken = names.iter().find(|name| TAKEN.contains(&name.to_ascii_lowercase().as_str())).or(own);
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

fn check_width(channel: &Channel) -> Option<String> {
    let width = channel.width;
    if channel.is_color() && !(3..=4).contains(&width) {
        return Some(format!("{width} numbers a vertex; a color has 3 or 4: red, green, blue, alpha from 0 to 1"));
    }
    let sound = (1..=MAX_WIDTH).contains(&width);
    (!sound).then(|| format!("{width} numbers a vertex; a channel has 1 to {MAX_WIDTH}"))
}

fn check_length(channel: &Channel, n: usize) -> Option<String> {
    let rows = channel.values.len() / channel.width;
    let sound = channel.values.len() == n * channel.width;
    (!sound).then(|| format!("{rows} entries for {n} vertices; give one a vertex"))
}
