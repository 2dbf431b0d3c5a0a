//! Bicubic caps at vertices where the surface is not smooth all around; they interpolate points of the limit surface.

use super::level::{Level, Sharpened, Spot};
use super::net::{BicubicNet, bezier};
use super::sector::{Sector, SectorKind};
use crate::math::vector::{Vector, minus, plus, times};

/// Returns the caps of a sector. Twelve points are those of the exact surface outside, and the vertex is its limit;
/// along spokes the caps interpolate the limit of the midpoint, or are exact if the spoke is sharp, and inside they
/// interpolate the limit of the face's centre. `spot` is that of the sector on the next level.
pub(super) fn interpolated(level: &Level, sector: &Sector, (next, spot): &(Level, Spot)) -> Vec<BicubicNet> {
    let limit = level.limit(sector.spokes[0]);
    let children = spot.half_edges(next);
    let net = |(&spoke, &child): (&u32, &u32)| {
        let mut net = bezier(&level.net(spoke));
        net[0][0] = limit;
        let before = level.topology.previous(spoke);
        let ends = [spoke, before].map(|side| level.topology.edge(side));
        let far = [level.start(level.after(spoke, 1)), level.start(before)];
        // the midpoints of the two spokes in the child of the face
        let middles = [next.after(child, 1), next.after(child, 3)];
        let exact = [[net[2][0], net[3][0]], [net[0][2], net[0][3]]];
        for side in 0..2 {
            let is_sharp = level.edge_sharpened(ends[side]) == Sharpened::Ever && sector.kind != SectorKind::Dart;
            let point = if is_sharp {
                times(1.0 / 3.0, plus(times(2.0, level.start(spoke)), far[side]))
            } else {
                let through = next.limit(middles[side]);
                let [third, fourth] = exact[side];
                let rest = plus(plus(limit, times(3.0, third)), fourth);
                times(1.0 / 3.0, minus(times(8.0, through), rest))
            };
            let [i, j] = [[1, 0], [0, 1]][side];
            net[i][j] = point;
        }
        net[1][1] = [0.0; 3];
        let centre = next.limit(next.after(child, 2));
        net[1][1] = times(64.0 / 9.0, minus(centre, middle(&net)));
        net
    };
    sector.spokes.iter().zip(&children).map(net).collect()
}

/// Returns the point of a Bezier patch at (1/2, 1/2).
fn middle(net: &BicubicNet) -> Vector {
    let weights = [0.125, 0.375, 0.375, 0.125];
    let cells =
        net.iter().zip(weights).flat_map(|(row, a)| row.iter().zip(weights).map(move |(p, b)| times(a * b, *p)));
    cells.fold([0.0; 3], plus)
}
