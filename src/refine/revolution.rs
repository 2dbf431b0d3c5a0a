//! Which latitude lines of a mesh become exact circles, and how large.
//!
//! A line is exact when the rings around it, as far as the scheme reaches, are regular polygons of as many vertices on
//! one axis, or end in a boundary. On such a tube a level acts on each direction alone: around the axis it multiplies by
//! `cos(theta/2)`, and by `cos(theta/4)^2` for each average after the first; along the axis it is the curve scheme.

use crate::math::expression::Expression;
use crate::math::functions::{cos, sin, sqrt};
use crate::scheme::ops::Role;
use crate::scheme::plan::Plan;
use crate::shape::directions::{Direction, Directions, Line};
use crate::shape::mesh::Mesh;
use crate::shape::topology::Topology;

type Vector = [f64; 3];

/// By how much of its size a ring may miss a regular polygon, as coordinates with a few decimals do.
const IRREGULARITY: f64 = 1e-5;
/// What rounding leaves of numbers that are equal.
const ROUNDING: f64 = 1e-9;
/// Levels after which radii have settled.
const LEVELS: u32 = 64;

/// What becomes of a latitude line.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlook {
    /// The line.
    pub line: Line,
    /// The circle that it becomes, or why it becomes none.
    pub circle: Result<Circle, String>,
}

/// A circle in the limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// Its radius, model units.
    pub radius: f64,
    /// By how much the rings that it comes from miss regular polygons, model units: the line is a circle to about that.
    pub irregularity: f64,
}

/// A ring of a tube: a regular polygon.
#[derive(Debug, Clone, Copy)]
struct Ring {
    centre: Vector,
    /// Unit vector along the axis, `None` for a ring without extent.
    axis: Option<Vector>,
    /// From the centre to the vertex that the tube counts from.
    first: Vector,
    /// Greatest distance of a vertex from its place in the regular polygon.
    irregularity: f64,
}

/// Which side of a directed line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

/// What lies beyond a ring.
enum Beyond {
    /// Another ring, vertex by vertex.
    Ring(Vec<u32>),
    /// The boundary of the mesh.
    Boundary,
    /// Something else, and what.
    Other(&'static str),
}

/// What becomes of every latitude line of a mesh under a plan.
pub fn outlooks(mesh: &Mesh, plan: &Plan) -> Vec<Outlook> {
    let Some(directions) = &mesh.directions else { return Vec::new() };
    let tube = Tube { mesh, directions, plan };
    let lines = directions.lines(&mesh.topology).into_iter();
    lines.map(|line| Outlook { circle: tube.circle(&line), line }).collect()
}

struct Tube<'a> {
    mesh: &'a Mesh,
    directions: &'a Directions,
    plan: &'a Plan,
}

