//! Identities of sharp edges and corners.

use proptest::prelude::*;
use serde_json::{Value, json};

use super::{refined, refined_mesh, semi_stationary, static_word, word};
use crate::support;
use crate::support::nets::{self, Net, distance, same_surface};

const TOLERANCE: f64 = 1e-12;

/// The ends of an edge, and its sharpness.
type Crease = ([usize; 2], f64);

fn creased(net: &Net, creases: &[Crease], plan: &Value, levels: u32) -> Net {
    let mut input = net.input();
    let entry = |(edge, sharpness): &Crease| json!({ "edge": edge, "sharpness": sharpness });
    input["mesh"]["creases"] = creases.iter().map(entry).collect();
    Net::of(&support::json(json!({ "input": input, "plan": plan, "levels": levels })))
}

fn catmull_clark() -> Value {
    json!({ "preset": "catmull-clark", "boundary": "edge-only" })
}

fn chaikin() -> Value {
    json!({ "preset": "catmull-clark", "boundary": "edge-only", "parameters": { "creasing": "chaikin" } })
}

/// Returns plans that support infinitely sharp edges, each with the corresponding plan for curves.
fn plans() -> Vec<(Value, Value)> {
    let words = [word("UC"), word("UCP"), static_word("UCCP"), semi_stationary("UCP", "1", 0.5), word("CU")];
    let edge_only = |plan: Value| {
        let mut on_mesh = plan.clone();
        on_mesh["boundary"] = json!("edge-only");
        (on_mesh, plan)
    };
    let cubic = json!({ "preset": "cubic-b-spline" });
    let mut plans: Vec<_> = words.into_iter().map(edge_only).collect();
    plans.extend([(catmull_clark(), cubic.clone()), (chaikin(), cubic)]);
    plans
}

/// Returns a torus of 4 x 5 quads and the edges of its first row, which form a ring.
fn ring(sharpness: f64) -> (Net, [Crease; 4]) {
    (nets::torus(4, 5), [0, 1, 2, 3].map(|i| ([i, (i + 1) % 4], sharpness)))
}

fn assert_same(found: &Net, expected: &Net, what: &str) {
    assert_eq!(found.faces, expected.faces, "{what}");
    for (i, (p, q)) in found.positions.iter().zip(&expected.positions).enumerate() {
        assert!(distance(p, q) <= TOLERANCE, "{what}: vertex {i} is {p:?} and {q:?}");
    }
}

fn largest_difference(a: &Net, b: &Net) -> f64 {
    a.positions.iter().zip(&b.positions).map(|(p, q)| distance(p, q)).fold(0.0, f64::max)
}

#[test]
fn creases_follow_the_curve_scheme() {
    let (net, creases) = ring(10.0);
    for (plan, curve) in plans() {
        let surface = creased(&net, &creases, &plan, 3);
        for p in refined(&net.positions[..4], true, &curve, 3) {
            assert!(surface.positions.iter().any(|q| distance(&p, q) <= TOLERANCE), "{plan}: {p:?} is missing");
        }
    }
}

/// Returns the corners of all faces in sequence.
fn soup(net: &Net) -> Vec<[f64; 3]> {
    net.faces.iter().flatten().map(|&v| net.positions[v]).collect()
}

#[test]
fn a_crease_is_a_boundary_on_both_sides() {
    let (net, creases) = ring(1e9);
    let mut open = net.clone();
    open.positions.extend_from_within(..4);
    for face in &mut open.faces[16..] {
        face.iter_mut().filter(|v| **v < 4).for_each(|v| *v += 20);
    }
    for (plan, _) in plans() {
        let closed = soup(&creased(&net, &creases, &plan, 3));
        let open = soup(&refined_mesh(&open, &plan, 3));
        assert_eq!(closed.len(), open.len());
        assert!(closed.iter().zip(&open).all(|(p, q)| distance(p, q) <= TOLERANCE), "{plan}");
    }
}

#[test]
fn sharpness_zero_is_no_crease() {
    let (net, creases) = ring(0.0);
    for (plan, _) in plans() {
        assert_eq!(creased(&net, &creases, &plan, 2), refined_mesh(&net, &plan, 2), "{plan}");
    }
}

/// Creases of whole sharpness n are infinitely sharp for n levels, and smooth from then on.
#[test]
fn whole_sharpness_counts_levels() {
    for n in 1..=3_u32 {
        let (net, creases) = ring(f64::from(n));
        let (_, infinite) = ring(10.0);
        for plan in [catmull_clark(), chaikin()] {
            let sharp = creased(&net, &infinite, &plan, n);
            assert_same(&creased(&net, &creases, &plan, n), &sharp, "as long as it is sharp");
            let smoothed = creased(&net, &creases, &plan, n + 1);
            assert_eq!(same_surface(&refined_mesh(&sharp, &plan, 1), &smoothed, TOLERANCE), Ok(()), "afterwards");
        }
    }
}

