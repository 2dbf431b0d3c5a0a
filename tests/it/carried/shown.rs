//! Pictures coloured by carried data.

use serde_json::{Value, json};

use crate::support::nets::{self, Net};
use crate::support::render;

/// Returns a job for a cube with these entries, drawn with these options.
fn job(carried: &Value, options: &Value) -> Value {
    let mut mesh = nets::cube().to_json();
    for (name, value) in carried.as_object().expect("entries") {
        mesh[name] = value.clone();
    }
    let mut output = json!({ "format": "png", "width": 64, "height": 48 });
    for (name, value) in options.as_object().expect("options") {
        output[name] = value.clone();
    }
    json!({ "input": { "mesh": mesh }, "outputs": [output] })
}

/// The bytes of a picture, whose debug output omits them.
#[derive(PartialEq)]
struct Picture(Vec<u8>);

impl std::fmt::Debug for Picture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a picture of {} bytes", self.0.len())
    }
}

fn picture(carried: &Value, options: &Value) -> Picture {
    Picture(render(&job(carried, options)).unwrap_or_else(|faults| panic!("{faults:?}")).0)
}

fn pixels(Picture(bytes): &Picture) -> Vec<[u8; 4]> {
    let picture = image::load_from_memory_with_format(bytes, image::ImageFormat::Png).expect("it is a picture");
    picture.to_rgba8().pixels().map(|pixel| pixel.0).collect()
}

fn channel(rows: &[Value]) -> Value {
    json!({ "channels": { "color": rows } })
}

#[test]
fn one_colour_for_all_vertices_is_that_colour() {
    // 51, 102 and 153 of 255
    let constant = channel(&vec![json!([0.2, 0.4, 0.6]); 8]);
    let plain = picture(&json!({}), &json!({ "color": "#336699" }));
    for shading in ["smooth", "flat"] {
        let plain = picture(&json!({}), &json!({ "color": "#336699", "shading": shading }));
        assert_eq!(picture(&constant, &json!({ "color_by": "channel", "shading": shading })), plain);
    }
    // alpha is ignored, and values beyond 0 to 1 are clamped
    let clear = channel(&vec![json!([0.2, 0.4, 0.6, 0.1]); 8]);
    assert_eq!(picture(&clear, &json!({ "color_by": "channel" })), plain);
    let bright = picture(&channel(&vec![json!([7.0, -3.0, 1.0]); 8]), &json!({ "color_by": "channel" }));
    assert_eq!(bright, picture(&json!({}), &json!({ "color": "#ff00ff" })));
    // and without `color_by` the channel is not shown
    assert_eq!(picture(&constant, &json!({ "color": "#336699" })), plain);
}

#[test]
fn colours_of_vertices_are_blended_between_them() {
    let rows: Vec<Value> = (0..8).map(|v| if v % 2 == 0 { json!([1, 0, 0]) } else { json!([0, 0, 1]) }).collect();
    let found = pixels(&picture(&channel(&rows), &json!({ "color_by": "channel", "background": "transparent" })));
    let solid = found.iter().filter(|pixel| pixel[3] == 255);
    let [mut red, mut blue, mut between] = [0; 3];
    for pixel in solid {
        match (pixel[0] > pixel[2].saturating_add(90), pixel[2] > pixel[0].saturating_add(90)) {
            (true, _) => red += 1,
            (_, true) => blue += 1,
            _ => between += 1,
        }
    }
    assert!(red > 20 && blue > 20 && between > 20, "{red} {blue} {between}");
}

#[test]
fn weights_are_seen_by_their_share_of_the_range() {
    let weights = |scale: f64, shift: f64| {
        let values: Vec<f64> = (0..8).map(|v| f64::from(v * v) * scale + shift).collect();
        picture(
            &json!({ "channels": { "warmth": values } }),
            &json!({ "color_by": "channel", "channel": "warmth", "camera": { "azimuth_deg": 40 } }),
        )
    };
    let expected = weights(1.0, 0.0);
    assert_eq!(weights(4.0, -32.0), expected);
    assert_eq!(weights(0.125, 1.0), expected);
    assert_ne!(weights(-1.0, 0.0), expected);
    // if all values are equal, one colour; and the largest possible range
    assert_eq!(weights(0.0, 3.0), weights(0.0, -1.0));
    let huge = json!({ "channels": { "warmth": [-1.7e308, 1.7e308, 0, 0, 0, 0, 0, 0] } });
    assert!(!picture(&huge, &json!({ "color_by": "channel", "channel": "warmth" })).0.is_empty());
}

fn squares(shift: [f64; 2]) -> Picture {
    let values: Vec<[f64; 2]> = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
        .iter()
        .map(|uv| [uv[0] + shift[0], uv[1] + shift[1]])
        .collect();
    let uvs = json!({ "uvs": { "values": values, "faces": vec![[0, 1, 2, 3]; 6] } });
    picture(&uvs, &json!({ "color_by": "uvs", "color": "#000" }))
}

