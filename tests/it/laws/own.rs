//! Common properties of schemes with a connectivity of their own: counts as forecast, topology kept, and data without
//! effect.

use std::collections::BTreeMap;

use planish::job::limits::Limits;
use proptest::prelude::*;
use serde_json::{Value, json};

use super::refined_mesh;
use crate::support::nets::{self, Net, distance, same_surface};
use crate::support::{parsed, render};

const TOLERANCE: f64 = 1e-11;

fn plan(preset: &str, boundary: &str) -> Value {
    json!({ "preset": preset, "boundary": boundary })
}

fn boundaries() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec!["edge-and-corner", "edge-only"])
}

/// Returns the number of faces at each vertex, and whether it is on the boundary.
fn rings(net: &Net) -> BTreeMap<usize, (usize, bool)> {
    let side = |face: &[usize], j: usize| (face[j], face[(j + 1) % face.len()]);
    let sides: std::collections::BTreeSet<_> =
        net.faces.iter().flat_map(|face| (0..face.len()).map(|j| side(face, j)).collect::<Vec<_>>()).collect();
    let mut rings = BTreeMap::new();
    for &(a, b) in &sides {
        let ring = rings.entry(a).or_insert((0, false));
        ring.0 += 1;
        ring.1 |= !sides.contains(&(b, a));
        rings.entry(b).or_insert((0, false)).1 |= !sides.contains(&(b, a));
    }
    rings
}

/// Whether no inner vertex has only two faces, which these schemes refuse.
fn has_rings(net: &Net) -> bool {
    rings(net).values().all(|&(n, on_boundary)| on_boundary || n > 2)
}

fn euler(net: &Net) -> isize {
    (rings(net).len() + net.faces.len()).cast_signed() - net.edges().len().cast_signed()
}

/// Compares the forecast with the result, and the topology of the result with that of the input.
fn check(net: &Net, plan: &Value, levels: u32) -> Result<(), TestCaseError> {
    for level in 0..=levels {
        let job = json!({ "input": net.input(), "plan": plan, "levels": level, "outputs": [{ "format": "json" }] });
        let read = parsed(job.to_string().as_bytes()).map_err(|faults| TestCaseError::fail(format!("{faults:?}")))?;
        let estimate = Limits::default().estimate(&read);
        let estimate = estimate.map_err(|refusal| TestCaseError::fail(format!("{refusal:?}")))?;
        let count = estimate.forecast.levels[level as usize];
        let (bytes, report) = render(&job).map_err(|faults| TestCaseError::fail(format!("{faults:?}")))?;
        let fine = Net::of(&serde_json::from_slice(&bytes).expect("the json output is JSON"));
        prop_assert_eq!(count.vertices, fine.positions.len() as u128);
        prop_assert_eq!(count.faces, fine.faces.len() as u128);
        prop_assert_eq!(count.edges, fine.edges().len() as u128);
        prop_assert_eq!(count.corners, fine.faces.iter().map(|face| face.len() as u128).sum());
        // at vertices of the input with several fans, these were separated
        if report.warnings.is_empty() {
            prop_assert_eq!(euler(&fine), euler(net));
        }
    }
    Ok(())
}

