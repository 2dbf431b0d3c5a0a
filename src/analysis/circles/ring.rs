//! Rings of tubes: regular polygons in space, star-shaped ones included.

use crate::math::functions::{atan2, cos, real, sin};
use crate::math::vector::{Vector, cross, dot, length, plus, times};

/// By how much of its size a ring may miss a regular polygon, as coordinates with a few decimals do.
/// Five decimals of a ring of size 1 miss by up to 1e-5. Half of it refuses such files; twice of it tells circles of
/// rings that miss one by as much more, which `irregularity` reports.
const IRREGULARITY: f64 = 1e-5;
/// What rounding leaves of numbers that are equal.
/// It is far above the spacing of numbers, 2e-16, and far below differences that are meant, so that half and twice of
/// it decide alike.
pub(super) const ROUNDING: f64 = 1e-9;
/// By how much of its distance from the origin a ring may miss one, as rounded coordinates do.
/// It is 45 times the spacing of numbers at that distance. Half of it still covers a few roundings; twice of it admits
/// rings that are more crooked by 1e-14 of their distance, and only where that exceeds [`IRREGULARITY`] of their size.
const FAR: f64 = 1e-14;

/// A ring of a tube: a regular polygon.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ring {
    pub(super) centre: Vector,
    /// Unit vector along the axis, around which the vertices turn counter-clockwise; `None` for a ring without extent.
    pub(super) axis: Option<Vector>,
    /// How often its vertices go round the axis: 1, or more for a star.
    pub(super) winding: f64,
    /// From the centre to the vertex that the tube counts from.
    pub(super) first: Vector,
    /// Greatest distance of a vertex from its place in the regular polygon.
    pub(super) irregularity: f64,
}

impl Ring {
    /// The regular polygon of these points; `None` where they are none.
    pub(super) fn of(points: &[Vector]) -> Option<Self> {
        let n = points.len();
        let inverse = 1.0 / real(n);
        let centre = points.iter().fold([0.0; 3], |sum, p| plus(sum, times(inverse, *p)));
        let arms: Vec<Vector> = points.iter().map(|p| plus(*p, times(-1.0, centre))).collect();
        let far = points.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        let radius = arms.iter().map(|arm| length(*arm)).fold(0.0, f64::max);
        if radius <= ROUNDING * far {
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
            if !missed.is_finite() || missed > IRREGULARITY * radius + FAR * far {
                return None;
            }
            irregularity = irregularity.max(missed);
        }
        Some(Self { centre, axis: Some(axis), winding, first: arms[0], irregularity })
    }
}

/// By how much another ring misses the axis of the first, model units.
pub(super) fn tilt(ring: &Ring, other: &Ring) -> Result<f64, String> {
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
    if off > IRREGULARITY * radius.max(length(apart)) || turned > IRREGULARITY {
        return Err("the ring has another axis".into());
    }
    Ok(off + turned * radius)
}
