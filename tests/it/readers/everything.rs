//! read(write(x)) = x for all data of a mesh, in every format: a table states what a format cannot hold.

use std::collections::BTreeSet;

use proptest::prelude::*;
use serde_json::{Value, json};

use super::round_trips::{again, in_format, kept};
use crate::support::nets::{Net, manifold, triangle_manifold, triangulated};
use crate::support::render;

/// The precision of numbers after reading.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Numbers {
    F64,
    F32,
}

/// The colours of vertices after reading.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Colors {
    /// Unchanged.
    Whole,
    /// Without alpha.
    Opaque,
    /// In steps of 1/255.
    Bytes,
    Lost,
}

/// Data of a mesh beyond positions, triangles and colours.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Data {
    /// Faces with any number of corners.
    Polygons,
    Uvs,
    Channels,
    Groups,
    Materials,
    /// Materials of meshes whose vertices have no colours.
    MaterialsAlone,
    /// Creases and corners.
    Sharp,
}

/// The data that a format holds.
#[derive(Debug, Clone, Copy)]
struct Holds {
    numbers: Numbers,
    colors: Colors,
    data: &'static [Data],
}

impl Holds {
    fn has(self, data: Data) -> bool {
        self.data.contains(&data)
    }
}

const JSON: Holds = Holds {
    numbers: Numbers::F64,
    colors: Colors::Whole,
    data: &[Data::Polygons, Data::Uvs, Data::Channels, Data::Groups, Data::Materials, Data::Sharp],
};
const OBJ: Holds = Holds {
    colors: Colors::Opaque,
    data: &[Data::Polygons, Data::Uvs, Data::Groups, Data::Materials, Data::Sharp],
    ..JSON
};
const PLY: Holds = Holds {
    colors: Colors::Bytes,
    data: &[Data::Polygons, Data::Uvs, Data::Channels, Data::Groups, Data::Materials],
    ..JSON
};
const GLTF: Holds =
    Holds { numbers: Numbers::F32, data: &[Data::Uvs, Data::Channels, Data::Groups, Data::Materials], ..PLY };
const STL: Holds = Holds { colors: Colors::Lost, data: &[], ..GLTF };
const USDA: Holds = Holds { colors: Colors::Bytes, ..JSON };
const THREE_MF: Holds = Holds { data: &[Data::MaterialsAlone], ..PLY };

/// Returns every format that is written and read, in several variants, with the data that it holds. Options that add to
/// a file take nothing from it.
fn table() -> Vec<(Value, Holds)> {
    vec![
        (json!({ "format": "json" }), JSON),
        (json!({ "format": "obj" }), OBJ),
        (json!({ "format": "obj", "normals": "area", "ids": true }), OBJ),
        (json!({ "format": "ply" }), PLY),
        (json!({ "format": "ply", "ascii": true, "face_sizes": "uint" }), PLY),
        (json!({ "format": "ply", "normals": "area", "ids": true }), PLY),
        (json!({ "format": "ply", "precision": "f32" }), Holds { numbers: Numbers::F32, ..PLY }),
        (json!({ "format": "glb", "crease_angle": 180 }), GLTF),
        (json!({ "format": "gltf", "normals": "none", "ids": true }), GLTF),
        (json!({ "format": "stl" }), STL),
        (json!({ "format": "usda" }), USDA),
        (json!({ "format": "usda", "normals": "area" }), USDA),
        (json!({ "format": "3mf" }), THREE_MF),
    ]
}

#[test]
fn the_table_has_every_format_that_is_written_and_read() {
    let both = planish::input::READERS.iter().map(|reader| reader.name);
    let both = both.filter(|name| planish::output::named(name).is_some()).chain(["json"]);
    for name in both {
        assert!(table().iter().any(|(options, _)| options["format"] == name), "{name}");
    }
}

/// The content of a mesh, independent of the order of its vertices and faces.
#[derive(Debug, PartialEq)]
struct Content {
    faces: Vec<Face>,
    sharp: Vec<String>,
}

/// The corners in sequence, from the smallest on, with group and material.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Face {
    corners: Vec<Vec<String>>,
    names: [Option<String>; 2],
}

