//! Limits under plans with D, also on open meshes and before the first U.

use std::collections::{BTreeMap, BTreeSet};

use planish::math::functions::sqrt;
use proptest::prelude::*;
use serde_json::{Value, json};

use super::limit;
use crate::support::nets::{self, Net, distance};
use crate::support::{json, render};

fn extent(net: &Net) -> f64 {
    net.positions.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()))
}

fn mean<'a>(net: &'a Net, cell: impl IntoIterator<Item = &'a usize>) -> [f64; 3] {
    let points: Vec<[f64; 3]> = cell.into_iter().map(|&v| net.positions[v]).collect();
    let n = f64::from(u32::try_from(points.len()).expect("few"));
    points.iter().fold([0.0; 3], |sum: [f64; 3], p| [0, 1, 2].map(|k| sum[k] + p[k] / n))
}

/// Returns the indices of the faces that have all vertices of a cell.
fn around(net: &Net, cell: &BTreeSet<usize>) -> Vec<usize> {
    (0..net.faces.len()).filter(|&f| cell.iter().all(|v| net.faces[f].contains(v))).collect()
}

/// Returns the faces around a vertex in sequence, from boundary to boundary if there is one; and whether the sequence
/// is closed.
fn fan(net: &Net, v: usize) -> (Vec<usize>, bool) {
    // for each face the vertices after and before v
    let sides: BTreeMap<usize, (usize, usize)> = around(net, &BTreeSet::from([v]))
        .into_iter()
        .map(|f| {
            let face = &net.faces[f];
            let at = face.iter().position(|&u| u == v).expect("v is there");
            (face[(at + 1) % face.len()], (face[(at + face.len() - 1) % face.len()], f))
        })
        .collect();
    let befores: BTreeSet<usize> = sides.values().map(|side| side.0).collect();
    let first = sides.keys().find(|after| !befores.contains(after)).or_else(|| sides.keys().next());
    let mut at = *first.expect("v has faces");
    let mut faces = Vec::new();
    for _ in 0..sides.len() {
        let (before, f) = sides[&at];
        faces.push(f);
        at = before;
    }
    (faces, sides.contains_key(&at))
}

/// Returns the part of a net within some rings of faces around a cell, and the cell in it.
fn cut(net: &Net, cell: &BTreeSet<usize>, rings: usize) -> (Net, BTreeSet<usize>) {
    let mut kept = cell.clone();
    for _ in 0..rings {
        let near: Vec<&Vec<usize>> = net.faces.iter().filter(|face| face.iter().any(|v| kept.contains(v))).collect();
        let more: Vec<usize> = near.into_iter().flatten().copied().collect();
        kept.extend(more);
    }
    let number: BTreeMap<usize, usize> = kept.iter().enumerate().map(|(i, &v)| (v, i)).collect();
    let inside = net.faces.iter().filter(|face| face.iter().all(|v| kept.contains(v)));
    let faces = inside.map(|face| face.iter().map(|v| number[v]).collect()).collect();
    (
        Net { positions: kept.iter().map(|&v| net.positions[v]).collect(), faces },
        cell.iter().map(|v| number[v]).collect(),
    )
}

/// Applies one letter; returns the net and the child of a cell (a vertex, an edge or a face), as the set of its
/// vertices. D numbers the new points like the faces; the centre of an upsampled cell is found by its position.
fn step(net: &Net, cell: &BTreeSet<usize>, letter: &str) -> (Net, BTreeSet<usize>) {
    let next = applied(net, letter);
    let heir = heir(net, &next, cell, letter);
    (next, heir)
}

fn applied(net: &Net, letter: &str) -> Net {
    let plan = json!({ "word": letter, "boundary": "edge-only" });
    Net::of(&json(json!({ "input": net.input(), "plan": plan, "levels": 1 })))
}

