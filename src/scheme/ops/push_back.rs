//! P: the push-back.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::Arc;

use super::latitude::LatitudeLines;
use crate::math::expression::{Expression, ExpressionError};
use crate::math::functions::{ratio, sin};
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::anchor::Anchor;
use crate::scheme::creases::{Creases, Rule};
use crate::scheme::curve_rule::{CurveRule, between};
use crate::scheme::mask_range::steps;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Facts, Follows, Nets, Operator, Role, SplineStep};
use crate::scheme::polygon_anchor::PolygonAnchor;
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::rules::LatitudeRule;
use crate::scheme::settings::LetterSettings;
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::StepError;
use crate::shape::tile::Tile;
use crate::shape::topology::{NONE, Topology, index};

/// Minimum absolute value of sin(alpha), by which shares of displacements are divided. The largest alpha that a preset
/// takes, 1e6, is rounded by 6e-11, so that multiples of pi are recognised up to there. Half of it still recognises
/// them; twice of it refuses angles up to 2e-9 from a multiple, where shares are half a thousand million.
const LEAST_ALPHA_SINE: f64 = 1e-9;

/// P, the push-back towards the anchor: `D_i = delta (P_i - V_i)`; `V += D_i`, `E += omega/2 (D_1 + D_2)`,
/// `F += omega^2 / n sum D`.
#[derive(Debug)]
pub struct PushBack(DisplacementShare);

/// The push-back of words.
pub(super) const WORD_PUSH_BACK: PushBack = PushBack(DisplacementShare::Linear);
/// The push-back of circle schemes.
pub const CIRCULAR_PUSH_BACK: PushBack = PushBack(DisplacementShare::Circular);

static LINEAR: Facts = Facts {
    letter: Some('P'),
    name: "push-back",
    curve: Some(CurveRule::PushBack { compensated: true }),
    follows: Follows::Creases,
    pointwise: true,
    symmetric: true,
    ..PUSH_BACK_FACTS
};

static CIRCULAR: Facts = Facts {
    name: "circular-push-back",
    curve: Some(CurveRule::PushBack { compensated: false }),
    nets: Nets::Polygons("this scheme refines polygons"),
    needs_alpha: true,
    ..PUSH_BACK_FACTS
};

/// The facts that both push-backs share.
const PUSH_BACK_FACTS: Facts = Facts {
    doc: "Pushes back towards the polygon or mesh that entered the last U. With D = delta (old - new) at each vertex: \
         vertices move by D, edge points by omega/2 (D1 + D2), face points of an n-gon by omega^2/n times the sum over \
         its vertices; omega is the compensation. For higher arities D is interpolated as U interpolates, times omega \
         on edges and omega^2 inside faces. delta 0 changes nothing, 1 interpolates. Needs an even number of D \
         since the last U.",
    source: "Zhang and Wang 2002, formulas (3) and (6)-(9)",
    role: Role::PushBack,
    uses: &["delta", "compensation"],
    ..Facts::USUAL
};

/// How a point between two vertices shares in their displacements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum DisplacementShare {
    /// `omega (d - j) / d` and `omega j / d`.
    Linear,
    /// `sin((d - j) alpha / d) / sin(alpha)` and `sin(j alpha / d) / sin(alpha)`.
    Circular,
}

impl DisplacementShare {
    /// Returns the share in the displacement of the vertex that is `steps` of `d` away from the other one.
    fn of(self, steps: isize, d: isize, values: &StepValues<'_>) -> f64 {
        let [_, linear]: [f64; 2] = between(steps as i64, d as i64);
        match self {
            Self::Linear => values.compensation * linear,
            Self::Circular if values.alpha == 0.0 => linear,
            Self::Circular => sin(linear * values.alpha) / sin(values.alpha),
        }
    }
}

