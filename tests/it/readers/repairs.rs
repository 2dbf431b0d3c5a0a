//! Welding and pairing: their effects, their messages, and what they leave unchanged.

use planish::math::functions::{cos, sin};
use planish::shape::weld::weld;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::nets::{Net, cube, grid, manifold, torus};
use crate::support::{self, render};

fn with(net: &Net, options: &Value) -> Value {
    let mut input = net.input();
    options.as_object().into_iter().flatten().for_each(|(name, value)| input[name] = value.clone());
    json!({ "input": input, "outputs": [{ "format": "json" }] })
}

fn repaired(net: &Net, options: &Value) -> (Net, Vec<String>) {
    let (bytes, report) = render(&with(net, options)).unwrap_or_else(|faults| panic!("{faults:?}"));
    (Net::of(&serde_json::from_slice(&bytes).expect("the output is JSON")), report.warnings)
}

/// Returns the net with separate vertices for every face.
fn apart(net: &Net) -> Net {
    let positions = net.faces.iter().flatten().map(|&v| net.positions[v]).collect();
    let mut next = 0..;
    let faces = net.faces.iter().map(|face| next.by_ref().take(face.len()).collect()).collect();
    Net { positions, faces }
}

fn triangulated(net: &Net) -> Net {
    let fan = |face: &Vec<usize>| (1..face.len() - 1).map(|i| vec![face[0], face[i], face[i + 1]]).collect::<Vec<_>>();
    Net { positions: net.positions.clone(), faces: net.faces.iter().flat_map(fan).collect() }
}

#[test]
fn equal_places_are_merged_and_told() {
    let (found, warnings) = repaired(&apart(&cube()), &json!({ "weld": 0 }));
    assert_eq!((found.positions.len(), found.faces.len()), (8, 6));
    assert_eq!(warnings, ["welding merged 16 vertices: 8 into 0, 9 into 3, 10 into 5, 11 into 4, 12 into 1, ..."]);
    support::nets::same_surface(&found, &cube(), 0.0).expect("it is the cube");
}

#[test]
fn parameters_that_merged_vertices_had_otherwise_are_told() {
    let net = apart(&cube());
    let warnings = |parameters: Value| {
        let mut input = net.input();
        input["mesh"]["parameters"] = parameters;
        input["weld"] = json!(0);
        let job = json!({ "input": input, "plan": { "word": "UCP" }, "levels": 1, "outputs": [{ "format": "json" }] });
        support::render(&job).expect("it can be done").1.warnings
    };
    let last = |value: f64| (0..24).map(|v| if v == 10 { value } else { 0.0 }).collect::<Vec<f64>>();
    let told = warnings(json!({ "delta": last(1.0), "kernel": vec![1; 24] }));
    let expected = "merged vertices differ in parameters, and those that stayed keep theirs: delta (10 into 5)";
    assert_eq!((told.len(), told[1].as_str()), (2, expected));
    assert_eq!(warnings(json!({ "delta": last(-0.0) })).len(), 1);
}

#[test]
fn vertices_go_to_the_lowest_within_the_distance() {
    let positions: Vec<[f64; 3]> = [0.0, 0.6, 1.2, 1.0, 3.0].map(|x| [x, 0.0, 0.0]).to_vec();
    let welded = weld(&positions, 1.0).expect("the distance is right");
    // 1.2 is too far from 0, and 0.6 was merged; 1.0 is at the limit of the distance from 0
    assert_eq!(welded.image, [0, 0, 1, 0, 2]);
    assert_eq!(welded.kept, [0, 2, 4]);
    assert_eq!(welded.pairs, [[1, 0], [3, 0]]);
}

#[test]
fn faces_without_area_are_left_out_and_told() {
    let net = Net {
        positions: vec![
            [0., 0., 0.],
            [1., 0., 0.],
            [1., 1., 0.],
            [0., 1., 0.],
            [0., 1e-9, 0.],
            [2., 0., 0.],
            [2., 1., 0.],
        ],
        faces: vec![vec![1, 5, 6, 2], vec![0, 1, 4], vec![4, 1, 2, 3]],
    };
    let (found, warnings) = repaired(&net, &json!({ "weld": 1e-6 }));
    assert_eq!(found.faces, [[1, 4, 5, 2], [0, 1, 2, 3]]);
    let told = ["welding merged 1 vertex: 4 into 0", "faces left out because welding left them no area: 1"];
    assert_eq!(warnings, told);
}