fn heir(net: &Net, next: &Net, cell: &BTreeSet<usize>, letter: &str) -> BTreeSet<usize> {
    let single = cell.first().copied().filter(|_| cell.len() == 1);
    match (letter.chars().next(), single) {
        (Some('D'), Some(v)) => {
            let (faces, closed) = fan(net, v);
            let m = faces.len();
            if closed { faces.into_iter().collect() } else { BTreeSet::from([faces[(m - 1) / 2], faces[m / 2]]) }
        }
        (Some('D'), None) => {
            let faces = around(net, cell);
            assert_eq!(faces.len(), 1, "one face has the boundary edge or is the face");
            faces.into_iter().collect()
        }
        (Some('U'), None) => {
            let middle = mean(net, cell);
            let off = |cell: &BTreeSet<usize>| distance(&mean(next, cell), &middle);
            let vertices = (0..next.positions.len()).map(|v| BTreeSet::from([v]));
            let edges = next.edges().into_iter().map(|(a, b)| BTreeSet::from([a, b]));
            let faces = next.faces.iter().map(|face| face.iter().copied().collect());
            let pieces: Vec<BTreeSet<usize>> = if cell.len() == 2 { edges.collect() } else { faces.collect() };
            let all: Vec<BTreeSet<usize>> = vertices.chain(pieces).collect();
            let found = all.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))).expect("there are some");
            assert!(off(&found) < 1e-12 * (1.0 + extent(net)), "no middle of {cell:?}");
            found
        }
        _ => cell.clone(),
    }
}

/// Returns the position of a vertex after many levels.
fn led_to(net: &Net, v: usize, letters: &[&str], levels: usize) -> [f64; 3] {
    let (mut net, mut cell) = cut(net, &BTreeSet::from([v]), 5);
    for _ in 0..levels {
        for letter in letters {
            (net, cell) = step(&net, &cell, letter);
        }
        (net, cell) = cut(&net, &cell, 5);
    }
    mean(&net, &cell)
}

fn open_nets() -> Vec<Net> {
    vec![nets::grid(5, 4), nets::sectors_of_quads(5, 2).0, holed()]
}

/// Returns a grid with a hole and a notch, which have three faces at their corners, and with two triangles.
fn holed() -> Net {
    let mut net = nets::grid(5, 6);
    net.faces.remove(17);
    net.faces.remove(2);
    let last = net.faces.pop().expect("a face");
    net.faces.push(vec![last[0], last[1], last[2]]);
    net.faces.push(vec![last[2], last[3], last[0]]);
    net
}

/// Returns limit positions; `None` if the plan or the net has no limit.
fn limits(net: &Net, plan: &Value) -> Option<Vec<[f64; 3]>> {
    let job = json!({ "input": net.input(), "plan": plan, "levels": 0,
        "outputs": [{ "format": "json", "positions": "limit" }] });
    let (bytes, _) = render(&job).ok()?;
    Some(Net::of(&serde_json::from_slice(&bytes).expect("json")).positions)
}

const PLANS: [&[&str]; 12] = [
    &["D", "U"],
    &["D", "C", "U"],
    &["D", "D", "U"],
    &["D", "U", "D", "U"],
    &["C", "D", "U"],
    &["D", "U", "D"],
    &["U", "D"],
    &["U", "D", "D"],
    &["U", "D", "D", "D"],
    &["U", "C", "D"],
    &["U", "D", "C"],
    &["U3", "D"],
];

fn edge_only(letters: &[&str]) -> Value {
    json!({ "word": letters.concat(), "boundary": "edge-only" })
}

