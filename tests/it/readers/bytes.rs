//! For any bytes, a reader returns a mesh or faults.

use planish::input::READERS;
use proptest::prelude::*;
use serde_json::json;

use super::read;
use crate::support::nets::{cube, mixed};
use crate::support::render;

/// Returns small files of every format.
fn files() -> Vec<(&'static str, Vec<u8>)> {
    let written = |format: &'static str, options: serde_json::Value| {
        let net = if format == "obj" { mixed() } else { cube() };
        (format, render(&json!({ "input": net.input(), "outputs": [options] })).expect("it can be written").0)
    };
    let obj = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nvt 0 0\nvt 1 0\nvn 0 0 1\no a\ng b c\nusemtl d\n\
               f 1/1/1 2/2/1 \\\n 3/-1/-1\nl 1 2\nt crease 2/1/0 0 1 3\nt corner 1/1/0 2 10\n\
               t interpolateboundary 1/0/0 1\nt hole 1/0/0 0\n";
    let off = "COFF\n3 1 3\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 1 2 1 0 0\n";
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
               endloop\nendfacet\nendsolid\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float s\nproperty float t\n\
               element face 1\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int a\nend_header\n\
               0 0 0 1 2 3 0 0\n1 0 0 1 2 3 0 0\n0 1 0 1 2 3 0 0\n3 0 1 2\n5\n";
    vec![
        written("obj", json!({ "format": "obj", "normals": "area" })),
        written("ply", json!({ "format": "ply", "normals": "area" })),
        written("ply", json!({ "format": "ply", "ascii": true })),
        ("ply", big_endian()),
        written("stl", json!({ "format": "stl" })),
        written("gltf", json!({ "format": "gltf" })),
        written("glb", json!({ "format": "glb" })),
        written("3mf", json!({ "format": "3mf" })),
        written("usda", json!({ "format": "usda", "normals": "area" })),
        ("obj", obj.into()),
        ("off", off.into()),
        ("stl", stl.into()),
        ("ply", ply.into()),
        ("usda", super::usda::scene().into_bytes()),
        ("gltf", super::gltf::every_feature().into_bytes()),
    ]
}

fn big_endian() -> Vec<u8> {
    let header = "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double x\nproperty float y\n\
                  property short z\n\
                  element face 1\nproperty list uchar ushort vertex_indices\nend_header\n";
    let body = (0..3 * 14).map(|i| u8::try_from(i).unwrap_or(0)).chain([3, 0, 0, 0, 1, 0, 2]);
    header.bytes().chain(body).collect()
}

#[test]
fn the_files_are_right_before_anything_is_changed() {
    for (format, bytes) in files() {
        super::mesh(format, &bytes);
    }
}

/// Reads any bytes, and checks the invariants of a mesh that results.
fn survives(format: &str, bytes: &[u8]) {
    let Ok(mesh) = read(format, bytes) else { return };
    let n = mesh.positions.len();
    assert!(mesh.positions.as_flattened().iter().all(|x| x.is_finite()));
    for f in 0..mesh.faces.len() {
        let face = mesh.faces.face(f);
        assert!(face.len() >= 3 && face.iter().all(|&v| (v as usize) < n), "{face:?}");
    }
    for channel in &mesh.channels {
        assert_eq!(channel.values.len(), n * channel.width, "{}", channel.name);
    }
    if let Some(uvs) = &mesh.uvs {
        assert_eq!(uvs.corners.len(), mesh.faces.n_half_edges());
        assert!(uvs.corners.iter().all(|&corner| (corner as usize) < uvs.values.len()));
    }
    let sets = mesh.groups.iter().chain(&mesh.materials);
    sets.for_each(|set| assert!(set.faces.iter().all(|&f| f < mesh.faces.len() as u64), "{}", set.name));
    assert!(mesh.creases.iter().all(|(edge, _)| edge.iter().all(|&v| v < n as u64)));
    assert!(mesh.corners.iter().all(|&(v, _)| v < n as u64));
    assert!(mesh.holes.iter().all(|&f| f < mesh.faces.len() as u64));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn changed_files_are_read_or_refused(
        file in prop::sample::select(files()),
        cuts in proptest::collection::vec(
            (any::<prop::sample::Index>(), 0..9_usize, prop_oneof![
                "[ -~\n]{0,4}".prop_map(String::into_bytes),
                prop::sample::select(vec!["-1", "0", "4294967295", "99999999999999999999", "nan", "1e308", "/", "\n"])
                    .prop_map(|text| text.as_bytes().to_vec()),
                proptest::collection::vec(prop_oneof![Just(0_u8), Just(255), Just(127), any::<u8>()], 0..5),
            ]),
            1..4,
        ),
    ) {
        let (format, mut bytes) = file;
        for (place, length, patch) in cuts {
            let from = place.index(bytes.len() + 1);
            let to = (from + length).min(bytes.len());
            bytes.splice(from..to, patch);
        }
        survives(format, &bytes);
    }

    /// Numbers changed in place, so that lengths still agree.
    #[test]
    fn changed_numbers_are_read_or_refused(
        file in prop::sample::select(files()),
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let (format, mut bytes) = file;
        for (place, byte) in changes {
            let at = place.index(bytes.len());
            bytes[at] = if bytes[at].is_ascii_digit() { b'0' + byte % 10 } else { byte };
        }
        survives(format, &bytes);
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        for reader in READERS {
            survives(reader.name, &bytes);
        }
    }

    #[test]
    fn cut_files_are_read_or_refused(file in prop::sample::select(files()), at in any::<prop::sample::Index>()) {
        let (format, bytes) = file;
        survives(format, &bytes[..at.index(bytes.len() + 1)]);
    }
}
