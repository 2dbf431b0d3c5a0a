//! Texture coordinates: seams remain seams, regions are refined as separate meshes, and formats split vertices where
//! necessary.

use proptest::prelude::*;
use serde_json::{Value, json};

use super::{job, refusal, text, told, written};
use crate::support::nets::{self, Net, distance};

/// A corner of a face: its vertex and its place.
type Pair = (usize, usize);

pub(super) struct Unfolded {
    pub(super) net: Net,
    pub(super) values: Vec<[f64; 2]>,
    pub(super) faces: Vec<Vec<usize>>,
    pub(super) origins: Vec<usize>,
}

impl Unfolded {
    pub(super) fn of(result: &Value) -> Self {
        let read = |value: &Value| serde_json::from_value(value.clone()).expect("lists of indices");
        Self {
            net: Net::of(result),
            values: serde_json::from_value(result["uvs"]["values"].clone()).expect("pairs"),
            faces: read(&result["uvs"]["faces"]),
            origins: serde_json::from_value(result["ids"]["faces"].clone()).expect("indices"),
        }
    }

    /// Returns the vertex and the place at corner `j` of face `f`.
    pub(super) fn corner(&self, f: usize, j: usize) -> Pair {
        let j = j % self.faces[f].len();
        (self.net.faces[f][j], self.faces[f][j])
    }

    /// Returns for each inner edge the two faces, and whether they share both places.
    fn inner_edges(&self) -> Vec<([usize; 2], bool)> {
        let mut sides = std::collections::BTreeMap::<(usize, usize), (usize, [Pair; 2])>::new();
        let mut edges = Vec::new();
        for f in 0..self.faces.len() {
            for j in 0..self.faces[f].len() {
                let [a, b] = [self.corner(f, j), self.corner(f, j + 1)];
                match sides.remove(&(b.0, a.0)) {
                    Some((g, ends)) => edges.push(([g, f], ends == [b, a])),
                    None => drop(sides.insert((a.0, b.0), (f, [a, b]))),
                }
            }
        }
        edges
    }
}

/// Returns texture coordinates with each face as a separate region.
fn islands(net: &Net) -> Value {
    let mut values: Vec<[f64; 2]> = Vec::new();
    let mut faces: Vec<Vec<usize>> = Vec::new();
    for (f, face) in net.faces.iter().enumerate() {
        faces.push((0..face.len()).map(|j| values.len() + j).collect());
        let shift = f64::from(u8::try_from(f % 200).expect("below 200"));
        values.extend((0..face.len()).map(|j| [shift + [0.0, 0.5, 0.5, 0.25][j % 4], [0.0, 0.0, 0.5, 0.75][j % 4]]));
    }
    json!({ "values": values, "faces": faces })
}

/// Returns texture coordinates without seams: those of the vertices.
pub(super) fn seamless(net: &Net, interpolation: &str) -> Value {
    let values: Vec<[f64; 2]> = net.positions.iter().map(|p| [p[0], p[1]]).collect();
    json!({ "values": values, "faces": net.faces, "interpolation": interpolation })
}

fn with_uvs(net: &Net, uvs: &Value, plan: &Value, levels: u32) -> Value {
    job(net, &json!({ "uvs": uvs }), plan, levels)
}

fn unfolded(net: &Net, uvs: &Value, plan: &Value, levels: u32) -> Unfolded {
    Unfolded::of(&told(with_uvs(net, uvs, plan, levels)))
}

fn catmull_clark(boundary: &str) -> Value {
    json!({ "preset": "catmull-clark", "boundary": boundary })
}

/// Checks that exactly those faces are joined in the result whose original faces are joined in the input.
fn check_seams(net: &Net, uvs: &Value, plan: &Value, levels: u32) {
    let coarse = unfolded(net, uvs, plan, 0);
    // two faces may share several edges, some of them joined
    let mut joined = std::collections::BTreeMap::<[usize; 2], Vec<bool>>::new();
    for ([f, g], together) in coarse.inner_edges() {
        joined.entry([f.min(g), f.max(g)]).or_default().push(together);
    }
    let fine = unfolded(net, uvs, plan, levels);
    for ([f, g], together) in fine.inner_edges() {
        let [a, b] = [fine.origins[f], fine.origins[g]];
        let sound = if a == b { together } else { joined[&[a.min(b), a.max(b)]].contains(&together) };
        assert!(sound, "faces {f} and {g} of {a} and {b}: {together}");
    }
}

