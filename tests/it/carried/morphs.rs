//! Frames: several positions of the same vertices, as morph targets of glTF or one by one.

use planish::job::key::Key;
use planish::job::limits::{Limits, Refusal};
use serde_json::{Value, json};

use super::files::check_size;
use super::{bytes, job, refusal, written};
use crate::support::nets::{self, Net};
use crate::support::parsed;

/// Returns three frames of the net: unchanged, sheared, and inflated unevenly.
fn frames(net: &Net) -> [Vec<[f64; 3]>; 3] {
    let moved = |by: &dyn Fn([f64; 3]) -> [f64; 3]| net.positions.iter().map(|&p| by(p)).collect();
    [
        moved(&|p| p),
        moved(&|[x, y, z]| [x + 0.3 * y, y, z - 0.2 * x]),
        moved(&|[x, y, z]| [1.5 * x, y * y + 2.0, z / 3.0]),
    ]
}

fn animated(net: &Net, extra: &Value, plan: &Value, levels: u32) -> Value {
    let mut question = job(net, extra, plan, levels);
    let [_, others @ ..] = frames(net);
    question["input"]["mesh"]["frames"] = json!(others);
    question
}

/// Returns jobs with frames whose plans use the sweep, rows or the limit, or that have no plan.
fn questions() -> Vec<Value> {
    let sharp = json!({
        "creases": [{ "edge": [0, 1], "sharpness": 10 }, { "edge": [1, 3], "sharpness": 1.5 }],
        "channels": { "weight": [0, 1, 2, 3, 4, 5, 6, 7] },
    });
    let cube = nets::cube();
    vec![
        animated(&cube, &json!({}), &json!({ "preset": "catmull-clark" }), 2),
        animated(&cube, &sharp, &json!({ "preset": "catmull-clark" }), 3),
        animated(&nets::mixed(), &json!({}), &json!({ "preset": "doo-sabin" }), 1),
        animated(&nets::octahedron(), &json!({}), &json!({ "preset": "loop" }), 2),
        animated(&cube, &json!({}), &json!({ "word": "UCPC" }), 0),
    ]
}

fn key(job: &Value, output: &Value) -> Key {
    let mut job = job.clone();
    job["outputs"] = json!([output]);
    parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{faults:?} for {job}")).keys()[0]
}

#[test]
fn a_frame_has_the_bytes_and_the_key_of_a_job_with_its_positions_alone() {
    let outputs = [
        json!({ "format": "glb" }),
        json!({ "format": "gltf", "normals": "limit", "positions": "limit" }),
        json!({ "format": "obj" }),
        json!({ "format": "json", "ids": false }),
        json!({ "format": "ply", "normals": "area" }),
        json!({ "format": "stl" }),
        json!({ "format": "stats" }),
        json!({ "format": "png", "width": 40, "height": 30 }),
    ];
    for question in questions() {
        for (k, output) in outputs.iter().flat_map(|output| (0..3).map(move |k| (k, output))) {
            let mut alone = question.clone();
            if k > 0 {
                alone["input"]["mesh"]["positions"] = question["input"]["mesh"]["frames"][k - 1].clone();
            }
            alone["input"]["mesh"]["frames"] = json!([]);
            let mut shown = output.clone();
            shown["frame"] = json!(k);
            assert_eq!(key(&question, &shown), key(&alone, output), "frame {k} of {question} as {output}");
            assert_eq!(written(&question, &shown), written(&alone, output), "frame {k} of {question} as {output}");
        }
        assert_ne!(key(&question, &outputs[0]), key(&question, &json!({ "format": "glb", "frame": 0 })));
    }
}

/// The glTF document of a glb file, and its buffer.
struct Glb {
    document: Value,
    buffer: Vec<u8>,
}

impl Glb {
    fn of(glb: &[u8]) -> Self {
        let length = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
        let document = serde_json::from_slice(&glb[20..20 + length]).expect("JSON");
        Self { document, buffer: glb[28 + length..].to_vec() }
    }

    fn number(value: &Value) -> usize {
        usize::try_from(value.as_u64().expect("a whole number")).expect("small")
    }

