//! Curvature combs and tangents of curves.

use super::easel::Easel;
use crate::drawing::PolylinePoints;
use crate::math::vector::{Vector, cross, dot, length, minus, times, unit};
use crate::output::error::FormatError;
use crate::output::scene::{Curve, ROWS_PER_CHUNK};
use crate::watch::Watch;

/// Length of a tooth that 95 % of the points do not exceed, as a share of the smaller side of the visible part. Twice
/// of it leaves the picture; half of it hides small wiggles.
const TOOTH_LENGTH: f64 = 0.12;
/// Longest tooth in units of that length: curvature at corners is unbounded, and would lead out of the picture. Half of
/// it cuts teeth that differ little from usual ones; twice of it lets single teeth hide the others.
const LONGEST_TOOTH: f64 = 3.0;
/// Minimum distance between teeth, pixels; half of it makes an area of them.
const SPACING_PX: f64 = 4.0;
/// Radius from which on a curve counts as straight, in smaller sides of the visible part, as on meshes: across the
/// picture, a curve of this radius is 1/8,000 of the side off its chord. Half of it hides bends twice as large; without
/// it, rounding would set the scale of the teeth of a straight curve.
const STRAIGHT_RADIUS: f64 = 1e3;
/// Distance of a point from the line through its neighbours that rounding makes, in units in the last place of the
/// largest coordinate. Measured on straight lines under nine plans, at 6 and 10 levels: 1.4 at most. Half of it would
/// leave little above that; twice of it would hide bends twice as large.
const COLLINEAR_ULPS: f64 = 4.0;
/// Length of a tangent, as a share of the smaller side of the visible part. A matter of taste: half of it hardly shows
/// a direction; twice of it crosses the curve elsewhere.
const TANGENT_LENGTH: f64 = 0.14;

/// The teeth of combs, each from the curve to its end, and the lines that join the ends.
pub(super) struct Comb {
    pub(super) teeth: Vec<PolylinePoints>,
    pub(super) ends: Vec<PolylinePoints>,
}

/// Returns the curvature combs of curves in the plane or in space: a point with curvature k and unit normal n towards
/// the centre of curvature has a tooth along `-k n`. All teeth have one scale, at which 95 % of the points have teeth
/// of at most [`TOOTH_LENGTH`]; `scale` multiplies it.
///
/// The curvature at a point is that of the circle through it and both its neighbours.
pub(super) fn combs(
    easel: &Easel,
    curves: &[Curve],
    scale: f64,
    side_px: f64,
    watch: &Watch,
) -> Result<Comb, FormatError> {
    let mut comb = Comb { teeth: Vec::new(), ends: Vec::new() };
    let Some(unit_px) = curves.iter().find_map(|curve| easel.unit_px(curve)) else { return Ok(comb) };
    let mut bends = Vec::with_capacity(curves.len());
    for curve in curves {
        watch.check()?;
        bends.push(bendings(curve, unit_px, 1.0 / (STRAIGHT_RADIUS * side_px)));
    }
    let mut sizes: Vec<f64> =
        bends.iter().flatten().map(|bend| dot(*bend, *bend).sqrt()).filter(|k| *k > 0.0).collect();
    sizes.sort_by(f64::total_cmp);
    let usual = sizes.get(sizes.len().saturating_sub(1) * 19 / 20).copied().unwrap_or(0.0);
    if usual == 0.0 {
        return Ok(comb);
    }
    let longest = LONGEST_TOOTH * usual;
    let stretch = scale * TOOTH_LENGTH * side_px / unit_px / usual;
    for (curve, bends) in curves.iter().zip(&bends) {
        let end = |i: usize, bend: &Vector| {
            let size = dot(*bend, *bend).sqrt();
            let shown = if size > longest { times(longest / size, *bend) } else { *bend };
            minus(easel.lifted(curve, i), times(stretch, shown))
        };
        let (mut last, mut ends) = (None::<[f64; 2]>, Vec::new());
        for (i, bend) in bends.iter().enumerate() {
            if i % ROWS_PER_CHUNK == 0 {
                watch.check()?;
            }
            let (foot, tip) = (easel.place(easel.lifted(curve, i)), easel.place(end(i, bend)));
            let (Some(foot), Some(tip)) = (foot, tip) else { continue };
            ends.push(short(tip));
            let far = last.is_none_or(|last| length(minus(foot, last)) >= SPACING_PX);
            if far && bend.iter().any(|x| x.abs() > 0.0) {
                comb.teeth.push(vec![short(foot), short(tip)]);
                last = Some(foot);
            }
        }
        ends.dedup();
        if let (true, Some(first)) = (curve.closed, ends.first().copied()) {
            ends.push(first);
        }
        comb.ends.extend(Some(ends).filter(|ends| ends.len() > 1));
    }
    Ok(comb)
}

