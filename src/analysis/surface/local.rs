//! The rows of one sector around a child of the centre over the points around the centre, read off the weights of the
//! operators.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::layout;
use super::sectors::{LatticePoint, NetKind};
use super::star::{SectorPoint, Star, sector, starts};
use crate::analysis::limit::{Centre, CycleRecord, Unlimited, WeightMode, child};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::stepper::Stepper;
use crate::shape::topology::{Topology, index};
use crate::watch::Watch;

/// Maximum number of points after one application of the cycle to a star. Valence 50 with the widest words of the
/// presets takes a third of it. Half of it refuses long words at valence 50; twice of it takes twice the memory, some
/// 100 bytes per point.
const MAX_STAR_POINTS: usize = 1 << 18;

/// Numbers of additional rings that are tried until all points are included on which the wanted points depend. An
/// average adds half a ring, so that 12 is enough for twenty. Half of it refuses the longest presets; twice of it takes
/// four times as long to refuse.
const TRIED_MARGINS: [i32; 4] = [2, 4, 7, 12];

/// A weight of a place around the centre; `None` is the centre itself.
pub(super) type PlacedWeight = (Option<SectorPoint>, f64);

/// The rows of the points of sector 0, and of the centre, after some applications of a cycle.
#[derive(Debug, Clone)]
pub(super) struct LocalRows {
    /// The weights of each point of sector 0.
    pub(super) rows: BTreeMap<LatticePoint, Vec<PlacedWeight>>,
    /// The weights of the centre; empty if the centre is a face.
    pub(super) centre: Vec<PlacedWeight>,
    /// The ratio of the distances of the first point of a sector from the centre after and before the applications.
    pub(super) shrinks: f64,
}

/// The cycle of a plan at alpha = 0, applied until directions are kept.
#[derive(Debug)]
pub(super) struct Applied {
    /// The plan at alpha = 0.
    pub(super) plan: Plan,
    /// The kind of net around the centre.
    pub(super) kind: NetKind,
    /// The operators of all applications.
    pub(super) steps: Vec<Scheduled>,
    /// The number of pieces of an edge after all applications.
    pub(super) arity: i32,
    /// The number of applications of the cycle.
    pub(super) applications: u32,
    /// Whether ray 0 and all lines parallel to it are latitude lines; only for regular nets of quads.
    pub(super) tagged: bool,
}

impl Applied {
    /// Prepares the cycle of a plan at alpha = 0 on nets of some kind.
    ///
    /// # Errors
    /// [`Unlimited`] if the cycle cannot be applied to nets of this kind.
    pub(super) fn new(plan: &Plan, kind: NetKind, watch: &Watch) -> Result<Self, Unlimited> {
        let plan = Plan { alpha: 0.0, compensation_alpha: None, ..plan.clone() };
        let tagged = plan.latitude.is_some();
        for applications in [1, 2] {
            let scheduled = plan.schedule(applications).map_err(|fault| Unlimited::Later(fault.detail))?;
            let steps = scheduled.into_iter().filter(|step| step.level > 0).collect();
            let applied = Self { plan: plan.clone(), kind, steps, arity: 1, applications, tagged };
            if let Some(local) = applied.wide_enough(kind.regular(), i32::from(kind.has_centre()), watch)? {
                #[expect(clippy::cast_possible_truncation, reason = "points come closer by a small whole number")]
                let arity = (1.0 / local.shrinks).round().clamp(1.0, 1e4) as i32;
                return if arity > 1 { Ok(Self { arity, ..applied }) } else { Err(Unlimited::NoUpsampling) };
            }
        }
        Err(Unlimited::Unsettled)
    }

    /// Returns the rows around a centre of n sectors, up to a radius, from a net that is large enough for them; `None`
    /// if a vertex becomes a face or a face a vertex, or if sectors are turned against those of the parent.
    pub(super) fn wide_enough(&self, n: usize, radius: i32, watch: &Watch) -> Result<Option<LocalRows>, Unlimited> {
        with_margin(|margin| self.local(n, radius, margin, watch))
    }

    /// Returns the rows around a centre of n sectors, up to a radius, from a net with `margin` additional rings.
    fn local(&self, n: usize, radius: i32, margin: i32, watch: &Watch) -> Result<Option<LocalRows>, Unlimited> {
        let side = self.side(radius, margin, n, watch)?;
        let star = Star::new(self.kind, n, side);
        let net = star.net.clone();
        let net = if self.tagged { net.carrying(None, Some(star.latitude_lines(self.kind))) } else { net };
        let FollowedNet { topology, centre, record, layout } = self.followed(net, star.centre, watch)?;
        if matches!(centre, Centre::Vertex(_)) != self.kind.has_centre() {
            return Ok(None);
        }
        let starts = starts(&topology, centre);
        if starts.len() != n {
            return Err(Unlimited::Lost);
        }
        let first = first(&topology, self.kind, starts[0]);
        let Some((turned, shrinks)) = layout::turned(&layout, self.kind, n, &star.places, first)? else {
            return Ok(None);
        };
        let wanted = sector(&topology, self.kind, starts[(n - turned) % n], radius);
        if wanted.len() != self.kind.points(radius).len() {
            return Err(Unlimited::Reach);
        }
        let vertices: Vec<u32> = wanted.values().copied().collect();
        let of_points = wanted.keys().copied().zip(rows(&record, &star.places, &vertices)?).collect();
        let centre = match centre {
            Centre::Vertex(v) => rows(&record, &star.places, &[v])?.swap_remove(0),
            _ => Vec::new(),
        };
        let local = LocalRows { rows: of_points, centre, shrinks };
        // rows that the rim of the net influences are not rules of its interior
        if local.reach(self.kind) + 1 >= side { Err(Unlimited::Reach) } else { Ok(Some(local)) }
    }

