//! Decides whether the limit of a cycle is continuous and smooth on regular nets.
//!
//! An impulse on a regular net is refined, and its differences are compared at two levels. If they do not clearly
//! shrink between these, they may still do so later or grow elsewhere. Then differences are followed through many more
//! levels at the places that one or two levels map to themselves: vertices and, where edges are halved, thirds of edges
//! and faces. Differences that do not vanish there do not vanish; the converse is not proved, but on all plans that
//! were tried, products of the matrices of other places grew no faster.

use super::bounds::MAX_LEVEL_POINTS;
use super::cycle::made;
use super::disc::{Centre, RingCount};
use super::error::Unlimited;
use super::leading::starting_vectors;
use super::on_net::CycleOnNet;
use super::vertex_parameters::{CommonParameters, VertexParameters};
use super::walk::WholeNet;
use crate::math::functions::{exp, ln, real};
use crate::math::vector::minus;
use crate::refine::{Points, RefineError};
use crate::scheme::mesh_net::MeshNet;
use crate::shape::topology::{Topology, index};
use crate::watch::{Stopped, Watch};

/// Pairs of levels of the impulse whose differences are compared; the first pair that does not take too many points is
/// used.
/// With half of these levels more differences have not shrunk yet and are followed at places, which costs time; twice
/// of them, 4 and 8, make 256 times as many points where edges are halved, more than are allowed.
const COMPARED_LEVELS: [[usize; 2]; 4] = [[2, 4], [1, 3], [1, 2], [0, 1]];
/// The first and the last level at which differences at a place are compared with those at half that level. The last is
/// so high that the product of a power of the level and a decaying factor is seen to shrink.
/// With half of the first, differences are judged while they may still grow or shrink otherwise than later; with twice
/// of it, clear ones are followed for twice as long. Differences that grow like the square of the level times `b^level`
/// vanish up to b = 0.989 by the last; half of it ends at 0.978, and twice of it, at 0.994, takes twice as long.
const PLACE_LEVELS: [usize; 2] = [16, 256];
/// Differences that grow by this factor while the level doubles grow faster than a power of the level, and diverge;
/// those that shrink by it vanish. Between the two, they are compared again at twice the level.
/// Linear growth doubles as the level does, and quadratic growth is fourfold, so that 8 excludes both. Half of it calls
/// quadratic growth divergent; twice of it compares factors between 8 and 16 again at twice the level.
const DIVERGING_FACTOR: f64 = 8.0;
/// Maximum number of points that are made around all places together.
/// At some hundred nanoseconds a point they take less than a second. With half of it wide cycles are decided by the
/// impulse alone sooner; with twice of it that takes up to twice as long.
const MAX_PLACE_POINTS: usize = 1 << 22;
/// Differences that shrink to this share between the two levels of the impulse vanish.
/// Bilinear refinement halves its differences in one level, and most schemes do so within the levels compared. Half of
/// it follows more differences at places, which costs time; twice of it would accept differences that do not change.
const VANISHING_SHARE: f64 = 0.5;
/// Differences that do not shrink to this share do not vanish.
/// With 1, a decrease by rounding would count. At 0.96, twice as far from 1, schemes whose differences shrink by 3 in
/// 100 are refused; at 0.99, half as far, a decrease by 1 in 100 counts, still far above rounding.
const SHRINKING_SHARE: f64 = 0.98;

/// The smoothness of a scheme on regular nets, as an impulse shows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ImpulseSmoothness {
    /// The differences of an impulse do not vanish: there is no continuous limit.
    Rough,
    /// The differences of an impulse vanish, the divided second differences do not.
    Continuous,
    /// The divided second differences of an impulse vanish: the limit has a continuous tangent.
    Smooth,
}

/// A cycle on regular nets whose vertices all carry the same parameters, which is applied with its settled values.
#[derive(Debug, Clone, Copy)]
pub(super) struct Impulse<'a> {
    /// The cycle, with the kind of net on which it is regular.
    pub(super) on_net: &'a CycleOnNet<'a>,
    /// The parameters that all vertices carry.
    pub(super) common: CommonParameters,
    /// Number of rings whose vertices influence a limit.
    pub(super) support: usize,
}

/// A net and its points: places in the plane, with the refined impulse as height.
struct ImpulseNet {
    net: MeshNet,
    points: Points,
}

