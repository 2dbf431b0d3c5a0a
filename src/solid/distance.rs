//! How far caps are from the limit surface, at points of its exact pieces on the next levels.

use super::edges::Edges;
use super::error::SolidError;
use super::level::{Level, Refiner, Spot};
use super::spline::{Surface, of_cell};
use crate::math::functions::ratio;
use crate::math::vector::{Vector, cross, dot, length, minus};

/// Rings of exact pieces around the vertex that are looked at. The distance is largest in the first two for valences to
/// 6; half of them would miss that of high ones, twice takes twice as long.
const RINGS: usize = 4;
/// Points a side of each piece.
const POINTS: usize = 6;
/// Steps of Newton's method towards the foot of a point; each doubles the number of digits from a start that is right
/// to a tenth.
const STEPS: usize = 6;

/// The largest distance of such points from the caps of a sector, one a spoke: those of the faces around the vertex on
/// the next level.
///
/// # Errors
/// When the watch says stop.
pub(super) fn farthest(
    caps: &[Surface],
    is_closed: bool,
    (mut level, mut spot): (Level, Spot),
    refiner: &Refiner<'_>,
    edges: &mut Edges,
) -> Result<f64, SolidError> {
    let (mut farthest, mut scale): (f64, f64) = (0.0, 0.5);
    for ring in 0..RINGS {
        if ring > 0 {
            (level, spot) = level.closer(&spot, refiner, edges)?;
            scale *= 0.5;
        }
        for (i, &spoke) in spot.half_edges(&level).iter().enumerate() {
            let [beside, diagonal, before] = level.around(spoke);
            for (piece, [a, b]) in [(beside, [1.0, 0.0]), (diagonal, [1.0, 1.0]), (before, [0.0, 1.0])] {
                let exact = of_cell(&level.net(piece));
                for (u, v) in (0..POINTS * POINTS).map(|k| (k % POINTS, k / POINTS)) {
                    let [u, v] = [u, v].map(|k| ratio(k, POINTS - 1));
                    let at = [(a + u) * scale, (b + v) * scale];
                    let distance = from_caps(exact.at([u, v])[0], caps, i, is_closed, at);
                    farthest = farthest.max(distance);
                }
            }
        }
    }
    Ok(farthest)
}

/// The distance of a point from a cap, or from its neighbour where its foot lies beyond a spoke.
fn from_caps(point: Vector, caps: &[Surface], i: usize, is_closed: bool, [u, v]: [f64; 2]) -> f64 {
    let n = caps.len();
    let (own, foot) = from_cap(point, &caps[i], [u, v]);
    let neighbour = |beyond: bool, other: Option<usize>, at: [f64; 2]| {
        other.filter(|_| beyond).map_or(own, |other| from_cap(point, &caps[other], at).0)
    };
    let next = if is_closed { Some((i + 1) % n) } else { Some(i + 1).filter(|&i| i < n) };
    let before = if is_closed { Some((i + n - 1) % n) } else { i.checked_sub(1) };
    let on_next = neighbour(foot[0] <= 0.0, next, [v.max(u), 0.0]);
    let on_before = neighbour(foot[1] <= 0.0, before, [0.0, u.max(v)]);
    own.min(on_next).min(on_before)
}

/// The distance of a point from a surface over the unit square, and the parameters of its foot, looked for from `at`
/// on.
fn from_cap(point: Vector, surface: &Surface, mut at: [f64; 2]) -> (f64, [f64; 2]) {
    let mut least = (f64::INFINITY, at);
    for _ in 0..=STEPS {
        let [on, along_u, along_v] = surface.at(at);
        let apart = minus(point, on);
        let distance = length(apart);
        if distance < least.0 {
            least = (distance, at);
        }
        let [a, b, c] = [dot(along_u, along_u), dot(along_u, along_v), dot(along_v, along_v)];
        let [f, g] = [dot(along_u, apart), dot(along_v, apart)];
        let area = cross(along_u, along_v);
        let square = dot(area, area);
        if square <= 0.0 {
            break;
        }
        let step = [(c * f - b * g) / square, (a * g - b * f) / square];
        at = [0, 1].map(|k| (at[k] + step[k]).clamp(0.0, 1.0));
    }
    least
}