    /// Returns the radius of a net whose points up to a radius are refined, with `margin` additional rings.
    pub(super) fn side(&self, radius: i32, margin: i32, sectors: usize, watch: &Watch) -> Result<i32, Unlimited> {
        watch.check()?;
        let side = radius / self.arity + margin + 2;
        let finer = usize::try_from(self.arity * self.arity).unwrap_or(usize::MAX);
        let n = (self.kind.points(side).len() * sectors).saturating_mul(finer);
        if n > MAX_STAR_POINTS { Err(Unlimited::Fine) } else { Ok(side) }
    }

    /// Takes the steps of the cycle from a net, and follows its centre.
    pub(super) fn followed(
        &self,
        mut net: MeshNet,
        mut centre: Centre,
        watch: &Watch,
    ) -> Result<FollowedNet, Unlimited> {
        let (mut record, mut layout) = (CycleRecord::new(WeightMode::Exact), CycleRecord::new(WeightMode::Exact));
        for step in &self.steps {
            layout::record(&mut layout, &self.plan, &net, step)?;
            let next = Stepper::new(&self.plan).next(&net, step)?;
            record.add(next.action)?;
            centre = child(centre, step.letter.facts().children, [&net, &next.net], &record)?;
            net = next.net;
        }
        watch.advance(net.mesh.n_vertices() as u64);
        Ok(FollowedNet { topology: net.mesh.topology(), centre, record, layout })
    }
}

/// What the steps of a cycle make of a net.
pub(super) struct FollowedNet {
    /// The connectivity after the steps.
    pub(super) topology: Arc<Topology>,
    /// The child of the centre.
    pub(super) centre: Centre,
    /// The weights of the steps.
    pub(super) record: CycleRecord,
    /// The places of the points: the weights of the steps that make new points, with the kernel 1.
    pub(super) layout: CycleRecord,
}

/// Returns what is found with the least of the tried margins that is wide enough.
pub(super) fn with_margin<T>(find: impl Fn(i32) -> Result<T, Unlimited>) -> Result<T, Unlimited> {
    let found = TRIED_MARGINS.iter().find_map(|&margin| match find(margin) {
        Err(Unlimited::Reach) => None,
        found => Some(found),
    });
    found.unwrap_or(Err(Unlimited::Reach))
}

/// Returns the first point of the sector that begins at a half-edge.
fn first(topology: &Topology, kind: NetKind, start: u32) -> u32 {
    if kind.has_centre() { topology.vertex(topology.next(start)) } else { topology.vertex(start) }
}

impl LocalRows {
    /// Returns the radius of the farthest point that has a weight.
    pub(super) fn reach(&self, kind: NetKind) -> i32 {
        let all = self.rows.values().flatten().chain(&self.centre);
        all.filter_map(|&(place, _)| place).map(|(_, p)| kind.radius(p)).max().unwrap_or(0)
    }

    /// Returns the radius of the farthest point that has a weight in the rows of the points up to a radius.
    pub(super) fn reach_of(&self, kind: NetKind, radius: i32) -> i32 {
        let near = self.rows.iter().filter(|(p, _)| kind.radius(**p) <= radius).flat_map(|(_, row)| row);
        near.chain(&self.centre).filter_map(|&(place, _)| place).map(|(_, p)| kind.radius(p)).max().unwrap_or(0)
    }
}

/// Returns the least radius, at most `farthest`, for which the points up to it depend only on each other, and all read
/// points depend only on them. `reach` is the radius of the farthest point that has a weight; `reach_of` returns it for
/// the rows of the points up to a radius.
pub(super) fn closed(farthest: i32, reach: i32, reach_of: impl Fn(i32) -> i32) -> Result<i32, Unlimited> {
    let mut radius = reach.min(farthest);
    // the closed part must include all points that influence it
    while reach_of(radius) > radius {
        radius = reach_of(radius);
        if radius > farthest {
            return Err(Unlimited::Reach);
        }
    }
    if reach > radius { Err(Unlimited::Reach) } else { Ok(radius) }
}

/// Returns the rows of some vertices after the steps over the places before them.
pub(super) fn rows<R: FromIterator<PlacedWeight>>(
    record: &CycleRecord,
    places: &[Option<SectorPoint>],
    vertices: &[u32],
) -> Result<Vec<R>, Unlimited> {
    let origins: Vec<u32> = (0..index(places.len())).collect();
    let matrix = record.matrix(vertices, &origins, places.len()).ok_or(Unlimited::Reach)?;
    if !matrix.weights().iter().all(|weight| weight.is_finite()) {
        return Err(Unlimited::Reach);
    }
    let row = |r: usize| {
        let (columns, weights) = matrix.row(r);
        columns.iter().map(|&column| places[column as usize]).zip(weights.iter().copied()).collect()
    };
    Ok((0..vertices.len()).map(row).collect())
}
