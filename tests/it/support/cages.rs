//! Cages, the input of solids and of evaluations.

use planish::math::functions::{cos, sin};
use planish::math::vector::Vector;
use planish::scheme::plan::{Plan, PlanInput, Subject};
use planish::scheme::tags::Boundary;
use planish::shape::mesh::{Mesh, MeshInput};

/// A mesh with sharp edges and corners.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cage {
    pub(crate) points: Vec<Vector>,
    pub(crate) faces: Vec<Vec<u32>>,
    pub(crate) creases: Vec<([u64; 2], f64)>,
    pub(crate) corners: Vec<(u64, f64)>,
    pub(crate) holes: Vec<u64>,
    pub(crate) boundary: Boundary,
}

impl Cage {
    pub(crate) fn mesh(&self) -> Mesh {
        Mesh::new(MeshInput {
            positions: self.points.clone(),
            faces: self.faces.iter().map(|face| face.iter().copied()).collect(),
            creases: self.creases.clone(),
            corners: self.corners.clone(),
            holes: self.holes.clone(),
            ..MeshInput::default()
        })
        .unwrap_or_else(|faults| panic!("{faults:?}"))
    }

    pub(crate) fn plan(&self) -> Plan {
        let input = PlanInput { preset: Some("catmull-clark".into()), boundary: self.boundary, ..PlanInput::default() };
        Plan::resolve(&input, Subject { is_mesh: true, ..Subject::default() }).expect("the plan is one")
    }

    pub(crate) fn size(&self) -> f64 {
        let side = |k: usize| {
            let all = || self.points.iter().map(|p| p[k]);
            all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
        };
        (0..3).map(side).fold(0.0, f64::max)
    }
}

/// Returns a cube with sides of length `2 h`.
pub(crate) fn cube(h: f64) -> Cage {
    let sign = |bit: usize| if bit == 0 { -h } else { h };
    Cage {
        points: (0..8).map(|i| [sign(i & 4), sign(i & 2), sign(i & 1)]).collect(),
        faces: [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
            .map(Vec::from)
            .into(),
        ..Cage::default()
    }
}

/// Returns quads over `n x m` cells, with the points that `at` gives.
pub(crate) fn sheet(n: u32, m: u32, at: impl Fn(f64, f64) -> Vector) -> Cage {
    let points = (0..=n).flat_map(|i| (0..=m).map(move |j| (f64::from(i), f64::from(j))));
    let number = |i: u32, j: u32| i * (m + 1) + j;
    let face = |i, j| vec![number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
    Cage {
        points: points.map(|(i, j)| at(i, j)).collect(),
        faces: (0..n).flat_map(|i| (0..m).map(move |j| face(i, j))).collect(),
        ..Cage::default()
    }
}

/// Returns a prism with `n` sides.
pub(crate) fn prism(n: u32) -> Cage {
    let at = |i: u32, z| {
        let a = std::f64::consts::TAU * f64::from(i) / f64::from(n);
        [10.0 * cos(a), 10.0 * sin(a), z]
    };
    let sides = (0..n).map(|i| vec![i, (i + 1) % n, n + (i + 1) % n, n + i]);
    let ends = [(0..n).rev().collect::<Vec<_>>(), (n..2 * n).collect()];
    Cage {
        points: [-10.0, 10.0].into_iter().flat_map(|z| (0..n).map(move |i| at(i, z))).collect(),
        faces: ends.into_iter().chain(sides).collect(),
        ..Cage::default()
    }
}