impl Operator for PushBack {
    fn facts(&self) -> &'static Facts {
        match self.0 {
            DisplacementShare::Linear => &LINEAR,
            DisplacementShare::Circular => &CIRCULAR,
        }
    }

    fn at_alpha(&self, _: &mut LetterSettings, alpha: f64) -> Result<(), String> {
        let pole = self.0 == DisplacementShare::Circular && alpha != 0.0 && sin(alpha).abs() < LEAST_ALPHA_SINE;
        if pole { Err(format!("the circular push-back has a pole at alpha = {alpha}")) } else { Ok(()) }
    }

    fn spline(&self, _: &LetterSettings, _: f64) -> Result<SplineStep, &'static str> {
        Err("its P pushes back")
    }

    fn on_polygon(&self, net: &PolygonNet, values: &StepValues<'_>) -> Result<Step<PolygonNet>, StepError> {
        let anchor = net.anchor.clone().ok_or_else(no_anchor)?;
        legal(net.duals, anchor.lost, "natural ends")?;
        let delta = values.delta.value(f64::NAN).map_err(|error| no_delta(2, &error))?;
        let phase = net.phase.ok_or_else(no_anchor)?;
        // control point k of the net has the index j = k + start, and vertices lie at the multiples of d
        let (d, start) = (steps(phase.arity), phase.start());
        let children = children_of(&anchor, net, d, start);
        let (last, first) = (net.n - 1, net.first().cast_signed());
        let shares: Vec<f64> = (0..d).map(|steps| self.0.of(steps, d, values)).collect();
        let (ends_fixed, local) = (!net.is_closed(), net.local.clone());
        let rows = RowsBy::new(net.n, anchor.n, move |row, out: &mut Rows| {
            if ends_fixed && (row == 0 || row == last) && (first == 1 || start != 0) {
                return;
            }
            let j = row.cast_signed() - first + start;
            let (i, part) = (j.div_euclid(d), j.rem_euclid(d));
            let delta = |i: usize| local.as_ref().map_or(delta, |local| local.delta[i]);
            if part == 0 {
                anchor.push(i, 1.0, delta, out);
            } else {
                let share = |steps: isize| match &local {
                    Some(local) => local.compensation(i, part) * ratio(steps.unsigned_abs(), d.unsigned_abs()),
                    None => shares[steps.unsigned_abs()],
                };
                anchor.push(i, share(d - part), delta, out);
                anchor.push(i + 1, share(part), delta, out);
            }
        });
        let rows = if net.is_uniform(true) { rows.repeating(d.unsigned_abs(), 4 * d.unsigned_abs()) } else { rows };
        Ok(Step { net: net.clone(), action: Action::PushBack { rows: Box::new(rows), children } })
    }

    fn on_mesh(&self, net: &MeshNet, values: &StepValues<'_>) -> Result<Step<MeshNet>, StepError> {
        let anchor = net.since.anchor.clone().ok_or_else(no_anchor)?;
        legal(net.since.duals, anchor.lost, "a boundary or a valence below 3")?;
        let deltas = deltas(net, &anchor, values.delta)?;
        let children = children(&anchor);
        if let Some(lines) = net.since.local.as_ref().and_then(|local| LatitudeLines::of(&anchor, local)).map(Arc::new)
        {
            let rows = Box::new(lines.displacements(deltas.into()));
            let push = Action::PushBack { rows, children };
            let by_places = values.latitude_rule == LatitudeRule::Position;
            let action = if by_places { Action::Sequence(vec![lines.follows(), push]) } else { push };
            return Ok(Step { net: net.clone(), action });
        }
        let (omega, local, n_v) = (values.compensation, net.since.local.clone(), anchor.topology.n_vertices());
        // of edge points and face points, if they have their own
        let omega = move |place: usize| match &local {
            Some(local) if place >= n_v => local.compensation[place - n_v],
            _ => omega,
        };
        let rows = RowsBy::new(net.mesh.n_vertices(), anchor.topology.n_vertices(), move |row, out: &mut Rows| {
            let place = anchor.order.as_ref().map_or(row, |order| order[row] as usize);
            let omega = omega(place);
            let scales = [1.0, omega, omega * omega];
            out.group(|out| anchor.shares(place, scales, |v, share| out.add(v, share * deltas[v as usize])));
        });
        Ok(Step { net: net.clone(), action: Action::PushBack { rows: Box::new(rows), children } })
    }
}