#[test]
fn seams_stay_seams() {
    for net in [nets::cube(), nets::prism(5), nets::mixed(), nets::grid(3, 2)] {
        for interpolation in ["none", "corners-only", "corners-plus1", "corners-plus2", "boundaries", "all"] {
            let mut uvs = islands(&net);
            uvs["interpolation"] = json!(interpolation);
            check_seams(&net, &uvs, &catmull_clark("edge-and-corner"), 2);
            // one face shares one place with its neighbours, and its other values are its own
            let mut uvs = seamless(&net, interpolation);
            let n = net.positions.len();
            let values = uvs["values"].as_array_mut().expect("values");
            values.extend([json!([9.0, 9.5]), json!([9.5, 9.0])]);
            uvs["faces"][0][0] = json!(n);
            uvs["faces"][0][1] = json!(n + 1);
            check_seams(&net, &uvs, &catmull_clark("edge-only"), 2);
        }
    }
}

#[test]
fn without_seams_they_are_refined_like_a_channel() {
    for net in [nets::torus(4, 3), nets::cube(), nets::mixed(), nets::grid(3, 2)] {
        for plan in [
            catmull_clark("edge-only"),
            json!({ "word": "UCP", "boundary": "edge-only", "parameters": { "kernel": 1.5, "delta": 0.3 } }),
            json!({ "preset": "kobbelt", "boundary": "edge-only" }),
        ] {
            let found = unfolded(&net, &seamless(&net, "none"), &plan, 2);
            check_at_vertices(&found, 0.0);
        }
    }
}

/// Vertices are in the order of the input, whatever the order of the faces, and so are places.
#[test]
fn without_seams_places_have_the_order_of_vertices() {
    for net in [nets::torus(4, 3), nets::cube(), nets::mixed(), nets::grid(3, 2), nets::prism(5)] {
        let faces: Vec<_> = net.faces.iter().rev().cloned().collect();
        let net = Net { positions: net.positions, faces };
        for levels in 0..3 {
            let found = unfolded(&net, &seamless(&net, "all"), &catmull_clark("edge-only"), levels);
            assert_eq!(found.faces, found.net.faces, "level {levels}");
        }
    }
}

#[test]
fn triangles_and_other_arities_have_texture_coordinates_too() {
    let (triangles, quads) = (nets::tetrahedron(), nets::grid(3, 2));
    for (net, plan) in [
        (&triangles, json!({ "preset": "loop", "boundary": "edge-only" })),
        (&triangles, json!({ "word": "U3C", "boundary": "edge-only", "parameters": { "split": "triangle" } })),
        (&quads, json!({ "word": "U3C", "boundary": "edge-only" })),
    ] {
        check_at_vertices(&unfolded(net, &seamless(net, "none"), &plan, 2), 0.0);
        for interpolation in ["none", "corners-plus2", "all"] {
            let mut uvs = islands(net);
            uvs["interpolation"] = json!(interpolation);
            check_seams(net, &uvs, &plan, 2);
        }
    }
}

/// Checks that the texture coordinates of each corner are the first two coordinates of its vertex.
pub(super) fn check_at_vertices(found: &Unfolded, tolerance: f64) {
    assert!(!found.faces.is_empty());
    for f in 0..found.faces.len() {
        for j in 0..found.faces[f].len() {
            let (vertex, place) = found.corner(f, j);
            let (p, uv) = (found.net.positions[vertex], found.values[place]);
            assert!(distance(&p[..2], &uv) <= tolerance, "face {f}, corner {j}: {p:?} and {uv:?}");
        }
    }
}