#[test]
fn squares_are_an_eighth_wide_and_alternate() {
    let expected = squares([0.0, 0.0]);
    for shift in [[0.25, 0.0], [0.0, -0.75], [0.125, 0.125], [1024.0, -0.25]] {
        assert_eq!(squares(shift), expected, "{shift:?}");
    }
    for far in [1e9, 1e300, f64::MAX] {
        assert!(!squares([far, -far]).0.is_empty(), "{far:e}");
    }
    let swapped = squares([0.125, 0.0]);
    assert_ne!(swapped, expected);
    assert_eq!(squares([0.0, 0.125]), swapped);
    // seen from afar, half of the surface is dark
    let dark = |picture: &Picture| pixels(picture).iter().filter(|pixel| pixel[0] < 90).count();
    assert!(dark(&expected) > 100 && dark(&expected).abs_diff(dark(&swapped)) < 80);
}

#[test]
fn groups_and_materials_have_a_colour_each() {
    let of = |kind: &str, sets: Value| picture(&json!({ kind: sets }), &json!({ "color_by": kind, "color": "#fff" }));
    let all = json!([{ "name": "all", "faces": [0, 1, 2, 3, 4, 5] }]);
    let one = of("groups", all.clone());
    assert_eq!(of("materials", all), one, "the first name has the first colour");
    let none = picture(&json!({}), &json!({ "color": "#fff" }));
    assert_ne!(one, none);
    assert_eq!(of("groups", json!([{ "name": "none", "faces": [] }])), none, "faces without a name are as they were");
    let renamed = json!([{ "name": "other", "faces": [5, 4, 3, 2, 1, 0] }]);
    assert_eq!(of("groups", renamed), one);
    // as many colours as faces
    let faces: Vec<Value> = (0..6).map(|f| json!({ "name": format!("f{f}"), "faces": [f] })).collect();
    assert_eq!(of("groups", json!(faces)), picture(&json!({}), &json!({ "color_by": "faces" })));
}

#[test]
fn what_a_mesh_does_not_carry_cannot_be_shown() {
    let pairs = json!({ "channels": { "pair": vec![[1, 2]; 8], "w": vec![1; 8] } });
    for (carried, options, place, said) in [
        (json!({}), json!({ "color_by": "channel" }), "channel", "no channel \"color\"; it has none"),
        (
            pairs.clone(),
            json!({ "color_by": "channel", "channel": "heat" }),
            "channel",
            "no channel \"heat\"; it has pair, w",
        ),
        (pairs.clone(), json!({ "color_by": "channel", "channel": "pair" }), "channel", "has 2 numbers a vertex"),
        (pairs.clone(), json!({ "channel": "w" }), "channel", "\"color_by\" is \"channel\""),
        (pairs, json!({ "color_by": "channel", "channel": "" }), "channel", "1 to 64 characters"),
        (json!({}), json!({ "color_by": "uvs" }), "color_by", "no texture coordinates"),
        (json!({}), json!({ "color_by": "groups" }), "color_by", "no groups"),
        (json!({}), json!({ "color_by": "materials" }), "color_by", "no materials"),
        (json!({}), json!({ "color_by": "height" }), "color_by", "expected one of none, channel"),
    ] {
        let faults = render(&job(&carried, &options)).map(|_| "drawn").expect_err("it is refused");
        assert_eq!(faults[0].pointer, format!("/outputs/0/{place}"));
        assert!(faults[0].detail.contains(said), "{faults:?}");
    }
    let line = json!({ "polygon": { "points": [[0, 0], [1, 0], [1, 1]] } });
    for by in ["channel", "uvs", "groups", "materials", "faces"] {
        let outputs = json!([{ "format": "png", "color_by": by }]);
        let faults =
            render(&json!({ "input": line, "outputs": outputs })).map(|_| "drawn").expect_err("curves have one colour");
        assert_eq!(faults[0].pointer, "/outputs/0/color_by");
    }
}

#[test]
fn faces_and_edges_of_the_input_are_shown_where_they_stay() {
    let Net { positions, faces } = nets::cube();
    let input = json!({ "mesh": { "positions": positions, "faces": faces } });
    for options in [json!({ "color_by": "faces" }), json!({ "show": ["isolines"] })] {
        for (word, stays) in [("UC", true), ("U3C", true), ("UD", false)] {
            let mut output = json!({ "format": "png", "width": 32, "height": 32 });
            for (name, value) in options.as_object().expect("options") {
                output[name] = value.clone();
            }
            let job = json!({ "input": input, "plan": { "word": word }, "levels": 1, "outputs": [output] });
            match render(&job) {
                Ok(_) => assert!(stays, "{word}"),
                Err(faults) => {
                    assert!(!stays && faults[0].pointer == "/plan/word", "{faults:?}");
                    assert!(faults[0].detail.contains("cannot carry"), "{faults:?}");
                }
            }
        }
    }
}