impl Tube<'_> {
    fn topology(&self) -> &Topology {
        &self.mesh.topology
    }

    fn point(&self, v: u32) -> Vector {
        let at = 3 * v as usize;
        [self.mesh.positions[at], self.mesh.positions[at + 1], self.mesh.positions[at + 2]]
    }

    fn circle(&self, line: &Line) -> Result<Circle, String> {
        if !line.closed {
            return Err("the line is open".into());
        }
        if self.plan.latitude.is_none() {
            return Err("the plan does not look at latitude tags".into());
        }
        let reach = self.reach()?;
        let ring = self.ring(&line.vertices)?;
        let left = self.side(line, &ring, Side::Left, reach)?;
        let right = self.side(line, &ring, Side::Right, reach)?;
        let place = left.len();
        let rings: Vec<Ring> = left.into_iter().rev().chain([ring]).chain(right).collect();
        let irregularity = rings.iter().map(|ring| ring.irregularity).fold(0.0, f64::max);
        Ok(Circle { radius: self.limit(line.vertices.len(), &rings, place, reach)?, irregularity })
    }

    /// The rings on one side of a line, the nearest first, as far as the scheme reaches or the mesh goes.
    fn side(&self, line: &Line, ring: &Ring, side: Side, reach: usize) -> Result<Vec<Ring>, String> {
        let mut rings = Vec::new();
        let mut vertices = line.vertices.clone();
        for away in 1..=reach {
            let place = if away == 1 { "next to it".to_owned() } else { format!("{away} rings away") };
            vertices = match self.beyond(&vertices, side) {
                Beyond::Boundary => break,
                Beyond::Other(what) => return Err(format!("{place}, {what}")),
                Beyond::Ring(next) => next,
            };
            let found = self.ring(&vertices).map_err(|error| format!("{place}, {error}"))?;
            coaxial(ring, &found).map_err(|error| format!("{place}, {error}"))?;
            rings.push(found);
        }
        Ok(rings)
    }

    /// How many rings the limit of a line depends on, on each side.
    fn reach(&self) -> Result<usize, String> {
        let letters = &self.plan.word.cycle;
        let is = |role: Role| letters.iter().filter(|letter| letter.operator.role() == role).count();
        let pushed = is(Role::PushBack) > 0 && self.plan.delta.value(4.0) != Ok(0.0);
        match (is(Role::Upsample), is(Role::Average)) {
            (1, averages) if averages > 0 && self.plan.word.prefix.is_empty() => Ok(averages + usize::from(pushed)),
            _ => Err("only words U C^k and U C^k P are looked at".into()),
        }
    }

    /// The vertices beyond a line on one side, in its order.
    fn beyond(&self, line: &[u32], side: Side) -> Beyond {
        let topology = self.topology();
        let mut next = Vec::with_capacity(line.len());
        let mut missing = 0;
        for (i, &v) in line.iter().enumerate() {
            let w = line[(i + 1) % line.len()];
            let (from, to) = if side == Side::Left { (v, w) } else { (w, v) };
            let Some(corner) = topology.ring(from as usize).find(|&c| topology.vertex(topology.next(c)) == to) else {
                missing += 1;
                continue;
            };
            let (after, before) = (topology.next(corner), topology.previous(corner));
            let along = [after, before].map(|c| self.directions.of(topology.edge(c)));
            if topology.face(topology.face_of(corner)).len() != 4 || along != [Direction::Longitude; 2] {
                return Beyond::Other("a face is no quad between two longitude edges");
            }
            next.push(topology.vertex(if side == Side::Left { before } else { topology.next(after) }));
        }
        if missing > 0 {
            return if next.is_empty() { Beyond::Boundary } else { Beyond::Other("the boundary cuts the tube") };
        }
        let closes = |i: usize| {
            let (a, b) = (next[i], next[(i + 1) % next.len()]);
            let edges = topology.ring(a as usize).flat_map(|c| [topology.edge(c), topology.edge(topology.previous(c))]);
            edges.into_iter().any(|e| {
                let ends = topology.ends(e as usize);
                (ends == [a, b] || ends == [b, a]) && self.directions.of(e) == Direction::Latitude
            })
        };
        if (0..next.len()).all(closes) { Beyond::Ring(next) } else { Beyond::Other("the tube is not tagged") }
    }

    /// The regular polygon of these vertices.
    fn ring(&self, vertices: &[u32]) -> Result<Ring, String> {
        let n = vertices.len();
        let inverse = 1.0 / real(n);
        let points: Vec<Vector> = vertices.iter().map(|&v| self.point(v)).collect();
        let centre = points.iter().fold([0.0; 3], |sum, p| add(sum, scaled(*p, inverse)));
        let arms: Vec<Vector> = points.iter().map(|p| add(*p, scaled(centre, -1.0))).collect();
        let size = points.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        let first = arms[0];
        if arms.iter().all(|arm| length(*arm) <= ROUNDING * size) {
            return Ok(Ring { centre, axis: None, first: [0.0; 3], irregularity: 0.0 });
        }
        let turn = (0..n).map(|i| cross(arms[i], arms[(i + 1) % n])).fold([0.0; 3], add);
        let axis = scaled(turn, 1.0 / length(turn));
        let angle = std::f64::consts::TAU * inverse;
        let (c, s) = (cos(angle), sin(angle));
        let mut irregularity: f64 = 0.0;
        for i in 0..n {
            let turned = add(scaled(arms[i], c), scaled(cross(axis, arms[i]), s));
            let missed = length(add(turned, scaled(arms[(i + 1) % n], -1.0)));
            if !missed.is_finite() || missed > IRREGULARITY * size {
                return Err("the ring is no regular polygon".into());
            }
            irregularity = irregularity.max(missed);
        }
        Ok(Ring { centre, axis: Some(axis), first, irregularity })
    }

    /// The radius in the limit of ring `place` of a tube of `n`-gons; rings beyond `reach` do not matter.
    fn limit(&self, n: usize, rings: &[Ring], place: usize, reach: usize) -> Result<f64, String> {
        let Some(ring) = rings.iter().find(|ring| ring.axis.is_some()) else { return Ok(0.0) };
        // first vertices as complex numbers in the plane across the axis
        let x = scaled(ring.first, 1.0 / length(ring.first));
        let y = cross(ring.axis.unwrap_or_default(), x);
        let mut now: Vec<[f64; 2]> = rings.iter().map(|ring| [dot(ring.first, x), dot(ring.first, y)]).collect();
        let mut at = place;
        let delta = self.plan.delta.value(4.0).map_err(|error| error.to_string())?;
        let own_alpha = self.plan.latitude.as_ref().is_some_and(|latitude| latitude.own_alpha);
        let mut theta = std::f64::consts::TAU / real(n);
        let mut alpha = if own_alpha { theta } else { self.plan.alpha };
        let pushed = self.plan.word.cycle.iter().any(|letter| letter.operator.role() == Role::PushBack);
        let averages = self.plan.word.cycle.iter().filter(|letter| letter.operator.role() == Role::Average).count();
        let kernel = self.plan.kernel.first().ok_or("the plan has no kernel")?;
        let longitude = self.plan.latitude.as_ref().and_then(|latitude| latitude.kernel_longitude.as_ref());
        for _ in 0..LEVELS {
            let value = |expression: &Expression| expression.value(alpha).map_err(|error| error.to_string());
            let c = cos(theta / 2.0);
            if (value(kernel)? - c).abs() > ROUNDING
                || pushed && (value(&self.plan.compensation)? * c - 1.0).abs() > ROUNDING
            {
                return Err(format!(
                    "circles need the kernel cos(alpha/2) and the compensation 1/cos(alpha/2) with alpha = 2 pi / {n}"
                ));
            }
            let f = longitude.map_or(Ok(c), value)?;
            let quarter = cos(theta / 4.0);
            let next = along(&now, [f, c, quarter * quarter], averages, pushed.then_some(delta));
            let moved = (next[2 * at][0] - now[at][0]).abs() + (next[2 * at][1] - now[at][1]).abs();
            let low = (2 * at).saturating_sub(reach);
            let high = (2 * at + reach + 1).min(next.len());
            (now, at) = (next[low..high].to_vec(), 2 * at - low);
            if moved <= 1e-16 * (now[at][0].abs() + now[at][1].abs()) {
                break;
            }
            alpha /= 2.0;
            theta /= 2.0;
        }
        Ok(sqrt(now[at][0] * now[at][0] + now[at][1] * now[at][1]))
    }
}

