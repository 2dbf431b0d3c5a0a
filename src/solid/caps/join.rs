//! Patches of bidegree 5 with common tangent planes along the spokes of a vertex: unfitted caps and their free
//! parameters. Sources: J. Peters, CAGD 8 (1991); T. Hermann, J. Peters, T. Strotman, Computers and Graphics 35 (2011).

use super::bezier::{BezierNet, differences, raised};
use super::characteristic::{subdominant, turn_cos, turn_sin};
use super::rings::Rings;
use crate::math::functions::{cos, real, sqrt};
use crate::math::vector::{minus, plus, times};

/// Number of free coefficients of one sector, which can be changed without breaking the joins: the middle point of its
/// first spoke, the middle point of the ribbon across it, and the coefficients (2, 2), (3, 2), (2, 3) and (3, 3).
pub(super) const FREE_COEFFICIENTS: usize = 6;

/// The free parameters of a sector.
pub(super) type Free<const D: usize> = [[f64; D]; FREE_COEFFICIENTS];

/// The patch of one sector.
pub(super) type SectorPatch<const D: usize> = BezierNet<D, 6>;

/// Returns the limit point of the vertex: `(N^2 V + 4 sum e + sum f) / (N (N + 5))`.
pub(super) fn limit<const D: usize>(rings: &Rings<D>) -> [f64; D] {
    let n = rings.valence();
    let mut sum = times(real(n * n), rings.centre);
    for s in 0..n {
        sum = plus(sum, plus(times(4.0, rings.at(s, [1, 0])), rings.at(s, [1, 1])));
    }
    times(1.0 / real(n * (n + 5)), sum)
}

/// Returns the two tangents of the limit surface at the vertex, which are the unit vectors on the characteristic net.
/// Source: M. Halstead, M. Kass, T. DeRose, SIGGRAPH 1993, 35-44.
pub(super) fn tangents<const D: usize>(rings: &Rings<D>) -> [[f64; D]; 2] {
    let n = rings.valence();
    let c = turn_cos(1, n);
    let a = 1.0 + c + cos(std::f64::consts::PI / real(n)) * sqrt(2.0 * (9.0 + c));
    let unit = real(n) / 2.0 * (a + 2.0 * (1.0 + c) / (4.0 * subdominant(n) - 1.0));
    [turn_cos, turn_sin].map(|wave: fn(usize, usize) -> f64| {
        let mut sum = [0.0; D];
        for s in 0..n {
            sum = plus(sum, times(a * wave(s, n), rings.at(s, [1, 0])));
            sum = plus(sum, times(wave(s, n) + wave(s + 1, n), rings.at(s, [1, 1])));
        }
        times(1.0 / unit, sum)
    })
}

/// The spokes as quartic curves, with their first and second derivatives at the vertex.
struct Spokes<const D: usize> {
    curves: Vec<[[f64; D]; 5]>,
    slopes: Vec<[f64; D]>,
    bends: Vec<[f64; D]>,
}

fn spokes<const D: usize>(rings: &Rings<D>, outside: &[BezierNet<D, 4>], sigma: f64, free: &[Free<D>]) -> Spokes<D> {
    let n = rings.valence();
    let (limit, [first, second]) = (limit(rings), tangents(rings));
    let mut curves: Vec<[[f64; D]; 5]> = (0..n)
        .map(|s| {
            let [_, b1, b2, b3] = outside[s].0.map(|row| row[0]);
            let along = plus(times(turn_cos(s, n), first), times(turn_sin(s, n), second));
            let middle = plus(times(0.5, plus(b1, b2)), free[s][0]);
            [limit, plus(limit, times(sigma, along)), middle, plus(times(0.75, b2), times(0.25, b3)), b3]
        })
        .collect();
    if n.is_multiple_of(2) && n != 4 {
        let signed = |s: usize, x: [f64; D]| if s.is_multiple_of(2) { x } else { times(-1.0, x) };
        let sum = (0..n).fold([0.0; D], |sum, s| plus(sum, signed(s, curves[s][2])));
        let mean = times(1.0 / real(n), sum);
        curves.iter_mut().enumerate().for_each(|(s, curve)| curve[2] = minus(curve[2], signed(s, mean)));
    }
    let slopes = curves.iter().map(|curve| times(4.0, minus(curve[1], curve[0]))).collect();
    let bend = |curve: &[[f64; D]; 5]| {
        times(12.0, plus(minus(curve[2], times(2.0, curve[1])), curve[0])) //
    };
    let bends = curves.iter().map(bend).collect();
    Spokes { curves, slopes, bends }
}