/// A region without neighbours in another face gives the same numbers as the positions of a mesh cut open there.
#[test]
fn a_region_is_refined_as_a_mesh_of_its_own() {
    let net = nets::cube();
    for (interpolation, boundary) in [("none", "edge-only"), ("corners-only", "edge-and-corner")] {
        let mut uvs = islands(&net);
        uvs["interpolation"] = json!(interpolation);
        let found = unfolded(&net, &uvs, &catmull_clark("edge-only"), 2);
        let values: Vec<[f64; 2]> = serde_json::from_value(uvs["values"].clone()).expect("pairs");
        let island: Vec<[f64; 3]> = values[..4].iter().map(|p| [p[0], p[1], 0.0]).collect();
        let alone =
            job(&Net { positions: island, faces: vec![vec![0, 1, 2, 3]] }, &json!({}), &catmull_clark(boundary), 2);
        let alone = Net::of(&told(alone));
        for (face, expected) in found.faces.iter().zip(&alone.faces) {
            for (&place, &vertex) in face.iter().zip(expected) {
                assert!(distance(&found.values[place], &alone.positions[vertex][..2]) == 0.0, "{interpolation}");
            }
        }
    }
}

#[test]
fn linear_ones_are_bilinear_on_each_face() {
    for net in [nets::cube(), nets::mixed(), nets::prism(5)] {
        for uvs in [islands(&net), seamless(&net, "all")] {
            let [smooth, bilinear] =
                [catmull_clark("edge-only"), json!({ "word": "U" })].map(|plan| unfolded(&net, &uvs, &plan, 3));
            assert_eq!(smooth.values, bilinear.values);
            assert_eq!(smooth.faces, bilinear.faces);
        }
    }
    check_at_vertices(&unfolded(&nets::mixed(), &seamless(&nets::mixed(), "all"), &json!({ "word": "U" }), 2), 0.0);
}

/// At the end of a crease on a seam, both values are as sharp as the crease makes one of them. The numbers are those of
/// OpenSubdiv 3.5.
#[test]
fn creases_that_end_on_a_seam_sharpen_both_sides() {
    let square = nets::grid(2, 2);
    let mut values: Vec<[f64; 2]> = (0..9).map(|i| [f64::from(i % 3), f64::from(i / 3)]).collect();
    values[4] = [1.3, 1.0];
    values.extend([[5.0, 0.0], [5.3, 1.0], [5.0, 2.0]]);
    let faces = json!([[0, 1, 4, 3], [9, 2, 5, 10], [3, 4, 7, 6], [10, 5, 8, 11]]);
    let middle = |interpolation: &str, creases: &[([usize; 2], f64)], corner: f64, levels: u32| {
        let uvs = json!({ "values": values, "faces": faces, "interpolation": interpolation });
        let sharp: Vec<Value> = creases.iter().map(|(e, s)| json!({ "edge": e, "sharpness": s })).collect();
        let mut question = job(&square, &json!({ "uvs": uvs }), &catmull_clark("edge-and-corner"), levels);
        question["input"]["mesh"]["creases"] = json!(sharp);
        question["input"]["mesh"]["corners"] = json!([{ "vertex": 4, "sharpness": corner }]);
        // places are numbered vertex by vertex, and vertex 1 has two
        Unfolded::of(&told(question)).values[5][0]
    };
    for interpolation in ["corners-plus1", "corners-plus2"] {
        let cases = [
            (vec![([4, 5], 10.0)], 0.0, 1, 1.3),
            (vec![([4, 5], 0.5)], 0.0, 1, 1.2625),
            (vec![([4, 5], 1.5)], 0.0, 1, 1.3),
            (vec![], 0.0, 1, 1.225),
            // a value that is sharp itself, or beside sharp edges of its own, follows no other
            (vec![([4, 5], 0.5)], 0.25, 1, 1.24375),
            (vec![([4, 5], 0.5), ([3, 4], 0.2)], 0.0, 1, 1.24),
            (vec![([4, 5], 10.0), ([3, 4], 0.2)], 0.25, 1, 1.3),
            // while the seam remains semi-sharp, the value follows wholly or not at all
            (vec![([4, 5], 0.5), ([1, 4], 0.75)], 0.0, 1, 1.2625),
            (vec![([4, 5], 0.5), ([1, 4], 1.25)], 0.0, 1, 1.3),
            (vec![([4, 5], 0.5), ([4, 7], 2.5)], 0.0, 1, 1.3),
            (vec![([4, 5], 0.5), ([4, 7], 10.0)], 0.0, 1, 1.2625),
            (vec![([4, 5], 1.5), ([4, 7], 1.75)], 0.0, 2, 1.28125),
            (vec![([4, 5], 1.5), ([4, 7], 2.25)], 0.0, 2, 1.3),
            (vec![([4, 5], 0.5), ([4, 7], 2.25)], 0.0, 2, 1.2625),
        ];
        for (creases, corner, levels, expected) in cases {
            let found = middle(interpolation, &creases, corner, levels);
            assert!((found - expected).abs() < 1e-15, "{interpolation} {creases:?} {corner}: {found}, not {expected}");
        }
    }
    assert!((middle("corners-only", &[([4, 5], 10.0)], 0.0, 1) - 1.225).abs() < 1e-15);
}

