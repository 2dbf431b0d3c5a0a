//! Smaller glTF: short indices, an order for graphics processors, numbers of 16 bits, and encoded views.

mod levels_of_detail;
mod model;
mod refused;

use std::collections::{BTreeMap, BTreeSet};

use planish::job::limits::Limits;
use planish::output::Size;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::{nets, parsed, peak, render};
use model::Model;

/// Returns a job on a mesh, refined once, so that the origins of its vertices differ.
fn job(mesh: &Value, output: &Value) -> Value {
    json!({ "input": { "mesh": mesh }, "plan": { "preset": "catmull-clark" }, "levels": 1, "outputs": [output] })
}

fn written(job: &Value) -> Vec<u8> {
    render(job).unwrap_or_else(|faults| panic!("{faults:?} for {job}")).0
}

/// Returns the options of each way to make a model smaller.
fn ways() -> [Value; 5] {
    [
        json!({ "vertex_order": "cache" }),
        json!({ "compression": "quantize" }),
        json!({ "compression": "quantize", "vertex_order": "cache" }),
        json!({ "compression": "meshopt" }),
        json!({ "compression": "meshopt", "normals": "none" }),
    ]
}

fn with(way: &Value, more: &Value) -> Value {
    let mut output = way.clone();
    more.as_object().expect("options").iter().for_each(|(name, value)| output[name] = value.clone());
    output
}

/// Returns the positions of vertices by their origins. A vertex in which two sheets of a mesh touch has a position on
/// each.
fn by_origin(
    origins: Vec<[u32; 2]>,
    places: impl IntoIterator<Item = [f64; 3]>,
) -> BTreeMap<[u32; 2], BTreeSet<[u64; 3]>> {
    let mut all: BTreeMap<_, BTreeSet<_>> = BTreeMap::new();
    for (origin, place) in origins.into_iter().zip(places) {
        all.entry(origin).or_default().insert(place.map(f64::to_bits));
    }
    all
}