    /// Returns the numbers of an accessor.
    fn scalars(&self, accessor: &Value) -> Vec<f32> {
        let accessor = &self.document["accessors"][Self::number(accessor)];
        let view = &self.document["bufferViews"][Self::number(&accessor["bufferView"])];
        let bytes = &self.buffer[Self::number(&view["byteOffset"])..][..4 * Self::number(&accessor["count"])];
        bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect()
    }

    /// Returns the rows of an accessor.
    fn rows(&self, accessor: &Value) -> Vec<[f32; 3]> {
        let accessor = &self.document["accessors"][Self::number(accessor)];
        let view = &self.document["bufferViews"][Self::number(&accessor["bufferView"])];
        let start = view.get("byteOffset").map_or(0, Self::number);
        let bytes = &self.buffer[start..start + 12 * Self::number(&accessor["count"])];
        let numbers = bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        let rows: Vec<[f32; 3]> = numbers.collect::<Vec<_>>().as_chunks().0.to_vec();
        if let Some(least) = accessor.get("min") {
            let of = |pick: fn(f32, f32) -> f32| [0, 1, 2].map(|k| rows.iter().map(|row| row[k]).reduce(pick));
            assert_eq!((least, &accessor["max"]), (&json!(of(f32::min)), &json!(of(f32::max))));
        }
        rows
    }
}