/// Returns the child of each stored point of the anchor; the end points of a dual polygon are their own children.
fn children_of(anchor: &PolygonAnchor, net: &PolygonNet, d: isize, start: isize) -> Arc<[u32]> {
    let mut children = vec![0; anchor.n];
    children[anchor.n - 1] = index(net.n - 1);
    for i in 0..anchor.n_control {
        let child = d * i.cast_signed() - start + net.first().cast_signed();
        children[i + anchor.first] = index(child.unsigned_abs());
    }
    children.into()
}

fn legal(duals: u32, lost: bool, to: &'static str) -> Result<(), StepError> {
    // first the faults that no other input could avoid
    if duals % 2 == 1 {
        Err(odd_duals(duals))
    } else if lost {
        Err(lost_points(to))
    } else {
        Ok(())
    }
}

/// Returns the child in the net of each anchor vertex, or [`NONE`].
fn children(anchor: &Anchor) -> Arc<[u32]> {
    let n_v = anchor.topology.n_vertices();
    let mut children: Vec<u32> = (0..index(n_v)).collect();
    if let Some(order) = &anchor.order {
        children.fill(NONE);
        for (here, &place) in order.iter().enumerate() {
            if (place as usize) < n_v {
                children[place as usize] = index(here);
            }
        }
    }
    children.into()
}

/// Returns the push-back factor of each anchor vertex: 0 at corners, else the expression at the valence that
/// [`seen_valence`] returns; on creases, at the regular valence.
fn deltas(net: &MeshNet, anchor: &Anchor, delta: &Expression) -> Result<Vec<f64>, StepError> {
    let creases = Creases::of_parent(net);
    let mut known: BTreeMap<usize, f64> = BTreeMap::new();
    let mut deltas = Vec::with_capacity(anchor.topology.n_vertices());
    let own = net.since.local.as_ref().and_then(|local| local.delta.as_ref());
    for v in 0..anchor.topology.n_vertices() {
        let valence = match creases.as_ref().and_then(|creases| creases.vertex(v)) {
            Some(_) => anchor.tile.regular_valence(),
            None => seen_valence(&anchor.topology, anchor.tile, v),
        };
        let value = match known.entry(valence) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(new) => *new.insert(delta.value(ratio(valence, 1)).map_err(|e| no_delta(valence, &e))?),
        };
        deltas.push(own.map_or(value, |own| own[v]));
    }
    let apart = creases.as_ref().map_or(&[][..], Creases::vertices).iter();
    let apart = apart.filter(|(_, blend)| blend.before == Rule::Corner).map(|(corner, _)| corner);
    anchor.corners.iter().chain(apart).for_each(|&corner| deltas[corner as usize] = 0.0);
    Ok(deltas)
}

/// Returns the valence at which expressions are evaluated: on the boundary and at isolated vertices the regular valence
/// (4, on triangles 6).
pub(in crate::scheme) fn seen_valence(topology: &Topology, tile: Tile, v: usize) -> usize {
    if topology.is_isolated(v) || topology.boundary_edges(v).is_some() {
        tile.regular_valence()
    } else {
        topology.ring(v).count()
    }
}

/// Returns the error for a push-back without an upsampling before it.
pub(in crate::scheme) fn no_anchor() -> StepError {
    StepError::new("P needs a U before it: it pushes back towards what entered the last U")
}

/// Returns the error for a push-back in a dual net.
pub(in crate::scheme) fn odd_duals(duals: u32) -> StepError {
    StepError::new(format!("P needs an even number of D since the last U; here it is {duals}"))
}

/// Returns the error for a push-back after points were lost.
pub(in crate::scheme) fn lost_points(to: &str) -> StepError {
    StepError::new(format!("P needs a child of every point that entered the last U; here some were lost to {to}"))
}

/// Returns the error for a push-back factor that has no value at some valence.
fn no_delta(valence: usize, error: &ExpressionError) -> StepError {
    StepError::new(format!("delta: {error} (valence {valence})"))
}