/// Returns at each point the curvature of the curve enlarged by `scale`, times the unit normal towards the centre of
/// curvature; 0 at ends, where points coincide, and where the curvature is below `least` or is no larger than what
/// rounding of the coordinates makes of a straight line, `2 e / h^2` for errors `e` and distances `h` of the points.
fn bendings(curve: &Curve, scale: f64, least: f64) -> Vec<Vector> {
    let n = curve.len();
    let coordinate = |i: usize, k: usize| if k < curve.dimension { curve.points[i * curve.dimension + k] } else { 0.0 };
    let at = |i: usize| -> Vector { std::array::from_fn(|k| scale * coordinate(i, k)) };
    let largest = curve.points.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let error = COLLINEAR_ULPS * f64::EPSILON * scale * largest;
    let bend = |i: usize| {
        let inner = curve.closed || (i > 0 && i + 1 < n);
        if n < 3 || !inner {
            return [0.0; 3];
        }
        let [a, b, c] = [at((i + n - 1) % n), at(i), at((i + 1) % n)];
        let (u, v, w) = (minus(b, a), minus(c, b), minus(c, a));
        let axis = cross(u, v);
        let sides = (dot(u, u) * dot(v, v) * dot(w, w)).sqrt();
        let size = 2.0 * dot(axis, axis).sqrt() / sides;
        let rounding = 2.0 * error / dot(u, u).min(dot(v, v));
        if !(size > least.max(rounding) && size.is_finite()) {
            return [0.0; 3];
        }
        // across the chord, towards the side to which the curve turns
        times(size, unit(cross(axis, w)))
    };
    (0..n).map(bend).collect()
}

/// Returns tangents at about as many points of each curve as its control polygon has, evenly among the points of the
/// curve, each centred on its point. A tangent has the direction from the point before to the point after.
pub(super) fn tangents(
    easel: &Easel,
    curves: &[Curve],
    control: &[Curve],
    side_px: f64,
    watch: &Watch,
) -> Result<Vec<PolylinePoints>, FormatError> {
    let mut found = Vec::new();
    for (curve, control) in curves.iter().zip(control) {
        watch.check()?;
        let (n, wanted) = (curve.len(), control.len());
        let step = (n / wanted.max(1)).max(1);
        for i in (0..n).step_by(step) {
            let (before, after) =
                if curve.closed { ((i + n - 1) % n, (i + 1) % n) } else { (i.max(1) - 1, (i + 1).min(n - 1)) };
            let ends = [before, i, after].map(|k| easel.place(easel.lifted(curve, k)));
            let [Some(a), Some(p), Some(b)] = ends else { continue };
            let size = length(minus(b, a));
            if size > 0.0 {
                let half = 0.5 * TANGENT_LENGTH * side_px / size;
                let way = [half * (b[0] - a[0]), half * (b[1] - a[1])];
                found.push(vec![short([p[0] - way[0], p[1] - way[1]]), short([p[0] + way[0], p[1] + way[1]])]);
            }
        }
    }
    Ok(found)
}

#[expect(clippy::cast_possible_truncation, reason = "pixel coordinates need no more than the precision of f32")]
fn short(place: [f64; 2]) -> [f32; 2] {
    place.map(|x| x as f32)
}
