//! Identification of files by their first bytes, for messages about files that are not what their sender says.

/// The first bytes of file formats that hold no supported mesh, with their descriptions. The table is used only after
/// reading has failed, so that short prefixes do no harm.
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

/// Maximum number of bytes that are examined to recognise text.
const MAX_EXAMINED: usize = 4096;

/// Describes, with an article, a file that holds no supported mesh, by its first bytes or as text. Call it only for
/// files that could not be read.
pub fn foreign(bytes: &[u8]) -> Option<&'static str> {
    let start = text_start(bytes);
    FOREIGN.iter().find(|(magic, _)| start.starts_with(magic)).map(|(_, what)| *what)
}

/// Whether the bytes begin like text, without control characters other than whitespace.
pub fn is_text(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(MAX_EXAMINED)];
    !start.is_empty() && start.iter().all(|byte| !byte.is_ascii_control() || byte.is_ascii_whitespace())
}

/// Strips a byte order mark and leading whitespace.
pub(super) fn text_start(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start()
}