#[test]
fn a_face_that_would_meet_a_vertex_twice_is_refused() {
    let positions = vec![[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [2., 0., 0.], [1., 1e-9, 0.], [0., 1., 0.]];
    let net = Net { positions, faces: vec![vec![0, 1, 3, 2, 4, 5]] };
    let found = support::faults(with(&net, &json!({ "weld": 1e-3 })));
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].pointer, "/input/weld");
    let detail = "merging vertices within 0.001 makes face 0 meet vertex 1 twice; choose a smaller distance";
    assert_eq!(found[0].detail, detail);
}

#[test]
fn a_distance_is_a_number_that_makes_sense() {
    let check = |distance: f64, detail: &str| {
        let found = support::faults(with(&cube(), &json!({ "weld": distance })));
        assert_eq!((found[0].pointer.as_str(), found[0].detail.as_str()), ("/input/weld", detail));
    };
    check(-1.0, "-1 is no distance; give a number of at least 0, where 0 merges equal positions");
    let small =
        "1e-13 is too small for coordinates up to 1.125e0; give at least 1.125e-12, or 0 to merge equal positions";
    check(1e-13, small);
}

#[test]
fn only_meshes_are_repaired() {
    let polygon = json!({ "points": [[0], [1]] });
    let found =
        support::faults(json!({ "input": { "polygon": polygon, "weld": 0, "pair_quads": true, "orient": "repair" } }));
    let pointers: Vec<&str> = found.iter().map(|fault| fault.pointer.as_str()).collect();
    assert_eq!(pointers, ["/input/orient", "/input/weld", "/input/pair_quads"]);
}

#[test]
fn corners_and_holes_follow_the_repairs() {
    let mut job = with(&apart(&cube()), &json!({ "weld": 0 }));
    job["input"]["mesh"]["corners"] = json!([{ "vertex": 23, "sharpness": 10 }]);
    job["input"]["mesh"]["holes"] = json!([5]);
    job["plan"] = json!({ "preset": "catmull-clark" });
    job["levels"] = json!(1);
    let found = Net::of(&support::json(job));
    assert_eq!(found.faces.len(), 5 * 4);
    // corner 23 is the last of the last face, (1, 3, 7, 5)
    assert!(found.positions.contains(&cube().positions[5]), "the corner keeps its place");
    assert!(!found.positions.contains(&cube().positions[0]), "the others do not");
}

#[test]
fn creases_follow_the_weld_and_part_pairs() {
    let mut job = with(&apart(&cube()), &json!({ "weld": 0 }));
    // corners 0 and 3 of the third face, (0, 1, 5, 4)
    job["input"]["mesh"]["creases"] = json!([{ "edge": [11, 8], "sharpness": 10 }]);
    job["plan"] = json!({ "preset": "catmull-clark" });
    job["levels"] = json!(1);
    let found = Net::of(&support::json(job));
    let [a, b] = [cube().positions[0], cube().positions[4]];
    let middle: [f64; 3] = std::array::from_fn(|k| f64::midpoint(a[k], b[k]));
    assert!(found.positions.contains(&middle), "the middle of a sharp edge stays on it");

    let mut job = with(&triangulated(&flat(2, 1)), &json!({ "pair_quads": true }));
    job["input"]["mesh"]["creases"] = json!([{ "edge": [0, 4], "sharpness": 0.5 }]);
    assert_eq!(Net::of(&support::json(job)).faces.iter().map(Vec::len).collect::<Vec<_>>(), [3, 3, 4]);
}

#[test]
fn channels_and_names_follow_the_repairs() {
    let net = apart(&triangulated(&flat(2, 1)));
    let mut job = with(&net, &json!({ "weld": 0, "pair_quads": true }));
    let heat: Vec<f64> = net.positions.iter().map(|[x, y, _]| x + 10.0 * y).collect();
    job["input"]["mesh"]["channels"] = json!({ "heat": heat });
    job["input"]["mesh"]["groups"] = json!([{ "name": "left", "faces": [1, 0] }]);
    job["input"]["mesh"]["materials"] = json!([{ "name": "red", "faces": [2] }]);
    let found = support::json(job);
    // the remaining vertices are the first ones, and the merged ones have the same numbers
    let stayed: Vec<f64> = Net::of(&found).positions.iter().map(|[x, y, _]| x + 10.0 * y).collect();
    assert_eq!(serde_json::from_value::<Vec<f64>>(found["channels"]["heat"].clone()).expect("numbers"), stayed);
    let sizes: Vec<usize> = Net::of(&found).faces.iter().map(Vec::len).collect();
    assert_eq!(sizes, [4, 3, 3], "faces of different materials stay apart");
    assert_eq!(found["groups"], json!([{ "name": "left", "faces": [0] }]));
    assert_eq!(found["materials"], json!([{ "name": "red", "faces": [1] }]));
}

