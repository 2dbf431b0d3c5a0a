//! A drawing of curves.

#![expect(clippy::cast_possible_truncation, reason = "pixel coordinates need no more than the precision of f32")]

use super::options::Options;
use crate::drawing::{Color, Discs, Drawing, Item, Mark, Point, Run, Stroke};
use crate::output::error::FormatError;
use crate::output::scene::{CHUNK, Curve, Scene, Shape};
use crate::raster::{Camera, Projection, View};
use crate::watch::Watch;

/// What is shown when the request does not say.
const DEFAULT_SHOW: &[&str] = &["curve", "control", "points"];
/// Colour of curves.
pub(super) const CURVE: Color = [37, 99, 235, 255];
const CONTROL: Color = [160, 170, 184, 255];
const POINT: Color = [71, 85, 105, 255];
const RING: Color = [255; 4];

/// Steps shorter than this are left out of a line, pixels.
const FINEST_PX: f64 = 0.25;
/// Longest polyline, so that painting one takes bounded memory.
const LONGEST: usize = 4096;

/// Draws the curves of a scene.
pub(crate) fn drawing(scene: &Scene<'_>, options: &Options<'_>, watch: &Watch) -> Result<Drawing, FormatError> {
    let (Shape::Curves(curves), Shape::Curves(control)) = (scene.shape, scene.control.shape()) else {
        return Err(FormatError::Unfit("only curves can be drawn as lines; ask for \"png\" instead".into()));
    };
    let shows = |item| options.shows(item, DEFAULT_SHOW);
    let mut shown: Vec<&Curve> = Vec::new();
    shown.extend(curves.iter().filter(|_| shows("curve")));
    shown.extend(control.iter().filter(|_| shows("control") || shows("points")));
    let easel = Easel::new(&shown, options.view(), options.size, options.corners());
    let unit = options.unit_px();
    let mut items = Vec::new();
    if shows("control") {
        let runs = easel.runs(control, watch)?;
        items.push(Item::lines("control", runs, Stroke::solid(1.5 * unit, CONTROL)).titled("control polygon"));
    }
    if shows("curve") {
        let runs = easel.runs(curves, watch)?;
        items.push(Item::lines("curve", runs, Stroke::solid(3.4 * unit, options.color(CURVE))).titled("curve"));
    }
    if shows("points") {
        let centres = easel.centres(control, watch)?;
        items.push(Item::new("points", Mark::Discs(discs(centres, unit))).titled("control points"));
    }
    Ok(Drawing { size: options.size, background: options.background, title: String::new(), items })
}

/// Brings points of 1 to 3 coordinates into the picture.
pub(super) struct Easel {
    camera: Camera,
    /// Middle and scale of the values of functions.
    graph: [f64; 2],
    /// Width over height of the picture.
    aspect: f64,
}

impl Easel {
    /// An easel that shows all these curves, or the box with these corners, as `asked`, in a picture of so many pixels.
    pub(super) fn new(shown: &[&Curve], asked: View, [width, height]: [u32; 2], given: Option<[[f64; 3]; 8]>) -> Self {
        let mut easel = Self {
            camera: Camera::framing(&View::default(), &[], width, height),
            graph: [0.0, 1.0],
            aspect: f64::from(width) / f64::from(height),
        };
        if shown.iter().any(|curve| curve.dimension == 1) {
            let values = || shown.iter().flat_map(|curve| curve.points.iter().copied());
            let [low, high] = given.map_or_else(|| ends(values()), |corners| [corners[0][1], corners[7][1]]);
            let half = 0.5 * high - 0.5 * low;
            let flat = half <= 1e-12 * low.abs().max(high.abs());
            easel.graph = [0.5 * low + 0.5 * high, if flat { 1.0 } else { 0.5 / half }];
        }
        let planar = shown.iter().all(|curve| curve.dimension < 3);
        let view = View { projection: Projection::Orthographic, azimuth_rad: 0.0, elevation_rad: 0.0, ..asked };
        let view = if planar { View { eye: None, up: [0.0, 1.0, 0.0], ..view } } else { asked };
        let all = shown.iter().flat_map(|curve| (0..curve.len()).map(|i| easel.lifted(curve, i)));
        let has_values = shown.iter().any(|curve| curve.dimension == 1);
        let points: Vec<[f64; 3]> = match given.filter(|_| !has_values) {
            Some(given) if planar => corners(given.into_iter()),
            Some(given) => given.to_vec(),
            None if planar => corners(all),
            None => all.collect(),
        };
        easel.camera = Camera::framing(&view, &[&points], width, height);
        easel
    }

    /// Point `i` of a curve in space: functions become graphs over the unit interval, plane curves lie at z = 0.
    fn lifted(&self, curve: &Curve, i: usize) -> [f64; 3] {
        let at = |k: usize| curve.points[i * curve.dimension + k];
        match curve.dimension {
            1 => {
                let steps = if curve.closed { curve.len() } else { curve.len() - 1 };
                #[expect(clippy::cast_precision_loss, reason = "fewer than 2^52 points")]
                let x = i as f64 / steps.max(1) as f64;
                [x * self.aspect, (at(0) - self.graph[0]) * self.graph[1], 0.0]
            }
            2 => [at(0), at(1), 0.0],
            _ => [at(0), at(1), at(2)],
        }
    }

