//! Projects points of curves into the picture.

#![expect(clippy::cast_possible_truncation, reason = "pixel coordinates need no more than the precision of f32")]

use crate::drawing::{Point, PolylinePoints};
use crate::output::error::FormatError;
use crate::output::scene::{Curve, ROWS_PER_CHUNK};
use crate::raster::{Camera, Projection, View};
use crate::watch::Watch;

/// Steps shorter than this are left out of a line, pixels. Half of it writes longer lines that look alike; twice of it
/// begins to show.
const FINEST_PX: f64 = 0.25;
/// Share of the largest value up to which the range of values counts as rounding, and their graph as flat. Half and
/// twice of it differ in graphs alone of which nothing but rounding is seen.
const FLAT_SHARE: f64 = 1e-12;
/// Maximum number of points of a polyline, so that painting one takes bounded memory.
pub(super) const MAX_POLYLINE_POINTS: usize = 4096;

/// Projects points of 1 to 3 coordinates into the picture.
pub(super) struct Easel {
    camera: Camera,
    /// Middle and scale of the values of functions.
    graph: [f64; 2],
    /// Width over height of the visible part.
    aspect: f64,
    /// Upper left corner of the visible part, pixels.
    origin: [f64; 2],
}

/// Left, top, width and height of a part of the picture, pixels.
pub(super) type PixelRect = [f32; 4];

impl Easel {
    /// Returns an easel that frames all these curves with the view `asked` in a picture of `size` pixels.
    pub(super) fn new(shown: &[&Curve], asked: View, size: [u32; 2]) -> Self {
        Self::within(shown, asked, (size, None), [0.0; 2])
    }