#[test]
fn where_numbers_of_merged_vertices_differ_a_seam_stays() {
    let mut job = with(&apart(&flat(2, 1)), &json!({ "weld": 0 }));
    job["input"]["mesh"]["channels"] = json!({ "side": [0, 0, 0, 0, 1, 1, 1, 1], "same": [7, 7, 7, 7, 7, 7, 7, 7] });
    let found = support::json(job);
    assert_eq!(found["channels"]["same"], json!([7, 7, 7, 7, 7, 7]));
    assert_eq!(found["positions"].as_array().map(Vec::len), Some(6));
    let side = &found["channels"]["side"];
    assert_eq!(side["values"].as_array().map(Vec::len), Some(8));
    for (f, face) in side["faces"].as_array().into_iter().flatten().enumerate() {
        let index = |place: &Value| usize::try_from(place.as_u64().expect("an index")).expect("small");
        assert!(face.as_array().into_iter().flatten().all(|place| side["values"][index(place)] == json!(f)), "{side}");
    }
}

/// For a mesh in JSON, the key is that of the resulting mesh, and the result is the same apart from the warning.
#[test]
fn a_weld_that_merges_nothing_changes_nothing() {
    let outputs = |job: &Value| support::parsed(job.to_string().as_bytes()).expect("a job").id();
    assert_eq!(outputs(&with(&cube(), &json!({ "weld": 0 }))), outputs(&with(&cube(), &json!({}))));
}

#[test]
fn a_weld_that_merges_every_face_away_is_refused_by_its_distance() {
    let faults =
        support::parsed(with(&cube(), &json!({ "weld": 9 })).to_string().as_bytes()).expect_err("no face is left");
    let told = "merging vertices within 9 leaves none of 6 faces; choose a smaller distance";
    assert_eq!(
        faults.iter().map(|fault| (&*fault.pointer, &*fault.detail)).collect::<Vec<_>>(),
        [("/input/weld", told)]
    );
}

#[test]
fn triangulated_quads_come_back() {
    for net in [flat(4, 3), cuboid(), cube()] {
        let (found, warnings) = repaired(&triangulated(&net), &json!({ "pair_quads": true }));
        let n = net.faces.len();
        assert_eq!(warnings, [format!("{n} pairs of triangles were joined into quads; 0 triangles are left")]);
        support::nets::same_surface(&found, &net, 0.0).expect("the quads are those of before");
    }
}

/// Returns a flat grid of rectangles.
fn flat(n: usize, m: usize) -> Net {
    let mut net = grid(n, m);
    net.positions.iter_mut().for_each(|p| *p = [p[0] * 1.5, p[1], 2.0]);
    net
}

fn cuboid() -> Net {
    let positions = (0..8).map(|i| [f64::from(i & 1), 2.0 * f64::from(i >> 1 & 1), 3.0 * f64::from(i >> 2)]).collect();
    Net { positions, ..cube() }
}

#[test]
fn equal_choices_are_left_alone() {
    // a fan of six equilateral triangles: each could pair with either neighbour
    let turn = std::f64::consts::FRAC_PI_3;
    let around = |i: f64| [cos(i * turn), sin(i * turn), 0.0];
    let positions = std::iter::once([0.0; 3]).chain((0..6).map(|i| around(f64::from(i)))).collect();
    let net = Net { positions, faces: (0..6).map(|i| vec![0, i + 1, (i + 1) % 6 + 1]).collect() };
    let (found, warnings) = repaired(&net, &json!({ "pair_quads": true }));
    assert_eq!(found.faces, net.faces);
    assert_eq!(warnings, ["0 pairs of triangles were joined into quads; 6 triangles are left"]);
}