/// After each letter, the rest of the cycle followed by that letter gives the same limit for the child of a vertex.
#[test]
fn limits_do_not_move_under_one_more_letter() {
    let closed = [nets::tetrahedron(), nets::prism(5)];
    for (n, net) in closed.into_iter().chain(open_nets()).enumerate() {
        let small = net.positions.len() < 11;
        let some = PLANS.into_iter().enumerate().filter(|(p, letters)| small || (p + n) % 2 == 0 && letters[0] != "U3");
        for (_, letters) in some {
            // two or three D before or after a U leave nothing of a mesh that is two faces wide
            let narrow = net.positions.len() > 40 && letters.iter().filter(|letter| **letter == "D").count() > 1;
            let Some(expected) = limits(&net, &edge_only(letters)) else {
                assert!(narrow, "{letters:?} has limits");
                continue;
            };
            let mut cells: Vec<BTreeSet<usize>> = (0..net.positions.len()).map(|v| BTreeSet::from([v])).collect();
            let (mut now, mut rest, mut compared) = (net.clone(), letters.to_vec(), 0);
            for _ in 0..=letters.len() {
                let next = applied(&now, rest[0]);
                cells.iter_mut().for_each(|cell| *cell = heir(&now, &next, cell, rest[0]));
                now = next;
                rest.rotate_left(1);
                let found = limits(&now, &edge_only(&rest)).unwrap_or_else(|| panic!("{rest:?} has limits"));
                for (v, cell) in cells.iter().enumerate().filter(|(_, cell)| cell.len() == 1) {
                    let off = distance(&expected[v], &found[*cell.first().expect("one")]);
                    assert!(off <= 1e-12 * (1.0 + extent(&net)), "{letters:?}: vertex {v} moves by {off} at {rest:?}");
                    compared += 1;
                }
            }
            assert!(compared >= net.positions.len(), "{letters:?}: {compared}");
        }
    }
}

/// The rounding errors of wide masks do not settle.
#[test]
fn wide_dual_words_have_limits() {
    let barrel = Net::of(&nets::control("barrel")["mesh"]);
    let led = applied(&applied(&barrel, "C"), "D");
    let plan = |word: &str| json!({ "word": word, "parameters": { "delta": 0.4 } });
    let expected = limits(&led, &plan("UCCCCPCD")).expect("limits");
    let (found, _) = limit(&barrel, &plan("CDUCCCCP"), 1);
    for (v, p) in expected.iter().enumerate() {
        let off = distance(p, &found.positions[v]);
        assert!(off <= 1e-12 * (1.0 + extent(&led)), "vertex {v} moves by {off}");
    }
}

/// The neighbourhood of a vertex between two faces shrinks more than others.
#[test]
fn vertices_between_two_faces_have_limits() {
    let mut net = nets::cube();
    let (face, middle) = (net.faces[0].clone(), net.positions.len());
    net.positions.push([0.5, 0.0, 0.0]);
    net.faces[0] = vec![face[0], face[1], face[2], middle];
    net.faces.push(vec![face[0], middle, face[2], face[3]]);
    let letters = ["U", "D", "D"];
    let found = limits(&net, &edge_only(&letters)).expect("limits");
    for (v, p) in found.iter().enumerate().take(middle) {
        let off = distance(p, &led_to(&net, v, &letters, 6));
        assert!(off <= 1e-2 * extent(&net), "vertex {v} is off by {off}");
    }
}

/// The children of each vertex, letter by letter, approach the limit.
#[test]
fn limits_are_where_levels_lead() {
    for (n, net) in [nets::tetrahedron(), nets::grid(5, 4), holed()].into_iter().enumerate() {
        for (p, letters) in PLANS.iter().enumerate() {
            // cut out of a net with other faces, quads would be split into fewer pieces
            if n == 2 && letters.contains(&"U3") {
                continue;
            }
            let Some(found) = limits(&net, &edge_only(letters)) else { continue };
            let levels = 8 / letters.iter().filter(|letter| letter.starts_with('U')).count();
            let v = (5 * n + 7 * p) % net.positions.len();
            let off = distance(&found[v], &led_to(&net, v, letters, levels));
            assert!(off <= 1e-2 * extent(&net), "{letters:?}, net {n}: vertex {v} is off by {off}");
        }
    }
}

/// Returns the weights of one point of a line: `UD` is the quadratic B-spline, whose ends are the midpoints of the
/// first and last edge.
fn quadratic(i: usize, n: usize) -> Vec<(usize, f64)> {
    match i {
        0 => vec![(0, 0.5), (1, 0.5)],
        i if i == n => vec![(n - 1, 0.5), (n, 0.5)],
        i => vec![(i - 1, 1.0 / 8.0), (i, 6.0 / 8.0), (i + 1, 1.0 / 8.0)],
    }
}

