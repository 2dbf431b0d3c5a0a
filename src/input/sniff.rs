//! What a mesh file is, by its first bytes, where its sender does not say.

/// Most lines of a text that are looked at for one that only OBJ files have.
/// Half of it misses files with longer licences before their first vertex; twice of it looks at more of what is none.
const MOST_LINES: usize = 100;
/// Bytes of these lines that are looked at, at most: a few thousand for each.
const MOST_TEXT: usize = 256 << 10;
/// Bytes at the end of an archive that are looked at for the name of a model: the list of some hundred files.
const MOST_LIST: usize = 64 << 10;
/// Bytes of a binary STL file before its triangles, and of each triangle.
const STL: [usize; 2] = [84, 50];

/// The name of the reader of a file that shows by its first bytes what it is.
pub(super) fn kind(bytes: &[u8]) -> Option<&'static str> {
    let text = bytes[..bytes.len().min(MOST_TEXT)].trim_ascii_start();
    let first = text.split(u8::is_ascii_whitespace).next().unwrap_or_default();
    match first {
        _ if bytes.starts_with(b"glTF") => Some("glb"),
        _ if is_3mf(bytes) => Some("3mf"),
        b"#usda" => Some("usda"),
        b"ply" => Some("ply"),
        _ if first.ends_with(b"OFF") => Some("off"),
        _ if is_stl(bytes) || first == b"solid" => Some("stl"),
        _ if text.split(|&byte| byte == b'\n').take(MOST_LINES).any(is_of_obj) => Some("obj"),
        _ => None,
    }
}

/// Whether it is an archive with a model in the list at its end.
fn is_3mf(bytes: &[u8]) -> bool {
    let list = &bytes[bytes.len().saturating_sub(MOST_LIST)..];
    bytes.starts_with(b"PK\x03\x04") && list.windows(6).any(|window| window == b".model")
}

/// Whether a binary STL file would be so long.
fn is_stl(bytes: &[u8]) -> bool {
    let count = bytes.get(80..84).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    let length = |n: u32| usize::try_from(n).ok()?.checked_mul(STL[1])?.checked_add(STL[0]);
    count.and_then(length).is_some_and(|length| length == bytes.len())
}

/// Whether a line is one of an OBJ file.
fn is_of_obj(line: &[u8]) -> bool {
    let mut words = line.trim_ascii().split(u8::is_ascii_whitespace);
    let key = words.next().unwrap_or_default();
    let follows = words.next().is_some();
    follows && [&b"v"[..], b"vn", b"vt", b"f", b"mtllib", b"o", b"g"].contains(&key)
}
