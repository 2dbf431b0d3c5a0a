//! APNG: a moving picture, in which the camera goes around or a parameter of the plan changes.

use super::counts::{Counts, ShapeKind};
use super::description::DescriptionPlace;
use super::error::FormatError;
use super::figure::FigureExtent;
use super::film::{self, DELAY, FRAMES, Film, SWEPT_RANGE, TURNTABLE};
use super::format::{Content, Costs, Format, FormatFacts, ParameterRange, Requirements};
use super::options::joined;
use super::picture::options::{self, CAMERA};
use super::picture::outline::Outline;
use super::png::{PNG_OPTIONS, Png};
use super::scene::{CoordinateSystem, Scene};
use super::size::Size;
use super::stream::Stream;
use crate::fault::Fault;
use crate::math::parameter::{Parameter, Values};
use crate::shape::attachments::Attachments;
use crate::shape::mesh::Mesh;

/// The format "apng".
#[derive(Debug, Clone, Copy)]
pub(super) struct Apng;

/// Bytes around the data of a frame: its control chunk (38), and at worst two more chunks.
const FRAME_BYTES: u128 = 128;
/// Maximum number of pixels of all frames: 60 of four megapixels, some ten seconds of drawing. Half of it refuses
/// turntables for large screens; twice of it lets one job draw for twice as long.
const MAX_FILM_PIXELS: u64 = 1 << 28;

const FILM_OPTIONS: [Parameter; 4] = [FRAMES, DELAY, TURNTABLE, SWEPT_RANGE];

/// The options of the format, followed by those of its frames.
const APNG_OPTIONS: [Parameter; FILM_OPTIONS.len() + PNG_OPTIONS.len()] = joined(&FILM_OPTIONS, PNG_OPTIONS);

const FACTS: &FormatFacts = &FormatFacts {
    name: "apng",
    extension: "apng",
    media_type: "image/apng",
    content: Content::Packed,
    doc: "A picture that moves: the camera goes around, or a parameter of the plan changes from frame to frame.",
    parameters: &APNG_OPTIONS,
    description: Some(DescriptionPlace::Png),
    holds,
    ..FormatFacts::USUAL
};

/// Refuses a camera that goes around plane curves or functions; a parameter can change with any shape.
fn holds(kind: ShapeKind, values: &Values) -> Result<(), String> {
    if !goes_around(values) || !matches!(kind, ShapeKind::Curves { dimension: 1..=2 }) {
        return options::drawable(kind);
    }
    Err("a camera does not go around curves in the plane; name a parameter of the plan in \"sweep\", and leave \
         \"turntable\" out"
        .to_owned())
}

/// Returns whether the camera goes around.
fn goes_around(values: &Values) -> bool {
    values.group(TURNTABLE.name).is_some() || values.group(SWEPT_RANGE.name).is_none()
}

impl Format for Apng {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn side_px(&self, outline: &Outline, coordinate_system: CoordinateSystem, values: &Values) -> Option<f64> {
        Png.side_px(outline, coordinate_system, values)
    }

    fn parameter_range(&self, values: &Values) -> Option<ParameterRange> {
        film::parameter_range(values)
    }

    fn encode(&self, scene: &Scene<'_>, values: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let watch = stream.watch;
        let mut extent = FigureExtent::default();
        extent.add(scene, values, watch)?;
        let mut film = Film::begin(values, stream.out)?;
        for shot in film::shots(values, &extent, scene.coordinate_system) {
            film.frame(scene, &shot, watch)?;
        }
        film.end()
    }
}

impl Requirements for Apng {
    fn suits(&self, kind: ShapeKind, carried: &Attachments, values: &Values) -> Result<(), Fault> {
        if goes_around(values) && values.group(CAMERA.name).is_some_and(|camera| camera.vector("eye").is_some()) {
            let detail = "the eye goes around; leave it out, and give a \"target\" to go around that";
            return Err(Fault::new("/camera/eye", detail));
        }
        let pixels = options::size(values).map(u64::from).iter().product::<u64>() * film::frames(values) as u64;
        if pixels > MAX_FILM_PIXELS {
            let most = MAX_FILM_PIXELS / (pixels / film::frames(values) as u64).max(1);
            let detail = format!(
                "the frames have {pixels} pixels together, at most {MAX_FILM_PIXELS} are drawn; ask for {most} frames, \
                 or for smaller ones"
            );
            return Err(Fault::new("/frames", detail));
        }
        Png.suits(kind, carried, values)
    }

    fn refers(&self, values: &Values) -> Option<&'static str> {
        Png.refers(values)
    }
}

impl Costs for Apng {
    fn size(&self, counts: &Counts, values: &Values) -> Size {
        let n = film::frames(values) as u128;
        Size::AtMost(n * (Png.size(counts, values).bytes() + FRAME_BYTES))
    }

    fn memory(&self, counts: &Counts, values: &Values) -> u128 {
        Png.memory(counts, values)
    }

    fn work(&self, mesh: Option<&Mesh>, counts: &Counts, values: &Values) -> u128 {
        Png.work(mesh, counts, values).saturating_mul(film::frames(values) as u128)
    }
}