#[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is what is tested")]
fn rounded(x: f64, numbers: Numbers) -> f64 {
    if numbers == Numbers::F32 { f64::from(x as f32) } else { x }
}

fn index(value: &Value) -> usize {
    usize::try_from(value.as_u64().expect("an index")).expect("small")
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// Converts a number, or a list of numbers, with `each`.
fn numbers(value: &Value, each: impl Fn(f64) -> f64) -> Vec<f64> {
    let one = std::slice::from_ref(value);
    value.as_array().map_or(one, Vec::as_slice).iter().map(|x| each(x.as_f64().expect("a number"))).collect()
}

/// Returns the content of a mesh in the notation of jobs, without the data that a format cannot hold.
fn content(mesh: &Value, holds: Holds) -> Content {
    let told = |x: f64| rounded(x, holds.numbers);
    let place = |v: usize| format!("{:?}", numbers(&mesh["positions"][v], told));
    let channel = |name: &str, value: &Value| match (name == "color", holds.colors) {
        (false, _) => holds.has(Data::Channels).then(|| numbers(value, told)),
        (true, Colors::Lost) => None,
        (true, Colors::Whole) => Some(numbers(value, |x| x)),
        (true, Colors::Opaque) => Some(numbers(value, |x| x)[..3].to_vec()),
        (true, Colors::Bytes) => Some(numbers(value, |x| (255.0 * x).round())),
    };
    let corner = |f: usize, j: usize| {
        let v = index(&mesh["faces"][f][j]);
        let mut corner = vec![place(v)];
        for (name, values) in mesh["channels"].as_object().into_iter().flatten() {
            corner.extend(channel(name, &values[v]).map(|values| format!("{name} {values:?}")));
        }
        let uvs = &mesh["uvs"];
        if holds.has(Data::Uvs) && uvs.is_object() {
            let [u, v] = &numbers(&uvs["values"][index(&uvs["faces"][f][j])], |x| x)[..] else { panic!("{uvs}") };
            // glTF counts v downwards
            let v = if holds.has(Data::Polygons) { told(*v) } else { 1.0 - told(1.0 - v) };
            corner.push(format!("uv {:?}", [told(*u), v]));
        }
        corner.sort_unstable();
        corner
    };
    let alone = mesh["channels"]["color"].is_null();
    let materials = holds.has(Data::Materials) || holds.has(Data::MaterialsAlone) && alone;
    let name = |kind: &str, f: usize| {
        let set = list(&mesh[kind]).iter().find(|set| list(&set["faces"]).iter().any(|face| index(face) == f))?;
        Some(set["name"].as_str()?.to_owned())
    };
    let face = |f: usize| {
        let held = [("groups", holds.has(Data::Groups)), ("materials", materials)];
        let names = held.map(|(kind, held)| name(kind, f).filter(|_| held));
        let corners: Vec<_> = (0..list(&mesh["faces"][f]).len()).map(|j| corner(f, j)).collect();
        let parts = if holds.has(Data::Polygons) { vec![corners] } else { fan(&corners) };
        parts.into_iter().map(move |corners| Face { corners: turned(corners), names: names.clone() })
    };
    let mut faces: Vec<Face> = (0..list(&mesh["faces"]).len()).flat_map(face).collect();
    faces.sort_unstable();
    let sharpness = |tag: &Value| tag["sharpness"].as_f64().expect("a number");
    let crease = |tag: &Value| {
        let mut ends = [0, 1].map(|k| place(index(&tag["edge"][k])));
        ends.sort_unstable();
        format!("{ends:?} {}", sharpness(tag))
    };
    let corner = |tag: &Value| format!("{} {}", place(index(&tag["vertex"])), sharpness(tag));
    let tags = list(&mesh["creases"]).iter().map(crease).chain(list(&mesh["corners"]).iter().map(corner));
    let mut sharp: Vec<String> = tags.filter(|_| holds.has(Data::Sharp)).collect();
    sharp.sort_unstable();
    Content { faces, sharp }
}

fn fan<T: Clone>(face: &[T]) -> Vec<Vec<T>> {
    (1..face.len() - 1).map(|i| vec![face[0].clone(), face[i].clone(), face[i + 1].clone()]).collect()
}

fn turned<T: Ord>(mut face: Vec<T>) -> Vec<T> {
    let least = (0..face.len()).min_by_key(|&i| &face[i]).unwrap_or(0);
    face.rotate_left(least);
    face
}

/// Returns a mesh with a random part of all data that it can carry.
fn carrying(net: &Net, mut seed: u64) -> Value {
    // D. Knuth's multiplier of 64 bits; the upper half is random enough
    let mut throw = move |n: u32| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as u32 % n
    };
    let mut mesh = net.to_json();
    let n = net.positions.len();
    for (name, width) in [("one", 1), ("two", 2), ("three", 3), ("four", 4), ("color", 3 + throw(2))] {
        let step = if name == "color" { 255.0 } else { 7.0 };
        let mut row = || (0..width).map(|_| f64::from(throw(256)) / step).collect::<Vec<_>>();
        let rows: Vec<_> = (0..n).map(|_| row()).collect();
        let values = if width == 1 { json!(rows.concat()) } else { json!(rows) };
        if throw(3) > 0 {
            mesh["channels"][name] = values;
        }
    }
    let faces = 0..net.faces.len();
    for kind in ["groups", "materials"] {
        let of_faces: Vec<u32> = faces.clone().map(|_| throw(4)).collect();
        let set = |name: u32| faces.clone().filter(|&f| of_faces[f] == name).collect::<Vec<_>>();
        let sets = (1..4).map(|name| (["", "top", "a.side", "x"][name as usize], set(name)));
        let sets: Vec<_> = sets.filter(|(_, faces)| !faces.is_empty()).collect();
        mesh[kind] = sets.into_iter().map(|(name, faces)| json!({ "name": name, "faces": faces })).collect();
    }
    if throw(3) > 0 {
        // two charts, with seams between neighbours in different ones
        let values: Vec<_> = (0..2 * n).map(|_| [f64::from(throw(100)) / 7.0, f64::from(throw(100)) / 3.0]).collect();
        let chart = |face: &Vec<usize>, chart: usize| face.iter().map(|&v| v + chart * n).collect::<Vec<_>>();
        let faces: Vec<_> = net.faces.iter().map(|face| chart(face, throw(2) as usize)).collect();
        mesh["uvs"] = json!({ "values": values, "faces": faces });
    }
    // edges at the boundary have no sharpness of their own
    let runs =
        |face: &[usize], a: usize, b: usize| (0..face.len()).any(|j| [face[j], face[(j + 1) % face.len()]] == [a, b]);
    let any = |a: usize, b: usize| net.faces.iter().any(|face| runs(face, a, b));
    let inner: Vec<_> = net.edges().into_iter().filter(|&(a, b)| any(a, b) && any(b, a)).collect();
    let sharpness = [0.5, 2.5, 10.0];
    let creases = inner.iter().filter_map(|&(a, b)| Some(([a, b], sharpness.get(throw(9) as usize)?)));
    mesh["creases"] = creases.map(|(edge, s)| json!({ "edge": edge, "sharpness": s })).collect();
    let corners = (0..n).filter_map(|v| Some((v, sharpness.get(throw(9) as usize)?)));
    mesh["corners"] = corners.map(|(v, s)| json!({ "vertex": v, "sharpness": s })).collect();
    mesh
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_a_format_holds_comes_back(net in prop_oneof![manifold(), triangle_manifold()], seed in any::<u64>()) {
        let net = kept(&net);
        let mesh = carrying(&net, seed);
        // two faces that share two non-adjacent corners are cut along the same line, which no surface is
        let mut input = triangulated(net.clone()).input();
        input["non_manifold"] = json!("refuse");
        let cut = json!({ "input": input, "outputs": [{ "format": "json" }] });
        let is_surface = render(&cut).is_ok();
        // formats of loose triangles join all corners at the same position
        let places = net.positions.iter().map(|p| p.map(|x| rounded(x, Numbers::F32).to_bits()));
        let is_apart = places.collect::<BTreeSet<_>>().len() == net.positions.len();
        let fits = |holds: Holds| (is_surface || holds.has(Data::Polygons)) && (is_apart || holds.has(Data::Groups));
        for (options, holds) in table().into_iter().filter(|&(_, holds)| fits(holds)) {
            // the up axis of the format, so that nothing is rotated
            let up = if options["format"] == "3mf" { "z" } else { "y" };
            let found = again(&options["format"], &in_format(&json!({ "mesh": mesh, "up": up }), &options));
            // all data that is found counts, colours in the steps of the format
            let colors = if holds.colors == Colors::Bytes { Colors::Bytes } else { Colors::Whole };
            let all = Holds { colors, ..JSON };
            prop_assert_eq!(content(&found, all), content(&mesh, holds), "{} of {}", options, mesh);
        }
    }
}