/// Returns `M p + shift` with a rotation and unequal scales.
fn moved(p: [f64; 3]) -> [f64; 3] {
    [0.6 * p[0] - 0.8 * p[1] + 3.0, 1.6 * p[0] + 1.2 * p[1] - 1.0, 0.5 * p[2] + 0.25 * p[0] + 7.0]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn doo_sabin_is_as_forecast(net in nets::manifold(), boundary in boundaries()) {
        prop_assume!(has_rings(&net));
        check(&net, &plan("doo-sabin", boundary), 3)?;
    }

    #[test]
    fn sqrt_3_is_as_forecast(net in nets::triangles(), boundary in boundaries()) {
        prop_assume!(has_rings(&net));
        check(&net, &plan("sqrt-3", boundary), 4)?;
    }

    #[test]
    fn refinement_commutes_with_affine_maps(net in nets::triangles(), boundary in boundaries()) {
        prop_assume!(has_rings(&net));
        for preset in ["doo-sabin", "sqrt-3"] {
            let image = Net { positions: net.positions.iter().map(|p| moved(*p)).collect(), ..net.clone() };
            let there = refined_mesh(&image, &plan(preset, boundary), 3);
            let here = refined_mesh(&net, &plan(preset, boundary), 3);
            prop_assert_eq!(&there.faces, &here.faces);
            for (p, q) in there.positions.iter().zip(&here.positions) {
                prop_assert!(distance(p, &moved(*q)) <= TOLERANCE, "{}: {:?}", preset, p);
            }
        }
    }

    #[test]
    fn where_a_face_starts_does_not_matter(
        net in nets::triangles(), boundary in boundaries(), turns in proptest::collection::vec(0..3_usize, 40),
    ) {
        // distinct positions, so that points can be told apart
        let apart = |(i, p): (usize, &[f64; 3])| {
            let step = f64::from(u32::try_from(i * i % 31).expect("below 31"));
            [p[0] + 0.37 * step, p[1] + 0.73 * step, p[2] + 1.19 * step]
        };
        let net = Net { positions: net.positions.iter().enumerate().map(apart).collect(), ..net };
        prop_assume!(has_rings(&net));
        let mut turned = net.clone();
        turned.faces.iter_mut().zip(turns.iter().cycle()).for_each(|(face, &turn)| face.rotate_left(turn));
        for preset in ["doo-sabin", "sqrt-3"] {
            let [a, b] = [&net, &turned].map(|net| refined_mesh(net, &plan(preset, boundary), 2));
            let distinct = (0..a.positions.len())
                .all(|i| a.positions[..i].iter().all(|p| distance(p, &a.positions[i]) > 1e-6));
            if distinct {
                prop_assert_eq!(same_surface(&a, &b, 1e-9), Ok(()), "{}", preset);
            }
        }
    }
}

/// A level of a closed mesh is the first level of the mesh before it.
#[test]
fn levels_of_closed_meshes_add_up() {
    for (preset, net) in [("doo-sabin", nets::prism(5)), ("doo-sabin", nets::cube()), ("sqrt-3", nets::tetrahedron())] {
        let plan = plan(preset, "edge-only");
        let (halfway, whole) = (refined_mesh(&net, &plan, 1), refined_mesh(&net, &plan, 2));
        assert_eq!(same_surface(&refined_mesh(&halfway, &plan, 1), &whole, 1e-12), Ok(()), "{preset}");
    }
}

/// Isolated vertices give no vertex of the dual scheme, and remain in the other.
#[test]
fn isolated_vertices() {
    let mut net = nets::tetrahedron();
    net.positions.push([9.0, 9.0, 9.0]);
    let dual = refined_mesh(&net, &plan("doo-sabin", "edge-only"), 1);
    assert_eq!((dual.positions.len(), dual.faces.len()), (12, 14));
    let primal = refined_mesh(&net, &plan("sqrt-3", "edge-only"), 2);
    assert_eq!(primal.positions.get(4), Some(&[9.0, 9.0, 9.0]));
}

/// New faces come from several old ones, so data that name faces are refused; channels are refined like positions.
#[test]
fn what_names_faces_is_refused_and_channels_are_refined() {
    for preset in ["doo-sabin", "sqrt-3"] {
        let mut mesh = nets::tetrahedron().to_json();
        mesh["channels"] = json!({ "place": mesh["positions"] });
        let job = |mesh: &Value, ids: bool| {
            let output = json!({ "format": "json", "ids": ids });
            json!({ "input": { "mesh": mesh }, "plan": { "preset": preset }, "levels": 2, "outputs": [output] })
        };
        let result: Value =
            serde_json::from_slice(&render(&job(&mesh, false)).expect("it runs").0).expect("the json output is JSON");
        assert_eq!(result["channels"]["place"], result["positions"], "{preset}");
        let refused = |job: &Value| render(job).expect_err("it is refused")[0].detail.clone();
        assert!(refused(&job(&mesh, true)).contains(&format!("{preset} cannot carry ids")));
        mesh["groups"] = json!([{ "name": "top", "faces": [0, 1] }]);
        assert!(refused(&job(&mesh, false)).contains(&format!("{preset} cannot carry groups and materials")));
    }
}

#[test]
fn a_hundred_levels_of_growth_are_counted_without_being_made() {
    for preset in ["doo-sabin", "sqrt-3"] {
        let job = json!({
            "input": nets::tetrahedron().input(), "plan": { "preset": preset }, "levels": 64,
            "outputs": [{ "format": "obj" }],
        });
        let read = parsed(job.to_string().as_bytes()).expect("a job");
        let refusal = format!("{:?}", Limits::default().estimate(&read).expect_err("it is too large"));
        assert!(refusal.contains("ask for at most"), "{refusal}");
    }
}
