//! Requests for comparisons, and their answers.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use super::choice::choice;
use super::job::JobRequest;
use crate::fault::Fault;
use crate::job::{Compared, Tolerances};
use crate::output::Farthest;
use crate::raster::Difference;

/// What is compared, and how closely.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ComparisonRequest {
    /// The first: the id of an artifact (64 hexadecimal digits), the id of an upload (`b3-` and 64 hexadecimal digits),
    /// or a job with at most one output. A job whose output is `png` is the picture, any other its refined shape.
    #[schema(value_type = ComparedRequest)]
    pub a: Value,
    /// The second, in the same ways.
    #[schema(value_type = ComparedRequest)]
    pub b: Value,
    /// How far apart colours may be, 0 to 1, as pixelmatch means it. Where it is left out, pictures that this service
    /// drew are compared by equality, others at 0.1.
    #[schema(minimum = 0.0, maximum = 1.0)]
    pub threshold: Option<f64>,
    /// How far apart shapes may be, model units; 0 where it is left out.
    #[schema(minimum = 0.0)]
    pub tolerance: Option<f64>,
    /// What is made besides the answer: nothing, or the picture of what differs between two pictures.
    #[serde(default)]
    #[schema(max_items = 1)]
    pub outputs: Vec<DifferenceRequest>,
}

/// One of the two that are compared.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(untagged)]
pub enum ComparedRequest {
    /// The id of an artifact or of an upload.
    Id(String),
    /// A job.
    Job(Box<JobRequest>),
}

/// The picture of what differs: grey where pixels are the same, red where they differ, yellow at smoothed edges.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct DifferenceRequest {
    /// Its format.
    pub format: DifferenceFormat,
}

choice! {
    /// The format of the picture of what differs.
    pub enum DifferenceFormat {
        /// Pixels.
        Png = "png",
    }
}

impl ComparisonRequest {
    /// Checks the request and returns its tolerances.
    ///
    /// # Errors
    /// Every fault, with a pointer into the request.
    pub fn tolerances(&self) -> Result<Tolerances, Vec<Fault>> {
        let mut faults = Vec::new();
        if let Some(threshold) = self.threshold.filter(|threshold| !(0.0..=1.0).contains(threshold)) {
            let detail = format!("{threshold} is no threshold; colours are from 0 to 1 apart");
            faults.push(Fault::new("/threshold", detail));
        }
        if let Some(tolerance) = self.tolerance.filter(|tolerance| *tolerance < 0.0) {
            faults.push(Fault::new("/tolerance", format!("{tolerance} is no distance; give 0 or more")));
        }
        if self.outputs.len() > 1 {
            let detail = format!("{} outputs; there is one picture of what differs", self.outputs.len());
            faults.push(Fault::new("/outputs", detail));
        }
        let Self { threshold, tolerance, .. } = *self;
        if faults.is_empty() { Ok(Tolerances { threshold, tolerance }) } else { Err(faults) }
    }
}

/// What differs.
#[derive(Debug, Clone, Default, Serialize, ToSchema)]
pub struct ComparisonAnswer {
    /// Whether both are the same within what is allowed: no pixel differs, or the shapes have one `shape_hash` or are
    /// proved to be within the tolerance.
    pub equal: bool,
    /// Of pictures of one size: the pixels that differ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pixels: Option<PixelsAnswer>,
    /// Of pictures of two sizes: width and height of each, pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sizes: Option<[[u32; 2]; 2]>,
    /// Of shapes: how far they are apart at most.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hausdorff: Option<HausdorffAnswer>,
    /// Of shapes: the distance that was allowed, model units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Of curves: the length, model units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length: Option<ChangeAnswer>,
    /// Of meshes, and plane curves that are closed: the area, square model units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<ChangeAnswer>,
    /// Of closed meshes: the signed volume, cubic model units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub volume: Option<ChangeAnswer>,
    /// Of shapes: the corners of the box around each, model units.
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    pub bounds: Option<BoxesAnswer>,
    /// Of shapes: the hash that no order of vertices changes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shape_hash: Option<HashesAnswer>,
    /// The picture of what differs, where it was asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub outputs: Vec<DifferenceAnswer>,
}

/// Pixels that differ.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct PixelsAnswer {
    /// The number of pixels that differ.
    pub different: u64,
    /// The number of pixels of each picture.
    pub of: u64,
    /// The number of pixels that are further apart than the threshold but smooth an edge, which are not counted as
    /// different.
    pub smoothed: u64,
    /// The largest distance of colours, 0 to 1: with a threshold of this, none differs.
    pub largest: f64,
}

/// How far the points of each of two shapes are from the other at most, model units; null where a shape has no faces.
///
/// Distances are those of points from triangles, exact but for rounding. They were found at the places `at`; no point
/// is further away than `at_most`, which is proved by cutting triangles until both are within a thousandth, or a
/// ten-millionth of the size of the shape, or 65,536 triangles were cut.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct HausdorffAnswer {
    /// The largest distance of a point of `a` from `b`.
    pub a_to_b: Option<f64>,
    /// The largest distance of a point of `b` from `a`.
    pub b_to_a: Option<f64>,
    /// The points that have these distances.
    pub at: PlacesAnswer,
    /// The distances that no point exceeds.
    pub at_most: BoundsAnswer,
}

