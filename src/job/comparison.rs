//! Comparisons of two pictures, or of two shapes.

use std::io::{self, Cursor, Write};
use std::sync::Arc;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageFormat, ImageReader};

use super::codec::Item;
use super::complete::Job;
use super::error::RunError;
use super::input::Input;
use super::key::{Key, content, hashed, versioned};
use super::limits::Admitted;
use super::shown::show;
use super::work::KeepWork;
use crate::fault::Fault;
use crate::output::{Farthest, Measured};
use crate::raster::{Difference, Measure, Pixels, difference};
use crate::watch::Watch;

/// Maximum number of pixels of a picture to compare. Two such pictures with their difference take 700 MiB. Half as many
/// would refuse scans of a page at 600 dots per inch; twice as many would take twice the memory.
const MAX_COMPARED_PIXELS: u64 = 1 << 26;
/// Bytes per pixel while two pictures are compared: two colours of four channels, possibly of sixteen bits each, and
/// the picture of the difference, which is then compressed.
const COMPARED_PIXEL_BYTES: u64 = 2 * 4 + 8 + 3 + 3;
/// Number of pixels compared per millisecond on one core, with smoothed edges (measured: 9,000 to 60,000). Half or
/// twice of it would book twice or half the time.
const PIXELS_A_MS: u64 = 10_000;
/// Number of distances from points to a shape per millisecond on one core (measured: 150 to 900). Half or twice of it
/// would book twice or half the time.
const QUERIES_A_MS: u128 = 300;

/// The default threshold for pictures, the same as in pixelmatch.
pub const USUAL_THRESHOLD: f64 = 0.1;

/// One of the two sides of a comparison.
#[derive(Debug, Clone)]
pub enum Side {
    /// The refined shape of a job that has one output, of the format `stats`.
    Shape(Arc<Admitted>),
    /// A picture.
    Picture(PngFile),
}

/// A PNG file whose size is known.
#[derive(Debug, Clone)]
pub struct PngFile {
    bytes: Arc<[u8]>,
    size: [u32; 2],
    /// Whether planish drew it, so that its pixels are exact.
    is_own: bool,
}

/// The tolerances of a comparison.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tolerances {
    /// For colours, 0 to 1; if `None`, pictures drawn by planish are compared for equality.
    pub threshold: Option<f64>,
    /// For distances, in model units.
    pub tolerance: Option<f64>,
}

/// A comparison of two pictures or two shapes.
#[derive(Debug)]
pub struct Comparison {
    sides: ComparedSides,
    key: Key,
}

#[derive(Debug)]
enum ComparedSides {
    Pictures([PngFile; 2], Measure),
    Shapes([Arc<Admitted>; 2], f64),
}

/// The result of a comparison.
#[derive(Debug)]
pub enum Compared {
    /// The result for pictures of equal size.
    Pixels {
        /// The differing pixels.
        difference: Difference,
        /// Width and height of both, in pixels.
        size: [u32; 2],
    },
    /// The sizes of two pictures of different size.
    Sizes([[u32; 2]; 2]),
    /// The result for two shapes.
    Shapes {
        /// The statistics of each, as the format `stats` writes them.
        stats: [Vec<u8>; 2],
        /// The point of each shape that is farthest from the other.
        farthest: [Option<Farthest>; 2],
        /// The permitted distance, in model units.
        tolerance: f64,
    },
}

impl PngFile {
    /// Reads a picture; `is_own` tells whether planish drew it.
    ///
    /// # Errors
    /// A sentence, if the bytes are not a PNG or have too many pixels.
    pub fn new(bytes: Arc<[u8]>, is_own: bool) -> Result<Self, String> {
        let reader = ImageReader::with_format(Cursor::new(&*bytes), ImageFormat::Png);
        let (width, height) = reader.into_dimensions().map_err(|error| format!("it is no PNG: {error}"))?;
        if u64::from(width) * u64::from(height) > MAX_COMPARED_PIXELS {
            return Err(format!("it has {width} x {height} pixels; at most {MAX_COMPARED_PIXELS} are compared"));
        }
        Ok(Self { bytes, size: [width, height], is_own })
    }

    fn pixels(&self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1])
    }

    fn decoded(&self) -> Result<Pixels, String> {
        let [width, height] = self.size;
        let mut reader = ImageReader::with_format(Cursor::new(&*self.bytes), ImageFormat::Png);
        let mut limits = image::Limits::default();
        (limits.max_image_width, limits.max_image_height) = (Some(width), Some(height));
        limits.max_alloc = Some(self.pixels() * 8 + (1 << 20));
        reader.limits(limits);
        let found = reader.decode().map_err(|error| format!("it cannot be decoded: {error}"))?.into_rgba8().into_raw();
        Ok(Pixels { size: [width as usize, height as usize], rgba: found.as_chunks::<4>().0.to_vec() })
    }
}

