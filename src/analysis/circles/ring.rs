//! Rings of tubes: regular polygons in space, star-shaped ones included.

use crate::math::functions::{atan2, cos, real, sin};
use crate::math::vector::{Vector, cross, dot, length, plus, times};

/// Largest deviation of a ring from a regular polygon, relative to the radius, as coordinates with a few decimals have
/// it. Five decimals of a ring of size 1 give up to 1e-5. Half of it would refuse such files; twice of it would report
/// circles for rings that deviate twice as much, by an amount that `irregularity` reports.
const MAX_IRREGULARITY: f64 = 1e-5;
/// Largest difference between numbers that are equal up to rounding. It is far above the spacing of numbers, 2e-16, and
/// far below intended differences, so that half or twice of it decides alike.
pub(super) const CIRCLE_ROUNDING: f64 = 1e-9;
/// Largest deviation of a ring from a regular polygon, relative to the greatest coordinate, as rounded coordinates have
/// it. It is 45 times the spacing of numbers of that size. Half of it still covers a few roundings; twice of it admits
/// rings that deviate by 1e-14 of their distance from the origin more, and only if that exceeds [`MAX_IRREGULARITY`] of
/// their size.
const MAX_RING_DEVIATION: f64 = 1e-14;

/// A ring of a tube: a regular polygon.
#[derive(Debug, Clone, Copy)]
pub(super) struct TubeRing {
    pub(super) centre: Vector,
    /// The unit vector along the axis, around which the vertices turn counter-clockwise; `None` for a ring without
    /// extent.
    pub(super) axis: Option<Vector>,
    /// How many times the vertices go around the axis: 1, or more for a star polygon.
    pub(super) winding: f64,
    /// The vector from the centre to the first vertex of the ring.
    pub(super) first: Vector,
    /// The greatest distance of a vertex from the preceding vertex turned by the angle of the polygon; of a ring
    /// without extent, its radius.
    pub(super) irregularity: f64,
}

impl TubeRing {
    /// Returns the regular polygon of these points; `None` if they are not one.
    pub(super) fn of(points: &[Vector]) -> Option<Self> {
        let n = points.len();
        let inverse = 1.0 / real(n);
        let centre = points.iter().fold([0.0; 3], |sum, p| plus(sum, times(inverse, *p)));
        let arms: Vec<Vector> = points.iter().map(|p| plus(*p, times(-1.0, centre))).collect();
        let far = points.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        let radius = arms.iter().map(|arm| length(*arm)).fold(0.0, f64::max);
        if radius <= CIRCLE_ROUNDING * far {
            return Some(Self { centre, axis: None, winding: 1.0, first: [0.0; 3], irregularity: radius });
        }
        let area = (0..n).map(|i| cross(arms[i], arms[(i + 1) % n])).fold([0.0; 3], plus);
        let axis = times(1.0 / length(area), area);
        let first = atan2(dot(axis, cross(arms[0], arms[1])), dot(arms[0], arms[1]));
        let winding = (first * real(n) / std::f64::consts::TAU).round();
        let angle = std::f64::consts::TAU * winding * inverse;
        let (c, s) = (cos(angle), sin(angle));
        let mut irregularity: f64 = 0.0;
        for i in 0..n {
            let turned = plus(times(c, arms[i]), times(s, cross(axis, arms[i])));
            let missed = length(plus(turned, times(-1.0, arms[(i + 1) % n])));
            if !missed.is_finite() || missed > MAX_IRREGULARITY * radius + MAX_RING_DEVIATION * far {
                return None;
            }
            irregularity = irregularity.max(missed);
        }
        Some(Self { centre, axis: Some(axis), winding, first: arms[0], irregularity })
    }
}

/// Returns by how much `other` deviates from the axis of `ring`, model units.
///
/// # Errors
/// A sentence if the rings do not share an axis, an orientation and a winding number.
pub(super) fn tilt(ring: &TubeRing, other: &TubeRing) -> Result<f64, String> {
    let apart = plus(other.centre, times(-1.0, ring.centre));
    let radius = length(ring.first).max(length(other.first));
    let Some(axis) = ring.axis.or(other.axis) else { return Ok(0.0) };
    let turned = match (ring.axis, other.axis) {
        (Some(a), Some(b)) if dot(a, b) < 0.0 => return Err("the ring runs the other way round".into()),
        (Some(_), Some(_)) if ring.winding.to_bits() != other.winding.to_bits() => {
            return Err("the ring goes round the axis another number of times".into());
        }
        (Some(a), Some(b)) => length(cross(a, b)),
        _ => 0.0,
    };
    let off = length(cross(axis, apart));
    if off > MAX_IRREGULARITY * radius.max(length(apart)) || turned > MAX_IRREGULARITY {
        return Err("the ring has another axis".into());
    }
    Ok(off + turned * radius)
}
