//! Random faces over random vertices.

use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support;
use crate::support::nets::Net;

fn soup() -> impl Strategy<Value = Net> {
    // few vertices, so that faces meet; some indices are out of range
    (1..12_usize).prop_flat_map(|n| {
        let positions = proptest::collection::vec(proptest::array::uniform3(-2.0..2.0_f64), n);
        let face = proptest::collection::vec(prop_oneof![40 => 0..n, 1 => 0..n + 2], 0..7);
        let faces = proptest::collection::vec(prop_oneof![1 => face, 8 => distinct(n)], 0..9);
        (positions, faces).prop_map(|(positions, faces)| Net { positions, faces })
    })
}

/// Returns three or more different vertices if there are as many.
fn distinct(n: usize) -> impl Strategy<Value = Vec<usize>> {
    let all: Vec<usize> = (0..n).collect();
    let least = n.min(3);
    (proptest::sample::subsequence(all, least..=n.min(6)), any::<u64>()).prop_map(|(mut face, turn)| {
        face.sort_by_key(|&v| (v as u64 + 1).wrapping_mul(turn | 1).rotate_left(17));
        face
    })
}

fn plans() -> Vec<Value> {
    let words = ["U", "D", "UD", "UDDP", "UCP", "C", "UUCPD(UC)"].map(|word| json!({ "word": word }));
    let presets = ["catmull-clark", "push-back", "doo-sabin", "kobbelt", "sqrt-3"]
        .map(|preset| json!({ "preset": preset, "boundary": "edge-only" }));
    words.into_iter().chain(presets).chain([json!({ "preset": "catmull-clark", "boundary": "none" })]).collect()
}

/// Checks that faces have at least three vertices, and that no side occurs twice in the same direction.
fn check_manifold(net: &Net) -> Result<(), TestCaseError> {
    let mut sides = std::collections::BTreeSet::new();
    for face in &net.faces {
        prop_assert!(face.len() > 2, "{:?}", face);
        for j in 0..face.len() {
            prop_assert!(face[j] < net.positions.len(), "{:?}", face);
            prop_assert!(sides.insert((face[j], face[(j + 1) % face.len()])), "a side occurs twice: {:?}", face);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn face_soups_are_refined_or_refused(net in soup(), orient in prop::sample::select(vec!["refuse", "repair"])) {
        let input = json!({ "mesh": net.to_json(), "orient": orient });
        for plan in plans() {
            let job = json!({ "input": input, "plan": plan, "levels": 2, "outputs": [{ "format": "json" }] });
            match support::render(&job) {
                Ok((bytes, _)) => {
                    let result = serde_json::from_slice(&bytes).expect("the json output is JSON");
                    check_manifold(&Net::of(&result))?;
                }
                Err(faults) => {
                    prop_assert!(!faults.is_empty());
                    for fault in faults {
                        prop_assert!(fault.pointer.starts_with('/') && fault.detail.len() > 10, "{}", fault);
                    }
                }
            }
        }
    }
}

/// The strategy above would prove little if all or none of its soups were meshes.
#[test]
fn some_soups_are_meshes_and_some_are_not() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let mut good = 0;
    for _ in 0..400 {
        let net = soup().new_tree(&mut runner).expect("a soup").current();
        let job = json!({ "input": net.input(), "outputs": [{ "format": "json" }] });
        good += u32::from(support::render(&job).is_ok());
    }
    assert!((20..380).contains(&good), "{good} of 400");
}