impl Comparison {
    /// Creates the comparison of two sides.
    ///
    /// # Errors
    /// Every fault, with pointers below the request: sides of two kinds, and tolerances that do not belong to them.
    pub fn new(sides: [Side; 2], asked: Tolerances) -> Result<Self, Vec<Fault>> {
        let out_of_place = |name: &str, detail: &str| Err(vec![Fault::new(format!("/{name}"), detail)]);
        let (sides, tolerance) = match (sides, asked) {
            ([Side::Picture(_), Side::Picture(_)], Tolerances { tolerance: Some(_), .. }) => {
                return out_of_place(
                    "tolerance",
                    "pictures are compared by a threshold of colours; give \"threshold\"",
                );
            }
            ([Side::Shape(_), Side::Shape(_)], Tolerances { threshold: Some(_), .. }) => {
                return out_of_place("threshold", "shapes are compared by distances; give \"tolerance\"");
            }
            ([Side::Picture(a), Side::Picture(b)], Tolerances { threshold, .. }) => {
                let usual = if a.is_own && b.is_own { Measure::Equality } else { Measure::Seen(USUAL_THRESHOLD) };
                let measure = threshold.map_or(usual, Measure::Seen);
                let written = match measure {
                    Measure::Equality => Item::text("equality"),
                    Measure::Seen(threshold) => Item::Number(threshold),
                };
                (ComparedSides::Pictures([a, b], measure), written)
            }
            ([Side::Shape(a), Side::Shape(b)], Tolerances { tolerance, .. }) => {
                let mut faults: Vec<Fault> = Vec::new();
                for (place, side) in [("/a", &a), ("/b", &b)] {
                    faults.extend(unmeasurable(side.job()).map(|detail| Fault::new(place, detail)));
                }
                if a.job().input.mesh().is_some() != b.job().input.mesh().is_some() {
                    faults.push(Fault::new("/b", "one is a mesh and the other a curve; compare two of a kind"));
                }
                if !faults.is_empty() {
                    return Err(faults);
                }
                let tolerance = tolerance.unwrap_or(0.0);
                (ComparedSides::Shapes([a, b], tolerance), Item::Number(tolerance))
            }
            _ => return out_of_place("b", "one is a picture and the other a shape; compare two of a kind"),
        };
        let keys = match &sides {
            ComparedSides::Pictures(pictures, _) => pictures.each_ref().map(|picture| content(&picture.bytes)),
            ComparedSides::Shapes(shapes, _) => shapes.each_ref().map(|shape| shape.job().keys()[0]),
        };
        let [a, b] = keys.map(|key| Item::text(&key.to_string()));
        let key = versioned("planish comparison", [tolerance, a, b]);
        Ok(Self { sides, key })
    }

    /// Returns the key of the result.
    pub fn key(&self) -> Key {
        self.key
    }

    /// Returns the key of the picture of the difference.
    pub fn picture_key(&self) -> Key {
        hashed(&Item::List(vec![Item::text("planish difference"), Item::text(&self.key.to_string())]))
    }

    /// Returns whether both sides are pictures of equal size, so that there is a picture of their difference.
    pub fn has_picture(&self) -> bool {
        matches!(&self.sides, ComparedSides::Pictures([a, b], _) if a.size == b.size)
    }

    /// Returns the number of pixels of the first picture; 0 for shapes.
    pub fn pixels(&self) -> u64 {
        if let ComparedSides::Pictures([a, _], _) = &self.sides { a.pixels() } else { 0 }
    }

    /// Returns an upper bound of the memory in bytes.
    pub fn bytes(&self) -> u128 {
        match &self.sides {
            ComparedSides::Pictures(pictures, _) => {
                let of = |picture: &PngFile| picture.pixels() * COMPARED_PIXEL_BYTES + picture.bytes.len() as u64;
                pictures.iter().map(of).map(u128::from).sum()
            }
            ComparedSides::Shapes(shapes, _) => {
                let refined = shapes.iter().map(|shape| shape.estimate().memory_bytes).max().unwrap_or(0);
                let trees: u128 = shapes.iter().map(triangles).sum();
                refined.saturating_add((trees + Measured::MAX_PIECES).saturating_mul(Measured::TRIANGLE_BYTES))
            }
        }
    }

