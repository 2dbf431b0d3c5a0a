//! Detection of the format of a mesh file from its first bytes, for requests that do not name it.

use super::stl::{STL_START, STL_TRIANGLE_BYTES};

/// Maximum number of lines of a text that are searched for an OBJ statement. Half of it misses files with longer
/// licences before their first vertex; twice of it searches more of other files in vain.
const MAX_SNIFFED_LINES: usize = 100;
/// Maximum number of bytes of these lines that are searched: a few thousand per line.
const MAX_SNIFFED_BYTES: usize = 256 << 10;
/// Bytes at the end of an archive that are searched for the name of a model: the list of some hundred files.
const MAX_LIST: usize = 64 << 10;

/// Returns the name of the reader for a file, if its first bytes show its format.
pub(super) fn kind(bytes: &[u8]) -> Option<&'static str> {
    let text = bytes[..bytes.len().min(MAX_SNIFFED_BYTES)].trim_ascii_start();
    let first = text.split(u8::is_ascii_whitespace).next().unwrap_or_default();
    match first {
        _ if bytes.starts_with(b"glTF") => Some("glb"),
        _ if is_3mf(bytes) => Some("3mf"),
        b"#usda" => Some("usda"),
        b"ply" => Some("ply"),
        _ if first.ends_with(b"OFF") => Some("off"),
        _ if is_stl(bytes) || first == b"solid" => Some("stl"),
        _ if text.split(|&byte| byte == b'\n').take(MAX_SNIFFED_LINES).any(is_of_obj) => Some("obj"),
        _ => None,
    }
}

/// Whether the bytes are a ZIP archive whose list, at the end, names a model.
fn is_3mf(bytes: &[u8]) -> bool {
    let list = &bytes[bytes.len().saturating_sub(MAX_LIST)..];
    bytes.starts_with(b"PK\x03\x04") && list.windows(6).any(|window| window == b".model")
}

/// Whether the length is that of a binary STL file with the triangle count in bytes 80 to 83.
fn is_stl(bytes: &[u8]) -> bool {
    let count = bytes.get(80..84).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    let length = |n: u32| usize::try_from(n).ok()?.checked_mul(STL_TRIANGLE_BYTES)?.checked_add(STL_START);
    count.and_then(length).is_some_and(|length| length == bytes.len())
}

/// Whether a line is an OBJ statement.
fn is_of_obj(line: &[u8]) -> bool {
    let mut words = line.trim_ascii().split(u8::is_ascii_whitespace);
    let key = words.next().unwrap_or_default();
    let follows = words.next().is_some();
    follows && [&b"v"[..], b"vn", b"vt", b"f", b"mtllib", b"o", b"g"].contains(&key)
}
