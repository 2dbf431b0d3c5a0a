//! Decides whether the limit of a cycle is continuous and smooth on regular nets.
//!
//! An impulse on a regular net is refined, and its differences are compared at two levels. Where they do not shrink
//! clearly between these, as they may grow at first, or later, or somewhere else, they are followed through many more
//! levels at the places that a level or two carry back to themselves: at vertices, and in thirds of edges and faces
//! where edges are halved. What does not vanish there does not vanish; products of other matrices grew no faster on any
//! plan that was tried.

use super::bounds::MAX_LEVEL_POINTS;
use super::cycle::made;
use super::disc::{Centre, Rings};
use super::error::Unlimited;
use super::on_net::CycleOnNet;
use super::tangent::starting_vectors;
use super::vertex_parameters::{CommonParameters, VertexParameters};
use super::walk::WholeNet;
use crate::math::functions::{exp, ln, real};
use crate::math::vector::minus;
use crate::refine::{Points, RefineError};
use crate::scheme::mesh_net::MeshNet;
use crate::shape::topology::{Topology, index};
use crate::watch::{Stopped, Watch};

/// Levels of the impulse whose differences are compared: the first that do not take too many points.
const LEVELS: [[usize; 2]; 4] = [[2, 4], [1, 3], [1, 2], [0, 1]];
/// The first and the last level at which differences are compared to those of half as many levels where places are
/// followed: so many that what grows by a power of the level, times what shrinks, is seen to shrink.
const PLACE_LEVELS: [usize; 2] = [16, 256];
/// Differences that are so many times as large after as many levels again grow by more than a power of the level; those
/// that are so many times as small vanish. What is between these is looked at again after twice as many.
/// A linear growth doubles over twice as many levels, a quadratic one is 4 times as large, so that 8 keeps both out.
/// Half of it calls quadratic growth divergent; twice of it looks again, at twice the levels, at what is between 8 and
/// 16.
const GROWS: f64 = 8.0;
/// Most points that are made of the surroundings of all places.
/// At some hundred nanoseconds a point it is below a second. With half of it wide cycles fall back on the impulse alone
/// sooner; with twice of it that takes up to twice as long.
const MAX_PLACE_POINTS: usize = 1 << 22;
/// Differences that shrink below this part of what they were between these levels vanish.
/// Bilinear refinement halves its differences in one level, and most schemes do so in the levels compared. Half of it
/// follows more of them at places, which costs time; twice of it would call vanishing what stays as it is.
const VANISHES: f64 = 0.5;
/// Differences that do not shrink below this part of what they were do not vanish.
/// 1 would count what rounding makes smaller as vanishing. At 0.96, twice as far from 1, schemes that shrink by 3 in
/// 100 are refused; at 0.99, half as far, the least that counts is 1 in 100, still far above rounding.
const SHRINKS: f64 = 0.98;

/// What an impulse shows of a scheme.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Smoothness {
    /// The differences of an impulse do not vanish: there is no continuous limit.
    Rough,
    /// The differences of an impulse vanish, the divided second differences do not.
    Continuous,
    /// The divided second differences of an impulse vanish: the limit has a continuous tangent.
    Smooth,
}

/// A cycle, as it is after its numbers have settled, on regular nets whose vertices all carry the same parameters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Impulse<'a> {
    /// The cycle, and what it is regular on.
    pub(super) on_net: &'a CycleOnNet<'a>,
    /// The parameters that all vertices carry.
    pub(super) common: CommonParameters,
    /// Rings that decide about a limit.
    pub(super) support: usize,
}

/// A net and its points: their places in the plane, and as third coordinate what the impulse leads to.
struct ImpulseNet {
    net: MeshNet,
    points: Points,
}