    /// Returns the work, in the units of the watch.
    pub fn work(&self) -> u128 {
        match &self.sides {
            ComparedSides::Pictures(pictures, _) => pictures[0].size[1].into(),
            ComparedSides::Shapes(shapes, _) => {
                let refined = shapes.iter().map(|shape| shape.estimate().forecast.work);
                let measured = shapes.iter().map(triangles);
                refined.chain(measured).fold(0, u128::saturating_add)
            }
        }
    }

    /// Returns the approximate time in milliseconds on one core.
    pub fn milliseconds(&self) -> u128 {
        match &self.sides {
            ComparedSides::Pictures(pictures, _) => {
                pictures.iter().map(|picture| u128::from(picture.pixels() / PIXELS_A_MS)).sum()
            }
            ComparedSides::Shapes(shapes, _) => {
                let of = |shape: &Arc<Admitted>| {
                    // a result that is cut into many pieces takes longer and is moved to the lane for long work
                    let queries = triangles(shape).saturating_mul(Measured::QUERIES_A_TRIANGLE);
                    shape.estimate().time_ms.saturating_add(queries / QUERIES_A_MS)
                };
                shapes.iter().map(of).fold(0, u128::saturating_add)
            }
        }
    }

    /// Runs the comparison.
    ///
    /// # Errors
    /// [`RunError`].
    pub fn run(&self, kept: &dyn KeepWork, watch: &Watch) -> Result<Compared, RunError> {
        match &self.sides {
            ComparedSides::Pictures([a, b], _) if a.size != b.size => Ok(Compared::Sizes([a.size, b.size])),
            ComparedSides::Pictures([a, b], measure) => {
                let size = a.size;
                let [a, b] = [("/a", a), ("/b", b)].map(|(place, picture)| {
                    picture.decoded().map_err(|detail| RunError::of_request(Fault::new(place, detail)))
                });
                let difference = difference(&a?, &b?, *measure, watch).map_err(RunError::Stopped)?;
                Ok(Compared::Pixels { difference, size })
            }
            ComparedSides::Shapes([a, b], tolerance) => {
                let [(stats_a, a), (stats_b, b)] = [measured(a, "/a", kept, watch)?, measured(b, "/b", kept, watch)?];
                let there = a.farthest_from(&b, watch).map_err(RunError::Stopped)?;
                let back = b.farthest_from(&a, watch).map_err(RunError::Stopped)?;
                let (stats, farthest) = ([stats_a, stats_b], [there, back]);
                Ok(Compared::Shapes { stats, farthest, tolerance: *tolerance })
            }
        }
    }
}

impl Compared {
    /// Writes the picture of the difference as PNG, if there is one.
    ///
    /// # Errors
    /// If the bytes cannot be written.
    pub fn write_picture(&self, out: &mut dyn Write) -> Result<(), RunError> {
        let Self::Pixels { difference, size: [width, height] } = self else { return Ok(()) };
        PngEncoder::new_with_quality(out, CompressionType::Fast, FilterType::Adaptive)
            .write_image(difference.picture.as_flattened(), *width, *height, ExtendedColorType::Rgb8)
            .map_err(|error| RunError::Io(io::Error::other(error)))
    }
}

/// Returns an upper bound of the number of triangles that a job shows; for a curve, of its segments.
fn triangles(admitted: &Arc<Admitted>) -> u128 {
    let last = admitted.estimate().forecast.levels.last().copied().unwrap_or_default();
    last.corners.max(last.vertices)
}

/// Returns why distances of a shape cannot be measured, or `None` if they can.
fn unmeasurable(job: &Job) -> Option<&'static str> {
    match &*job.input {
        _ if !job.panels().is_empty() => Some("a figure is a picture; ask for it as png"),
        Input::Polygons(polygons) if polygons.iter().any(|polygon| polygon.dimension > 3) => {
            Some("distances are measured in space; points of four coordinates have none there")
        }
        _ => None,
    }
}

/// Returns the statistics and the triangles of a shape.
fn measured(
    admitted: &Admitted,
    place: &str,
    kept: &dyn KeepWork,
    watch: &Watch,
) -> Result<(Vec<u8>, Measured), RunError> {
    let (job, on_demand) = (admitted.job(), admitted.estimate().on_demand);
    let output = &job.outputs[0];
    let (mut stats, mut found) = (Vec::new(), None);
    let shown = show((job, on_demand), output, kept, watch, &mut |scene| {
        output.format.write(scene, &output.options, &mut stats, watch)?;
        found = Some(Measured::of(&scene.shape, watch)?);
        Ok(())
    });
    shown.map_err(|error| match error {
        RunError::Impossible(fault) => RunError::of_request(job.entries(output).fault(fault).under(place)),
        other => other,
    })?;
    let found = found.ok_or_else(|| RunError::Io(io::Error::other("nothing was shown")))?;
    Ok((stats, found))
}
