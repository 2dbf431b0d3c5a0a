//! Comparisons: what differs between two pictures, or between two shapes.

use std::io::{self, Cursor, Write};
use std::sync::Arc;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageFormat, ImageReader};

use super::codec::Item;
use super::complete::Job;
use super::error::RunError;
use super::input::Input;
use super::key::{Key, RESULTS_VERSION, content, hashed};
use super::limits::Admitted;
use super::shown::show;
use super::work::KeepWork;
use crate::fault::Fault;
use crate::output::{Farthest, Measured};
use crate::raster::{Difference, Measure, Pixels, difference};
use crate::watch::Watch;

/// Most pixels of a picture that is compared.
/// Two of them with what is drawn of them take 700 MiB. Half of it refuses scans of a page at 600 dots an inch; twice
/// of it takes twice the memory.
const MOST_PIXELS: u64 = 1 << 26;
/// Bytes a pixel of both pictures while they are compared: two colours of four channels, in which sixteen bits a
/// channel may come, and the picture of their difference, which is then compressed.
const PIXEL_BYTES: u64 = 2 * 4 + 8 + 3 + 3;
/// Pixels that are compared in a millisecond of one core, smoothed edges included (measured: 9,000 to 60,000).
/// Half and twice of it book twice and half the time.
const PIXELS_A_MS: u64 = 10_000;
/// Distances of points from a shape that are found in a millisecond of one core (measured: 150 to 900).
/// Half and twice of it book twice and half the time.
const QUERIES_A_MS: u128 = 300;

/// The threshold of pictures where none is given: what pixelmatch has, too.
pub const USUAL_THRESHOLD: f64 = 0.1;

/// One of the two that are compared.
#[derive(Debug, Clone)]
pub enum Side {
    /// The refined shape of a job with one output of the format `stats`.
    Shape(Arc<Admitted>),
    /// A picture.
    Picture(PngFile),
}

/// A picture as a PNG file, of which the size is known.
#[derive(Debug, Clone)]
pub struct PngFile {
    bytes: Arc<[u8]>,
    size: [u32; 2],
    /// Whether this program drew it, so that its pixels mean something to the last bit.
    is_own: bool,
}

/// What is asked of a comparison.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tolerances {
    /// Of colours, 0 to 1; where it is left out, own pictures are compared by equality.
    pub threshold: Option<f64>,
    /// Of distances, model units.
    pub tolerance: Option<f64>,
}

/// Two things to be compared.
#[derive(Debug)]
pub struct Comparison {
    sides: Sides,
    key: Key,
}

#[derive(Debug)]
enum Sides {
    Pictures([PngFile; 2], Measure),
    Shapes([Arc<Admitted>; 2], f64),
}

/// What a comparison has found.
#[derive(Debug)]
pub enum Compared {
    /// Pictures of one size.
    Pixels {
        /// What differs.
        difference: Difference,
        /// Their width and height.
        size: [u32; 2],
    },
    /// Pictures of two sizes.
    Sizes([[u32; 2]; 2]),
    /// Shapes.
    Shapes {
        /// The statistics of each, as the format `stats` writes them.
        stats: [Vec<u8>; 2],
        /// How far each is from the other at most.
        farthest: [Option<Farthest>; 2],
        /// The distance that is allowed.
        tolerance: f64,
    },
}

