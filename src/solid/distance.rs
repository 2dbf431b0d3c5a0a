//! The distance between caps and the limit surface, sampled at points of both; the limit surface is given by its exact
//! pieces on the next levels.

use super::edges::Edges;
use super::error::SolidError;
use super::level::{Level, Refiner, Spot};
use super::spline::{BSplineSurface, of_cell};
use crate::math::functions::ratio;
use crate::math::vector::{Vector, cross, dot, length, minus};

/// Number of rings of exact pieces around the vertex that are sampled. For valences up to 6 the distance is largest in
/// the first two; half as many would miss that of high valences, twice as many take twice as long.
const SAMPLED_RINGS: usize = 4;
/// Number of points per side of each piece. The distance varies smoothly over a piece, so that a few points come near
/// its largest value: half of it may miss that; twice of it takes four times as long.
const POINTS_A_SIDE: usize = 6;
/// Number of Newton steps towards the foot of a point; each doubles the number of correct digits, starting from one.
const FOOT_NEWTON_STEPS: usize = 6;

/// An exact piece of the limit surface next to a vertex.
struct Piece {
    surface: BSplineSurface,
    ring: usize,
    /// The index of its face among those around the vertex.
    face: usize,
    /// Its first corner in the parameters of its cap, and the length of its sides there.
    from: [f64; 2],
    scale: f64,
}

impl Piece {
    fn place(&self, uv: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| self.from[k] + self.scale * uv[k])
    }
}

/// Returns the largest distance between points of the limit surface and the caps of a sector, one per spoke, in both
/// directions. `level` is that after the caps', and `spot` that of the faces around the vertex.
///
/// # Errors
/// If the watch says stop.
pub(super) fn farthest(
    caps: &[BSplineSurface],
    is_closed: bool,
    next: (Level, Spot),
    refiner: &Refiner<'_>,
    edges: &mut Edges,
) -> Result<f64, SolidError> {
    let pieces = pieces(next, refiner, edges)?;
    let mut farthest = 0.0_f64;
    for (p, piece) in pieces.iter().enumerate() {
        for (i, j) in (0..POINTS_A_SIDE).flat_map(|i| (0..POINTS_A_SIDE).map(move |j| (i, j))) {
            let uv = [i, j].map(|k| ratio(k, POINTS_A_SIDE - 1));
            let there = from_caps(piece.surface.at(uv)[0], caps, piece.face, is_closed, piece.place(uv));
            // off the sides, so that feet nearly always lie on the piece of the same parameters
            let uv = [i, j].map(|k| ratio(2 * k + 1, 2 * POINTS_A_SIDE));
            let back = from_pieces(caps[piece.face].at(piece.place(uv))[0], &pieces, p, (caps.len(), is_closed), uv);
            farthest = farthest.max(there).max(back);
        }
    }
    Ok(farthest)
}

/// Returns the pieces of all rings.
fn pieces(
    (mut level, mut spot): (Level, Spot),
    refiner: &Refiner<'_>,
    edges: &mut Edges,
) -> Result<Vec<Piece>, SolidError> {
    let (mut pieces, mut scale) = (Vec::new(), 0.5);
    for ring in 0..SAMPLED_RINGS {
        if ring > 0 {
            (level, spot) = level.closer(&spot, refiner, edges)?;
            scale *= 0.5;
        }
        for (face, &spoke) in spot.half_edges(&level).iter().enumerate() {
            let [beside, diagonal, before] = level.around(spoke);
            for (half_edge, from) in [(beside, [scale, 0.0]), (diagonal, [scale, scale]), (before, [0.0, scale])] {
                pieces.push(Piece { surface: of_cell(&level.net(half_edge)), ring, face, from, scale });
            }
        }
    }
    Ok(pieces)
}

/// Returns the distance of a point of a cap from the limit surface: from the piece of the same parameters or, if the
/// foot is on a side of that piece, from those around it.
fn from_pieces(point: Vector, pieces: &[Piece], own: usize, (n, is_closed): (usize, bool), uv: [f64; 2]) -> f64 {
    let (distance, foot) = from_cap(point, &pieces[own].surface, uv);
    if foot.iter().all(|&x| 0.0 < x && x < 1.0) {
        return distance;
    }
    let Piece { ring, face, .. } = pieces[own];
    let is_near = |other: &&Piece| {
        let apart = other.face.abs_diff(face);
        other.ring.abs_diff(ring) <= 1 && (apart <= 1 || is_closed && apart + 1 == n)
    };
    let others = pieces.iter().filter(is_near).map(|other| from_cap(point, &other.surface, [0.5; 2]).0);
    others.fold(distance, f64::min)
}

/// Returns the distance of a point from a cap, or from the neighbouring cap if its foot lies beyond a spoke.
fn from_caps(point: Vector, caps: &[BSplineSurface], i: usize, is_closed: bool, [u, v]: [f64; 2]) -> f64 {
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

/// Returns the distance of a point from a surface over the unit square, and the parameters of its foot, by a search
/// from `at`.
fn from_cap(point: Vector, surface: &BSplineSurface, mut at: [f64; 2]) -> (f64, [f64; 2]) {
    let mut least = (f64::INFINITY, at);
    for _ in 0..=FOOT_NEWTON_STEPS {
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
