//! The files of a ZIP archive, found by the list at its end.
//!
//! Source: APPNOTE.TXT 6.3.10, sections 4.3.7, 4.3.12 and 4.3.16.

use std::io::Read;

use flate2::bufread::DeflateDecoder;

use crate::input::text::quoted;

/// Most files of an archive. Half of it refuses models with a picture for each of their parts; twice of it lets a list
/// of nothing be read twice as long.
const MAX_FILES: u64 = 10_000;
/// Most bytes behind the list: its end with the longest comment.
const END: usize = 22 + u16::MAX as usize;
const STORED: u64 = 0;
const DEFLATED: u64 = 8;
/// Times the length of the archive that a file in it may inflate to. Deflate reaches a thousand; models of planish
/// reach 20 and those of lib3mf 15, so that twice of it lets bombs take longer, and half of it refuses large flat
/// grids.
const MOST_INFLATED: u64 = 200;
/// Bytes that a file may inflate to whatever the length of the archive.
const LEAST_INFLATED: u64 = 1 << 20;

/// One file of an archive, as its list has it.
#[derive(Debug)]
pub(super) struct Entry<'a> {
    /// Its name, without a slash at its start.
    pub(super) name: &'a str,
    method: u64,
    packed: &'a [u8],
    /// Bytes that it has, as it says.
    pub(super) length: u64,
}

/// A number of `n` bytes, the least significant first.
fn number(bytes: &[u8], at: usize, n: usize) -> Option<u64> {
    let bytes = bytes.get(at..at.checked_add(n)?)?;
    Some(bytes.iter().rev().fold(0, |all, &byte| all << 8 | u64::from(byte)))
}

/// The same as a place in the archive.
fn place(bytes: &[u8], at: usize, n: usize) -> Option<usize> {
    usize::try_from(number(bytes, at, n)?).ok()
}

/// The files of an archive in the order of its list.
///
/// # Errors
/// No archive, a broken one, one in several pieces or with ZIP64 fields, and one with too many files.
pub(super) fn entries(bytes: &[u8]) -> Result<Vec<Entry<'_>>, String> {
    let broken = || "the archive is cut off or broken: its list of files cannot be read; send it again".to_owned();
    let last = &bytes[bytes.len().saturating_sub(END)..];
    let end = last.windows(4).rposition(|window| window == b"PK\x05\x06").ok_or_else(broken)?;
    let n = number(last, end + 10, 2).ok_or_else(broken)?;
    let start = place(last, end + 16, 4).ok_or_else(broken)?;
    if n == u64::from(u16::MAX) || start == u32::MAX as usize {
        return Err("the archive has ZIP64 fields, which are not read; save it smaller than 4 GiB".to_owned());
    }
    if n > MAX_FILES {
        return Err(format!("the archive has {n} files; {MAX_FILES} are allowed; leave out what is no model"));
    }
    let (mut at, mut found) = (start, Vec::new());
    for i in 0..n {
        let entry = entry(bytes, &mut at).ok_or_else(|| format!("file {i} of the archive: {}", broken()))?;
        found.push(entry);
    }
    Ok(found)
}

/// The entry at a place of the list, which moves behind it.
fn entry<'a>(bytes: &'a [u8], at: &mut usize) -> Option<Entry<'a>> {
    let start = *at;
    (bytes.get(start..start.checked_add(4)?)? == b"PK\x01\x02").then_some(())?;
    let lengths = [28, 30, 32].map(|field| place(bytes, start + field, 2));
    let [name, extra, comment] = [lengths[0]?, lengths[1]?, lengths[2]?];
    let text = bytes.get(start + 46..start + 46 + name)?;
    *at = start + 46 + name + extra + comment;
    let is_locked = number(bytes, start + 8, 2)? & 1 == 1;
    let method = if is_locked { u64::MAX } else { number(bytes, start + 10, 2)? };
    let (packed, length) = (place(bytes, start + 20, 4)?, number(bytes, start + 24, 4)?);
    let head = place(bytes, start + 42, 4)?;
    (bytes.get(head..head.checked_add(4)?)? == b"PK\x03\x04").then_some(())?;
    let first = head + 30 + place(bytes, head + 26, 2)? + place(bytes, head + 28, 2)?;
    let name = std::str::from_utf8(text).ok()?.trim_start_matches('/');
    Some(Entry { name, method, packed: bytes.get(first..first.checked_add(packed)?)?, length })
}

impl<'a> Entry<'a> {
    /// Its bytes, inflated while they are read and never more than it says that it has, where the archive has `whole`.
    ///
    /// # Errors
    /// A method other than stored and deflated, a locked file, and one that bursts.
    pub(super) fn open(&self, whole: usize) -> Result<Box<dyn Read + 'a>, String> {
        if self.length > MOST_INFLATED.saturating_mul(whole as u64).max(LEAST_INFLATED) {
            return Err(format!(
                "{} says that it inflates to {} bytes, more than {MOST_INFLATED} times what the file has; send a \
                 smaller model",
                quoted(self.name),
                self.length
            ));
        }
        match self.method {
            STORED => Ok(Box::new(self.packed)),
            DEFLATED => Ok(Box::new(DeflateDecoder::new(self.packed).take(self.length))),
            u64::MAX => Err(format!("{} is encrypted; save the model without a password", quoted(self.name))),
            other => Err(format!(
                "{} is compressed by method {other}; stored and deflated files are read",
                quoted(self.name)
            )),
        }
    }
}