    /// Point `i` in space and, unless that is out of the picture, its pixel coordinates.
    fn spot(&self, curve: &Curve, i: usize) -> ([f64; 3], Option<[f64; 2]>) {
        let point = self.lifted(curve, i);
        (point, self.camera.place(point))
    }

    /// The curves as polylines.
    pub(super) fn runs(&self, curves: &[Curve], watch: &Watch) -> Result<Vec<Run>, FormatError> {
        let mut pen = Pen::default();
        for curve in curves {
            let n = curve.len();
            // A function on a closed polygon is drawn over one period, not led back to its start.
            let joined = curve.closed && curve.dimension > 1;
            let segments = if joined && n > 2 { n } else { n.saturating_sub(1) };
            let mut from = (n > 0).then(|| self.spot(curve, 0));
            for i in 0..segments {
                if i % CHUNK == 0 {
                    watch.check()?;
                }
                let to = self.spot(curve, (i + 1) % n);
                let ends = match (from, to) {
                    (Some((_, Some(a))), (_, Some(b))) => Some([a, b]),
                    (Some((a, _)), (b, _)) => self.camera.segment(a, b),
                    (None, _) => None,
                };
                pen.draw(ends, i + 1 == segments);
                from = Some(to);
            }
            pen.lift();
        }
        Ok(pen.runs)
    }

    fn centres(&self, curves: &[Curve], watch: &Watch) -> Result<Vec<Point>, FormatError> {
        let mut centres: Vec<Point> = Vec::new();
        for curve in curves {
            for i in 0..curve.len() {
                if i % CHUNK == 0 {
                    watch.check()?;
                }
                let (_, Some(place)) = self.spot(curve, i) else { continue };
                let place = place.map(|x| x as f32);
                let fresh = centres.last().is_none_or(|last| {
                    let (dx, dy) = (place[0] - last[0], place[1] - last[1]);
                    dx * dx + dy * dy > 0.25
                });
                if fresh {
                    centres.push(place);
                }
            }
        }
        Ok(centres)
    }
}

/// Discs that shrink where they would hide each other and the curve.
fn discs(centres: Vec<Point>, unit: f32) -> Discs {
    let steps = centres.windows(2).map(|pair| {
        let (dx, dy) = (f64::from(pair[1][0] - pair[0][0]), f64::from(pair[1][1] - pair[0][1]));
        (dx * dx + dy * dy).sqrt()
    });
    #[expect(clippy::cast_precision_loss, reason = "fewer than 2^52 points")]
    let mean = if centres.len() > 1 { steps.sum::<f64>() / (centres.len() - 1) as f64 } else { f64::INFINITY };
    let scale = (0.5 * mean as f32 / (5.6 * unit)).clamp(0.25, 1.0);
    let ring_px = if scale < 0.5 { 0.0 } else { 1.5 * unit * scale };
    let radius_px = 4.1 * unit * scale + ring_px;
    Discs { centres, radius_px, ring_px, color: POINT, ring: RING }
}

/// Smallest and largest value; `[0, 0]` when there is none.
fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let found = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    if found[0] <= found[1] { found } else { [0.0; 2] }
}

/// Opposite corners of the bounding box in the plane.
fn corners(points: impl Iterator<Item = [f64; 3]>) -> Vec<[f64; 3]> {
    let none = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let (low, high) =
        points.fold(none, |(a, b), p| ([a[0].min(p[0]), a[1].min(p[1])], [b[0].max(p[0]), b[1].max(p[1])]));
    if low[0] <= high[0] { vec![[low[0], low[1], 0.0], [high[0], high[1], 0.0]] } else { Vec::new() }
}

/// Joins segments to polylines and leaves out steps too small to see.
#[derive(Default)]
struct Pen {
    runs: Vec<Run>,
    run: Run,
    /// Where the pen really is; the run may end a little before.
    here: Option<[f64; 2]>,
    kept: [f64; 2],
}

impl Pen {
    fn draw(&mut self, segment: Option<[[f64; 2]; 2]>, last: bool) {
        let Some([from, to]) = segment else { return self.lift() };
        if self.here != Some(from) {
            self.lift();
            self.keep(from);
        }
        let (dx, dy) = (to[0] - self.kept[0], to[1] - self.kept[1]);
        if last || self.run.len() < 2 || dx * dx + dy * dy > FINEST_PX * FINEST_PX {
            self.keep(to);
        }
        self.here = Some(to);
        if self.run.len() >= LONGEST {
            self.lift();
            self.keep(to);
            self.here = Some(to);
        }
    }

    fn keep(&mut self, place: [f64; 2]) {
        self.run.push(place.map(|x| x as f32));
        self.kept = place;
    }

    fn lift(&mut self) {
        if self.run.len() > 1 {
            self.runs.push(std::mem::take(&mut self.run));
        }
        self.run.clear();
        self.here = None;
    }
}