impl Impulse<'_> {
    /// Refines an impulse and returns the smoothness that its differences show. Without `tangents`, a continuous limit
    /// counts as smooth.
    ///
    /// # Errors
    /// [`Unlimited`], for instance [`Unlimited::Fine`] if all pairs of levels take too many points.
    pub(super) fn smoothness(&self, tangents: bool, watch: &Watch) -> Result<ImpulseSmoothness, Unlimited> {
        let side = side(self.support, self.on_net.cycle.n_duals());
        let mut impulse_net = self.on(self.on_net.regular.net(side, self.on_net.tagged), side);
        let (levels, _) = compared(side, &self.on_net.cycle.pieces()).ok_or(Unlimited::Fine)?;
        let mut seen = Vec::new();
        for level in 0..=levels[1] {
            if level > 0 {
                watch.check()?;
                impulse_net = self.refined(impulse_net)?;
            }
            if levels.contains(&level) {
                seen.push(Differences::of(&impulse_net.net.mesh.topology(), &impulse_net.points.now));
            }
        }
        let vanish = |measure: DifferenceKind| -> Result<bool, Unlimited> {
            let [early, late] = [0, 1].map(|i| measure.of(&seen[i]));
            Ok(late <= VANISHING_SHARE * early
                || self.vanish_at_places(measure, watch)?.unwrap_or(late <= SHRINKING_SHARE * early))
        };
        Ok(if !vanish(DifferenceKind::First)? {
            ImpulseSmoothness::Rough
        } else if tangents && !vanish(DifferenceKind::DividedSecond)? {
            ImpulseSmoothness::Continuous
        } else {
            ImpulseSmoothness::Smooth
        })
    }

    /// Returns an impulse in the middle of a regular net of `side x side` squares.
    fn on(&self, net: MeshNet, side: usize) -> ImpulseNet {
        let all: Vec<u32> = (0..index(net.mesh.n_vertices())).collect();
        let net = self.common.of_all(all.len()).carried_by(net, &all);
        let middle = (side / 2) * (side + 1) + side / 2;
        let place = |v: usize| [index(v % (side + 1)), index(v / (side + 1)), u32::from(v == middle)].map(f64::from);
        ImpulseNet { points: Points::new((0..net.mesh.n_vertices()).flat_map(place).collect(), 3), net }
    }

    /// Refines by one level with settled values.
    fn refined(&self, ImpulseNet { net, mut points }: ImpulseNet) -> Result<ImpulseNet, Unlimited> {
        // forecasts do not count this work
        let uncounted = Watch::new();
        let net = self.on_net.cycle.applied(net, |action, step| {
            points.act(action, step.level, &uncounted).map_err(|error| match error {
                RefineError::Stopped(Stopped) => Unlimited::Stopped(Stopped),
                _ => Unlimited::Unsettled,
            })
        })?;
        Ok(ImpulseNet { net, points })
    }

    /// Returns whether differences vanish at all places that the cycle maps to themselves; `None` if there are too many
    /// points around a place.
    fn vanish_at_places(&self, measure: DifferenceKind, watch: &Watch) -> Result<Option<bool>, Unlimited> {
        let mut budget = MAX_PLACE_POINTS;
        for place in places(self.on_net.cycle.pieces().last().copied().unwrap_or(2)) {
            match self.vanish_at(place, measure, &mut budget, watch)? {
                Some(true) => {}
                other => return Ok(other),
            }
        }
        Ok(Some(true))
    }

    /// Returns whether differences vanish at a place, starting with heights without a pattern. At each level, the
    /// surroundings of the vertex nearest to the place are cut out and rescaled.
    fn vanish_at(
        &self,
        place: RecurrentPlace,
        measure: DifferenceKind,
        budget: &mut usize,
        watch: &Watch,
    ) -> Result<Option<bool>, Unlimited> {
        // so wide that points on the boundary of the disc do not influence the surroundings of a vertex at the next
        // level, even if edges become shorter only by a factor of the square root of 3
        let rings = self.support + self.support / 4 + 5;
        let rings = RingCount { support: rings, disc: rings };
        let side = 2 * (rings.disc + 2);
        let mut impulse_net = self.on(self.on_net.regular.net(side, self.on_net.tagged), side);
        let wild = starting_vectors(impulse_net.net.mesh.n_vertices(), 1).concat();
        impulse_net.points.now.chunks_exact_mut(3).zip(wild).for_each(|(p, z)| p[2] = z);
        let middle = (side / 2) * (side + 1) + side / 2;
        let Some(mut impulse_net) = impulse_net.around(&impulse_net.net.mesh.topology(), middle, rings, [1.0; 2], self)
        else {
            return Ok(None);
        };
        let (mut target, mut sizes, mut compared) = (place.at, vec![0.0], PLACE_LEVELS[0]);
        for level in 1..=PLACE_LEVELS[1] {
            watch.check()?;
            let made = made(impulse_net.net.mesh.n_vertices(), &self.on_net.cycle.pieces(), 1);
            let Some(left) = budget.checked_sub(made) else {
                return Ok((level > PLACE_LEVELS[0]).then_some(false));
            };
            *budget = left;
            impulse_net = self.refined(impulse_net)?;
            let topology = impulse_net.net.mesh.topology();
            let mut largest = Differences::default();
            let mut nearest = (f64::INFINITY, 0);
            for v in 0..topology.n_vertices() {
                let off = [0, 1].map(|k| (impulse_net.points.now[3 * v + k] - target[k]).abs());
                let off = off[0].max(off[1]);
                // within the length of an edge of the level before
                if off <= 1.0 {
                    largest = largest.or(&Differences::at(&topology, &impulse_net.points.now, v));
                }
                if off < nearest.0 {
                    nearest = (off, v);
                }
            }
            let size = measure.of(&largest);
            // the differences are zero, or too large to be followed further
            if size == 0.0 || !size.is_finite() {
                return Ok(Some(size == 0.0));
            }
            sizes.push(sizes[level - 1] + ln(size));
            if level == compared {
                let growth = exp(sizes[level] - sizes[level / 2]);
                let vanishes = growth <= if level < PLACE_LEVELS[1] { 1.0 / DIVERGING_FACTOR } else { SHRINKING_SHARE };
                if vanishes || growth >= DIVERGING_FACTOR {
                    return Ok(Some(vanishes));
                }
                compared *= 2;
            }
            let v = nearest.1;
            target = [0, 1].map(|k| place.rounded((target[k] - impulse_net.points.now[3 * v + k]) / largest.length));
            let Some(next) = impulse_net.around(&topology, v, rings, measure.units(&largest), self) else {
                return Ok(None);
            };
            impulse_net = next;
        }
        Ok(Some(false))
    }
}

