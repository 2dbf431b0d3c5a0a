//! Pictures that surfaces are covered with, as they came: their bytes are kept, and never changed.

use std::sync::Arc;

use crate::fault::Fault;

/// Most pixels of a picture: 8,192 x 8,192. Drawing takes some bytes for each. Half of it would refuse what game assets
/// have; twice of it takes gigabytes for one picture.
const MOST_PIXELS: u64 = 1 << 26;

/// How a picture is compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImageKind {
    /// Without loss, PNG.
    Png,
    /// With loss, JPEG.
    Jpeg,
}

impl ImageKind {
    /// The media type of such a picture.
    pub fn media_type(self) -> &'static str {
        match self {
            Self::Png => "image/png",
            Self::Jpeg => "image/jpeg",
        }
    }
}

/// A picture in a file of its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    kind: ImageKind,
    size: [u32; 2],
    bytes: Vec<u8>,
}

impl Image {
    /// The picture in a file, of which no more than the head is read.
    ///
    /// # Errors
    /// A sentence: the bytes are no PNG and no JPEG, or have more pixels than are allowed.
    pub fn new(bytes: Vec<u8>) -> Result<Self, String> {
        let known = png_size(&bytes).map(|size| (ImageKind::Png, size));
        let known = known.or_else(|| jpeg_size(&bytes).map(|size| (ImageKind::Jpeg, size)));
        let (kind, size) = known.ok_or("the picture is neither PNG nor JPEG")?;
        let [width, height] = size;
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels > MOST_PIXELS {
            return Err(format!("the picture has {width} x {height} pixels; 1 to {MOST_PIXELS} are allowed"));
        }
        Ok(Self { kind, size, bytes })
    }

    /// How it is compressed.
    pub fn kind(&self) -> ImageKind {
        self.kind
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The bytes of the file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// Width and height of a PNG, where it is one. Source: ISO/IEC 15948 (2004), sections 5.2 and 11.2.2.
fn png_size(bytes: &[u8]) -> Option<[u32; 2]> {
    let rest = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n")?;
    let word = |at: usize| rest.get(at..at + 4)?.try_into().ok().map(u32::from_be_bytes);
    (rest.get(4..8)? == b"IHDR").then_some([word(8)?, word(12)?])
}

/// Width and height of a JPEG, where it is one: those of its first frame. Source: ITU-T T.81 (1992), annex B.
fn jpeg_size(bytes: &[u8]) -> Option<[u32; 2]> {
    let mut rest = bytes.strip_prefix(&[0xff, 0xd8])?;
    loop {
        let &[mark, kind, high, low, ..] = rest else { return None };
        if mark != 0xff {
            return None;
        }
        // fill bytes may stand before a marker
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

/// What lies beyond the sides of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture turned over, then as it is, in turns.
    MirroredRepeat,
    /// The pixels along the side.
    ClampToEdge,
}

/// How a picture looks where its pixels are larger, or smaller, than those it is shown with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Filter {
    /// The pixel that is nearest.
    Nearest,
    /// A mean of the four that are nearest.
    Linear,
    /// The nearest pixel of the smaller copy whose pixels fit best.
    NearestMipmapNearest,
    /// A mean of the four nearest of that copy.
    LinearMipmapNearest,
    /// A mean of the nearest pixels of two copies.
    NearestMipmapLinear,
    /// A mean of the four nearest of two copies.
    LinearMipmapLinear,
}

/// Every wrap with its name.
pub const WRAPS: [(&str, Wrap); 3] =
    [("repeat", Wrap::Repeat), ("mirrored-repeat", Wrap::MirroredRepeat), ("clamp-to-edge", Wrap::ClampToEdge)];

/// Every filter with its name; larger pixels know the first two only.
pub const FILTERS: [(&str, Filter); 6] = [
    ("nearest", Filter::Nearest),
    ("linear", Filter::Linear),
    ("nearest-mipmap-nearest", Filter::NearestMipmapNearest),
    ("linear-mipmap-nearest", Filter::LinearMipmapNearest),
    ("nearest-mipmap-linear", Filter::NearestMipmapLinear),
    ("linear-mipmap-linear", Filter::LinearMipmapLinear),
];

impl Wrap {
    /// Its name.
    pub fn name(self) -> &'static str {
        WRAPS.iter().find(|(_, wrap)| *wrap == self).map_or("", |(name, _)| name)
    }
}

impl Filter {
    /// Its name.
    pub fn name(self) -> &'static str {
        FILTERS.iter().find(|(_, filter)| *filter == self).map_or("", |(name, _)| name)
    }
}

/// A picture and how it is laid over a surface: texture coordinates 0 to 1 are its width and height, the second from its
/// lower edge upwards.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// The picture.
    pub image: Arc<Image>,
    /// What lies beyond its sides: left and right, below and above.
    pub wrap: [Wrap; 2],
    /// How it looks where its pixels are larger than those it is shown with; nearest or linear.
    pub magnify: Option<Filter>,
    /// How it looks where they are smaller.
    pub minify: Option<Filter>,
}

impl Texture {
    /// A picture that repeats, with filters left to whoever shows it.
    pub fn new(image: Arc<Image>) -> Self {
        Self { image, wrap: [Wrap::Repeat; 2], magnify: None, minify: None }
    }

    /// Checks what is said of it.
    ///
    /// # Errors
    /// A filter for larger pixels that only smaller ones know.
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