#[test]
fn what_was_sharp_is_smooth_afterwards() {
    let (net, creases) = ring(1.7);
    let [halfway, whole] = [2, 3].map(|levels| creased(&net, &creases, &catmull_clark(), levels));
    assert_eq!(same_surface(&refined_mesh(&halfway, &catmull_clark(), 1), &whole, TOLERANCE), Ok(()));
    // with more sharpness than levels this does not hold
    let (_, creases) = ring(2.7);
    let [halfway, whole] = [2, 3].map(|levels| creased(&net, &creases, &catmull_clark(), levels));
    assert!(same_surface(&refined_mesh(&halfway, &catmull_clark(), 1), &whole, TOLERANCE).is_err());
}

/// In its first level, an edge of sharpness s < 1 is s parts crease and 1 - s parts smooth, and so are vertices.
#[test]
fn fractions_are_means() {
    let (net, _) = ring(0.0);
    let of = |sharpness: f64| creased(&net, &ring(sharpness).1, &catmull_clark(), 1);
    let (smooth, sharp, mean) = (of(0.0), of(1.0), of(0.375));
    assert!(largest_difference(&smooth, &sharp) > 0.1);
    for ((p, q), r) in smooth.positions.iter().zip(&sharp.positions).zip(&mean.positions) {
        let expected = [0, 1, 2].map(|k| 0.625 * p[k] + 0.375 * q[k]);
        assert!(distance(&expected, r) <= TOLERANCE, "{expected:?} is not {r:?}");
    }
}

#[test]
fn where_three_creases_meet_the_vertex_stays_and_where_one_ends_it_is_smooth() {
    let net = nets::cube();
    let edges = [[0, 1], [0, 2], [0, 4]];
    for (plan, _) in plans() {
        let smooth = refined_mesh(&net, &plan, 2);
        for n in 1..=3 {
            let creases: Vec<Crease> = edges[..n].iter().map(|&edge| (edge, 10.0)).collect();
            let fine = creased(&net, &creases, &plan, 2);
            if n == 3 {
                assert_eq!(fine.positions.first(), net.positions.first(), "{plan}");
            }
            if n == 1 && plan["preset"] == "catmull-clark" {
                let one = creased(&net, &creases, &plan, 1).positions[0];
                let smooth = refined_mesh(&net, &plan, 1).positions[0];
                // the dart's rule is smooth, and the crease does not affect face points in the first level
                assert!(distance(&one, &smooth) <= TOLERANCE, "{plan}");
            }
            assert!(largest_difference(&fine, &smooth) > 1e-3, "{n} creases in {plan}");
        }
    }
}

/// If everything is sharp, nothing moves: the first level is bilinear.
#[test]
fn a_mesh_of_creases_is_bilinear() {
    let net = nets::prism(5);
    let creases: Vec<Crease> = net.edges().into_iter().map(|(a, b)| ([b, a], 12.0)).collect();
    for plan in [catmull_clark(), word("UC")] {
        let bilinear = refined_mesh(&net, &word("U"), 1);
        let fine = creased(&net, &creases, &plan, 1);
        // the loop centres of C move face points, which are on no crease
        let held = if plan["word"].is_null() { fine.positions.len() } else { 25 };
        assert_eq!(fine.positions[..held], bilinear.positions[..held], "{plan}");
    }
}

#[test]
fn semi_sharp_corners_stay_as_long_as_they_are_sharp() {
    let of = |sharpness: f64, levels| {
        let mut input = nets::cube().input();
        input["mesh"]["corners"] = json!([{ "vertex": 5, "sharpness": sharpness }]);
        Net::of(&support::json(json!({ "input": input, "plan": catmull_clark(), "levels": levels }))).positions[5]
    };
    let (start, smooth) = (nets::cube().positions[5], of(0.0, 1));
    assert_eq!(Some(of(2.0, 2)), nets::cube().positions.get(5).copied());
    assert!(distance(&of(2.0, 3), &start) > 1e-3);
    let expected = [0, 1, 2].map(|k| 0.25 * start[k] + 0.75 * smooth[k]);
    assert!(distance(&of(0.25, 1), &expected) <= TOLERANCE);
}