#[test]
fn bent_and_bowed_quads_are_left_alone() {
    // a roof, and two triangles that make an arrowhead
    let roof = [[0., 0., 0.], [1., 0., 1.], [1., 1., 1.], [0., 1., 0.], [2., 0., 0.]];
    let arrow = [[0., 0., 0.], [1., 0.25, 0.], [0., 1., 0.], [0.25, 0.25, 0.], [9., 9., 9.]];
    for (positions, faces) in [(roof, [[0, 1, 2], [1, 4, 2]]), (arrow, [[0, 1, 3], [3, 1, 2]])] {
        let net = Net { positions: positions.to_vec(), faces: faces.map(Vec::from).to_vec() };
        assert_eq!(repaired(&net, &json!({ "pair_quads": true })).0.faces, net.faces);
    }
}

#[test]
fn holes_and_shown_faces_are_not_joined() {
    let mut job = with(&triangulated(&flat(1, 1)), &json!({ "pair_quads": true }));
    job["input"]["mesh"]["holes"] = json!([1]);
    assert_eq!(Net::of(&support::json(job.clone())).faces, [[0, 1, 3]]);
    job["input"]["mesh"]["holes"] = json!([]);
    assert_eq!(Net::of(&support::json(job)).faces.len(), 1);
}

#[test]
fn faces_are_turned_before_they_are_joined() {
    let mut net = triangulated(&flat(2, 1));
    net.faces[1].reverse();
    let (found, warnings) = repaired(&net, &json!({ "pair_quads": true, "orient": "repair" }));
    support::nets::same_surface(&found, &flat(2, 1), 0.0).expect("the quads are those of before");
    let told = [
        "faces turned to agree with their neighbours: 1",
        "2 pairs of triangles were joined into quads; 0 triangles are left",
    ];
    assert_eq!(warnings, told);
    assert_eq!(
        support::faults(with(&net, &json!({ "pair_quads": true, "non_manifold": "refuse" }))).len(),
        1,
        "but only when asked to"
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    /// The brute-force definition: the lowest remaining vertex within the distance.
    #[test]
    fn the_grid_finds_what_looking_at_all_finds(
        places in proptest::collection::vec(proptest::array::uniform3(-20..20_i32), 1..60), distance in 0.0..6.0_f64,
    ) {
        let places: Vec<[f64; 3]> = places.into_iter().map(|p| p.map(f64::from)).collect();
        let welded = weld(&places, distance).expect("the distance is right");
        let mut kept: Vec<usize> = Vec::new();
        for (v, place) in places.iter().enumerate() {
            let apart = |w: usize| places[w].iter().zip(place).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
            let near = |w: &usize| apart(*w) / (distance * distance) <= 1.0 || apart(*w) == 0.0;
            let found = kept.iter().position(near).unwrap_or_else(|| {
                kept.push(v);
                kept.len() - 1
            });
            // at the boundary of the ball, the two computations may round differently
            let on_rim = kept.iter().any(|&w| (apart(w) - distance * distance).abs() < 1e-9 * distance * distance);
            prop_assume!(!on_rim || distance == 0.0);
            prop_assert_eq!(welded.image[v] as usize, found);
        }
    }

    /// Pairing changes faces, never the surface that they cover or the vertices.
    #[test]
    fn pairing_keeps_corners_and_the_manifold(net in manifold()) {
        let before = triangulated(&Net::of(&support::json(with(&net, &json!({})))));
        // a diagonal may coincide with an existing edge
        prop_assume!(render(&with(&before, &json!({ "non_manifold": "refuse" }))).is_ok());
        let (after, _) = repaired(&before, &json!({ "pair_quads": true }));
        prop_assert_eq!(&after.positions, &before.positions);
        let triangles = |net: &Net| net.faces.iter().map(|face| face.len() - 2).sum::<usize>();
        prop_assert_eq!(triangles(&after), triangles(&before));
        let edges = after.edges();
        prop_assert!(edges.is_subset(&before.edges()));
        prop_assert_eq!(before.edges().len() - edges.len(), before.faces.len() - after.faces.len());
    }

    #[test]
    fn faces_apart_are_welded_together_again(n in 3..7_usize, m in 3..7_usize) {
        let net = torus(n, m);
        let (found, _) = repaired(&apart(&net), &json!({ "weld": 0 }));
        prop_assert!(support::nets::same_surface(&found, &net, 0.0).is_ok());
    }
}
