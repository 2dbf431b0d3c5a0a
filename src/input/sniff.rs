//! What a mesh file is, by its first bytes, where its sender does not say.

/// Bytes that are looked at: the comments that programs write before the first vertex of OBJ are shorter. Half of it
/// misses files with long licences; twice of it looks twice as long at what is no mesh.
const HEAD: usize = 64 << 10;
/// Bytes of the header of binary STL and of its count, and of each of its triangles.
const STL: [usize; 2] = [84, 50];
/// Words that begin lines of OBJ.
const OBJ: [&str; 9] = ["v", "vn", "vt", "vp", "f", "o", "g", "mtllib", "usemtl"];

/// The name of the reader of a file that shows by its first bytes what it is.
pub(super) fn kind(bytes: &[u8]) -> Option<&'static str> {
    let head = &bytes[..bytes.len().min(HEAD)];
    let kinds: [(&str, fn(&[u8], usize) -> bool); 5] =
        [("glb", is_glb), ("ply", is_ply), ("off", is_off), ("stl", is_stl), ("obj", is_obj)];
    kinds.into_iter().find(|(_, is)| is(head, bytes.len())).map(|(name, _)| name)
}

fn is_glb(head: &[u8], _: usize) -> bool {
    head.starts_with(b"glTF")
}

fn is_ply(head: &[u8], _: usize) -> bool {
    head.starts_with(b"ply\n") || head.starts_with(b"ply\r")
}

/// `OFF`, after letters that say what stands beside positions.
fn is_off(head: &[u8], _: usize) -> bool {
    let word = head.split(u8::is_ascii_whitespace).next().unwrap_or_default();
    word.len() <= 8 && word.ends_with(b"OFF")
}

/// Text that begins with `solid`, or bytes as long as their count of triangles says.
fn is_stl(head: &[u8], length: usize) -> bool {
    let count = head.get(80..STL[0]).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    let has_triangles = |count: u32| (count as usize).saturating_mul(STL[1]).saturating_add(STL[0]) == length;
    let is_text = head.starts_with(b"solid") && head.windows(5).any(|word| word == b"facet");
    is_text || count.is_some_and(has_triangles)
}

/// Text whose first line that is no comment begins with a word of OBJ.
fn is_obj(head: &[u8], _: usize) -> bool {
    let text = String::from_utf8_lossy(head);
    let mut words = text.lines().filter_map(|line| line.split_ascii_whitespace().next());
    words.find(|word| !word.starts_with('#')).is_some_and(|word| OBJ.contains(&word))
}