/// Returns the twists of the patches at the vertex: those that the net suggests, with the smallest correction that
/// makes the twists of neighbours add up as the join requires.
fn twists<const D: usize>(rings: &Rings<D>, spokes: &Spokes<D>) -> Vec<[f64; D]> {
    let n = rings.valence();
    let (c, limit) = (turn_cos(1, n), limit(rings));
    let suggested = |s: usize| {
        let near = plus(rings.at(s, [1, 0]), rings.at(s, [0, 1]));
        let sum = plus(plus(times(real(n), rings.centre), times(2.0, near)), rings.at(s, [1, 1]));
        let across = minus(times(1.0 / real(n + 5), sum), limit);
        minus(times(9.0, across), times(3.0, plus(spokes.slopes[s], spokes.slopes[(s + 1) % n])))
    };
    let start: Vec<[f64; D]> = (0..n).map(suggested).collect();
    let missing: Vec<[f64; D]> = (0..n)
        .map(|s| {
            let asked = plus(times(-4.0 * c, spokes.slopes[s]), times(2.0 * c, spokes.bends[s]));
            minus(asked, plus(start[s], start[(s + n - 1) % n]))
        })
        .collect();
    let corrected = |s: usize| (0..n).fold(start[s], |t, k| plus(t, times(share(k, n), missing[(s + n - k) % n])));
    (0..n).map(corrected).collect()
}

/// Returns the weight `share(k)` in the shortest solution x of `x_s + x_(s-1) = b_s`, the sum of `share(k) b_(s-k)`;
/// for even n it exists only if b has no alternating part.
fn share(k: usize, n: usize) -> f64 {
    let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    if n.is_multiple_of(2) { sign * (real(n) - 1.0 - 2.0 * real(k)) / real(2 * n) } else { sign / 2.0 }
}

/// Returns the cross derivatives along spoke s of the patches before and behind it, without the part along the spoke,
/// in degree 5.
fn ribbon<const D: usize>(
    s: usize,
    outside: &[BezierNet<D, 4>],
    spokes: &Spokes<D>,
    twists: &[[f64; D]],
) -> [[f64; D]; 6] {
    let n = outside.len();
    let (own, before) = (&outside[s].0, &outside[(s + n - 1) % n].0);
    let exact = |k: usize| times(1.5, minus(minus(own[k][1], own[k][0]), minus(before[1][k], before[0][k])));
    let at = times(0.5, minus(spokes.slopes[(s + 1) % n], spokes.slopes[(s + n - 1) % n]));
    let slope = times(1.0 / 8.0, minus(twists[s], twists[(s + n - 1) % n]));
    let near_end = plus(times(0.75, exact(2)), times(0.25, exact(3)));
    raised(&[at, plus(at, slope), times(0.5, plus(exact(1), exact(2))), near_end, exact(3)])
}

/// Returns the part of the cross derivative that both patches at a spoke share: `c (1 - u)^2` times the derivative
/// along it.
fn shared<const D: usize>(spoke: &[[f64; D]; 5], c: f64) -> [[f64; D]; 6] {
    let steps = differences(spoke);
    let weights = [1.0, 3.0 / 5.0, 3.0 / 10.0, 1.0 / 10.0];
    std::array::from_fn(|k| steps.get(k).map_or([0.0; D], |step| times(4.0 * c * weights[k], *step)))
}

