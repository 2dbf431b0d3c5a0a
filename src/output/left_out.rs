//! Sentences about the attachments of a mesh that a format leaves out.

use crate::math::parameter::Values;
use crate::output::format::Format;
use crate::shape::attachments::{Attachments, Channel};
use crate::shape::creases::CreaseTags;
use crate::shape::looks::{Alpha, Look};

/// Maximum number of channels that a sentence names.
const MAX_NAMED_CHANNELS: usize = 8;

/// A kind of attachment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Datum {
    /// All channels.
    Channels,
    /// All channels but the colour.
    OtherChannels,
    /// A colour that differs on the sides of seams.
    ColorSeams,
    /// The alpha of the colour.
    ColorAlpha,
    /// Texture coordinates.
    Uvs,
    /// Groups.
    Groups,
    /// Materials with names and looks.
    Materials,
    /// Materials without a colour.
    ColorlessMaterials,
    /// The looks of materials, but not their names.
    Looks,
    /// Metalness and roughness.
    Surface,
    /// The transparency of materials.
    Transparency,
    /// The alpha mode, if it is not the one that the colour implies.
    AlphaMode,
    /// The visible sides.
    Sides,
    /// Images.
    Textures,
}

/// Returns a sentence for each kind of attachment that the mesh has and the format cannot hold, with the formats to ask
/// for.
pub(super) fn left_out(format: &str, ask_for: &str, carried: &Attachments, kinds: &[Datum]) -> Vec<String> {
    let sentence = |datum: &Datum| {
        let (what, is_one) = datum.name(carried)?;
        let (is, it) = if is_one { ("is", "it") } else { ("are", "them") };
        Some(format!("{what} {is} left out, as {format} has no place for {it}; ask for {ask_for}"))
    };
    kinds.iter().filter_map(sentence).collect()
}

impl Datum {
    /// Returns the name of this kind of attachment and whether it is singular; `None` if the mesh has none.
    fn name(self, carried: &Attachments) -> Option<(String, bool)> {
        let any = |has: fn(&Look) -> bool| carried.looks.iter().any(has);
        let color = carried.color().map(|(_, color)| color);
        let (is_there, what, is_one) = match self {
            Self::Channels => return named(carried.channels.iter()),
            Self::OtherChannels => return named(carried.channels.iter().filter(|channel| !channel.is_color())),
            Self::ColorSeams => (
                color.is_some_and(|color| color.seams.is_some()),
                "the channel \"color\", which differs on the sides of seams,",
                true,
            ),
            Self::ColorAlpha => (
                color.is_some_and(|color| color.width == 4 && color.seams.is_none()),
                "the alpha of the channel \"color\"",
                true,
            ),
            Self::Uvs => (carried.uvs.is_some(), "texture coordinates", false),
            Self::Groups => (!carried.groups.is_empty(), "groups", false),
            Self::Materials => (!carried.materials.is_empty(), "materials", false),
            Self::ColorlessMaterials => {
                let is_there = (0..carried.materials.names.len()).any(|i| carried.look(Some(i)).color.is_none());
                (is_there, "materials without a color", false)
            }
            Self::Looks => (any(|look| !look.is_silent()), "how materials look", true),
            Self::Surface => {
                let is_there = any(|look| look.metallic.is_some() || look.roughness.is_some());
                (is_there, "metalness and roughness of materials", false)
            }
            Self::Transparency => (any(|look| look.alpha() != Alpha::Opaque), "transparency of materials", true),
            Self::AlphaMode => {
                let is_there = any(|look| look.alpha() != Look { alpha: None, ..look.clone() }.alpha());
                (is_there, "what the alpha of materials does", true)
            }
            Self::Sides => (any(|look| look.double_sided.is_some()), "which sides of materials are seen", true),
            Self::Textures => (any(|look| look.texture.is_some()), "textures", false),
        };
        is_there.then(|| (what.to_owned(), is_one))
    }
}

/// Returns the names of channels, and whether there is only one.
fn named<'a>(channels: impl Iterator<Item = &'a Channel>) -> Option<(String, bool)> {
    let names: Vec<String> = channels.map(|channel| format!("\"{}\"", channel.name)).collect();
    let more = if names.len() > MAX_NAMED_CHANNELS { ", ..." } else { "" };
    match names.len() {
        0 => None,
        1 => Some((format!("the channel {}", names[0]), true)),
        n => Some((format!("the channels {}{more}", names[..n.min(MAX_NAMED_CHANNELS)].join(", ")), false)),
    }
}

/// Returns sentences about all that a format leaves out of a mesh: attachments, and the tags of a mesh that was not
/// refined.
pub fn all(format: &dyn Format, carried: &Attachments, tags: &CreaseTags, options: &Values) -> Vec<String> {
    let sharp = if format.facts().has_no_tags { of_tags(format.name(), tags) } else { None };
    format.leaves_out(carried, options).into_iter().chain(sharp).collect()
}

/// Returns the sentence of a format that cannot hold the tags of a mesh, if the mesh has any.
pub(super) fn of_tags(format: &str, CreaseTags { creases, corners }: &CreaseTags) -> Option<String> {
    let n = creases.len() + corners.len();
    let sentence = || format!("sharp edges and vertices are left out of {format}: {n}; ask for obj or json");
    (n > 0).then(sentence)
}
