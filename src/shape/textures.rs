//! Images for textures, whose bytes are kept unchanged.

use std::sync::Arc;

use crate::fault::Fault;

/// Maximum number of pixels of an image: 8,192 x 8,192. Drawing takes some bytes per pixel. Half as many would refuse
/// images of common game assets; twice as many would take gigabytes for one image.
const MAX_IMAGE_PIXELS: u64 = 1 << 26;

/// The compression of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImageKind {
    /// Lossless, PNG.
    Png,
    /// Lossy, JPEG.
    Jpeg,
}

impl ImageKind {
    /// Returns the media type of such an image.
    pub fn media_type(self) -> &'static str {
        match self {
            Self::Png => "image/png",
            Self::Jpeg => "image/jpeg",
        }
    }
}

/// An encoded image file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    kind: ImageKind,
    size: [u32; 2],
    bytes: Vec<u8>,
}

impl Image {
    /// Reads an image file, of which only the header is parsed.
    ///
    /// # Errors
    /// A sentence, if the bytes are neither PNG nor JPEG, or have more pixels than allowed.
    pub fn new(bytes: Vec<u8>) -> Result<Self, String> {
        let known = png_size(&bytes).map(|size| (ImageKind::Png, size));
        let known = known.or_else(|| jpeg_size(&bytes).map(|size| (ImageKind::Jpeg, size)));
        let (kind, size) = known.ok_or("the picture is neither PNG nor JPEG")?;
        let [width, height] = size;
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels > MAX_IMAGE_PIXELS {
            return Err(format!("the picture has {width} x {height} pixels; 1 to {MAX_IMAGE_PIXELS} are allowed"));
        }
        Ok(Self { kind, size, bytes })
    }

    /// Returns the compression of the image.
    pub fn kind(&self) -> ImageKind {
        self.kind
    }

    /// Returns width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns the bytes of the file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// Returns the width and height of a PNG, or `None` for other bytes. Source: ISO/IEC 15948 (2004), sections 5.2,
/// 11.2.2.
fn png_size(bytes: &[u8]) -> Option<[u32; 2]> {
    let rest = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n")?;
    let word = |at: usize| rest.get(at..at + 4)?.try_into().ok().map(u32::from_be_bytes);
    (rest.get(4..8)? == b"IHDR").then_some([word(8)?, word(12)?])
}

/// Returns the width and height of a JPEG's first frame, or `None` for other bytes. Source: ITU-T T.81 (1992), annex
/// B.
fn jpeg_size(bytes: &[u8]) -> Option<[u32; 2]> {
    let mut rest = bytes.strip_prefix(&[0xff, 0xd8])?;
    loop {
        let &[mark, kind, high, low, ..] = rest else { return None };
        if mark != 0xff {
            return None;
        }
        // a marker may be preceded by fill bytes
        if kind == 0xff {
            rest = &rest[1..];
            continue;
        }
        let is_frame = matches!(kind, 0xc0..=0xcf) && !matches!(kind, 0xc4 | 0xc8 | 0xcc);
        if is_frame {
            let pair = |at: usize| rest.get(at..at + 2)?.try_into().ok().map(u16::from_be_bytes).map(u32::from);
            return Some([pair(7)?, pair(5)?]);
        }
        rest = rest.get(2 + usize::from(u16::from_be_bytes([high, low]))..)?;
    }
}

/// How a texture continues beyond its image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wrap {
    /// The image is repeated.
    #[default]
    Repeat,
    /// The image is repeated, every other time mirrored.
    MirroredRepeat,
    /// The pixels on the border are extended.
    ClampToEdge,
}

/// How a texture is sampled where its pixels are larger, or smaller, than those of the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Filter {
    /// The nearest pixel.
    Nearest,
    /// The mean of the four nearest pixels.
    Linear,
    /// The nearest pixel of the best mipmap level.
    NearestMipmapNearest,
    /// The mean of the four nearest pixels of the best mipmap level.
    LinearMipmapNearest,
    /// The mean of the nearest pixels of two mipmap levels.
    NearestMipmapLinear,
    /// The mean of the four nearest pixels of two mipmap levels.
    LinearMipmapLinear,
}

/// All wrap modes with their names.
pub const WRAPS: [(&str, Wrap); 3] =
    [("repeat", Wrap::Repeat), ("mirrored-repeat", Wrap::MirroredRepeat), ("clamp-to-edge", Wrap::ClampToEdge)];

/// All filters with their names; only the first two are for magnification.
pub const FILTERS: [(&str, Filter); 6] = [
    ("nearest", Filter::Nearest),
    ("linear", Filter::Linear),
    ("nearest-mipmap-nearest", Filter::NearestMipmapNearest),
    ("linear-mipmap-nearest", Filter::LinearMipmapNearest),
    ("nearest-mipmap-linear", Filter::NearestMipmapLinear),
    ("linear-mipmap-linear", Filter::LinearMipmapLinear),
];

impl Wrap {
    /// Returns the name of the wrap mode.
    pub fn name(self) -> &'static str {
        WRAPS.iter().find(|(_, wrap)| *wrap == self).map_or("", |(name, _)| name)
    }
}

impl Filter {
    /// Returns the name of the filter.
    pub fn name(self) -> &'static str {
        FILTERS.iter().find(|(_, filter)| *filter == self).map_or("", |(name, _)| name)
    }
}

/// An image and how it is mapped to a surface: texture coordinates from 0 to 1 span its width and height, the second
/// one from the lower edge upwards.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// The image.
    pub image: Arc<Image>,
    /// The wrap modes in the horizontal and in the vertical direction.
    pub wrap: [Wrap; 2],
    /// The filter for magnification, nearest or linear.
    pub magnify: Option<Filter>,
    /// The filter for minification.
    pub minify: Option<Filter>,
}

impl Texture {
    /// Creates a repeating texture without filters, which are left to the viewer.
    pub fn new(image: Arc<Image>) -> Self {
        Self { image, wrap: [Wrap::Repeat; 2], magnify: None, minify: None }
    }

    /// Checks the filters.
    ///
    /// # Errors
    /// If the magnification filter is one for minification only.
    pub fn check(&self) -> Result<(), Fault> {
        match self.magnify {
            None | Some(Filter::Nearest | Filter::Linear) => Ok(()),
            Some(other) => {
                let detail = format!("\"{}\" is a filter for smaller pixels; give nearest or linear", other.name());
                Err(Fault::new("/mag_filter", detail))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_off_heads_and_nothing_else_is_a_picture() {
        let png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x03\0\0\0\x05";
        assert_eq!(png_size(png), Some([3, 5]));
        // a comment of four bytes, a fill byte, a progressive frame of 7 x 260 pixels
        let jpeg = [0xff, 0xd8, 0xff, 0xfe, 0, 4, 1, 2, 0xff, 0xff, 0xc2, 0, 11, 8, 1, 4, 0, 7, 1];
        assert_eq!(jpeg_size(&jpeg), Some([7, 260]));
        for (bytes, detail) in [
            (b"GIF89a".to_vec(), "neither PNG nor JPEG"),
            (jpeg[..12].to_vec(), "neither PNG nor JPEG"),
            ([&png[..16], &[0; 8]].concat(), "0 x 0 pixels"),
            ([&png[..16], &[1; 8]].concat(), "16843009 x 16843009 pixels"),
        ] {
            let found = Image::new(bytes).expect_err("no picture");
            assert!(found.contains(detail), "{found}");
        }
    }
}
