//! Classical schemes on triangles besides Loop.

use crate::math::expression::Expression;
use crate::math::parameter::{Default, Kind, Parameter};
use crate::scheme::ops::{ButterflyEdges, RootThree};
use crate::scheme::preset::{Preset, Refines, Spelling, letters};
use crate::scheme::word::Letter;
use crate::shape::tile::Tile;

pub(super) const BUTTERFLY: Preset = Preset {
    name: "butterfly",
    doc: "The modified butterfly scheme for triangles: interpolates, C1; at w = 1/16 regular regions reproduce cubics. Edge \
          points 1/2 (a + b) + 2w (c + d) - w (four far vertices) between vertices of valence 6, weights of the ring at \
          others, four-point curves on boundaries.",
    source: "Zorin, Schroeder and Sweldens, SIGGRAPH 1996, 189-192; Dyn, Levin and Gregory, ACM TOG 9 (1990), 160-169",
    parameters: &[Parameter {
        name: "w",
        kind: Kind::Number { min: -1e3, max: 1e3 },
        unit: "",
        default: Default::Number(1.0 / 16.0),
        doc: "Tension: what edge points are off the middles of their edges at 1/16 is multiplied by 16 w.",
    }],
    refines: Refines::Meshes,
    spell: |values| {
        let w = values.number("w").unwrap_or(1.0 / 16.0);
        let mut cycle = letters("U");
        cycle.push(Letter::plain(&ButterflyEdges));
        let compensation = Expression::constant(16.0 * w);
        Ok(Spelling { tile: Tile::Triangle, compensation, ..Spelling::of(cycle) })
    },
};

pub(super) const SQRT_3: Preset = Preset {
    name: "sqrt-3",
    doc: "Kobbelt's sqrt 3 scheme for triangles: each level makes three times as many, C2 in regular regions, C1 at \
          extraordinary vertices. Boundaries are cubic B-splines of their polygons, cut in three every second level.",
    source: "Kobbelt, SIGGRAPH 2000, 103-112",
    parameters: &[],
    refines: Refines::Meshes,
    spell: |_| Ok(Spelling::of(vec![Letter::plain(&RootThree)])),
};