/// Returns the largest difference of coordinates.
fn apart(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    assert_eq!(a.len(), b.len());
    let both = a.as_flattened().iter().zip(b.as_flattened());
    both.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn morph_targets_lead_from_the_first_frame_to_each_other_one() {
    for question in questions() {
        for normals in ["area", "limit", "none"] {
            let output = json!({ "format": "glb", "normals": normals });
            let whole = Glb::of(&written(&question, &output));
            let primitive = &whole.document["meshes"][0]["primitives"][0];
            assert_eq!(whole.document["meshes"][0]["weights"], json!([0.0, 0.0]));
            assert_eq!(whole.document["meshes"][0]["extras"]["targetNames"], json!(["frame 1", "frame 2"]));
            for k in 0..3 {
                let mut shown = output.clone();
                shown["frame"] = json!(k);
                let alone = Glb::of(&written(&question, &shown));
                let other = &alone.document["meshes"][0]["primitives"][0]["attributes"];
                let names = if normals == "none" { &["POSITION"][..] } else { &["POSITION", "NORMAL"] };
                for name in names {
                    let base = whole.rows(&primitive["attributes"][name]);
                    let moved: Vec<[f32; 3]> = if k == 0 {
                        base
                    } else {
                        let by = whole.rows(&primitive["targets"][k - 1][name]);
                        base.iter().zip(by).map(|(from, by)| [0, 1, 2].map(|i| from[i] + by[i])).collect()
                    };
                    let error = apart(&moved, &alone.rows(&other[name]));
                    assert!(error < 2e-6, "{name} of frame {k} is {error} off in {question}");
                }
                assert!(k > 0 || primitive["targets"][0].get("NORMAL").is_some() == (normals != "none"));
            }
            let mut sized = question.clone();
            sized["outputs"] = json!([output]);
            check_size(&sized);
        }
    }
}

#[test]
fn what_frames_cannot_be_part_of_is_refused_at_its_place() {
    let question = &questions()[0];
    let of = |output: Value| {
        let mut question = question.clone();
        question["outputs"] = json!([output]);
        parsed(question.to_string().as_bytes()).expect_err("it is refused")
    };
    let found = of(json!({ "format": "obj" }));
    assert_eq!(found[0].pointer, "/outputs/0/frame");
    assert_eq!(found[0].detail, "obj holds one frame, the mesh has 3; give a \"frame\" from 0 to 2, or ask for glb");
    assert_eq!(
        of(json!({ "format": "obj", "frame": 3 }))[0].detail,
        "there is no frame 3; the mesh has 3, counted from 0"
    );
    for wrong in [json!(-1), json!(0.5), json!("one"), json!(1024)] {
        assert_eq!(of(json!({ "format": "glb", "frame": wrong }))[0].pointer, "/outputs/0/frame");
    }
    let with = |pointer: &str, value: Value| {
        let mut question = question.clone();
        let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
        question.pointer_mut(parent).expect("the place exists")[name] = value;
        refusal(&question).into_iter().map(|(pointer, _)| pointer).collect::<Vec<_>>()
    };
    assert!(with("/input/weld", json!(0)).contains(&"/input/weld".into()));
    assert!(with("/input/pair_quads", json!(true)).contains(&"/input/pair_quads".into()));
    assert!(with("/levels", json!({ "tolerance": 0.1 })).contains(&"/levels".into()));
    assert_eq!(with("/input/mesh/frames", json!([[[0, 0, 0]]])), ["/input/mesh/frames/0"]);
    assert_eq!(with("/input/mesh/frames", json!([[[0, 0]]])), ["/input/mesh/frames/0/0"]);
    assert_eq!(with("/input/mesh/frames", json!(vec![json!([]); 1024])), ["/input/mesh/frames"]);
    let curve = json!({
        "input": { "polygon": { "points": [[0, 0], [1, 0], [1, 1]] } }, "plan": { "preset": "chaikin" }, "levels": 1,
        "outputs": [{ "format": "json", "frame": 0 }],
    });
    assert_eq!(parsed(curve.to_string().as_bytes()).expect_err("it is refused")[0].pointer, "/outputs/0/frame");
}

#[test]
fn each_frame_counts_as_vertices_of_its_own() {
    let mut question = questions()[0].clone();
    let limits = |max_vertices| Limits { max_vertices, ..Limits::default() };
    let estimate =
        |question: &Value, most| limits(most).estimate(&parsed(question.to_string().as_bytes()).expect("a job"));
    question["outputs"] = json!([{ "format": "glb" }]);
    assert!(estimate(&question, 3 * 98).is_ok());
    let Err(Refusal::TooLarge { detail, .. }) = estimate(&question, 3 * 98 - 1) else { panic!("it is too large") };
    assert!(detail.contains("294 vertices in all frames"), "{detail}");
    question["outputs"] = json!([{ "format": "glb", "frame": 1 }, { "format": "obj", "frame": 2 }]);
    assert!(estimate(&question, 98).is_ok());
    assert!(!bytes(&question).is_empty());
}

#[test]
fn vertices_that_join_fans_are_split_in_all_frames() {
    let [a, b] = [[0, 1, 2], [0, 3, 4]];
    let positions = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [-1., 0., 0.], [-1., -1., 0.]];
    let net = Net { positions: positions.to_vec(), faces: vec![a.to_vec(), b.to_vec()] };
    let question = animated(&net, &json!({}), &json!({ "preset": "loop" }), 1);
    let whole = Glb::of(&written(&question, &json!({ "format": "glb" })));
    let targets = &whole.document["meshes"][0]["primitives"][0]["targets"];
    assert_eq!(targets.as_array().map(Vec::len), Some(2));
    assert_eq!(whole.rows(&targets[1]["POSITION"]).len(), 12);
}

#[test]
fn an_animation_leads_through_all_frames_at_the_given_rate() {
    let question = &questions()[1];
    for up in ["y", "z"] {
        let mut question = question.clone();
        question["input"]["up"] = json!(up);
        let output = json!({ "format": "glb", "frames_per_second": 8 });
        let whole = Glb::of(&written(&question, &output));
        let animation = &whole.document["animations"][0];
        let sampler = &animation["samplers"][0];
        assert_eq!(whole.scalars(&sampler["input"]), [0.0, 0.125, 0.25]);
        assert_eq!(whole.scalars(&sampler["output"]), [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
        let target = &animation["channels"][0]["target"];
        assert_eq!(target["path"], "weights");
        assert!(whole.document["nodes"][Glb::number(&target["node"])].get("mesh").is_some());
        let mut sized = question.clone();
        sized["outputs"] = json!([output]);
        check_size(&sized);
        sized["outputs"] = json!([{ "format": "gltf", "frames_per_second": 24, "frame": 1 }]);
        let Err(faults) = crate::support::render(&sized) else { panic!("one frame makes no animation") };
        assert_eq!(faults[0].pointer, "/outputs/0/frames_per_second");
    }
}
