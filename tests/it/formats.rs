//! The promises of the formats: sizes known beforehand, the same bytes for any number of threads, and numbers that read
//! back.

use std::io::{self, Write};
use std::ops::Range;
use std::sync::Arc;

use planish::math::parameter::{Literal, Values};
use planish::output::scene::{CoordinateSystem, Curve, FaceChunk, MeshSource, Notes, Scene, Shape, in_chunks};
use planish::output::{Counts, Format, FormatError, ShapeKind, Size, named};
use planish::shape::source::{CarriedSource, OriginSource};
use planish::solid::CageCounts;
use planish::watch::Watch;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::nothing;

/// A mesh in memory.
#[derive(Debug, Clone, Default)]
struct Net {
    positions: Vec<[f64; 3]>,
    faces: Vec<Vec<u32>>,
}

impl MeshSource for Net {
    fn n_vertices(&self) -> usize {
        self.positions.len()
    }

    fn n_faces(&self) -> usize {
        self.faces.len()
    }

    fn n_half_edges(&self) -> usize {
        self.faces.iter().map(Vec::len).sum()
    }

    fn positions(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        out.clear();
        out.extend_from_slice(&self.positions[range]);
    }

    fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
        out.clear();
        self.faces[range].iter().for_each(|face| out.push(face));
    }
}

impl CarriedSource for Net {}

impl OriginSource for Net {
    fn input_cells(&self) -> [usize; 3] {
        [self.positions.len(), 0, self.faces.len()]
    }
}

fn cube() -> Net {
    let positions = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Net { positions, faces: faces.map(Vec::from).to_vec() }
}

/// Returns a bumpy square of `n x n` quads.
fn grid(n: u32) -> Net {
    let points = (0..=n).flat_map(|j| (0..=n).map(move |i| (f64::from(i), f64::from(j))));
    let positions = points.map(|(x, y)| [x / 3.0, y / 7.0, (x * y) % 1.9]).collect();
    let quads = (0..n).flat_map(|j| (0..n).map(move |i| j * (n + 1) + i));
    Net { positions, faces: quads.map(|a| vec![a, a + 1, a + n + 2, a + n + 1]).collect() }
}

fn curve(dimension: usize, closed: bool, points: &[f64]) -> Curve {
    Curve { points: points.to_vec(), dimension, closed, tangents: None }
}

fn counts(shape: Shape<'_>) -> Counts {
    match shape {
        Shape::Mesh(mesh) => Counts {
            vertices: mesh.n_vertices() as u128,
            faces: mesh.n_faces() as u128,
            half_edges: mesh.n_half_edges() as u128,
            largest_face: 4,
            attachments: Arc::new(mesh.attachments().clone()),
            input_faces: mesh.input_cells()[2],
            input_edges: mesh.input_cells()[1],
            cage: CageCounts::default(),
            ..nothing(ShapeKind::Mesh)
        },
        Shape::Curves(curves) => Counts {
            polygons: curves.len() as u128,
            vertices: curves.iter().map(|curve| curve.len() as u128).sum(),
            ..nothing(ShapeKind::Curves { dimension: curves.first().map_or(1, |curve| curve.dimension) })
        },
    }
}

/// Returns every format that is checked here, with the options that change its bytes.
fn variants() -> Vec<(&'static dyn Format, Values)> {
    let text = |value: &str| Literal::Text(value.into());
    let given = [
        ("json", vec![]),
        ("stats", vec![]),
        ("obj", vec![]),
        ("obj", vec![("normals", text("area"))]),
        ("glb", vec![]),
        ("glb", vec![("normals", text("none"))]),
        ("gltf", vec![]),
        ("gltf", vec![("normals", text("none"))]),
        ("ply", vec![]),
        ("ply", vec![("ascii", Literal::Flag(true))]),
        ("ply", vec![("ascii", Literal::Flag(true)), ("precision", text("f32")), ("normals", text("area"))]),
        ("ply", vec![("normals", text("area")), ("face_sizes", text("uint"))]),
        ("ply", vec![("precision", text("f32"))]),
        ("stl", vec![]),
        ("usda", vec![]),
        ("3mf", vec![]),
        ("3mf", vec![("parts", text("components"))]),
        ("usda", vec![("normals", text("area"))]),
    ];
    given.into_iter().map(|(name, given)| (format(name), options(name, &given))).collect()
}

fn format(name: &str) -> &'static dyn Format {
    named(name).expect("the format exists")
}

fn options(name: &str, given: &[(&str, Literal)]) -> Values {
    let given: Vec<_> = given.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect();
    Values::resolve(format(name).facts().parameters, &given).expect("the options are known")
}

