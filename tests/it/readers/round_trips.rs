//! read(write(x)) = x for every format that can hold it: bit for bit if numbers are f64 or shortest text, rounded once
//! if they are f32.

use proptest::prelude::*;
use serde_json::{Value, json};

use super::{mesh, net};
use crate::support::nets::{Net, manifold};
use crate::support::render;

/// Returns the bytes of a net in a format.
fn written(net: &Net, options: &Value) -> Vec<u8> {
    in_format(&net.input(), options)
}

/// Returns the net as the library stores it: vertices that join several fans are split.
pub(super) fn kept(net: &Net) -> Net {
    Net::of(&crate::support::json(json!({ "input": net.input() })))
}

#[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is what is tested")]
fn rounded(net: &Net) -> Net {
    let positions = net.positions.iter().map(|p| p.map(|x| f64::from(x as f32))).collect();
    Net { positions, faces: net.faces.clone() }
}

/// Returns the net with the triangles that formats write.
fn triangulated(net: &Net) -> Net {
    let fan = |face: &Vec<usize>| (1..face.len() - 1).map(|i| vec![face[0], face[i], face[i + 1]]).collect::<Vec<_>>();
    Net { positions: net.positions.clone(), faces: net.faces.iter().flat_map(fan).collect() }
}

/// Numbers vertices by their first appearance in the faces, with each position once.
fn by_appearance(net: &Net) -> Net {
    let mut positions: Vec<[f64; 3]> = Vec::new();
    let mut number = |v: usize| {
        let place = net.positions[v];
        positions.iter().position(|known| known.map(f64::to_bits) == place.map(f64::to_bits)).unwrap_or_else(|| {
            positions.push(place);
            positions.len() - 1
        })
    };
    let faces = net.faces.iter().map(|face| face.iter().map(|&v| number(v)).collect()).collect();
    Net { positions, faces }
}