/// The biquadratic B-spline over all of its parameters, also at the sides and corners of an open grid.
#[test]
fn open_grids_have_the_limits_of_biquadratic_splines() {
    for (n, m) in [(4, 3), (1, 1), (2, 1)] {
        let net = nets::grid(n, m);
        for plan in [json!({ "word": "UD" }), json!({ "preset": "repeated-averaging", "parameters": { "degree": 2 } })]
        {
            let (found, normals) = limit(&net, &plan, 0);
            for (i, j) in (0..=n).flat_map(|i| (0..=m).map(move |j| (i, j))) {
                let (mut expected, mut tangents) = ([0.0; 3], [[0.0; 3]; 2]);
                for (a, x) in quadratic(i, n) {
                    for (b, y) in quadratic(j, m) {
                        let p = net.positions[b * (n + 1) + a];
                        expected = [0, 1, 2].map(|k| expected[k] + x * y * p[k]);
                    }
                }
                let v = j * (n + 1) + i;
                assert!(distance(&found.positions[v], &expected) <= 1e-13, "{n} x {m}: {i}, {j}");
                // derivatives: (-1, 0, 1)/2 inside, (-1, 1) at the ends
                let slope = |i: usize, n: usize| match i {
                    0 => vec![(0, -1.0), (1, 1.0)],
                    i if i == n => vec![(n - 1, -1.0), (n, 1.0)],
                    i => vec![(i - 1, -0.5), (i + 1, 0.5)],
                };
                for (tangent, (along, across)) in
                    tangents.iter_mut().zip([(slope(i, n), quadratic(j, m)), (quadratic(i, n), slope(j, m))])
                {
                    for (a, x) in &along {
                        for (b, y) in &across {
                            let p = net.positions[b * (n + 1) + a];
                            *tangent = [0, 1, 2].map(|k| tangent[k] + x * y * p[k]);
                        }
                    }
                }
                let [[a, b, c], [d, e, f]] = tangents;
                let normal = [b * f - c * e, c * d - a * f, a * e - b * d];
                let length = sqrt(normal.iter().map(|x| x * x).sum());
                let off = distance(&normals[v], &normal.map(|x| x / length));
                assert!(off <= 1e-9, "{n} x {m}, {plan}: normal {i}, {j} is off by {off}");
            }
        }
    }
}

/// Doo-Sabin's boundary is the quadratic B-spline of its polygon, and its corners are fixed.
#[test]
fn boundaries_of_doo_sabin_have_limits() {
    let (n, m) = (4, 3);
    let net = nets::grid(n, m);
    for boundary in ["edge-only", "edge-and-corner"] {
        let plan = json!({ "preset": "doo-sabin", "boundary": boundary });
        let [(coarse, normals), (fine, _)] = [0, 1].map(|levels| limit(&net, &plan, levels));
        for i in 1..n {
            let expected = [0, 1, 2].map(|k| {
                let p = |i: usize| net.positions[i][k];
                (p(i - 1) + 6.0 * p(i) + p(i + 1)) / 8.0
            });
            assert!(distance(&coarse.positions[i], &expected) <= 1e-13, "{boundary}: {i}");
        }
        let corner = distance(&coarse.positions[0], &net.positions[0]);
        assert!(if boundary == "edge-only" { corner > 0.1 } else { corner <= 1e-15 }, "{boundary}: {corner}");
        assert!(normals.iter().all(|n| (sqrt(n.iter().map(|x| x * x).sum()) - 1.0).abs() < 1e-12));
        // the limits of a level's vertices lie on the same surface
        let deep = Net::of(&json(json!({ "input": net.input(), "plan": plan, "levels": 6 })));
        for p in coarse.positions.iter().chain(&fine.positions) {
            let near = deep.positions.iter().map(|q| distance(p, q)).fold(f64::INFINITY, f64::min);
            assert!(near <= 2e-2, "{boundary}: {p:?} is {near} away");
        }
    }
}

