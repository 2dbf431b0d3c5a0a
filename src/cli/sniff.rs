//! What an input is, by its first bytes, where its name does not tell.

use crate::input;

/// Most lines of a text that are looked at for one that only OBJ files have.
const MOST_LINES: usize = 100;
/// Bytes of a binary STL file before its triangles, and of each triangle.
const STL: [usize; 2] = [84, 50];

/// The name of the reader, `json` for the JSON of a mesh, or `job`.
///
/// # Errors
/// A sentence, where the bytes are nothing that is known.
pub(super) fn sniffed(bytes: &[u8]) -> Result<&'static str, String> {
    let text = bytes.trim_ascii_start();
    let first = text.split(|byte| byte.is_ascii_whitespace()).next().unwrap_or_default();
    match first {
        _ if text.starts_with(b"{") => Ok(of_json(bytes)),
        _ if bytes.starts_with(b"glTF") => Ok("glb"),
        b"ply" => Ok("ply"),
        _ if first.ends_with(b"OFF") => Ok("off"),
        _ if is_stl(bytes) || first == b"solid" => Ok("stl"),
        _ if text.split(|&byte| byte == b'\n').take(MOST_LINES).any(is_of_obj) => Ok("obj"),
        _ => {
            let text = input::is_text(bytes).then_some("plain text");
            let what = input::foreign(bytes).or(text).map(|what| format!("it is {what}; ")).unwrap_or_default();
            Err(format!(
                "{what}it is no job (JSON), and no mesh file that is known by its first bytes; name its kind with \
                 --input-format"
            ))
        }
    }
}

/// What a JSON object is.
fn of_json(bytes: &[u8]) -> &'static str {
    #[derive(serde::Deserialize)]
    struct Head {
        positions: Option<serde::de::IgnoredAny>,
        asset: Option<serde::de::IgnoredAny>,
    }
    match serde_json::from_slice::<Head>(bytes) {
        Ok(Head { positions: Some(_), .. }) => "json",
        Ok(Head { asset: Some(_), .. }) => "gltf",
        _ => "job",
    }
}

/// Whether a binary STL file would be so long.
fn is_stl(bytes: &[u8]) -> bool {
    let count = bytes.get(80..84).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    let length = |n: u32| usize::try_from(n).ok()?.checked_mul(STL[1])?.checked_add(STL[0]);
    count.and_then(length).is_some_and(|length| length == bytes.len())
}

/// Whether a line is one of an OBJ file.
fn is_of_obj(line: &[u8]) -> bool {
    let mut words = line.trim_ascii().split(|byte| byte.is_ascii_whitespace());
    let key = words.next().unwrap_or_default();
    let follows = words.next().is_some();
    follows && [&b"v"[..], b"vn", b"vt", b"f", b"mtllib", b"o", b"g"].contains(&key)
}