/// Returns nets with coordinates of many magnitudes, which text must preserve to the last bit.
fn scaled() -> impl Strategy<Value = Net> {
    let factor = prop_oneof![Just(1.0), Just(1e-6), Just(1e6), Just(1.0 / 3.0), Just(-7.123_456_789e-20)];
    (manifold(), factor).prop_map(|(net, factor)| {
        let positions = net.positions.iter().map(|p| p.map(|x| x * factor + 0.0)).collect();
        Net { positions, faces: net.faces }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn polygons_in_f64_come_back_bit_for_bit(net in scaled()) {
        let kept = kept(&net);
        for options in [
            json!({ "format": "obj" }),
            json!({ "format": "obj", "normals": "area" }),
            json!({ "format": "ply" }),
            json!({ "format": "ply", "face_sizes": "uint", "normals": "area" }),
            json!({ "format": "ply", "ascii": true }),
        ] {
            let format = options["format"].as_str().unwrap_or_default().to_owned();
            prop_assert_eq!(&super::net(&mesh(&format, &written(&net, &options))), &kept, "{}", options);
        }
    }

    #[test]
    fn polygons_in_f32_come_back_rounded_once(net in manifold(), ascii in any::<bool>()) {
        let bytes = written(&net, &json!({ "format": "ply", "precision": "f32", "ascii": ascii }));
        prop_assert_eq!(super::net(&mesh("ply", &bytes)), rounded(&kept(&net)));
    }

    #[test]
    fn gltf_comes_back_as_its_triangles(net in manifold()) {
        let expected = triangulated(&rounded(&kept(&net)));
        for format in ["glb", "gltf"] {
            let options = json!({ "format": format, "crease_angle": 180 });
            prop_assert_eq!(&super::net(&mesh(format, &written(&net, &options))), &expected);
        }
    }

    #[test]
    fn stl_comes_back_welded(net in manifold()) {
        let found = super::net(&mesh("stl", &written(&net, &json!({ "format": "stl" }))));
        prop_assert_eq!(found, by_appearance(&triangulated(&rounded(&kept(&net)))));
    }

    /// A job with the file is the same as one with the mesh: same bytes, same key.
    #[test]
    fn a_file_and_its_mesh_are_one_input(net in manifold()) {
        let kept = kept(&net);
        let obj = String::from_utf8(written(&kept, &json!({ "format": "obj" }))).expect("obj is text");
        let json_text = kept.to_json().to_string();
        let outputs = json!([{ "format": "json" }]);
        let direct = json!({ "input": kept.input(), "outputs": outputs });
        for text in [json!({ "format": "obj", "data": obj }), json!({ "format": "json", "data": json_text })] {
            let job = json!({ "input": { "text": text }, "outputs": outputs });
            prop_assert_eq!(render(&job), render(&direct));
            prop_assert_eq!(key(&job), key(&direct));
        }
    }
}

/// Returns groups and materials of some faces, as lists of a mesh.
fn sets(n_faces: usize) -> impl Strategy<Value = [Value; 2]> {
    let one = proptest::collection::vec(proptest::option::of(0..3_usize), n_faces).prop_map(|of_faces| {
        let faces = |name: usize| (0..of_faces.len()).filter(|&f| of_faces[f] == Some(name)).collect::<Vec<_>>();
        let sets = (0..3).map(|name| (["top", "a.side", "x"][name], faces(name)));
        let sets = sets.filter(|(_, faces)| !faces.is_empty());
        json!(sets.map(|(name, faces)| json!({ "name": name, "faces": faces })).collect::<Vec<_>>())
    });
    (one.clone(), one).prop_map(|(groups, materials)| [groups, materials])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    /// Faces in no group and without a material are read as such.
    #[test]
    fn groups_and_materials_of_some_faces_come_back(
        (net, [groups, materials]) in manifold().prop_flat_map(|net| (Just(net.clone()), sets(net.faces.len())))
    ) {
        let mut mesh = kept(&net).to_json();
        (mesh["groups"], mesh["materials"]) = (groups, materials);
        let input = json!({ "mesh": mesh });
        let direct = in_format(&input, &json!({ "format": "json" }));
        for format in ["obj", "ply", "json"] {
            let bytes = in_format(&input, &json!({ "format": format }));
            let text = json!({ "format": format, "data": base64(&bytes), "encoding": "base64" });
            let again = in_format(&json!({ "text": text }), &json!({ "format": "json" }));
            let [again, direct] = [&again, &direct].map(|bytes| by_name(bytes));
            prop_assert_eq!(again, direct, "{}", format);
        }
    }
}

/// Returns a mesh with its groups and materials sorted by name, as files list them in the order of their faces.
/// Warnings are removed, as OBJ without a library warns that looks may be missing.
fn by_name(bytes: &[u8]) -> Value {
    let mut mesh: Value = serde_json::from_slice(bytes).expect("json");
    mesh.as_object_mut().expect("an object").remove("warnings");
    for name in ["groups", "materials"] {
        if let Some(sets) = mesh[name].as_array_mut() {
            sets.sort_by_key(|set| set["name"].to_string());
        }
    }
    mesh
}

/// Returns the bytes of an input in a format.
pub(super) fn in_format(input: &Value, options: &Value) -> Vec<u8> {
    let job = json!({ "input": input, "outputs": [options] });
    render(&job).unwrap_or_else(|faults| panic!("{options}: {faults:?}")).0
}

/// Returns the mesh of a file, in the notation of jobs.
pub(super) fn again(format: &Value, bytes: &[u8]) -> Value {
    let text = json!({ "format": format, "data": base64(bytes), "encoding": "base64" });
    crate::support::json(json!({ "input": { "text": text } }))
}

fn key(job: &Value) -> String {
    let job = crate::support::parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{faults:?}"));
    job.id().to_string()
}

/// Models far away are written near the origin with a translation, which is read in f64.
#[test]
fn gltf_far_from_the_origin_comes_back_to_f32_of_the_model_itself() {
    let cube = crate::support::nets::cube();
    let place = |[x, y, z]: [f64; 3]| [x / 3.0 + 1e6, y / 7.0 + 2e6 + 0.1, z * 0.01];
    let far = Net { positions: cube.positions.iter().copied().map(place).collect(), ..cube };
    for format in ["glb", "gltf"] {
        let found = net(&mesh(format, &written(&far, &json!({ "format": format }))));
        for (found, expected) in found.positions.iter().zip(&far.positions) {
            // f32 rounds numbers of at most half a unit from the centre
            let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-7, "{format}: {found:?} for {expected:?}");
        }
    }
}

#[test]
fn binary_files_travel_in_base64() {
    let cube = crate::support::nets::cube();
    let glb = written(&cube, &json!({ "format": "glb" }));
    let gltf = String::from_utf8(written(&cube, &json!({ "format": "gltf" }))).expect("gltf is text");
    // the text form of the same file contains base64 of the same kind
    let data = base64(&glb);
    let outputs = json!([{ "format": "json" }]);
    let binary = json!({ "format": "glb", "data": data, "encoding": "base64" });
    let text = json!({ "format": "gltf", "data": gltf, "encoding": "text" });
    let [binary, text] = [binary, text].map(|text| render(&json!({ "input": { "text": text }, "outputs": outputs })));
    assert!(binary.is_ok());
    assert_eq!(binary, text);
}

/// Encodes bytes in base64 without padding.
pub(super) fn base64(bytes: &[u8]) -> String {
    let letters = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let bit = |i: usize| bytes.get(i / 8).map_or(0, |byte| usize::from(byte >> (7 - i % 8) & 1));
    let letter = |i: usize| char::from(letters[(0..6).fold(0, |sum, k| 2 * sum + bit(6 * i + k))]);
    (0..(8 * bytes.len()).div_ceil(6)).map(letter).collect()
}

/// Returns a cube with channels, groups and materials.
fn carrying() -> Value {
    let mut mesh = crate::support::nets::cube().to_json();
    let color = |i: u32| [f64::from(i & 1), f64::from(i >> 1 & 1), 0.2];
    let heat = (0..8).map(|i| f64::from(i) / 3.0).collect::<Vec<_>>();
    mesh["channels"] = json!({ "color": (0..8).map(color).collect::<Vec<_>>(), "heat": heat });
    mesh["groups"] = json!([{ "name": "top", "faces": [1] }, { "name": "sides", "faces": [2, 3, 4] }]);
    mesh["materials"] = json!([{ "name": "red", "faces": [0, 1, 2] }, { "name": "blue", "faces": [3, 4, 5] }]);
    json!({ "mesh": mesh })
}

/// Carried data is preserved: the file that is read is written identically.
#[test]
fn channels_groups_and_materials_come_back() {
    for options in [
        json!({ "format": "ply" }),
        json!({ "format": "ply", "ascii": true }),
        json!({ "format": "obj" }),
        json!({ "format": "json" }),
    ] {
        let bytes = in_format(&carrying(), &options);
        let text = json!({ "format": options["format"], "data": base64(&bytes), "encoding": "base64" });
        let again = in_format(&json!({ "text": text }), &options);
        assert_eq!(String::from_utf8_lossy(&again), String::from_utf8_lossy(&bytes), "{options}");
    }
    let glb = mesh("glb", &in_format(&carrying(), &json!({ "format": "glb" })));
    let color = glb.channels.iter().find(|channel| channel.name == "color").expect("it has colours");
    assert!(color.values.iter().all(|x| [0.0, 0.2, 1.0].iter().any(|y| (x - y).abs() < 1e-6)), "{color:?}");
    let names: Vec<&str> = glb.materials.iter().map(|set| set.name.as_str()).collect();
    assert_eq!(names, ["red", "blue"]);
}