/// A point of each of two shapes.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct PlacesAnswer {
    /// A point of `a`.
    pub a_to_b: Option<[f64; 3]>,
    /// A point of `b`.
    pub b_to_a: Option<[f64; 3]>,
}

/// A distance from each of two shapes.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct BoundsAnswer {
    /// A distance from `b` that no point of `a` exceeds.
    pub a_to_b: Option<f64>,
    /// A distance from `a` that no point of `b` exceeds.
    pub b_to_a: Option<f64>,
}

/// A number of each, and by how much it changes from the first to the second.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
pub struct ChangeAnswer {
    /// The number of `a`.
    pub a: f64,
    /// The number of `b`.
    pub b: f64,
    /// The number of `b` less the number of `a`.
    pub change: f64,
}

/// The box around each: its least and its greatest coordinates.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct BoxesAnswer {
    /// The least and the greatest coordinates of the box around `a`.
    pub a: [Vec<f64>; 2],
    /// The least and the greatest coordinates of the box around `b`.
    pub b: [Vec<f64>; 2],
    /// The coordinates of `b` less those of `a`; empty where their points have other numbers of coordinates.
    pub change: [Vec<f64>; 2],
}

/// The hash of each.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct HashesAnswer {
    /// The hash of `a`.
    pub a: String,
    /// The hash of `b`.
    pub b: String,
    /// Whether the hashes are the same.
    pub equal: bool,
}

/// A picture of what differs.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct DifferenceAnswer {
    /// Its format.
    #[schema(pattern = "^png$")]
    pub format: &'static str,
    /// Id of the artifact.
    pub id: String,
    /// Where it is.
    pub href: String,
}

impl ComparisonAnswer {
    /// Creates the answer from the result of a comparison.
    pub fn new(found: &Compared) -> Self {
        match found {
            Compared::Sizes(sizes) => Self { sizes: Some(*sizes), ..Self::default() },
            Compared::Pixels { difference, .. } => {
                let Difference { different, smoothed, largest, picture } = difference;
                let of = picture.len() as u64;
                let pixels = PixelsAnswer { different: *different, of, smoothed: *smoothed, largest: *largest };
                Self { equal: *different == 0, pixels: Some(pixels), ..Self::default() }
            }
            Compared::Shapes { stats, farthest, tolerance } => Self::of_shapes(stats, *farthest, *tolerance),
        }
    }

    fn of_shapes(stats: &[Vec<u8>; 2], farthest: [Option<Farthest>; 2], tolerance: f64) -> Self {
        let stats: [Value; 2] = stats.each_ref().map(|stats| serde_json::from_slice(stats).unwrap_or_default());
        let number = |name: &str| {
            let [a, b] = stats.each_ref().map(|stats| stats[name].as_f64());
            a.zip(b).map(|(a, b)| ChangeAnswer { a, b, change: b - a })
        };
        let [a, b] = stats.each_ref().map(|stats| stats["shape_hash"].as_str().unwrap_or_default().to_owned());
        let is_same = a == b;
        let finite =
            |way: fn(&Farthest) -> f64| farthest.map(|found| found.as_ref().map(way).filter(|d| d.is_finite()));
        let ([a_to_b, b_to_a], most) = (finite(|found| found.distance), finite(|found| found.at_most));
        let at = farthest.map(|found| found.map(|found| found.at));
        let hausdorff = HausdorffAnswer {
            a_to_b,
            b_to_a,
            at: PlacesAnswer { a_to_b: at[0], b_to_a: at[1] },
            at_most: BoundsAnswer { a_to_b: most[0], b_to_a: most[1] },
        };
        Self {
            equal: is_same || most.iter().all(|most| most.is_some_and(|most| most <= tolerance)),
            hausdorff: Some(hausdorff),
            tolerance: Some(tolerance),
            length: number("length"),
            area: number("area"),
            volume: number("volume"),
            bounds: boxes(&stats),
            shape_hash: Some(HashesAnswer { a, b, equal: is_same }),
            ..Self::default()
        }
    }
}

fn boxes(stats: &[Value; 2]) -> Option<BoxesAnswer> {
    let corner = |stats: &Value, name: &str| {
        let found = stats["bounding_box"][name].as_array()?;
        found.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>()
    };
    let corners = |stats: &Value| Some([corner(stats, "min")?, corner(stats, "max")?]);
    let (a, b) = (corners(&stats[0])?, corners(&stats[1])?);
    let minus = |k: usize| {
        let is_one = a[k].len() == b[k].len();
        a[k].iter().zip(&b[k]).filter(|_| is_one).map(|(a, b)| b - a).collect()
    };
    Some(BoxesAnswer { change: [minus(0), minus(1)], a, b })
}
