//! Classical schemes on triangles besides Loop.

use crate::math::parameter::Value;
use crate::scheme::claim::Claim;
use crate::scheme::letter::Letter;
use crate::scheme::ops::{ButterflyEdges, RootThree};
use crate::scheme::preset::{Preset, Refines, Spelling, letters};
use crate::shape::tile::Tile;

pub(super) const BUTTERFLY: Preset = Preset {
    name: "butterfly",
    doc: "The modified butterfly scheme for triangles: interpolates, C1; at w = 1/16 regular regions reproduce cubics. \
          Edge points 1/2 (a + b) + 2w (c + d) - w (four far vertices) between vertices of valence 6, weights of the \
          ring at others, four-point curves on boundaries.",
    source: "Zorin, Schroeder and Sweldens, SIGGRAPH 1996, 189-192; Dyn, Levin and Gregory, ACM TOG 9 (1990), 160-169",
    parameters: &[ButterflyEdges::W],
    refines: Refines::Meshes,
    claims: &[
        Claim::on_meshes("w = 1/16", &[&[("w", "1/16")]], ["1", "6", "3"], Some([3, 12])),
        Claim::on_meshes(
            "0 < w < 1/12, w not 1/16",
            &[&[("w", "1/20")], &[("w", "3/40")]],
            ["1", "6", "1"],
            Some([3, 12]),
        ),
    ],
    spell: |values| {
        let w = Value::Number(values.number("w").unwrap_or(1.0 / 16.0));
        let cycle = [letters("U"), vec![Letter::plain(&ButterflyEdges).with(&ButterflyEdges::W, w)]].concat();
        Ok(Spelling { tile: Tile::Triangle, ..Spelling::of(cycle) })
    },
};

pub(super) const SQRT_3: Preset = Preset {
    name: "sqrt-3",
    doc: "Kobbelt's sqrt 3 scheme for triangles: each level makes three times as many, C2 in regular regions, C1 at \
          extraordinary vertices. Boundaries are cubic B-splines of their polygons, cut in three every second level.",
    source: "Kobbelt, SIGGRAPH 2000, 103-112",
    parameters: &[],
    refines: Refines::Meshes,
    claims: &[Claim::on_meshes("", &[&[]], ["2", "5", "1"], Some([3, 50]))],
    spell: |_| Ok(Spelling::of(vec![Letter::plain(&RootThree)])),
};