/// A place in the plane that one or two levels map to itself, or to the same place relative to another vertex.
#[derive(Debug, Clone, Copy)]
struct RecurrentPlace {
    /// The place relative to a vertex, in edge lengths.
    at: [f64; 2],
    /// The number of parts of an edge: at all levels, coordinates are multiples of `1/parts`, or in duals of half that.
    parts: f64,
}

impl RecurrentPlace {
    /// Returns a coordinate without its rounding error, which would grow at every level.
    fn rounded(&self, x: f64) -> f64 {
        (x * 2.0 * self.parts).round() / (2.0 * self.parts)
    }
}

/// Returns the places that one or two levels map to themselves if they cut edges into `pieces` pieces, without those
/// that are mirror images of others.
fn places(pieces: usize) -> Vec<RecurrentPlace> {
    let mut places = Vec::new();
    for parts in [pieces.saturating_sub(1), pieces + 1] {
        let is_own_mirror = |p: usize| p == 0 || 2 * p == parts;
        for (i, j) in (0..=parts / 2).flat_map(|j| (0..=j).map(move |i| (i, j))) {
            // vertices only once
            let direct = (j > 0 || parts == 1).then_some(j);
            let mirrored = (!is_own_mirror(i) && !is_own_mirror(j)).then_some(parts - j);
            let place = |y: usize| RecurrentPlace { at: [i, y].map(|p| real(p) / real(parts)), parts: real(parts) };
            places.extend(direct.into_iter().chain(mirrored).map(place));
        }
    }
    places
}

/// Returns the number of squares along a side of the net for an impulse that influences limits within `support` rings,
/// under a cycle with `n_duals` D.
pub(super) fn side(support: usize, n_duals: usize) -> usize {
    2 * (support + 1 + n_duals)
}

/// Returns the two levels of an impulse on `side x side` squares whose differences are compared, and the number of
/// points that they take; `None` if that is always too large. `pieces` are the numbers of pieces of an edge after each
/// operator of a level.
pub(super) fn compared(side: usize, pieces: &[usize]) -> Option<([usize; 2], usize)> {
    let found = COMPARED_LEVELS.map(|levels| (levels, made((side + 1) * (side + 1), pieces, levels[1])));
    found.into_iter().find(|&(_, points)| points <= MAX_LEVEL_POINTS)
}