/// Returns the triangles of a model by the positions of their corners, each rotated to start at the smallest.
fn triangles(model: &Model) -> BTreeSet<[[u64; 3]; 3]> {
    let places: Vec<[u64; 3]> = model.places(0).iter().map(|place| place.map(f64::to_bits)).collect();
    let turned = |[a, b, c]: [usize; 3]| {
        let [a, b, c] = [places[a], places[b], places[c]];
        [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().expect("three")
    };
    (0..model.n_primitives()).flat_map(|i| model.triangles(i)).map(turned).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_vertex_is_farther_from_its_place_than_stated(
        net in nets::manifold(),
        scale in -12..12_i32,
        far in prop_oneof![Just(0.0), Just(1e3), Just(-1e6)],
    ) {
        let factor = planish::math::functions::pow(10.0, f64::from(scale));
        let mut net = net;
        net.positions.iter_mut().flatten().for_each(|x| *x = (*x + far) * factor);
        let told = written(&job(&net.to_json(), &json!({ "format": "json" })));
        let told: Value = serde_json::from_slice(&told).expect("JSON");
        let exact: Vec<[f64; 3]> = serde_json::from_value(told["positions"].clone()).expect("positions");
        let plain = Model::of(&written(&job(&net.to_json(), &json!({ "format": "glb", "ids": true }))));
        for way in ways() {
            let output = with(&way, &json!({ "format": "glb", "ids": true }));
            let small = Model::of(&written(&job(&net.to_json(), &output)));
            let places = by_origin(origins(&small), small.places(0));
            if way.get("compression").is_none() {
                prop_assert_eq!(places, by_origin(origins(&plain), plain.places(0)), "an order changes no place");
                continue;
            }
            let error = small.document["meshes"][0]["extras"]["position_error"].as_f64().expect("an error");
            let meant = by_origin(origins(&plain), exact.iter().copied());
            prop_assert!(places.keys().eq(meant.keys()), "the same vertices, with {way}");
            for (origin, places) in places {
                for place in places {
                    let near = |meant: &[u64; 3]| {
                        place.iter().zip(meant).all(|(x, y)| (f64::from_bits(*x) - f64::from_bits(*y)).abs() <= error)
                    };
                    prop_assert!(meant[&origin].iter().any(near), "a place of {origin:?} with {way}, within {error}");
                }
            }
        }
    }
}

/// Returns the origins of the vertices of a model, in order.
fn origins(model: &Model) -> Vec<[u32; 2]> {
    let key = |origin: &Vec<f64>| [origin[0], origin[1]].map(|x| format!("{x}").parse().expect("a whole number"));
    model.rows(0, "_ORIGIN").iter().map(key).collect()
}

/// Returns a grid with every kind of data that a mesh can carry.
fn laden() -> Value {
    let net = nets::grid(3, 4);
    let (n, last) = (net.positions.len(), net.faces.len() - 1);
    let mut mesh = net.to_json();
    let share =
        |i: usize| format!("{i}").parse::<f64>().expect("a number") / format!("{n}").parse::<f64>().expect("one");
    mesh["channels"] = json!({
        "color": (0..n).map(|i| [share(i), 1.0 - share(i), 0.5, 1.0]).collect::<Vec<_>>(),
        "heat": (0..n).map(|i| 40.0 * share(i)).collect::<Vec<_>>(),
    });
    mesh["uvs"] = json!({
        "values": (0..n).map(|i| [share(i), 1.0 - share(i)]).collect::<Vec<_>>(), "faces": net.faces,
    });
    mesh["groups"] = json!([{ "name": "a", "faces": [0, 3] }, { "name": "b", "faces": [1] }]);
    mesh["materials"] = json!([{ "name": "m", "faces": [0, last] }]);
    mesh
}

#[test]
fn all_that_a_vertex_carries_goes_where_the_vertex_goes() {
    let plain = Model::of(&written(&job(&laden(), &json!({ "format": "glb", "ids": true }))));
    let rows = |model: &Model, name: &str| -> BTreeMap<[u32; 2], Vec<f64>> {
        origins(model).into_iter().zip(model.rows(0, name)).collect()
    };
    for way in ways() {
        let small = Model::of(&written(&job(&laden(), &with(&way, &json!({ "format": "glb", "ids": true })))));
        let exact = way.get("compression").is_none();
        for (name, error) in [("COLOR_0", 1e-5), ("_HEAT", 0.0), ("TEXCOORD_0", 8e-6), ("NORMAL", 0.02)] {
            if name == "NORMAL" && way["normals"] == "none" {
                continue;
            }
            let (found, known) = (rows(&small, name), rows(&plain, name));
            for (origin, known) in known {
                for (x, y) in found[&origin].iter().zip(known) {
                    assert!((x - y).abs() <= if exact { 0.0 } else { error }, "{name} of {origin:?}: {x} for {y}");
                }
            }
        }
        let names: Vec<&Value> =
            small.document["nodes"].as_array().expect("nodes").iter().map(|n| &n["name"]).collect();
        assert!(names.contains(&&json!("a")) && names.contains(&&json!("b")), "{names:?}");
        if exact {
            assert_eq!(triangles(&small), triangles(&plain));
        }
        // each triangle still names its original face: its corners stem from that face and its neighbourhood
        let faces = |model: &Model| -> Vec<(BTreeSet<[u32; 2]>, u64)> {
            let (origins, mut all) = (origins(model), Vec::new());
            for i in 0..model.n_primitives() {
                let corners = model.triangles(i).into_iter().map(|corners| corners.map(|v| origins[v]).into());
                all.extend(corners.zip(model.faces(i)));
            }
            all.sort();
            all
        };
        assert_eq!(faces(&small), faces(&plain), "{way}");
    }
}

#[test]
fn indices_take_16_bits_up_to_65_535_vertices() {
    // the limit of 65,535 is between grids of 255 x 255 and 255 x 256 faces
    for (n, bytes, kind) in [(254, 6, 5123), (255, 12, 5125)] {
        let net = nets::grid(n, 255);
        let mut question = json!({ "input": { "mesh": net.to_json() } });
        question["outputs"] = json!([{ "format": "glb", "normals": "none" }]);
        let model = Model::of(&written(&question));
        assert_eq!(net.positions.len() > 65_535, kind == 5125);
        let indices = &model.document["meshes"][0]["primitives"][0]["indices"];
        let accessor = &model.document["accessors"][Model::number(indices)];
        assert_eq!(accessor["componentType"], kind);
        let view = &model.document["bufferViews"][Model::number(&accessor["bufferView"])];
        assert_eq!(Model::number(&view["byteLength"]), bytes * 2 * net.faces.len());
        assert_eq!(model.triangles(0).iter().flatten().max(), Some(&(net.positions.len() - 1)));
    }
}

/// Returns the number of vertices per triangle that a processor computes which caches the last 16.
fn computed(triangles: &[[usize; 3]]) -> f64 {
    let (mut kept, mut computed) = (Vec::new(), 0_u32);
    for &v in triangles.as_flattened() {
        if !kept.contains(&v) {
            computed += 1;
            kept.push(v);
            kept.drain(..kept.len().saturating_sub(16));
        }
    }
    f64::from(computed) / f64::from(u32::try_from(triangles.len()).expect("few"))
}

#[test]
fn the_order_for_processors_computes_fewer_vertices() {
    let question = |order: &str| {
        let mesh = nets::cube().to_json();
        let output = json!({ "format": "glb", "vertex_order": order });
        json!({ "input": { "mesh": mesh }, "plan": { "preset": "catmull-clark" }, "levels": 5, "outputs": [output] })
    };
    let [plain, ordered] = ["documented", "cache"].map(|order| Model::of(&written(&question(order))));
    assert_eq!(triangles(&plain), triangles(&ordered));
    let [before, after] = [plain, ordered].map(|model| computed(&model.triangles(0)));
    assert!(before > 1.0 && after < 0.75, "{before} and {after} vertices a triangle");
}

#[test]
fn sizes_and_memory_are_forecast_as_bounds() {
    for way in ways() {
        for format in ["glb", "gltf"] {
            for levels in [0, 3] {
                let mut question = job(&laden(), &with(&way, &json!({ "format": format, "ids": true })));
                question["levels"] = json!(levels);
                let job = parsed(question.to_string().as_bytes()).expect("a job");
                let admitted = Limits::default().admit(job).expect("within limits");
                let Size::AtMost(most) = admitted.estimate().outputs[0].1 else { panic!("{question} has no bound") };
                let ((bytes, _), taken) = peak(|| render(&question).expect("a model"));
                assert!(bytes.len() as u128 <= most, "{} of at most {most} bytes for {question}", bytes.len());
                let memory = admitted.estimate().memory_bytes;
                assert!(u128::from(taken) <= memory + (1 << 20), "{taken} of {memory} bytes of memory for {question}");
            }
        }
    }
}

#[test]
fn an_animal_of_a_million_and_a_half_bytes_takes_less_than_a_quarter_of_one() {
    let text = include_str!("../../api/examples/jobs/animal-catmull-clark-glb.json");
    let mut question: Value = serde_json::from_str(text).expect("JSON");
    let mut length = |compression: &str| {
        question["levels"] = json!(3);
        question["outputs"] = json!([{ "format": "glb", "compression": compression }]);
        written(&question).len()
    };
    assert_eq!(length("none"), 1_149_004);
    assert!(length("quantize") < 770_000);
    assert!(length("meshopt") < 250_000);
}