/// Returns the patches around a vertex, one per sector, that continue the surface outside with one derivative and
/// satisfy `p_v + q_u = 2 cos(2 pi / N) (1 - u)^2 p_u` along spoke s for any free parameters; they are linear in the
/// net and in the free parameters. `sigma` is the length of the first leg of a spoke whose tangent has length 1.
pub(super) fn join<const D: usize>(rings: &Rings<D>, sigma: f64, free: &[Free<D>]) -> Vec<SectorPatch<D>> {
    let n = rings.valence();
    let outside: Vec<BezierNet<D, 4>> = (0..n).map(|s| rings.outside(s)).collect();
    let spokes = spokes(rings, &outside, sigma, free);
    let twists = twists(rings, &spokes);
    let c = turn_cos(1, n);
    let ribbons: Vec<[[[f64; D]; 6]; 2]> = (0..n)
        .map(|s| {
            let mut own = ribbon(s, &outside, &spokes, &twists);
            let middle: [[f64; D]; 6] = raised(&[[0.0; D], [0.0; D], free[s][1], [0.0; D], [0.0; D]]);
            own.iter_mut().zip(middle).for_each(|(own, middle)| *own = plus(*own, middle));
            let both = shared(&spokes.curves[s], c);
            [std::array::from_fn(|k| plus(both[k], own[k])), std::array::from_fn(|k| minus(both[k], own[k]))]
        })
        .collect();
    let curves: Vec<[[f64; D]; 6]> = spokes.curves.iter().map(raised).collect();
    (0..n)
        .map(|s| {
            let next = (s + 1) % n;
            sector(&outside[s].raised(), [&curves[s], &curves[next]], [&ribbons[s][0], &ribbons[next][1]], &free[s])
        })
        .collect()
}

/// Returns one patch from the surface outside, its two spokes, the cross derivatives along them, and the free
/// parameters.
fn sector<const D: usize>(
    outside: &SectorPatch<D>,
    [low, left]: [&[[f64; D]; 6]; 2],
    [up, right]: [&[[f64; D]; 6]; 2],
    free: &Free<D>,
) -> SectorPatch<D> {
    let mut p = outside.0;
    for k in 0..4 {
        p[1][k] = plus(left[k], times(0.2, right[k]));
        p[k][1] = plus(low[k], times(0.2, up[k]));
    }
    for k in 0..6 {
        p[0][k] = left[k];
        p[k][0] = low[k];
    }
    let sides = plus(plus(p[1][2], p[3][2]), plus(p[2][1], p[2][3]));
    let corners = plus(plus(p[1][1], p[1][3]), plus(p[3][1], p[3][3]));
    p[2][2] = plus(minus(times(0.5, sides), times(0.25, corners)), free[2]);
    p[3][2] = plus(p[3][2], free[3]);
    p[2][3] = plus(p[2][3], free[4]);
    p[3][3] = plus(p[3][3], free[5]);
    BezierNet(p)
}

/// Returns the length of the first leg of spokes whose tangents have length 1: the leg for which the spokes of the
/// characteristic net would be cubic, times [`LEG_FACTORS`].
pub(super) fn first_leg(characteristic: &Rings<2>) -> f64 {
    let [_, x1, x2, x3] = characteristic.outside(0).0.map(|row| row[0][0]);
    let cubic = (3.0 * (x1 + x2) - (3.0 * x2 + x3) + x3) / 4.0;
    cubic * LEG_FACTORS[characteristic.valence()]
}

/// Factors of the first leg by valence, from 0 to 32, for which fitted caps of random vertices deviate least, found in
/// steps of 0.02. At 0.1 more or less, deviations are two to five times as large.
const LEG_FACTORS: [f64; 33] = [
    1.0, 1.0, 1.0, 1.0, 1.0, 0.9, 0.81, 0.72, 0.66, 0.6, 0.55, 0.51, 0.48, 0.44, 0.42, 0.4, 0.37, 0.35, 0.34, 0.32,
    0.3, 0.29, 0.28, 0.27, 0.26, 0.25, 0.24, 0.23, 0.22, 0.22, 0.21, 0.2, 0.2,
];