impl ImpulseNet {
    /// Returns the disc around an inner vertex as a net of its own. The vertex is moved to 0, the plane through it and
    /// two neighbours is subtracted from the heights, and lengths and heights are divided by `units`. `None` if the
    /// disc has too many vertices or is no valid mesh, or the vertex has fewer than two neighbours.
    fn around(
        &self,
        topology: &Topology,
        v: usize,
        rings: RingCount,
        units: [f64; 2],
        impulse: &Impulse<'_>,
    ) -> Option<Self> {
        let found = WholeNet::of(&self.net, topology).disc(Centre::Vertex(index(v)), rings)?;
        let (net, origins) = found.disc.net(impulse.on_net.cycle.disc_rules)?;
        let at = |v: u32| [0, 1, 2].map(|k| self.points.now[3 * v as usize + k]);
        let centre = at(index(v));
        let seen = |v: u32| minus(at(v), centre);
        let mut ring = topology.ring(v).map(|half_edge| seen(topology.vertex(topology.next(half_edge))));
        let ([a, b, z], [c, d, w]) = (ring.next()?, ring.next()?);
        let determinant = a * d - b * c;
        let slope = [(z * d - w * b) / determinant, (w * a - z * c) / determinant];
        let [length, size] = units;
        // vertices of a regular net lie at multiples of half an edge; rounding errors would grow at every level
        let whole = |x: f64| (2.0 * x / length).round() / 2.0;
        let scaled = |[x, y, z]: [f64; 3]| [whole(x), whole(y), (z - slope[0] * x - slope[1] * y) / size];
        let points = origins.iter().flat_map(|&origin| scaled(seen(found.vertices[origin as usize]))).collect();
        let net = VertexParameters::of(&self.net, &found.vertices).carried_by(net, &origins);
        Some(Self { net, points: Points::new(points, 3) })
    }
}

/// The kind of differences that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum DifferenceKind {
    First,
    DividedSecond,
}

impl DifferenceKind {
    fn of(self, differences: &Differences) -> f64 {
        match self {
            Self::First => differences.first,
            Self::DividedSecond => differences.second / differences.length,
        }
    }

    /// Returns the units of length and height in which the differences of this kind are 1.
    fn units(self, differences: &Differences) -> [f64; 2] {
        let height = if self == Self::First { differences.first } else { differences.second };
        [differences.length, height]
    }
}

/// The greatest differences of heights, and the greatest edge length, around some vertices.
#[derive(Debug, Clone, Copy, Default)]
struct Differences {
    /// The greatest difference of heights along an edge.
    first: f64,
    /// The greatest second difference of heights over two opposite edges of an inner vertex of even valence.
    second: f64,
    /// The greatest edge length in the plane, by the greater of its two coordinates.
    length: f64,
}

impl Differences {
    /// Returns the differences around a vertex.
    fn at(topology: &Topology, points: &[f64], v: usize) -> Self {
        let at = |v: u32| [0, 1, 2].map(|k| points[3 * v as usize + k]);
        let [x, y, z] = at(index(v));
        let valence = topology.ring(v).count();
        let inside = !topology.is_isolated(v) && topology.boundary_edges(v).is_none() && valence.is_multiple_of(2);
        let around: Vec<[f64; 3]> =
            topology.ring(v).map(|half_edge| at(topology.vertex(topology.next(half_edge)))).collect();
        let mut largest = Self::default();
        for (i, p) in around.iter().enumerate() {
            largest.first = largest.first.max((p[2] - z).abs());
            largest.length = largest.length.max((p[0] - x).abs().max((p[1] - y).abs()));
            if inside {
                let q = around[(i + valence / 2) % valence];
                largest.second = largest.second.max((p[2] - 2.0 * z + q[2]).abs());
            }
        }
        largest
    }

    /// Returns the greatest differences around all vertices.
    fn of(topology: &Topology, points: &[f64]) -> Self {
        (0..topology.n_vertices()).map(|v| Self::at(topology, points, v)).fold(Self::default(), |a, b| a.or(&b))
    }

    /// Returns the maximum of each difference.
    fn or(&self, other: &Self) -> Self {
        Self {
            first: self.first.max(other.first),
            second: self.second.max(other.second),
            length: self.length.max(other.length),
        }
    }
}