/// The fixed values on seams and boundaries of a square of 2 x 2 quads.
#[test]
fn interpolations_keep_what_their_names_say() {
    // places 0..9 are the vertices row by row; faces: lower left, lower right, upper left, upper right
    let square = nets::grid(2, 2);
    let kept = |uvs: &Value, interpolation: &str| -> Vec<usize> {
        let mut uvs = uvs.clone();
        uvs["interpolation"] = json!(interpolation);
        let before = unfolded(&square, &uvs, &catmull_clark("edge-only"), 0);
        let after = unfolded(&square, &uvs, &catmull_clark("edge-only"), 1);
        let places = 0..before.values.len();
        places.filter(|&place| distance(&before.values[place], &after.values[place]) == 0.0).collect()
    };
    let bent: Vec<[f64; 2]> =
        (0..9).map(|i| [f64::from(i % 3) + 0.1 * f64::from(i * i), f64::from(i / 3 * i)]).collect();
    let whole = json!({ "values": bent, "faces": square.faces });
    assert_eq!(kept(&whole, "none"), Vec::<usize>::new());
    for interpolation in ["corners-only", "corners-plus1", "corners-plus2"] {
        assert_eq!(kept(&whole, interpolation), [0, 2, 6, 8], "{interpolation}");
    }
    assert_eq!(kept(&whole, "boundaries"), [0, 1, 2, 3, 5, 6, 7, 8]);
    assert_eq!(kept(&whole, "all").len(), 9);
    // the seam between the lower faces ends in the middle: the middle is a dart, the ends of the seam are corners
    let mut values = bent.clone();
    values.push([7.0, -3.0]);
    let dart = json!({ "values": values, "faces": [[0, 1, 4, 3], [9, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]] });
    // places, vertex by vertex: 1 and 2 belong to vertex 1, 5 to the middle
    for interpolation in ["corners-only", "corners-plus1"] {
        assert_eq!(kept(&dart, interpolation), [0, 1, 2, 3, 7, 9], "{interpolation}");
    }
    assert_eq!(kept(&dart, "corners-plus2"), [0, 1, 2, 3, 5, 7, 9]);
    // one separate face: the middle has a corner of it and, around it, the concave rest
    let mut values = bent.clone();
    values.extend([[7.0, -3.0], [8.0, -2.0], [6.5, -1.5], [6.0, -1.0]]);
    let cut = json!({ "values": values, "faces": [[9, 10, 11, 12], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]] });
    // places: vertex 1 has 1 and 2, vertex 3 has 4 and 5, the middle has 6 in the separate face and 7
    for interpolation in ["corners-only", "corners-plus1"] {
        assert_eq!(kept(&cut, interpolation), [0, 1, 2, 3, 4, 5, 6, 9, 11], "{interpolation}");
    }
    assert_eq!(kept(&cut, "corners-plus2"), [0, 1, 2, 3, 4, 5, 6, 7, 9, 11]);
    // three regions at the middle: the region of two faces keeps its value there, too
    let mut values = bent;
    values.extend([
        [7.0, -3.0],
        [8.0, -2.0],
        [6.5, -1.5],
        [6.0, -1.0],
        [-3.0, 2.0],
        [-2.0, 2.5],
        [-2.5, 3.5],
        [-3.5, 3.0],
    ]);
    let three = json!({ "values": values, "faces": [[9, 10, 11, 12], [13, 14, 15, 16], [3, 4, 7, 6], [4, 5, 8, 7]] });
    assert_eq!(kept(&three, "corners-only"), [0, 1, 2, 3, 4, 5, 6, 7, 9, 10, 11, 13]);
    assert_eq!(kept(&three, "corners-plus1"), [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 13]);
}