impl Impulse<'_> {
    /// Refines an impulse, and compares how its differences shrink. What is continuous counts as smooth where nobody
    /// asks for `tangents`.
    pub(super) fn smoothness(&self, tangents: bool, watch: &Watch) -> Result<Smoothness, Unlimited> {
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
        let vanish = |measure: Measure| -> Result<bool, Unlimited> {
            let [early, late] = [0, 1].map(|i| measure.of(&seen[i]));
            Ok(late <= VANISHES * early || self.vanish_at_places(measure, watch)?.unwrap_or(late <= SHRINKS * early))
        };
        Ok(if !vanish(Measure::First)? {
            Smoothness::Rough
        } else if tangents && !vanish(Measure::DividedSecond)? {
            Smoothness::Continuous
        } else {
            Smoothness::Smooth
        })
    }

    /// An impulse in the middle of a regular net of `side x side` squares.
    fn on(&self, net: MeshNet, side: usize) -> ImpulseNet {
        let all: Vec<u32> = (0..index(net.mesh.n_vertices())).collect();
        let net = self.common.of_all(all.len()).carried_by(net, &all);
        let middle = (side / 2) * (side + 1) + side / 2;
        let place = |v: usize| [index(v % (side + 1)), index(v / (side + 1)), u32::from(v == middle)].map(f64::from);
        ImpulseNet { points: Points::new((0..net.mesh.n_vertices()).flat_map(place).collect(), 3), net }
    }

    /// One level more.
    fn refined(&self, ImpulseNet { net, mut points }: ImpulseNet) -> Result<ImpulseNet, Unlimited> {
        // work that no forecast counts
        let uncounted = Watch::new();
        let net = self.on_net.cycle.applied(net, |action, step| {
            points.act(action, step.level, &uncounted).map_err(|error| match error {
                RefineError::Stopped(Stopped) => Unlimited::Stopped(Stopped),
                _ => Unlimited::Unsettled,
            })
        })?;
        Ok(ImpulseNet { net, points })
    }

    /// Whether differences vanish at all places that are followed; `None` where too many points are around one.
    fn vanish_at_places(&self, measure: Measure, watch: &Watch) -> Result<Option<bool>, Unlimited> {
        let mut budget = MAX_PLACE_POINTS;
        for place in places(self.on_net.cycle.pieces().last().copied().unwrap_or(2)) {
            match self.vanish_at(place, measure, &mut budget, watch)? {
                Some(true) => {}
                other => return Ok(other),
            }
        }
        Ok(Some(true))
    }

    /// Whether differences vanish at a place, from heights without a pattern on.
    fn vanish_at(
        &self,
        place: RecurrentPlace,
        measure: Measure,
        budget: &mut usize,
        watch: &Watch,
    ) -> Result<Option<bool>, Unlimited> {
        // no point of the rim reaches what is around a vertex at the next level, not even where edges become shorter by
        // the root of 3 only
        let rings = self.support + self.support / 4 + 5;
        let rings = Rings { support: rings, disc: rings };
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
                // within an edge of the level before
                if off <= 1.0 {
                    largest = largest.or(&Differences::at(&topology, &impulse_net.points.now, v));
                }
                if off < nearest.0 {
                    nearest = (off, v);
                }
            }
            let size = measure.of(&largest);
            // none, or too large to go on
            if size == 0.0 || !size.is_finite() {
                return Ok(Some(size == 0.0));
            }
            sizes.push(sizes[level - 1] + ln(size));
            if level == compared {
                let growth = exp(sizes[level] - sizes[level / 2]);
                let vanishes = growth <= if level < PLACE_LEVELS[1] { 1.0 / GROWS } else { SHRINKS };
                if vanishes || growth >= GROWS {
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

/// A place in the plane, in edges from a vertex, that levels carry back to itself, or to its like at another vertex.
#[derive(Debug, Clone, Copy)]
struct RecurrentPlace {
    at: [f64; 2],
    /// What its coordinates are whole multiples of, at all levels: one part of so many, or half of it in duals.
    parts: f64,
}

impl RecurrentPlace {
    /// A coordinate of it without rounding, which would grow with every level.
    fn rounded(&self, x: f64) -> f64 {
        (x * 2.0 * self.parts).round() / (2.0 * self.parts)
    }
}

/// The places that a cut of edges in so many pieces carries back to themselves in one level or two, but for those that
/// are mirror images of others.
fn places(pieces: usize) -> Vec<RecurrentPlace> {
    let mut places = Vec::new();
    for parts in [pieces.saturating_sub(1), pieces + 1] {
        let is_own_mirror = |p: usize| p == 0 || 2 * p == parts;
        for (i, j) in (0..=parts / 2).flat_map(|j| (0..=j).map(move |i| (i, j))) {
            // vertices once
            let direct = (j > 0 || parts == 1).then_some(j);
            let mirrored = (!is_own_mirror(i) && !is_own_mirror(j)).then_some(parts - j);
            let place = |y: usize| RecurrentPlace { at: [i, y].map(|p| real(p) / real(parts)), parts: real(parts) };
            places.extend(direct.into_iter().chain(mirrored).map(place));
        }
    }
    places
}

/// Squares along a side of the net under an impulse whose limit reaches so many rings.
pub(super) fn side(support: usize, n_duals: usize) -> usize {
    2 * (support + 1 + n_duals)
}

/// The levels of an impulse on `side x side` squares whose differences are compared, where they do not take too many
/// points, and how many these are. `pieces` are those of an edge after each operator of a level.
pub(super) fn compared(side: usize, pieces: &[usize]) -> Option<([usize; 2], usize)> {
    let found = LEVELS.map(|levels| (levels, made((side + 1) * (side + 1), pieces, levels[1])));
    found.into_iter().find(|&(_, points)| points <= MAX_LEVEL_POINTS)
}

impl ImpulseNet {
    /// What is around a vertex inside, seen from it and in other units of length and height: its place is 0, and the
    /// plane through it and two others is taken off the heights. `None` where this is too much, or not of the net.
    fn around(
        &self,
        topology: &Topology,
        v: usize,
        rings: Rings,
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
        // regular vertices lie at whole edges, or halves: rounding would grow as the differences do
        let whole = |x: f64| (2.0 * x / length).round() / 2.0;
        let scaled = |[x, y, z]: [f64; 3]| [whole(x), whole(y), (z - slope[0] * x - slope[1] * y) / size];
        let points = origins.iter().flat_map(|&origin| scaled(seen(found.vertices[origin as usize]))).collect();
        let net = VertexParameters::of(&self.net, &found.vertices).carried_by(net, &origins);
        Some(Self { net, points: Points::new(points, 3) })
    }
}

/// Which differences are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Measure {
    First,
    DividedSecond,
}

impl Measure {
    fn of(self, differences: &Differences) -> f64 {
        match self {
            Self::First => differences.first,
            Self::DividedSecond => differences.second / differences.length,
        }
    }

    /// The units of length and height in which these differences are 1.
    fn units(self, differences: &Differences) -> [f64; 2] {
        let height = if self == Self::First { differences.first } else { differences.second };
        [differences.length, height]
    }
}

/// Largest differences of the third coordinate along edges, and largest edge in the first two.
#[derive(Debug, Clone, Copy, Default)]
struct Differences {
    first: f64,
    /// Between an edge and the one opposite to it.
    second: f64,
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

    /// Returns the differences around all vertices, each the greatest.
    fn of(topology: &Topology, points: &[f64]) -> Self {
        (0..topology.n_vertices()).map(|v| Self::at(topology, points, v)).fold(Self::default(), |a, b| a.or(&b))
    }

    /// The larger of each.
    fn or(&self, other: &Self) -> Self {
        Self {
            first: self.first.max(other.first),
            second: self.second.max(other.second),
            length: self.length.max(other.length),
        }
    }
}