fn attempt(format: &dyn Format, options: &Values, shape: Shape<'_>) -> Result<Vec<u8>, FormatError> {
    let mut out = Vec::new();
    format.write(
        &Scene {
            shape,
            control: &shape,
            warnings: &[],
            coordinate_system: CoordinateSystem::default(),
            notes: &Notes::default(),
            weights: None,
            details: &[],
        },
        options,
        &mut out,
        &Watch::new(),
    )?;
    Ok(out)
}

fn bytes(name: &str, shape: Shape<'_>) -> Vec<u8> {
    attempt(format(name), &options(name, &[]), shape).expect("the shape fits")
}

fn text(name: &str, shape: Shape<'_>) -> String {
    String::from_utf8(bytes(name, shape)).expect("it is text")
}

fn stats(shape: Shape<'_>) -> Value {
    serde_json::from_slice(&bytes("stats", shape)).expect("it is JSON")
}

fn check_sizes(shape: Shape<'_>) {
    let counts = counts(shape);
    for (format, options) in variants() {
        if format.holds(counts.kind).is_err() {
            continue;
        }
        let length = match attempt(format, &options, shape) {
            Ok(bytes) => bytes.len() as u128,
            Err(FormatError::Unfit(_)) => continue,
            Err(error) => panic!("{}: {error}", format.name()),
        };
        match format.size(&counts, &options) {
            Size::Exact(promised) => assert_eq!(length, promised, "{} {options:?}", format.name()),
            Size::AtMost(bound) => assert!(length <= bound, "{} {options:?}: {length} > {bound}", format.name()),
        }
    }
}

/// Returns finite numbers of every magnitude, awkward ones more often.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>().prop_filter("finite", |x| x.is_finite()),
        -1e3..1e3,
        Just(-0.0),
        Just(-2.225_073_858_507_201_4e-308),
        Just(-f64::from(f32::MAX)),
        Just(-1.175_494_350_822_287_5e-38),
    ]
}

fn any_net() -> impl Strategy<Value = Net> {
    (3_u32..40).prop_flat_map(|n| {
        let positions = prop::collection::vec([number(), number(), number()], n as usize);
        let face = prop::sample::subsequence((0..n).collect::<Vec<_>>(), 3..=n as usize);
        (positions, prop::collection::vec(face.prop_shuffle(), 0..12))
            .prop_map(|(positions, faces)| Net { positions, faces })
    })
}

fn any_curves() -> impl Strategy<Value = Vec<Curve>> {
    (1_usize..=4).prop_flat_map(|dimension| {
        let polygon = (prop::collection::vec(number(), 0..40), any::<bool>()).prop_map(move |(mut points, closed)| {
            points.truncate(points.len() / dimension * dimension);
            Curve { points, dimension, closed, tangents: None }
        });
        prop::collection::vec(polygon, 0..5)
    })
}

proptest! {
    #[test]
    fn no_mesh_is_longer_than_its_forecast(net in any_net()) {
        check_sizes(Shape::Mesh(&net));
    }

    #[test]
    fn no_curves_are_longer_than_their_forecast(curves in any_curves()) {
        check_sizes(Shape::Curves(&curves));
    }

    #[test]
    fn json_reads_back_bit_for_bit(net in any_net()) {
        let read: Value = serde_json::from_slice(&bytes("json", Shape::Mesh(&net))).expect("it is JSON");
        let expected: Vec<[f64; 3]> = net.positions.iter().map(|p| p.map(|x| x + 0.0)).collect();
        let read_positions: Vec<[f64; 3]> = serde_json::from_value(read["positions"].clone()).expect("rows");
        prop_assert_eq!(read_positions, expected);
        prop_assert_eq!(&read["faces"], &json!(net.faces));
    }

    #[test]
    fn the_shape_hash_ignores_every_order(net in any_net(), turn in 0_usize..40, seed in any::<prop::sample::Index>()) {
        let n = u32::try_from(net.positions.len()).expect("a small net");
        let shift = u32::try_from(seed.index(n as usize)).expect("a small net");
        let mut moved = net.clone();
        moved.positions.rotate_right(shift as usize);
        for face in &mut moved.faces {
            let corner = turn % face.len();
            face.rotate_left(corner);
            for vertex in face.iter_mut() {
                *vertex = (*vertex + shift) % n;
            }
        }
        moved.faces.reverse();
        let (before, after) = (stats(Shape::Mesh(&net)), stats(Shape::Mesh(&moved)));
        prop_assert_eq!(&before["shape_hash"], &after["shape_hash"]);
    }
}