#[test]
fn formats_part_vertices_on_seams_and_nothing_else() {
    let net = nets::cube();
    let question = with_uvs(&net, &islands(&net), &catmull_clark("edge-only"), 1);
    let obj = text(&question, &json!({ "format": "obj", "normals": "area" }));
    let count = |what: &str| obj.lines().filter(|line| line.starts_with(what)).count();
    assert_eq!(["v ", "vt ", "vn ", "f "].map(count), [26, 54, 26, 24]);
    let corner = obj.lines().last().and_then(|line| line.split(' ').next_back()).expect("a corner");
    assert_eq!(corner.split('/').count(), 3, "{corner}");
    let ply = text(&question, &json!({ "format": "ply", "ascii": true }));
    assert!(
        ply.contains("element vertex 54\n") && ply.contains("property double s\nproperty double t\nelement face 24")
    );
    let document: Value = serde_json::from_str(&text(&question, &json!({ "format": "gltf" }))).expect("JSON");
    let accessors = document["accessors"].as_array().expect("accessors");
    assert!(accessors[..3].iter().all(|accessor| accessor["count"] == 54), "{accessors:?}");
    let smooth = with_uvs(&net, &seamless(&net, "all"), &catmull_clark("edge-only"), 1);
    let document: Value = serde_json::from_str(&text(&smooth, &json!({ "format": "gltf" }))).expect("JSON");
    assert_eq!(document["accessors"][0]["count"], 26);
}

/// Positions with normals, each pair once: seams add none, sharp edges do.
#[test]
fn normals_feel_sharp_edges_but_no_seams() {
    let net = nets::cube();
    let creases = json!([{ "edge": [0, 1], "sharpness": 10 }, { "edge": [1, 3], "sharpness": 10 },
        { "edge": [3, 7], "sharpness": 10 }, { "edge": [4, 6], "sharpness": 2.5 }]);
    let pairs = |uvs: Option<Value>, creases: &Value| -> std::collections::BTreeSet<Vec<String>> {
        let mut question = job(&net, &json!({ "creases": creases }), &catmull_clark("edge-only"), 2);
        if let Some(uvs) = uvs {
            question["input"]["mesh"]["uvs"] = uvs;
        }
        for output in [json!({ "format": "glb" }), json!({ "format": "ply", "normals": "area" })] {
            let mut question = question.clone();
            question["outputs"] = json!([output]);
            super::files::check_size(&question);
        }
        let ply = text(&question, &json!({ "format": "ply", "ascii": true, "normals": "area" }));
        let n: usize =
            ply.split_once("element vertex ").and_then(|(_, rest)| rest.lines().next()?.parse().ok()).expect("a count");
        let rows = ply.split_once("end_header\n").expect("a header").1.lines().take(n);
        rows.map(|row| row.split(' ').take(6).map(str::to_owned).collect()).collect()
    };
    for (creases, at_least) in [(json!([]), 98), (creases, 105)] {
        let plain = pairs(None, &creases);
        assert!(plain.len() >= at_least, "{}", plain.len());
        for uvs in [islands(&net), seamless(&net, "none"), partly_cut(&net)] {
            assert_eq!(pairs(Some(uvs), &creases), plain);
        }
    }
}

/// Returns texture coordinates without seams except around the first face.
fn partly_cut(net: &Net) -> Value {
    let mut uvs = seamless(net, "corners-only");
    let n = net.positions.len();
    let corners: Vec<usize> = (0..net.faces[0].len()).map(|j| n + j).collect();
    uvs["faces"][0] = json!(corners);
    uvs["values"].as_array_mut().expect("values").extend(corners.iter().map(|&at| json!([at, 1])));
    uvs
}

