//! Rows sum to one: constants remain, straight lines remain straight, and refinement commutes with affine maps.

use planish::math::functions::{cos, sin};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::{curve_plans, mesh_plans, refined, refined_mesh, refined_polygon};
use crate::support::nets::{self, Net};

/// Coordinates are below 10 and maps below 3, amplified by a few levels of unequal weights.
const TOLERANCE: f64 = 1e-11;

pub(super) fn assert_near(found: &[f64], expected: &[f64], what: &str) -> Result<(), TestCaseError> {
    prop_assert_eq!(found.len(), expected.len());
    for (x, y) in found.iter().zip(expected) {
        prop_assert!((x - y).abs() <= TOLERANCE, "{}: {} is not {}", what, x, y);
    }
    Ok(())
}

fn point<const D: usize>() -> impl Strategy<Value = [f64; D]> {
    proptest::array::uniform(-10.0..10.0)
}

/// The map `matrix x p + shift`.
#[derive(Debug, Clone)]
pub(super) struct Affine<const D: usize> {
    matrix: [[f64; D]; D],
    shift: [f64; D],
}

impl<const D: usize> Affine<D> {
    pub(super) fn random() -> impl Strategy<Value = Self> {
        let matrix = proptest::array::uniform(proptest::array::uniform(-3.0..3.0));
        (matrix, point()).prop_map(|(matrix, shift)| Self { matrix, shift })
    }

    fn of(&self, point: &[f64; D]) -> [f64; D] {
        let mut image = self.shift;
        for (x, row) in image.iter_mut().zip(&self.matrix) {
            *x += row.iter().zip(point).map(|(m, p)| m * p).sum::<f64>();
        }
        image
    }

    pub(super) fn all(&self, points: &[[f64; D]]) -> Vec<[f64; D]> {
        points.iter().map(|point| self.of(point)).collect()
    }
}

fn check_curve<const D: usize>(
    points: &[[f64; D]],
    closed: bool,
    map: &Affine<D>,
    plan: &Value,
) -> Result<(), TestCaseError>
where
    [f64; D]: serde::Serialize + serde::de::DeserializeOwned,
{
    let mapped = refined(&map.all(points), closed, plan, 2);
    let expected = map.all(&refined(points, closed, plan, 2));
    assert_near(mapped.as_flattened(), expected.as_flattened(), &plan.to_string())
}

fn polygon<const D: usize>() -> impl Strategy<Value = Vec<[f64; D]>> {
    proptest::collection::vec(point(), 3..9)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn curves_commute_with_affine_maps(
        flat in (polygon::<2>(), Affine::<2>::random()),
        space in (polygon::<3>(), Affine::<3>::random()),
        four in (polygon::<4>(), Affine::<4>::random()),
        closed in any::<bool>(),
    ) {
        for plan in curve_plans() {
            check_curve(&flat.0, closed, &flat.1, &plan)?;
            check_curve(&space.0, closed, &space.1, &plan)?;
            check_curve(&four.0, closed, &four.1, &plan)?;
        }
    }

    #[test]
    fn meshes_commute_with_affine_maps(net in nets::manifold(), map in Affine::<3>::random()) {
        for plan in mesh_plans() {
            let mapped = refined_mesh(&Net { positions: map.all(&net.positions), ..net.clone() }, &plan, 2);
            let expected = refined_mesh(&net, &plan, 2);
            assert_near(
                mapped.positions.as_flattened(),
                map.all(&expected.positions).as_flattened(),
                &plan.to_string(),
            )?;
            prop_assert_eq!(mapped.faces, expected.faces);
        }
    }

    #[test]
    fn straight_lines_stay_straight(
        places in proptest::collection::vec(-10.0..10.0_f64, 3..9), from in point::<3>(), along in point::<3>(),
        closed in any::<bool>(),
    ) {
        let on_line = |t: &f64| [0, 1, 2].map(|i| from[i] + t * along[i]);
        for plan in curve_plans() {
            let line: Vec<[f64; 3]> = places.iter().map(on_line).collect();
            let numbers: Vec<[f64; 1]> = places.iter().map(|&t| [t]).collect();
            let expected: Vec<[f64; 3]> = refined(&numbers, closed, &plan, 2).iter().map(|[t]| on_line(t)).collect();
            let found = refined(&line, closed, &plan, 2);
            assert_near(found.as_flattened(), expected.as_flattened(), &plan.to_string())?;
        }
    }
}

#[test]
fn constants_stay_constant() {
    let near = |x: f64| (x - 1.0).abs() <= 1e-14;
    for plan in curve_plans() {
        for closed in [true, false] {
            let points = refined(&[[1.0]; 6], closed, &plan, 3);
            assert!(points.iter().all(|[x]| near(*x)), "{plan} closed {closed}: {points:?}");
        }
    }
    for net in [nets::cube(), nets::tetrahedron(), nets::mixed(), nets::grid(3, 2), nets::prism(5)] {
        for plan in mesh_plans() {
            let points = refined_mesh(&Net { positions: vec![[1.0; 3]; net.positions.len()], ..net.clone() }, &plan, 2);
            assert!(points.positions.as_flattened().iter().all(|x| near(*x)), "{plan}");
        }
    }
}

/// Linear precision: the reflection at the ends continues evenly, too.
#[test]
fn evenly_spaced_points_stay_evenly_spaced_between_clamped_ends() {
    let line: Vec<[f64; 1]> = (0..6).map(|i| [f64::from(i)]).collect();
    for text in ["UC", "UCP", "UCC"] {
        let plan = json!({ "word": text });
        let points = refined(&line, false, &plan, 3);
        for (i, [x]) in (0..).zip(&points) {
            assert!((x - f64::from(i) / 8.0).abs() <= 1e-14, "{plan}: point {i} at {x}");
        }
        assert_eq!(points.len(), 41);
    }
}

/// At an inflection with mu = 1, a tangent lies along the edge up to rounding, which must not choose between arc and
/// inflection.
#[test]
fn incenter_turns_with_its_input_at_inflections() {
    let points = [[0.0, 0.0], [1.0, 1.0], [2.0, 0.0], [3.3, 1.0], [4.0, 0.0]];
    let refined = |points: &[[f64; 2]], mu: f64| {
        let plan = json!({ "preset": "incenter", "parameters": { "mu": mu } });
        refined_polygon::<2>(&json!({ "points": points }), &plan, 2)
    };
    for (mu, angle) in [(1.0, 0.1), (1.0, 0.7), (1.0, 2.0), (0.5, 0.1)] {
        let (c, s) = (cos(angle), sin(angle));
        let turned = |[x, y]: [f64; 2]| [c * x - s * y, s * x + c * y];
        let expected = refined(&points, mu).into_iter().map(turned);
        let found = refined(&points.map(turned), mu);
        for (a, b) in expected.zip(&found) {
            assert!((a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-9, "mu {mu}, angle {angle}: {a:?} and {b:?}");
        }
    }
}