/// Names that a format uses for another purpose; the documentation states the effect.
#[test]
fn names_that_mean_something_else_in_a_format_change() {
    let net = crate::support::nets::grid(1, 1);
    let come_back = |format: &str, extra: &Value| {
        let mut mesh = net.to_json();
        for (name, value) in extra.as_object().expect("an object") {
            mesh[name] = value.clone();
        }
        again(&json!(format), &in_format(&json!({ "mesh": mesh }), &json!({ "format": format })))
    };
    let channels = |names: &[&str]| {
        let of_name = |name: &&str| ((*name).to_owned(), json!([0.0, 0.25, 0.5, 1.0]));
        json!({ "channels": names.iter().map(of_name).collect::<serde_json::Map<_, _>>() })
    };
    // the group of no group, the material of no material
    for kind in ["groups", "materials"] {
        let sets = json!({ kind: [{ "name": "default", "faces": [0] }] });
        assert!(come_back("obj", &sets).get(kind).is_none());
        assert_eq!(come_back("ply", &sets)[kind], sets[kind]);
    }
    // two channels that are named like the parts of one
    let joined = come_back("ply", &channels(&["a_0", "a_1"]));
    assert_eq!(joined["channels"], json!({ "a": [[0, 0], [0.25, 0.25], [0.5, 0.5], [1, 1]] }));
    for apart in [&["a_0", "b_0", "c_1"][..], &["a_0", "a_2"], &["a", "a_0", "a_1"], &["color_0", "color_1", "color_2"]]
    {
        assert_eq!(come_back("ply", &channels(apart)), come_back("json", &channels(apart)), "{apart:?}");
    }
    let five = channels(&["a_0", "a_1", "a_2", "a_3", "a_4"]);
    assert_eq!(come_back("ply", &five), come_back("json", &five));
    // texture coordinates of other programs
    let uvs = come_back("ply", &channels(&["u", "v"]));
    assert!(uvs["uvs"].is_object() && uvs.get("channels").is_none(), "{uvs}");
    // glTF has upper-case names only
    for (written, read) in [("Heat", "heat"), ("Color", "COLOR")] {
        let expected = come_back("json", &channels(&[read]));
        assert_eq!(come_back("glb", &channels(&[written]))["channels"], expected["channels"]);
    }
}