/// Chaikin's rule evens out sharpness along a crease; equal sharpness remains as it is.
#[test]
fn chaikin_creasing_differs_where_sharpness_does() {
    let (net, even) = ring(2.5);
    let uneven = [0, 1, 2, 3].map(|i: usize| (even[i].0, [0.5, 1.75, 3.25, 2.0][i]));
    let [a, b] = [catmull_clark(), chaikin()].map(|plan| creased(&net, &even, &plan, 3));
    assert_same(&a, &b, "even sharpness");
    let [a, b] = [catmull_clark(), chaikin()].map(|plan| creased(&net, &uneven, &plan, 3));
    assert!(largest_difference(&a, &b) > 1e-3);
}

/// Under Chaikin's rule, an edge is fully sharp if both its halves remain sharp, and else as sharp as it states, at
/// most fully. OpenSubdiv 3.5 has (0.373046875, -0.888671875, 1.015625) at the first of these places, and agrees at the
/// others.
#[test]
fn an_edge_is_as_sharp_as_its_halves_or_as_it_says() {
    let corners = [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    let mut faces = corners.map(Vec::from).to_vec();
    faces[0].reverse();
    let positions = (0..8).map(|i| [[-1, 1, 1, -1][i % 4], [-1, -1, 1, 1][i % 4], [-1, 1][i / 4]].map(f64::from));
    let net = Net { positions: positions.collect(), faces };
    let has = |creases: &[Crease], levels, place: [f64; 3]| {
        let fine = creased(&net, creases, &chaikin(), levels);
        fine.positions.iter().any(|p| distance(p, &place) <= 1e-15)
    };
    assert!(has(&[([4, 5], 2.4), ([5, 6], 1.3)], 2, [0.375, -0.875, 1.0]));
    // both halves of the middle edge get 3/4 of 0.5 and 1/4 of 4, minus 1
    assert!(has(&[([4, 5], 4.0), ([5, 6], 0.5), ([6, 7], 4.0)], 1, [1.0, 0.0, 1.0]));
    // and here 1/4 of 2.5, minus 1: neither remains
    assert!(has(&[([4, 5], 2.5), ([5, 6], 0.5), ([6, 7], 2.5)], 1, [0.875, 0.0, 0.875]));
    // one remains
    assert!(has(&[([4, 5], 4.0), ([5, 6], 0.5), ([6, 7], 2.5)], 1, [0.875, 0.0, 0.875]));
}

/// The same holds under Loop, and for all data of vertices.
#[test]
fn all_that_an_edge_carries_is_as_sharp_as_its_halves() {
    let around = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]].map(|[x, y]: [f64; 2]| [x, y, 0.0]);
    let positions = [around.as_slice(), &[[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]].concat();
    let faces: Vec<_> = (0..4).flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]]).collect();
    let values: Vec<_> = positions.iter().map(|p| [p[0], p[1]]).collect();
    let crease = |a: usize, sharpness: f64| json!({ "edge": [a, a + 1], "sharpness": sharpness });
    let of = |preset: &str, sharpness: f64| {
        let mesh = json!({
            "positions": positions, "faces": faces, "channels": { "place": values },
            "uvs": { "values": values, "faces": faces, "interpolation": "none" },
            "creases": [crease(0, sharpness), crease(1, 0.5), crease(2, sharpness)],
        });
        let plan = json!({ "preset": preset, "parameters": { "creasing": "chaikin" } });
        support::json(json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 1 }))
    };
    // 3/8 of each end and 1/8 of the other two vertices; the means of the ends and of the centres of the faces
    for (preset, smooth) in [("loop", 0.375), ("catmull-clark", 5.0 / 12.0)] {
        for (sharpness, x) in [(4.0, 0.5), (2.5, 0.25 + smooth / 2.0)] {
            let fine = of(preset, sharpness);
            let rows = |list: &Value| -> Vec<Vec<f64>> { serde_json::from_value(list.clone()).expect("numbers") };
            for list in [&fine["positions"], &fine["channels"]["place"], &fine["uvs"]["values"]] {
                let there = rows(list).iter().any(|row| distance(&row[..2], &[-x, x]) <= 1e-15);
                assert!(there, "{preset}, {sharpness}: {list} is without ({}, {x})", -x);
            }
        }
    }
}

#[test]
fn the_triangle_rule_acts_beside_triangles_alone() {
    let smooth = json!({ "preset": "catmull-clark", "parameters": { "triangle_rule": "smooth" } });
    let plain = json!({ "preset": "catmull-clark" });
    for net in [nets::cube(), nets::grid(3, 2), nets::prism(5)] {
        assert_eq!(refined_mesh(&net, &smooth, 2), refined_mesh(&net, &plain, 2));
    }
    let net = nets::prism(3);
    assert!(largest_difference(&refined_mesh(&net, &smooth, 1), &refined_mesh(&net, &plain, 1)) > 1e-3);
}

