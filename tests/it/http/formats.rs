//! Every format of the registry, for a mesh and for a polygon.

use planish::output::FORMATS;

use super::jobs::{formats, mesh, polygon, with};
use super::server::{Answer, settings, story};

#[test]
fn every_format_is_answered_for_what_it_holds_and_refused_for_what_it_does_not() {
    story(settings(), async |server| {
        for (is_mesh, job) in [(true, mesh(1)), (false, polygon(1))] {
            let holding: Vec<&str> = formats(is_mesh).iter().map(|format| format.name()).collect();
            for format in FORMATS {
                let mut asked = with(job.clone(), format.name());
                if format.is_of_limit() {
                    // the default tolerance takes long in a debug build
                    asked["outputs"][0]["tolerance"] = 1e-2.into();
                    asked["outputs"][0]["continuity"] = "bicubic".into();
                }
                let answer = server.render(&asked).await;
                if holding.contains(&format.name()) {
                    let answer = answer.ok();
                    assert_eq!(answer.header("content-type"), format.facts().media_type);
                    check(format.name(), is_mesh, &answer);
                } else {
                    let problem = answer.problem(422, "invalid-job");
                    assert_eq!(problem["errors"][0]["pointer"], "/outputs/0/format", "{problem}");
                }
            }
        }
    });
}

/// Checks that an answer is valid in its format: a cube of 24 quads, or a closed polygon of 8 points.
fn check(format: &str, is_mesh: bool, answer: &Answer) {
    match format {
        "json" if is_mesh => {
            let json = answer.json();
            assert_eq!(json["positions"].as_array().unwrap().len(), 26);
            assert_eq!(json["faces"].as_array().unwrap().len(), 24);
        }
        "json" => {
            let json = answer.json();
            assert_eq!(json["points"].as_array().unwrap().len(), 8);
            assert_eq!(json["closed"], true);
        }
        "stats" => assert_eq!(answer.json()["kind"], if is_mesh { "mesh" } else { "curves" }),
        "obj" => {
            let (points, elements) = if is_mesh { (26, ("f ", 24)) } else { (8, ("l ", 1)) };
            assert_eq!(lines(answer, "v "), points);
            assert_eq!(lines(answer, elements.0), elements.1);
        }
        "mtl" => assert_eq!(answer.text(), "# planish\n", "it has no materials"),
        "glb" | "gltf" => check_gltf(is_mesh, &answer.body),
        // 26 vertices with positions and normals, 48 triangles
        "gltf-bin" => assert_eq!(answer.body.len(), 26 * 24 + 48 * 6),
        "ply" => {
            assert!(answer.body.starts_with(b"ply\nformat binary_little_endian 1.0\n"));
            assert_eq!(lines(answer, if is_mesh { "element vertex 26" } else { "element vertex 8" }), 1);
            assert_eq!(lines(answer, if is_mesh { "element face 24" } else { "element edge 8" }), 1);
        }
        "stl" => {
            assert_eq!(answer.body.len(), 84 + 50 * 48);
            assert_eq!(answer.body[80..84], 48_u32.to_le_bytes());
        }
        "3mf" => assert!(answer.body.starts_with(b"PK\x03\x04") && answer.body.ends_with(&[0; 2]), "an archive"),
        "usda" => {
            let text = answer.text();
            assert!(text.starts_with("#usda 1.0\n") && text.ends_with("}\n"), "{text}");
            assert_eq!(text.matches("subdivisionScheme = \"none\"").count(), 1);
        }
        "png" | "apng" => {
            let picture = image::load_from_memory_with_format(&answer.body, image::ImageFormat::Png).unwrap();
            let picture = picture.to_rgba8();
            let first = picture.get_pixel(0, 0);
            assert!(picture.pixels().any(|pixel| pixel != first), "something is drawn");
        }
        "svg" => {
            let text = answer.text();
            assert!(text.contains("<svg") && text.contains("<path") && text.trim_end().ends_with("</svg>"), "{text}");
        }
        "pdf" => assert!(answer.body.starts_with(b"%PDF-") && answer.body.ends_with(b"%%EOF"), "a whole file"),
        "stencils" => {
            let json = answer.json();
            assert_eq!(json["columns"], 8 - 4 * u32::from(!is_mesh));
            assert_eq!(json["vertices"], if is_mesh { 26 } else { 8 });
        }
        "stencils-bin" => assert!(answer.body.starts_with(br#"{"rows":"#) && answer.body.contains(&b'\n')),
        "step" => {
            let text = answer.text();
            assert!(text.starts_with("ISO-10303-21;") && text.ends_with("END-ISO-10303-21;\n"), "{text}");
            assert_eq!(text.matches("ADVANCED_FACE").count(), 24);
        }
        "certificate" => assert_eq!(answer.json()["is_closed"], true),
        other => panic!("no check for the format {other}"),
    }
}

fn lines(answer: &Answer, start: &str) -> usize {
    answer.text().lines().filter(|line| line.starts_with(start)).count()
}

fn check_gltf(is_mesh: bool, bytes: &[u8]) {
    let document = gltf::Gltf::from_slice(bytes).unwrap().document;
    let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
    assert_eq!(primitive.get(&gltf::Semantic::Positions).unwrap().count(), if is_mesh { 26 } else { 8 });
    if is_mesh {
        assert_eq!(primitive.mode(), gltf::mesh::Mode::Triangles);
        assert_eq!(primitive.indices().unwrap().count(), 3 * 48);
    }
}

#[test]
fn pictures_have_the_size_that_was_asked_for() {
    story(settings(), async |server| {
        let mut job = mesh(1);
        job["outputs"] = serde_json::json!([{ "format": "png", "width": 77, "height": 55 }]);
        let answer = server.render(&job).await.ok();
        let picture = image::load_from_memory(&answer.body).unwrap();
        assert_eq!((picture.width(), picture.height()), (77, 55));
    });
}