#[test]
fn forecasts_of_absurd_counts_saturate() {
    for kind in [ShapeKind::Mesh, ShapeKind::Curves { dimension: 3 }] {
        for n in [1_u128 << 100, u128::MAX] {
            let counts = Counts {
                kind,
                polygons: n,
                control: n,
                vertices: n,
                faces: n,
                half_edges: n,
                ..counts(Shape::Curves(&[]))
            };
            for (format, options) in variants() {
                let least = if format.name() == "stats" { 0 } else { n / 2 };
                let holds_nothing = format.name() == "stl";
                assert!(holds_nothing || format.size(&counts, &options).bytes() >= least, "{}", format.name());
            }
        }
    }
}

#[test]
fn bytes_do_not_depend_on_the_number_of_threads() {
    let net = grid(300);
    let shape = Shape::Mesh(&net);
    let with = |n: usize| -> Vec<Vec<u8>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads start");
        pool.install(|| variants().iter().map(|(f, o)| attempt(*f, o, shape).expect("it fits")).collect())
    };
    let alone = with(1);
    for n in [2, 3] {
        assert!(with(n) == alone, "{n} threads");
    }
}

#[test]
fn obj_keeps_polygons_and_counts_from_one() {
    let net = Net {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.5, -0.0], [0.1, 1e-7, 1e21]],
        faces: vec![vec![0, 1, 2, 3]],
    };
    assert_eq!(text("obj", Shape::Mesh(&net)), "# planish\nv 0 0 0\nv 1 0 0\nv 1 0.5 0\nv 0.1 1e-7 1e+21\nf 1 2 3 4\n");
}

#[test]
fn obj_joins_closed_curves_and_pads_with_zeros() {
    let curves = [curve(2, true, &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]), curve(2, false, &[5.0, 6.0, 7.0, 8.0])];
    let expected = "# planish\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 6 0\nv 7 8 0\nl 1 2 3 1\nl 4 5\n";
    assert_eq!(text("obj", Shape::Curves(&curves)), expected);
}