fn sharpness() -> impl Strategy<Value = f64> {
    prop_oneof![Just(10.0), Just(1.0), 0.0..4.0_f64]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn creases_move_with_the_mesh(
        net in nets::manifold(), sharpness in proptest::collection::vec(sharpness(), 40), chaikin_too in any::<bool>(),
    ) {
        let creases: Vec<Crease> = net.edges().into_iter().map(|(a, b)| [a, b]).zip(sharpness).collect();
        // rotated about an axis by the angle of (3, 4, 5), and translated
        let rigid = |[x, y, z]: [f64; 3]| [0.6 * x - 0.8 * y + 2.0, 0.8 * x + 0.6 * y - 1.0, z + 0.5];
        let moved = Net { positions: net.positions.iter().copied().map(rigid).collect(), faces: net.faces.clone() };
        let plan = if chaikin_too { chaikin() } else { catmull_clark() };
        let (before, after) = (creased(&net, &creases, &plan, 2), creased(&moved, &creases, &plan, 2));
        for (p, q) in before.positions.iter().zip(&after.positions) {
            prop_assert!(distance(&rigid(*p), q) <= 1e-11, "{:?} went to {:?}", p, q);
        }
    }

    /// The order of creases and of their ends does not matter.
    #[test]
    fn creases_are_a_set(net in nets::manifold(), sharpness in proptest::collection::vec(sharpness(), 40)) {
        let creases: Vec<Crease> = net.edges().into_iter().map(|(a, b)| [a, b]).zip(sharpness).collect();
        let turned: Vec<Crease> = creases.iter().rev().map(|&([a, b], s)| ([b, a], s)).collect();
        prop_assert_eq!(creased(&net, &creases, &chaikin(), 2), creased(&net, &turned, &chaikin(), 2));
    }
}

/// Sharpness belongs to the mesh: under Chaikin's rule it evens out around a vertex on a seam as if there were no seam,
/// so that texture coordinates equal to positions remain equal beside an edge inside their region.
#[test]
fn seams_do_not_change_how_sharp_edges_are() {
    let n = 8;
    let (net, _) = nets::sectors_of_quads(n, 1);
    let side = |sector: usize| net.faces[sector][1];
    let flat = |shift: f64| net.positions.iter().map(move |p| [p[0] + shift, p[1]]);
    let values: Vec<[f64; 2]> = flat(0.0).chain(flat(100.0)).collect();
    let chart = |(sector, face): (usize, &Vec<usize>)| {
        let shift = if sector < n / 2 { 0 } else { net.positions.len() };
        face.iter().map(|v| v + shift).collect::<Vec<_>>()
    };
    let faces: Vec<_> = net.faces.iter().enumerate().map(chart).collect();
    let mut input = net.input();
    input["mesh"]["uvs"] = json!({ "values": values, "faces": faces, "interpolation": "none" });
    input["mesh"]["corners"] = json!([{ "vertex": 0, "sharpness": 10 }]);
    // one edge within the first region; another within the second, or on the seam
    for other in [6, 4] {
        let creases = [(2, 1.25), (other, 2.5)].map(|(s, x)| json!({ "edge": [0, side(s)], "sharpness": x }));
        input["mesh"]["creases"] = creases.into();
        for plan in [catmull_clark(), chaikin()] {
            let job = json!({ "input": input, "plan": plan, "levels": 2 });
            let found = support::json_with(job, &json!({ "ids": true, "isolines": true }));
            let read = |value: &Value| -> Vec<Vec<usize>> { serde_json::from_value(value.clone()).expect("indices") };
            let is_it = |line: &Vec<usize>| [line[0], line[4]].contains(&side(2)) && [line[0], line[4]].contains(&0);
            let line = read(&found["isolines"]).into_iter().find(is_it).expect("it is an edge");
            // the point next to the vertex on the seam
            let point = if line[0] == 0 { line[1] } else { line[3] };
            let corners = read(&found["faces"]).concat().into_iter().zip(read(&found["uvs"]["faces"]).concat());
            let places: Vec<usize> = corners.filter(|&(v, _)| v == point).map(|(_, place)| place).collect();
            assert_eq!(places.len(), 4);
            let place: [f64; 3] = serde_json::from_value(found["positions"][point].clone()).expect("a place");
            for at in places {
                let uv: [f64; 2] = serde_json::from_value(found["uvs"]["values"][at].clone()).expect("a pair");
                assert!(distance(&uv, &place[..2]) <= TOLERANCE, "{uv:?} at {place:?}, {plan}, {other}");
            }
        }
    }
}