/// One level of the rings of a tube: averages with the weight `factors[0]` along the axis and the factors for what turns
/// about it, then the push-back with compensation 1. The first and the last ring are averaged around the axis alone, as on
/// boundaries.
fn along(rings: &[[f64; 2]], factors: [f64; 3], averages: usize, delta: Option<f64>) -> Vec<[f64; 2]> {
    let n = rings.len();
    let mix =
        |pairs: &[([f64; 2], f64)]| pairs.iter().fold([0.0; 2], |sum, (p, w)| [sum[0] + w * p[0], sum[1] + w * p[1]]);
    let mut fine: Vec<[f64; 2]> = (0..2 * n - 1)
        .map(|j| if j % 2 == 0 { rings[j / 2] } else { mix(&[(rings[j / 2], 0.5), (rings[j / 2 + 1], 0.5)]) })
        .collect();
    for average in 0..averages {
        let (f, factor) = if average == 0 { (factors[0], factors[1]) } else { (1.0, factors[2]) };
        let weight = |j: usize| if j.is_multiple_of(2) { f } else { 1.0 };
        fine = (0..fine.len())
            .map(|j| {
                if j == 0 || j + 1 == fine.len() {
                    return mix(&[(fine[j], factor)]);
                }
                let [a, b, c] = [j - 1, j, j + 1].map(weight);
                let (before, after) = (2.0 * (a + b), 2.0 * (b + c));
                mix(&[
                    (fine[j - 1], factor * a / before),
                    (fine[j], factor * (b / before + b / after)),
                    (fine[j + 1], factor * c / after),
                ])
            })
            .collect();
    }
    if let Some(delta) = delta {
        let moves: Vec<[f64; 2]> = (0..n).map(|i| mix(&[(rings[i], delta), (fine[2 * i], -delta)])).collect();
        for (j, point) in fine.iter_mut().enumerate() {
            let both = [moves[j / 2], moves[j.div_ceil(2)]];
            *point = mix(&[(*point, 1.0), (both[0], 0.5), (both[1], 0.5)]);
        }
    }
    fine
}

fn coaxial(ring: &Ring, other: &Ring) -> Result<(), String> {
    let apart = add(other.centre, scaled(ring.centre, -1.0));
    let size = length(ring.first).max(length(other.first)).max(length(apart));
    let parallel = |axis: Vector, vector: Vector| length(cross(axis, vector)) <= IRREGULARITY * size;
    let same = match (ring.axis.or(other.axis), ring.axis, other.axis) {
        (Some(axis), Some(a), Some(b)) => parallel(axis, apart) && length(cross(a, b)) <= IRREGULARITY,
        (Some(axis), _, _) => parallel(axis, apart),
        (None, _, _) => true,
    };
    if same { Ok(()) } else { Err("the ring has another axis".into()) }
}

fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn scaled(a: Vector, factor: f64) -> Vector {
    a.map(|x| x * factor)
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(a: Vector) -> f64 {
    sqrt(dot(a, a))
}

#[expect(clippy::cast_precision_loss, reason = "rings have far fewer than 2^52 vertices")]
fn real(n: usize) -> f64 {
    n as f64
}