/// glTF is in metres with y up, and 3MF has z up: unit and axis change the positions. In other formats, positions
/// remain.
#[test]
fn units_and_axes_come_back_as_places() {
    let net = crate::support::nets::tetrahedron();
    for (unit, metres) in [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254)] {
        for up in ["y", "z"] {
            let input = json!({ "mesh": net.to_json(), "unit": unit, "up": up });
            for (options, holds) in table() {
                let found = Net::of(&again(&options["format"], &in_format(&input, &options)));
                let is_gltf = options["format"] == "glb" || options["format"] == "gltf";
                let place = |p: &[f64; 3]| match (is_gltf, up) {
                    (false, "y") if options["format"] == "3mf" => [p[0], -p[2], p[1]],
                    (false, _) => *p,
                    (true, "y") => p.map(|x| metres * x),
                    (true, _) => [p[0], p[2], -p[1]].map(|x| metres * x),
                };
                for p in net.positions.iter().map(place) {
                    let near = |q: &&[f64; 3]| crate::support::nets::distance(*q, &p) <= 1e-15;
                    assert!(found.positions.iter().any(|q| near(&q)), "{p:?} of {options}: {found:?}");
                }
                assert!(holds.has(Data::Polygons) || found.faces.len() == net.faces.len());
            }
        }
    }
}
