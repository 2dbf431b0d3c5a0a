//! Runs of vertex properties that together form one channel.

use super::header::PlyProperty;
use crate::shape::attachments::{COLOR_CHANNEL, MAX_WIDTH};

/// The name of a channel and its number of components.
type ChannelColumns<'a> = (&'a str, usize);

/// Returns for each property the multi-component channel that it belongs to and its component index there, if any.
///
/// A run consists of consecutive scalar properties `a_0`, `a_1`, ... up to `a_3` of one type, as the writer splits
/// channels. Longer runs form no channel, nor do runs beside a property `a`, nor `color_0`, because colours have
/// property names of their own.
pub(super) fn runs(properties: &[PlyProperty]) -> Vec<Option<(ChannelColumns<'_>, usize)>> {
    let mut found = vec![None; properties.len()];
    let mut start = 0;
    while start < properties.len() {
        let Some(base) = properties[start].name.strip_suffix("_0").filter(|_| properties[start].list.is_none()) else {
            start += 1;
            continue;
        };
        let follows = |&(k, property): &(usize, &PlyProperty)| {
            let is_next = property.name.strip_prefix(base) == Some(&format!("_{k}"));
            is_next && property.list.is_none() && property.kind == properties[start].kind
        };
        let width = properties[start..].iter().enumerate().take_while(follows).count();
        let has_own = properties.iter().any(|property| property.name.eq_ignore_ascii_case(base));
        if (2..=MAX_WIDTH).contains(&width) && !has_own && base != COLOR_CHANNEL {
            (0..width).for_each(|k| found[start + k] = Some(((base, width), k)));
        }
        start += width.max(1);
    }
    found
}