#[test]
fn gltf_counts_texture_coordinates_downwards() {
    let net = nets::grid(1, 1);
    let question = with_uvs(
        &net,
        &json!({ "values": [[0, 0], [1, 0.25], [0.5, 1]], "faces": [[0, 1, 2, 2]] }),
        &json!({ "word": "U" }),
        0,
    );
    let glb = written(&question, &json!({ "format": "glb", "normals": "none" }));
    let uvs = &glb[glb.len() - 12 - 32..glb.len() - 12];
    let floats: Vec<f32> = uvs.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
    assert_eq!(
        floats.iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
        [0.0, 1.0, 1.0, 0.75, 0.5, 0.0, 0.5, 0.0_f32].map(f32::to_bits)
    );
}

#[test]
fn a_repaired_face_keeps_its_texture_coordinates() {
    let net = nets::cube();
    let mut turned = net.clone();
    let mut uvs = islands(&net);
    turned.faces[3].reverse();
    uvs["faces"][3].as_array_mut().expect("a face").reverse();
    let mut question = with_uvs(&turned, &uvs, &catmull_clark("edge-only"), 1);
    question["input"]["orient"] = json!("repair");
    let [repaired, sound] = [question, with_uvs(&net, &islands(&net), &catmull_clark("edge-only"), 1)].map(told);
    assert_eq!(repaired["faces"], sound["faces"]);
    assert_eq!(repaired["uvs"], sound["uvs"]);
}

#[test]
fn what_does_not_fit_the_mesh_is_named() {
    let net = nets::grid(2, 1);
    for (uvs, place) in [
        (json!({ "values": [[0, 0]], "faces": [[0, 0, 0, 0]] }), "/faces"),
        (json!({ "values": [[0, 0]], "faces": [[0, 0, 0, 0], [0, 0, 0]] }), "/faces/1"),
        (json!({ "values": [[0, 0]], "faces": [[0, 0, 0, 0], [0, 0, 1, 0]] }), "/faces/1/2"),
        (json!({ "values": [[0, 0]], "faces": [[0, 0, 0, 4_294_967_296_u64], [0, 0, 0, 0]] }), "/faces/0/3"),
        (json!({ "values": [[0]], "faces": [] }), "/values/0"),
        (json!({ "values": [[0, 0]], "faces": [], "interpolation": "some" }), "/interpolation"),
        (json!({ "values": [[0, 0]] }), "/faces"),
    ] {
        let found = refusal(&with_uvs(&net, &uvs, &json!({ "word": "U" }), 1));
        assert_eq!(found[0].0, format!("/input/mesh/uvs{place}"), "{uvs}: {found:?}");
    }
    for plan in [json!({ "word": "UD" }), json!({ "preset": "doo-sabin" })] {
        let net = nets::torus(4, 3);
        let found = refusal(&with_uvs(&net, &islands(&net), &plan, 1));
        assert!(found[0].1.contains("cannot carry uvs"), "{found:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_numbering_of_places_is_refined_and_forecast(
        net in nets::manifold(),
        picks in prop::collection::vec(0..6_usize, 64),
        interpolation in prop::sample::select(
            vec!["none", "corners-only", "corners-plus1", "corners-plus2", "boundaries", "all"],
        ),
        levels in 0..3_u32,
    ) {
        let values: Vec<[f64; 2]> = (0..6_u8).map(|i| [f64::from(i), f64::from(i * i) / 8.0]).collect();
        let mut at = picks.iter().cycle();
        let faces: Vec<Vec<usize>> =
            net.faces.iter().map(|face| face.iter().map(|_| *at.next().expect("a cycle")).collect()).collect();
        let uvs = json!({ "values": values, "faces": faces, "interpolation": interpolation });
        check_seams(&net, &uvs, &catmull_clark("edge-and-corner"), levels);
        for output in [
            json!({ "format": "json" }),
            json!({ "format": "obj", "normals": "area" }),
            json!({ "format": "glb", "ids": true }),
            json!({ "format": "gltf", "normals": "none" }),
            json!({ "format": "ply", "normals": "area", "precision": "f32" }),
            json!({ "format": "ply", "ascii": true }),
        ] {
            let mut question = with_uvs(&net, &uvs, &catmull_clark("edge-and-corner"), levels);
            question["outputs"] = json!([output]);
            super::files::check_size(&question);
        }
    }
}