impl PngFile {
    /// A picture; `is_own` says whether this program drew it.
    ///
    /// # Errors
    /// A sentence, where the bytes are no PNG or have too many pixels.
    pub fn new(bytes: Arc<[u8]>, is_own: bool) -> Result<Self, String> {
        let reader = ImageReader::with_format(Cursor::new(&*bytes), ImageFormat::Png);
        let (width, height) = reader.into_dimensions().map_err(|error| format!("it is no PNG: {error}"))?;
        if u64::from(width) * u64::from(height) > MOST_PIXELS {
            return Err(format!("it has {width} x {height} pixels; at most {MOST_PIXELS} are compared"));
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
    /// The comparison of two sides.
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
                (Sides::Pictures([a, b], measure), written)
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
                (Sides::Shapes([a, b], tolerance), Item::Number(tolerance))
            }
            _ => return out_of_place("b", "one is a picture and the other a shape; compare two of a kind"),
        };
        let keys = match &sides {
            Sides::Pictures(pictures, _) => pictures.each_ref().map(|picture| content(&picture.bytes)),
            Sides::Shapes(shapes, _) => shapes.each_ref().map(|shape| shape.job().keys()[0]),
        };
        let [a, b] = keys.map(|key| Item::text(&key.to_string()));
        let version = Item::Integer(u64::from(RESULTS_VERSION));
        let key = hashed(&Item::List(vec![Item::text("planish comparison"), version, tolerance, a, b]));
        Ok(Self { sides, key })
    }

    /// The key of what it finds.
    pub fn key(&self) -> Key {
        self.key
    }

    /// The key of the picture of the difference.
    pub fn picture_key(&self) -> Key {
        hashed(&Item::List(vec![Item::text("planish difference"), Item::text(&self.key.to_string())]))
    }

    /// Whether it is one of two pictures of one size, which have a picture of their difference.
    pub fn has_picture(&self) -> bool {
        matches!(&self.sides, Sides::Pictures([a, b], _) if a.size == b.size)
    }

    /// Pixels of the first picture; none where shapes are compared.
    pub fn pixels(&self) -> u64 {
        if let Sides::Pictures([a, _], _) = &self.sides { a.pixels() } else { 0 }
    }

    /// Bytes of memory that it takes at most.
    pub fn bytes(&self) -> u128 {
        match &self.sides {
            Sides::Pictures(pictures, _) => {
                let of = |picture: &PngFile| picture.pixels() * PIXEL_BYTES + picture.bytes.len() as u64;
                pictures.iter().map(of).map(u128::from).sum()
            }
            Sides::Shapes(shapes, _) => {
                let refined = shapes.iter().map(|shape| shape.estimate().memory_bytes).max().unwrap_or(0);
                let trees: u128 = shapes.iter().map(triangles).sum();
                refined.saturating_add((trees + Measured::MOST_PIECES).saturating_mul(Measured::TRIANGLE_BYTES))
            }
        }
    }

    /// Units of work, as the watch counts them.
    pub fn work(&self) -> u128 {
        match &self.sides {
            Sides::Pictures(pictures, _) => pictures[0].size[1].into(),
            Sides::Shapes(shapes, _) => {
                let refined = shapes.iter().map(|shape| shape.estimate().forecast.work);
                let measured = shapes.iter().map(triangles);
                refined.chain(measured).fold(0, u128::saturating_add)
            }
        }
    }

    /// Milliseconds on one core, roughly.
    pub fn milliseconds(&self) -> u128 {
        match &self.sides {
            Sides::Pictures(pictures, _) => {
                pictures.iter().map(|picture| u128::from(picture.pixels() / PIXELS_A_MS)).sum()
            }
            Sides::Shapes(shapes, _) => {
                let of = |shape: &Arc<Admitted>| {
                    // what is cut in many pieces takes longer, and is moved to where long work is done
                    let queries = triangles(shape).saturating_mul(Measured::QUERIES);
                    shape.estimate().time_ms.saturating_add(queries / QUERIES_A_MS)
                };
                shapes.iter().map(of).fold(0, u128::saturating_add)
            }
        }
    }

    /// Compares.
    ///
    /// # Errors
    /// [`RunError`].
    pub fn run(&self, kept: &dyn KeepWork, watch: &Watch) -> Result<Compared, RunError> {
        match &self.sides {
            Sides::Pictures([a, b], _) if a.size != b.size => Ok(Compared::Sizes([a.size, b.size])),
            Sides::Pictures([a, b], measure) => {
                let size = a.size;
                let [a, b] = [("/a", a), ("/b", b)].map(|(place, picture)| {
                    picture.decoded().map_err(|detail| RunError::of_request(Fault::new(place, detail)))
                });
                let difference = difference(&a?, &b?, *measure, watch).map_err(RunError::Stopped)?;
                Ok(Compared::Pixels { difference, size })
            }
            Sides::Shapes([a, b], tolerance) => {
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
    /// Writes the picture of the difference as PNG; nothing where there is none.
    ///
    /// # Errors
    /// When the bytes cannot be taken.
    pub fn write_picture(&self, out: &mut dyn Write) -> Result<(), RunError> {
        let Self::Pixels { difference, size: [width, height] } = self else { return Ok(()) };
        PngEncoder::new_with_quality(out, CompressionType::Fast, FilterType::Adaptive)
            .write_image(difference.picture.as_flattened(), *width, *height, ExtendedColorType::Rgb8)
            .map_err(|error| RunError::Io(io::Error::other(error)))
    }
}

/// The triangles of what a job shows, at most; of a curve its segments.
fn triangles(admitted: &Arc<Admitted>) -> u128 {
    let last = admitted.estimate().forecast.levels.last().copied().unwrap_or_default();
    last.corners.max(last.vertices)
}

/// Why distances of a shape are not measured, if so.
fn unmeasurable(job: &Job) -> Option<&'static str> {
    match &*job.input {
        _ if !job.panels().is_empty() => Some("a figure is a picture; ask for it as png"),
        Input::Polygons(polygons) if polygons.iter().any(|polygon| polygon.dimension > 3) => {
            Some("distances are measured in space; points of four coordinates have none there")
        }
        _ => None,
    }
}

/// The statistics of a shape, and its triangles.
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