    /// Returns an easel that frames all these curves, or the box with the `given` corners, with the view `asked`, in a
    /// part of the picture: width and height in pixels, with its upper left corner at `origin`.
    pub(super) fn within(
        shown: &[&Curve],
        asked: View,
        ([width, height], given): ([u32; 2], Option<[[f64; 3]; 8]>),
        origin: [f64; 2],
    ) -> Self {
        let mut easel = Self {
            camera: Camera::framing(&View::default(), &[], width, height),
            graph: [0.0, 1.0],
            aspect: f64::from(width) / f64::from(height),
            origin,
        };
        if shown.iter().any(|curve| curve.dimension == 1) {
            let values = || shown.iter().flat_map(|curve| curve.points.iter().copied());
            let [low, high] = given.map_or_else(|| ends(values()), |corners| [corners[0][1], corners[7][1]]);
            let half = 0.5 * high - 0.5 * low;
            let flat = half <= FLAT_SHARE * low.abs().max(high.abs());
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

    /// Returns the coordinates at the left, right, bottom and top of a part of the picture: of plane curves, or, if
    /// `steps` is given, of functions from 0 to `steps`.
    pub(super) fn ranges(&self, [left, top, width, height]: PixelRect, steps: Option<f64>) -> [f64; 4] {
        let [left, top, width, height] = [left, top, width, height].map(f64::from);
        let at = |x: f64, y: f64| self.camera.unplaced([x - self.origin[0], y - self.origin[1]]);
        let ([x0, y0, _], [x1, y1, _]) = (at(left, top + height), at(left + width, top));
        let Some(steps) = steps else { return [x0, x1, y0, y1] };
        let number = |y: f64| y / self.graph[1] + self.graph[0];
        [x0 / self.aspect * steps, x1 / self.aspect * steps, number(y0), number(y1)]
    }

    /// Returns the number of pixels per model unit at the start of a curve.
    pub(super) fn unit_px(&self, curve: &Curve) -> Option<f64> {
        if curve.is_empty() { None } else { self.camera.unit_px(self.lifted(curve, 0)) }
    }

    /// Returns the position of a point in the picture in pixels, unless the point is out of it.
    pub(super) fn place(&self, point: [f64; 3]) -> Option<[f64; 2]> {
        self.camera.place(point).map(|[x, y]| [x + self.origin[0], y + self.origin[1]])
    }

    /// Returns the part of a segment in front of the camera, pixels.
    pub(super) fn segment(&self, a: [f64; 3], b: [f64; 3]) -> Option<[[f64; 2]; 2]> {
        self.camera.segment(a, b).map(|ends| ends.map(|[x, y]| [x + self.origin[0], y + self.origin[1]]))
    }

    /// Returns point `i` of a curve in space: functions become graphs over the unit interval, plane curves lie at z =
    /// 0.
    pub(super) fn lifted(&self, curve: &Curve, i: usize) -> [f64; 3] {
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

    /// Returns point `i` in space and its pixel coordinates, unless it is out of the picture.
    fn spot(&self, curve: &Curve, i: usize) -> ([f64; 3], Option<[f64; 2]>) {
        let point = self.lifted(curve, i);
        (point, self.place(point))
    }

    /// Returns the curves as polylines.
    pub(super) fn runs<'c>(
        &self,
        curves: impl IntoIterator<Item = &'c Curve>,
        watch: &Watch,
    ) -> Result<Vec<PolylinePoints>, FormatError> {
        let mut pen = Pen::default();
        for curve in curves {
            let n = curve.len();
            // A function on a closed polygon is drawn over one period, and not joined to its start.
            let joined = curve.closed && curve.dimension > 1;
            let segments = if joined && n > 2 { n } else { n.saturating_sub(1) };
            let mut from = (n > 0).then(|| self.spot(curve, 0));
            for i in 0..segments {
                if i % ROWS_PER_CHUNK == 0 {
                    watch.check()?;
                }
                let to = self.spot(curve, (i + 1) % n);
                let ends = match (from, to) {
                    (Some((_, Some(a))), (_, Some(b))) => Some([a, b]),
                    (Some((a, _)), (b, _)) => self.segment(a, b),
                    (None, _) => None,
                };
                pen.draw(ends, i + 1 == segments);
                from = Some(to);
            }
            pen.lift();
        }
        Ok(pen.runs)
    }

    /// Returns a closed curve as the outline of an area.
    pub(super) fn outline(&self, curve: &Curve, watch: &Watch) -> Result<PolylinePoints, FormatError> {
        let mut outline: PolylinePoints = Vec::new();
        let mut kept = [f64::INFINITY; 2];
        for i in 0..curve.len() {
            if i % ROWS_PER_CHUNK == 0 {
                watch.check()?;
            }
            let (_, Some(place)) = self.spot(curve, i) else { continue };
            let (dx, dy) = (place[0] - kept[0], place[1] - kept[1]);
            if dx * dx + dy * dy > FINEST_PX * FINEST_PX {
                outline.push(place.map(|x| x as f32));
                kept = place;
            }
        }
        Ok(outline)
    }

    pub(super) fn centres(&self, curves: &[Curve], watch: &Watch) -> Result<Vec<Point>, FormatError> {
        let mut centres: Vec<Point> = Vec::new();
        for curve in curves {
            for i in 0..curve.len() {
                if i % ROWS_PER_CHUNK == 0 {
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

/// Returns the smallest and the largest value; zeros if there is none.
fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let found = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    if found[0] <= found[1] { found } else { [0.0; 2] }
}

/// Returns the lower and the upper corner of the bounding box in the plane.
fn corners(points: impl Iterator<Item = [f64; 3]>) -> Vec<[f64; 3]> {
    let none = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let (low, high) =
        points.fold(none, |(a, b), p| ([a[0].min(p[0]), a[1].min(p[1])], [b[0].max(p[0]), b[1].max(p[1])]));
    if low[0] <= high[0] { vec![[low[0], low[1], 0.0], [high[0], high[1], 0.0]] } else { Vec::new() }
}

/// Joins segments to polylines and leaves out steps too small to see.
#[derive(Default)]
struct Pen {
    runs: Vec<PolylinePoints>,
    run: PolylinePoints,
    /// The end of the last segment; the run may end a little before it.
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
        if self.run.len() >= MAX_POLYLINE_POINTS {
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