#[test]
fn json_has_the_notation_of_requests() {
    let one = [curve(2, true, &[0.0, -0.0, 1.0, 0.5])];
    assert_eq!(text("json", Shape::Curves(&one)), r#"{"points":[[0,0],[1,0.5]],"closed":true}"#);
    let two = [curve(1, true, &[1.0]), curve(1, false, &[])];
    let expected = r#"{"polygons":[{"points":[[1]],"closed":true},{"points":[],"closed":false}]}"#;
    assert_eq!(text("json", Shape::Curves(&two)), expected);
    let net = Net { positions: vec![[0.0, 1.0, 2.5]; 3], faces: vec![vec![0, 1, 2]] };
    let expected = r#"{"positions":[[0,1,2.5],[0,1,2.5],[0,1,2.5]],"faces":[[0,1,2]]}"#;
    assert_eq!(text("json", Shape::Mesh(&net)), expected);
}

#[test]
fn json_carries_warnings_as_far_as_its_forecast_allows() {
    let net = cube();
    let shape = Shape::Mesh(&net);
    let json = format("json");
    for (n, last) in [(1, "\"odd\" vertex 0"), (100_000, "and ")] {
        let warnings: Vec<String> = (0..n).map(|i| format!("\"odd\" vertex {i}")).collect();
        let mut out = Vec::new();
        json.write(
            &Scene {
                shape,
                control: &shape,
                warnings: &warnings,
                coordinate_system: CoordinateSystem::default(),
                notes: &Notes::default(),
                weights: None,
                details: &[],
            },
            &options("json", &[]),
            &mut out,
            &Watch::new(),
        )
        .expect("it fits");
        assert!(out.len() as u128 <= json.size(&counts(shape), &options("json", &[])).bytes());
        let read: Value = serde_json::from_slice(&out).expect("it is JSON");
        let found = read["warnings"].as_array().expect("a list");
        assert!(found[found.len() - 1].as_str().expect("a text").starts_with(last));
    }
}

#[test]
fn a_cube_has_the_statistics_of_a_cube() {
    let mut net = cube();
    // far away, where naive sums of cones would lose all digits
    net.positions.iter_mut().flatten().for_each(|x| *x = *x * 2.0 + 1_048_576.0);
    let found = stats(Shape::Mesh(&net));
    assert_eq!(found["euler_characteristic"], 2);
    assert_eq!(found["valences"], json!({ "interior": { "3": 8 }, "boundary": {} }));
    assert_eq!((&found["area"], &found["volume"]), (&json!(24.0), &json!(8.0)));
    assert_eq!(found["moments_of"], "solid");
    assert_eq!(found["centroid"], json!([1_048_577.0, 1_048_577.0, 1_048_577.0]));
    let moment = found["second_moments"][0][0].as_f64().expect("a number");
    assert!((moment - 8.0 / 3.0).abs() < 1e-14, "rounding of a dozen terms");
    net.faces.iter_mut().for_each(|face| face.reverse());
    assert_eq!(stats(Shape::Mesh(&net))["volume"], -8.0);
}

#[test]
fn an_open_mesh_has_boundary_loops_and_no_volume() {
    let mut net = grid(4);
    net.faces.remove(5);
    let found = stats(Shape::Mesh(&net));
    assert_eq!((&found["boundary_loops"], &found["euler_characteristic"]), (&json!(2), &json!(0)));
    assert_eq!((&found["volume"], &found["moments_of"]), (&Value::Null, &json!("surface")));
}

#[test]
fn a_square_curve_has_its_length_and_area() {
    let square = [curve(2, true, &[0.0, 0.0, 2.0, 0.0, 2.0, 2.0, 0.0, 2.0])];
    let found = stats(Shape::Curves(&square));
    assert_eq!((&found["length"], &found["area"]), (&json!(8.0), &json!(4.0)));
    assert_eq!(found["centroid"], json!([1.0, 1.0]));
    let turned = [curve(2, true, &[2.0, 2.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0])];
    let turned = stats(Shape::Curves(&turned));
    assert_eq!(found["shape_hash"], turned["shape_hash"]);
    assert_ne!(found["positions_hash"], turned["positions_hash"]);
}

#[test]
fn gltf_far_from_the_origin_keeps_its_digits() {
    let mut net = cube();
    net.positions.iter_mut().flatten().for_each(|x| *x += 1e9);
    let document: Value = serde_json::from_slice(&bytes("gltf", Shape::Mesh(&net))).expect("it is JSON");
    assert_eq!(document["nodes"][0]["translation"], json!([1e9, 1e9, 1e9]));
    let positions = &document["accessors"][0];
    assert_eq!((&positions["min"], &positions["max"]), (&json!([0.0, 0.0, 0.0]), &json!([1.0, 1.0, 1.0])));
}

#[test]
fn what_a_format_cannot_hold_is_refused_with_a_remedy() {
    let four = ShapeKind::Curves { dimension: 4 };
    for name in ["obj", "glb", "gltf", "ply", "stl"] {
        let refusal = format(name).holds(four).expect_err("four coordinates are too many");
        assert!(refusal.contains("json"), "{refusal}");
    }
    let mut net = cube();
    net.positions[3][1] = 1e200;
    for name in ["glb", "gltf", "stl"] {
        let error = attempt(format(name), &options(name, &[]), Shape::Mesh(&net)).expect_err("beyond f32");
        assert!(error.to_string().contains("1e200") && error.to_string().contains("obj"), "{error}");
    }
    net.positions[3][1] = f64::NAN;
    for (format, options) in variants() {
        let error = attempt(format, &options, Shape::Mesh(&net)).expect_err("not a number");
        assert!(error.to_string().contains("vertex 3"), "{error}");
    }
    let round = Net { positions: vec![[0.0; 3]; 300], faces: vec![(0..300).collect()] };
    let error = attempt(format("ply"), &options("ply", &[]), Shape::Mesh(&round)).expect_err("a large face");
    assert!(error.to_string().contains("face_sizes"), "{error}");
}

#[test]
fn a_stopped_watch_and_a_full_disk_end_every_writer() {
    struct Full;
    impl Write for Full {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let net = cube();
    let shape = Shape::Mesh(&net);
    let scene = Scene {
        shape,
        control: &shape,
        warnings: &[],
        coordinate_system: CoordinateSystem::default(),
        notes: &Notes::default(),
        weights: None,
        details: &[],
    };
    let stopped = Watch::new();
    stopped.stop();
    for (format, options) in variants() {
        let ended = format.write(&scene, &options, &mut Vec::new(), &stopped);
        assert!(matches!(ended, Err(FormatError::Stopped(_))), "{}", format.name());
        let ended = format.write(&scene, &options, &mut Full, &Watch::new());
        assert!(matches!(ended, Err(FormatError::Io(_))), "{}", format.name());
    }
}

#[test]
fn streamed_chunks_join_without_a_seam() {
    let net = grid(300);
    assert!(net.n_vertices() > planish::output::scene::ROWS_PER_CHUNK);
    let read: Value = serde_json::from_slice(&bytes("json", Shape::Mesh(&net))).expect("it is JSON");
    assert_eq!(read["faces"], json!(net.faces));
    let mut n = 0;
    in_chunks(net.n_vertices(), |range| {
        n += range.len();
        Ok::<(), ()>(())
    })
    .expect("nothing fails");
    assert_eq!(read["positions"].as_array().map(Vec::len), Some(n));
}
