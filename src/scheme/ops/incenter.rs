//! Incenter subdivision: inserts the joint of a biarc on each edge.

use std::sync::Arc;

use rayon::prelude::*;

use crate::math::functions::sin;
use crate::math::parameter::{Default, Parameter};
use crate::math::planar::{Neighbours, Vector2, angle, half_chord, length, rotated};
use crate::math::vector::{direction, plus, times};
use crate::scheme::mask_range::MaskRange;
use crate::scheme::operator::{Children, Facts, Nets, Operator, Role};
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::settings::LetterSettings;
use crate::scheme::step::{Action, PointMap, Step, StepValues};
use crate::scheme::step_error::StepError;
use crate::watch::{Stopped, Watch};

/// Number of edges that one thread processes at a time. Half as many leave twice as many blocks to join; twice as many
/// leave threads idle on small polygons. Results do not depend on it.
const EDGES_PER_TASK: usize = 4096;
/// Turning angles below this, in radians, are rounding errors of 0, whose signs and quotients would be noise. It is far
/// above the rounding error of a direction, 2e-16, and far below a visible turning; half or twice the value changes
/// only the treatment of turnings of a billionth.
const STRAIGHT_ANGLE: f64 = 1e-9;

/// A level of incenter subdivision: points and unit tangents give points and unit tangents. On an edge of direction `e`
/// from A to B, with the turnings `a` from A's tangent to `e` and `b` from `e` to B's, the joint
/// `J = A + |AB| sin(b/2) / sin((a+b)/2) rot(e, -a/2)` is inserted, with tangent `e`. Then each tangent is turned by
/// `mu` of the angle to that of the circle through the point and its neighbours.
#[derive(Debug)]
pub struct Incenter;

impl Incenter {
    /// The fraction by which tangents are turned towards the circle.
    pub const CIRCLE_SHARE: Parameter = Parameter::number(
        "mu",
        [0.0, 1.0],
        Default::Number(0.25),
        "How far tangents follow the circle through three points: 0 keeps those of the biarcs, 1 takes the \
         circle's.",
    );
}

static FACTS: Facts = Facts {
    name: "incenter",
    doc: "A level of incenter subdivision, which is not linear: it turns tangents along with points of the plane. Used \
     by the preset incenter.",
    source: "after Deng and Wang, CAGD 27 (2010), 48-59",
    nets: Nets::Polygons("this scheme refines polygons"),
    role: Role::Upsample,
    children: Children::Vertices,
    parameters: &[Incenter::CIRCLE_SHARE],
    turns_tangents: true,
    ..Facts::USUAL
};

impl Operator for Incenter {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn mask_range(&self, _: &LetterSettings, _: u32) -> Option<MaskRange> {
        Some(MaskRange::upsample(2))
    }

    fn on_polygon(&self, net: &PolygonNet, values: &StepValues<'_>) -> Result<Step<PolygonNet>, StepError> {
        let mu = values.settings.number(&Self::CIRCLE_SHARE);
        let (landed, _) = net.land(MaskRange::upsample(2))?;
        let map = Biarcs { closed: net.is_closed(), mu, pinned: net.pinned.clone() };
        let pinned = net.pinned.iter().map(|i| 2 * i).collect();
        let next = PolygonNet { duals: 0, phase: Some(net.phase_after(2)), anchor: None, pinned, ..landed };
        Ok(Step { net: next, action: Action::Map(Box::new(map)) })
    }
}

/// The map that inserts the joints of the biarcs of all edges.
#[derive(Debug)]
struct Biarcs {
    closed: bool,
    mu: f64,
    /// Points whose tangents stay fixed, ascending.
    pinned: Arc<[u32]>,
}

impl PointMap for Biarcs {
    fn apply(
        &self,
        points: &[Vector2],
        tangents: &[Vector2],
        watch: &Watch,
    ) -> Result<(Vec<Vector2>, Vec<Vector2>), Stopped> {
        let n = points.len();
        let n_new = if self.closed { 2 * n } else { 2 * n - 1 };
        let (mut new_points, mut new_tangents) = (vec![[0.0; 2]; n_new], vec![[0.0; 2]; n_new]);
        let blocks = new_points.par_chunks_mut(2 * EDGES_PER_TASK).zip(new_tangents.par_chunks_mut(2 * EDGES_PER_TASK));
        blocks.enumerate().try_for_each(|(block, (new_points, new_tangents))| {
            watch.check()?;
            let edges = new_points.chunks_mut(2).zip(new_tangents.chunks_mut(2));
            for (i, (point, tangent)) in (block * EDGES_PER_TASK..).zip(edges) {
                (point[0], tangent[0]) = (points[i], tangents[i]);
                // the last point of an open polygon has no edge
                if point.len() == 2 {
                    let next = (i + 1) % n;
                    (point[1], tangent[1]) = joint(points[i], tangents[i], points[next], tangents[next]);
                }
            }
            watch.advance(new_points.len() as u64);
            Ok(())
        })?;
        self.blend(&new_points, &mut new_tangents, watch)?;
        for &i in self.pinned.iter() {
            new_tangents[2 * i as usize] = tangents[i as usize];
        }
        Ok((new_points, new_tangents))
    }
}

impl Biarcs {
    /// Turns each tangent by the fraction mu of the angle to the tangent of the circle.
    fn blend(&self, points: &[Vector2], tangents: &mut [Vector2], watch: &Watch) -> Result<(), Stopped> {
        if self.mu == 0.0 {
            return Ok(());
        }
        let neighbours = Neighbours::of(points, self.closed, watch)?;
        tangents.par_chunks_mut(EDGES_PER_TASK).enumerate().try_for_each(|(block, tangents)| {
            watch.check()?;
            for (i, tangent) in (block * EDGES_PER_TASK..).zip(tangents) {
                if let Some(circle) = neighbours.tangent(points, i) {
                    *tangent = rotated(*tangent, self.mu * angle(*tangent, circle));
                }
            }
            Ok(())
        })
    }
}

/// Returns the point that is inserted between two points, and its tangent.
fn joint(a: Vector2, tangent_a: Vector2, b: Vector2, tangent_b: Vector2) -> (Vector2, Vector2) {
    let half = half_chord(a, b);
    let Some(e) = direction(half) else {
        return (a, rotated(tangent_a, angle(tangent_a, tangent_b) / 2.0));
    };
    let (turn_a, turn_b) = (angle(tangent_a, e), angle(e, tangent_b));
    let sum = turn_a + turn_b;
    let middle = plus(times(0.5, a), times(0.5, b));
    if turn_a.abs() < STRAIGHT_ANGLE && turn_b.abs() < STRAIGHT_ANGLE {
        // the ratio of height to chord of an arc of so small an angle
        let height = length(half) * sum / 4.0;
        return (plus(middle, times(height, [e[1], -e[0]])), e);
    }
    let both = |turn: fn(f64) -> bool| turn(turn_a) && turn(turn_b);
    if !both(|turn| turn >= STRAIGHT_ANGLE) && !both(|turn| turn <= -STRAIGHT_ANGLE) {
        return (middle, rotated(e, (turn_a - turn_b) / 2.0));
    }
    // tangents that both run against the edge would meet at infinity
    if sum.abs() > 2.0 * std::f64::consts::PI - STRAIGHT_ANGLE {
        return (middle, e);
    }
    let reach = length(half) * (2.0 * sin(turn_b / 2.0) / sin(sum / 2.0));
    (plus(a, times(reach, rotated(e, -turn_a / 2.0))), e)
}
