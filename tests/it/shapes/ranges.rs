//! Meshes as sources: parts equal the corresponding ranges of the whole.

use planish::job::Input;
use planish::math::vector::{plus, unit};
use planish::output::normals::{area, area_vector, scale};
use planish::refine::{RefinedMesh, refine_mesh};
use planish::shape::source::{FaceChunk, MeshSource};
use planish::watch::Watch;
use serde_json::{Value, json};

use crate::support;
use crate::support::nets;

fn refined(input: &Value, plan: &Value, levels: u32) -> RefinedMesh {
    let job = json!({ "input": input, "plan": plan, "levels": levels, "outputs": [{ "format": "json" }] });
    let job = support::parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{plan}: {faults:?}"));
    let Input::Mesh(mesh) = &*job.input else { unreachable!("the input is a mesh") };
    refine_mesh(mesh, &job.plan, &job.plan.schedule(levels).expect("no functions"), &Watch::new()).expect("any mesh")
}

fn with_holes(mut input: Value, holes: &[usize]) -> Value {
    input["mesh"]["holes"] = json!(holes);
    input
}

/// Returns refined meshes of all kinds of sources.
fn meshes() -> Vec<RefinedMesh> {
    let split = |levels: u32| (json!({ "word": "UC", "parameters": { "split": "triangle" } }), levels);
    let word = |word: &str, levels: u32| (json!({ "word": word }), levels);
    let mixed = with_holes(nets::mixed().input(), &[0, 2]);
    let cases = [
        (mixed.clone(), word("U", 0)),
        (mixed.clone(), word("UC", 1)),
        (mixed.clone(), word("UC", 3)),
        (mixed, word("U3C", 2)),
        (nets::prism(5).input(), word("UD", 2)),
        (with_holes(nets::grid(3, 2).input(), &[1, 5]), word("U3C", 2)),
        (nets::torus(3, 3).input(), word("UC", 2)),
        (nets::octahedron().input(), split(1)),
        (with_holes(nets::octahedron().input(), &[7]), split(3)),
    ];
    cases.iter().map(|(input, (plan, levels))| refined(input, plan, *levels)).collect()
}

#[test]
fn any_range_of_faces_is_that_part_of_all_faces() {
    for mesh in meshes() {
        let (mut all, mut some, n) = (FaceChunk::default(), FaceChunk::default(), mesh.n_faces());
        mesh.faces(0..n, &mut all);
        let all: Vec<&[u32]> = all.iter().collect();
        assert_eq!(all.len(), n);
        assert_eq!(all.iter().map(|face| face.len()).sum::<usize>(), mesh.n_half_edges());
        let lengths = [0, 1, 2, 3, 7, 16, 61, n];
        for (start, length) in (0..n).flat_map(|start| lengths.map(|length| (start, length))) {
            let range = start..n.min(start + length);
            mesh.faces(range.clone(), &mut some);
            assert_eq!(some.iter().collect::<Vec<_>>(), all[range.clone()], "{range:?} of {n}");
            assert_eq!((some.len(), some.is_empty()), (range.len(), range.is_empty()));
        }
    }
}

/// Larger than a part that one thread sums, with and without vertices that belong to one part only.
#[test]
fn area_normals_are_sums_in_the_order_of_the_faces_whoever_adds_them() {
    let word = |text: &str| json!({ "word": text });
    let split = json!({ "word": "UC", "parameters": { "split": "triangle" } });
    let meshes = [
        refined(&with_holes(nets::mixed().input(), &[1]), &word("UC"), 6),
        refined(&nets::cube().input(), &word("UC"), 6),
        refined(&nets::cube().input(), &word("UC"), 7),
        refined(&nets::grid(40, 40).input(), &word("UC"), 3),
        refined(&with_holes(nets::grid(3, 2).input(), &[1, 5]), &word("UC"), 3),
        refined(&with_holes(nets::grid(9, 8).input(), &[0, 70, 71]), &word("U3C"), 2),
        refined(&nets::torus(3, 3).input(), &word("UC"), 2),
        refined(&nets::torus(40, 30).input(), &word("UC"), 2),
        refined(&nets::prism(5).input(), &word("UD"), 6),
        refined(&nets::octahedron().input(), &split, 6),
    ];
    for mesh in meshes {
        let mut faces = FaceChunk::default();
        mesh.faces(0..mesh.n_faces(), &mut faces);
        let smooth = mesh.all_positions();
        // many faces collapse to lines and points
        let coarse: Vec<[f64; 3]> = smooth.iter().map(|p| p.map(|x| (8.0 * x).round() / 8.0)).collect();
        let spike = |(v, p): (usize, &[f64; 3])| if v % 97 == 0 { p.map(|x| 1e200 * x) } else { *p };
        let spiky: Vec<[f64; 3]> = smooth.iter().enumerate().map(spike).collect();
        for positions in [smooth, coarse, spiky] {
            let scale = scale(&positions);
            let mut sums = vec![[0.0; 3]; positions.len()];
            for face in faces.iter() {
                let vector = area_vector(face, &positions, scale);
                face.iter().for_each(|&v| sums[v as usize] = plus(sums[v as usize], vector));
            }
            let found = area(&mesh, &positions, &Watch::new()).expect("nobody stops it");
            let bits = |row: [f64; 3]| row.map(f64::to_bits);
            assert!(
                sums.into_iter().map(unit).map(bits).eq(found.iter().copied().map(bits)),
                "{} faces",
                mesh.n_faces()
            );
        }
    }
}
