//! Properties of vertices that are the numbers of one channel.

use super::header::Property;
use crate::shape::attachments::{COLOR, MAX_WIDTH};

/// The name of a channel, and how many numbers it has.
type Run<'a> = (&'a str, usize);

/// For each property the channel of several numbers that it belongs to, and its place there.
///
/// Such are properties `a_0`, `a_1`, ... one after the other, up to `a_3`, of one type, as the writer splits channels.
/// More than four are no channel, nor are those beside a property `a`, nor `color_0`, as the colour has names of its
/// own.
pub(super) fn runs(properties: &[Property]) -> Vec<Option<(Run<'_>, usize)>> {
    let mut found = vec![None; properties.len()];
    let mut start = 0;
    while start < properties.len() {
        let Some(base) = properties[start].name.strip_suffix("_0").filter(|_| properties[start].list.is_none()) else {
            start += 1;
            continue;
        };
        let follows = |&(k, property): &(usize, &Property)| {
            let is_next = property.name.strip_prefix(base) == Some(&format!("_{k}"));
            is_next && property.list.is_none() && property.kind == properties[start].kind
        };
        let width = properties[start..].iter().enumerate().take_while(follows).count();
        let has_own = properties.iter().any(|property| property.name.eq_ignore_ascii_case(base));
        if (2..=MAX_WIDTH).contains(&width) && !has_own && base != COLOR {
            (0..width).for_each(|k| found[start + k] = Some(((base, width), k)));
        }
        start += width.max(1);
    }
    found
}
