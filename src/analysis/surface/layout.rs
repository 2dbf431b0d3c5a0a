//! Tracks where the points around a child lie, using only the steps that make new points, so that arity and turn follow
//! from the connectivity and not from the weights of averages.

use super::sectors::NetKind;
use super::star::SectorPoint;
use crate::analysis::limit::{CycleRecord, Unlimited};
use crate::math::functions::{atan2, real};
use crate::math::vector::length;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::Children;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::stepper::Stepper;
use crate::shape::topology::index;

/// Largest turn of a child's sectors against its parent's that is regarded as aligned, in sectors. Schemes keep
/// directions, or turn by half a sector, up to rounding. Half or twice of it decides alike.
const ALIGNED_TURN: f64 = 0.1;

/// Records a step on a net if it makes new points, with the kernel 1: such steps interpolate, or take means, in the
/// same way whatever the parameters of a plan are.
pub(super) fn record(layout: &mut CycleRecord, plan: &Plan, net: &MeshNet, step: &Scheduled) -> Result<(), Unlimited> {
    if step.letter.facts().children == Children::Same {
        return Ok(());
    }
    let plain = Scheduled { kernel: 1.0, ..step.clone() };
    layout.add(Stepper::new(plan).next(net, &plain)?.action)
}

/// Returns by how many of n sectors the first point of the child's ring lies after the ray, or the corner, of
/// sector 0, and the ratio of its distance from the centre to that of the parent's first point; `None` if it lies
/// between two rays or corners.
pub(super) fn turned(
    layout: &CycleRecord,
    kind: NetKind,
    n: usize,
    places: &[Option<SectorPoint>],
    first: u32,
) -> Result<Option<(usize, f64)>, Unlimited> {
    let origins: Vec<u32> = (0..index(places.len())).collect();
    let row = layout.matrix(&[first], &origins, places.len()).ok_or(Unlimited::Reach)?;
    let (columns, weights) = row.row(0);
    let mut sum = [0.0; 2];
    for (&column, weight) in columns.iter().zip(weights) {
        let Some((sector, point)) = places[column as usize] else { continue };
        let place = kind.direction(n, sector, point);
        (0..2).for_each(|k| sum[k] += weight * place[k]);
    }
    let sectors = atan2(sum[1], sum[0]) * real(n) / std::f64::consts::TAU;
    let whole = sectors.round();
    #[expect(clippy::cast_possible_truncation, reason = "at most half of the valence")]
    let turned = (whole as i64).rem_euclid(i64::try_from(n).unwrap_or(1));
    let shrinks = length(sum) / length(kind.direction(n, 0, [i32::from(kind.has_centre()), 0]));
    let turned = usize::try_from(turned).unwrap_or(0);
    Ok(((sectors - whole).abs() <= ALIGNED_TURN).then_some((turned, shrinks)))
}
