//! What a file is by its first bytes, where it is not what it is said to be.

use super::sniff;

/// How files begin that hold no mesh which is read here, and what they are. They are looked at where reading has
/// failed, so that short beginnings do no harm.
const FOREIGN: &[(&[u8], &str)] = &[
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"GIF8", "a GIF picture"),
    (b"RIFF", "a WebP picture or a sound"),
    (b"II*\0", "a TIFF picture"),
    (b"MM\0*", "a TIFF picture"),
    (b"BM", "a BMP picture"),
    (b"\x76\x2f\x31\x01", "an OpenEXR picture"),
    (b"%PDF-", "a PDF document"),
    (b"PK\x03\x04", "a zip archive (USDZ and office files are such, too; 3MF is read as 3mf)"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"\x28\xb5\x2f\xfd", "a zstd archive"),
    (b"BZh", "a bzip2 archive"),
    (b"\xfd7zXZ", "an xz archive"),
    (b"7z\xbc\xaf", "a 7z archive"),
    (b"Rar!", "a RAR archive"),
    (b"BLENDER", "a Blender file"),
    (b"Kaydara FBX", "an FBX file"),
    (b"; FBX", "an FBX file"),
    (b"PXR-USDC", "a USD file in binary form (usdcat writes it as usda, which is read)"),
    (b"#VRML", "a VRML file"),
    (b"# vtk", "a VTK file"),
    (b"<svg", "an SVG picture"),
    (b"<!DOCTYPE", "an HTML page"),
    (b"<html", "an HTML page"),
    (b"<", "an XML file (COLLADA, X3D and AMF are such)"),
    (b"\x7fELF", "a program"),
];

/// How files of the formats that are read begin.
const OWN: &[(&[u8], &str)] = &[
    (b"ply", "ply"),
    (b"glTF", "glb"),
    (b"solid ", "stl"),
    (b"OFF", "off"),
    (b"PK\x03\x04", "3mf"),
    (b"#usda", "usda"),
];

/// Most bytes that are looked at to tell a text.
const MOST: usize = 4096;

/// What a file is that holds no mesh which is read here, with an article: known by its first bytes, or a text. A file
/// that has failed to be read may be anything else.
pub fn foreign(bytes: &[u8]) -> Option<&'static str> {
    let start = text_start(bytes);
    FOREIGN.iter().find(|(magic, _)| start.starts_with(magic)).map(|(_, what)| *what)
}

/// The name of the reader of files that begin like these bytes.
pub fn own(bytes: &[u8]) -> Option<&'static str> {
    let start = text_start(bytes);
    let magic = OWN.iter().find(|(magic, _)| start.starts_with(magic)).map(|(_, name)| *name);
    magic.or_else(|| sniff::kind(bytes).filter(|&name| name == "obj"))
}

/// Whether the bytes begin like a text: without control characters but those between words.
pub fn is_text(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(MOST)];
    !start.is_empty() && start.iter().all(|byte| !byte.is_ascii_control() || byte.is_ascii_whitespace())
}

/// The bytes from the first one of a text on that is no blank, or as they are.
fn text_start(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start()
}