/// The limits of plane nets lie in the plane and commute with affine maps, also at the sides of regular grids, up to
/// the part that D removes.
#[test]
fn limits_of_flat_nets_are_flat_and_turn_with_them() {
    for letters in PLANS.into_iter().filter(|letters| letters[0] != "U3") {
        let mut net = holed();
        net.faces.truncate(20);
        net = cut(&net, &net.faces.iter().flatten().copied().collect(), 0).0;
        let plan = edge_only(letters);
        let Some(found) = limits(&net, &plan) else { continue };
        // an affine map, which also makes the net flat
        let moved = |p: &[f64; 3]| [1.0 + 2.0 * p[0] - p[1] + p[2], 3.0 * p[1] - p[2], 4.0 - p[0]];
        let other = Net { positions: net.positions.iter().map(moved).collect(), ..net.clone() };
        for (p, q) in found.iter().zip(limits(&other, &plan).expect("the same net")) {
            assert!(distance(&moved(p), &q) <= 1e-12 * (1.0 + extent(&other)), "{letters:?}: {p:?}");
        }
        // mirrored: x becomes -x, and all faces are reversed
        let mirrored = Net {
            positions: net.positions.iter().map(|p| [-p[0], p[1], p[2]]).collect(),
            faces: net.faces.iter().map(|face| face.iter().rev().copied().collect()).collect(),
        };
        for (p, q) in found.iter().zip(limits(&mirrored, &plan).expect("the same net")) {
            assert!(distance(&[-p[0], p[1], p[2]], &q) <= 1e-12 * (1.0 + extent(&net)), "{letters:?}: {p:?}");
        }
    }
}

/// An isolated vertex, which D removes, keeps its position.
#[test]
fn vertices_without_faces_stay() {
    let mut net = nets::cube();
    net.positions.insert(3, [7.0, 8.0, 9.0]);
    net.faces.iter_mut().flatten().filter(|v| **v >= 3).for_each(|v| *v += 1);
    for plan in ["UD", "DU", "DDU"] {
        let (found, _) = limit(&net, &json!({ "word": plan }), 0);
        assert!(distance(&found.positions[3], &net.positions[3]) <= 0.0, "{plan}");
        let (whole, _) = limit(&nets::cube(), &json!({ "word": plan }), 0);
        assert!(distance(&found.positions[4], &whole.positions[3]) <= 1e-14, "{plan}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Random words on random meshes have limits or report why not; with limits, the mesh stays within the extent of
    /// its points.
    #[test]
    fn dual_words_have_limits_or_say_why_not(
        net in nets::manifold(),
        word in "(D|C|DD){0,2}(UD|UDD|UCD|UDC|UDUC)(D|C){0,1}",
        levels in 0..2_u32,
        corner in any::<bool>(),
    ) {
        let boundary = if corner { "edge-and-corner" } else { "edge-only" };
        let plan = json!({ "word": word, "boundary": boundary });
        let with = |options: Value| {
            let mut output = json!({ "format": "json" });
            output.as_object_mut().expect("an object").extend(options.as_object().expect("an object").clone());
            render(&json!({ "input": net.input(), "plan": plan, "levels": levels, "outputs": [output] }))
        };
        match (with(json!({})), with(json!({ "positions": "limit", "normals": "limit" }))) {
            (Err(_), limit) => prop_assert!(limit.is_err()),
            (Ok(_), Err(faults)) => {
                let told = ["D leaves no faces", "D parts the faces", "D needs a vertex", "D is not possible here"];
                prop_assert!(told.iter().any(|text| faults[0].detail.contains(text)), "{:?}", faults);
            }
            (Ok((refined, _)), Ok((limit, _))) => {
                let [refined, limit] =
                    [refined, limit].map(|bytes| Net::of(&serde_json::from_slice(&bytes).expect("json")));
                prop_assert_eq!(refined.positions.len(), limit.positions.len());
                // all weights are positive
                let most = extent(&refined);
                prop_assert!(limit.positions.iter().flatten().all(|x| x.abs() <= most * (1.0 + 1e-9)));
            }
        }
    }
}
